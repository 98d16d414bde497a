//! From a mesh specification to a surface in its place.

use nalgebra::{Rotation3, Unit};

use super::point_cache::PointCache;
use super::spec::{CylinderSpec, Diagonals, MeshSpec, RotationSpec, UpAxis};
use crate::Vec3;
use crate::burning::{QuadMesh, Texture};
use crate::mesh::generate::{self, Corrugation, GeneratorError, GridDiagonals, HatSize};
use crate::mesh::{MeshError, OrientationPolicy, Surface, SurfaceOptions, UnreferencedPolicy};

/// Where mesh files and files of values by face come from; the library's scenes read no files themselves.
pub trait MeshSource {
    /// The mesh of the file named in a scene, checked but not scaled.
    ///
    /// # Errors
    /// Whatever the reader says; it is told with the place of the name.
    fn read(&self, file: &str, options: SurfaceOptions) -> Result<Surface, UnreadableMesh>;

    /// The text of a file of values by face; refused unless the source has such files.
    ///
    /// # Errors
    /// Whatever the reader says.
    fn read_text(&self, _file: &str) -> Result<String, UnreadableMesh> {
        Err(no_files())
    }

    /// The mesh of quads of the file named in a scene; refused unless the source has such files.
    ///
    /// # Errors
    /// Whatever the reader says.
    fn read_quads(&self, _file: &str) -> Result<QuadMesh, UnreadableMesh> {
        Err(no_files())
    }

    /// The image of the file named in a scene; refused unless the source has such files.
    ///
    /// # Errors
    /// Whatever the reader says.
    fn read_texture(&self, _file: &str) -> Result<Texture, UnreadableMesh> {
        Err(no_files())
    }

    /// The positions over time of the file named in a scene; refused unless the source has such files.
    ///
    /// # Errors
    /// Whatever the reader says.
    fn read_points(&self, _file: &str) -> Result<PointCache, UnreadableMesh> {
        Err(no_files())
    }
}

fn no_files() -> UnreadableMesh {
    UnreadableMesh {
        message: "this scene may not read files".to_owned(),
        help: None,
    }
}

/// Why a mesh file cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct UnreadableMesh {
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub help: Option<String>,
}

/// For scenes without mesh files.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFiles;

impl MeshSource for NoFiles {
    fn read(&self, _: &str, _: SurfaceOptions) -> Result<Surface, UnreadableMesh> {
        Err(no_files())
    }
}

/// Why a mesh of a scene cannot be had.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(super) enum ShapeError {
    #[error(transparent)]
    File(#[from] UnreadableMesh),
    #[error(transparent)]
    Generator(#[from] GeneratorError),
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error("a frame has {found} vertices, the mesh {expected}; export both from the same mesh")]
    PointCount { found: usize, expected: usize },
}

/// Reads or generates a mesh and puts it in its place.
pub(super) fn place(spec: &MeshSpec, source: &dyn MeshSource) -> Result<Surface, ShapeError> {
    let mut surface = make(spec, source)?;
    Placement::of(spec, &surface).apply(&mut surface.positions);
    // Checked again: a scale may push coordinates out of the range where areas can be computed.
    Ok(Surface::from_mesh(surface.mesh, surface.positions)?)
}

/// Puts other positions of a mesh's vertices, frame by frame, where [`place`] would, as if they were the mesh's own.
pub(super) fn place_points(
    spec: &MeshSpec,
    source: &dyn MeshSource,
    mut frames: Vec<Vec<Vec3>>,
) -> Result<Vec<Vec<Vec3>>, ShapeError> {
    let surface = make(spec, source)?;
    let expected = surface.positions.len();
    if let Some(found) = frames.iter().map(Vec::len).find(|&found| found != expected) {
        return Err(ShapeError::PointCount { found, expected });
    }
    let placement = Placement::of(spec, &surface);
    for points in &mut frames {
        placement.apply(points);
    }
    Ok(frames)
}

/// What is done to the vertices of a mesh: scaled, stood up, centred, turned, moved.
struct Placement<'a> {
    spec: &'a MeshSpec,
    /// What is the origin after centring [m].
    center: Option<Vec3>,
}

impl<'a> Placement<'a> {
    /// That of a mesh as it was read or generated, which says where its centre is.
    fn of(spec: &'a MeshSpec, surface: &Surface) -> Self {
        let mut placement = Self { spec, center: None };
        if spec.center {
            let mut points = surface.positions.clone();
            placement.stand_up(&mut points);
            let box_of = |start: [Vec3; 2], x: &Vec3| [start[0].inf(x), start[1].sup(x)];
            let start = [points[0], points[0]];
            let [low, high] = points.iter().fold(start, box_of);
            placement.center = Some((low + high) / 2.0);
        }
        placement
    }

    fn stand_up(&self, points: &mut [Vec3]) {
        let stretch = Vec3::from(self.spec.stretch.unwrap_or([1.0; 3]));
        let scale = stretch * (self.spec.units.in_metres() * self.spec.scale);
        for x in points {
            x.component_mul_assign(&scale);
            if self.spec.up == UpAxis::Y {
                *x = Vec3::new(x.x, -x.z, x.y);
            }
        }
    }

    fn apply(&self, points: &mut [Vec3]) {
        self.stand_up(points);
        for x in points {
            if let Some(center) = self.center {
                *x -= center;
            }
            *x = move_point(*x, self.spec.rotate.as_ref(), self.spec.translate);
        }
    }
}

/// Rotates, then translates.
pub(super) fn move_to(surface: &mut Surface, rotate: Option<&RotationSpec>, translate: [f64; 3]) {
    for x in &mut surface.positions {
        *x = move_point(*x, rotate, translate);
    }
}

/// Rotates, then translates.
pub(super) fn move_point(x: Vec3, rotate: Option<&RotationSpec>, translate: [f64; 3]) -> Vec3 {
    let turned = rotate.map_or(x, |rotate| {
        let pivot = Vec3::from(rotate.through);
        turn(rotate) * (x - pivot) + pivot
    });
    turned + Vec3::from(translate)
}

/// The rotation without its pivot: for directions.
pub(super) fn turn(rotate: &RotationSpec) -> Rotation3<f64> {
    let axis = Unit::new_normalize(Vec3::from(rotate.axis));
    Rotation3::from_axis_angle(&axis, rotate.degrees.to_radians())
}

fn make(spec: &MeshSpec, source: &dyn MeshSource) -> Result<Surface, ShapeError> {
    if let Some(file) = &spec.file {
        let orientation = match spec.repair_orientation {
            true => OrientationPolicy::Repair,
            false => OrientationPolicy::Refuse,
        };
        let unreferenced = UnreferencedPolicy::Drop;
        return Ok(source.read(
            file,
            SurfaceOptions {
                orientation,
                unreferenced,
            },
        )?);
    }
    Ok(generate(spec)?)
}

fn cylinder(spec: &CylinderSpec) -> Result<Surface, GeneratorError> {
    let (radius, height) = (spec.radius, spec.height);
    match &spec.corrugation {
        None => generate::cylinder(radius, height, spec.around, spec.along),
        Some(waves) => {
            let corrugation = Corrugation {
                waves: waves.waves,
                depth: waves.depth,
            };
            generate::corrugated_tube(radius, height, corrugation, spec.around, spec.along)
        }
    }
}

fn generate(spec: &MeshSpec) -> Result<Surface, GeneratorError> {
    if let Some(g) = &spec.grid {
        let [nx, ny] = g.cells;
        return generate::grid(g.size[0], g.size[1], nx, ny, diagonals(g.diagonals));
    }
    if let Some(g) = &spec.irregular {
        return generate::irregular(g.size[0], g.size[1], g.max_area, g.seed);
    }
    if let Some(g) = &spec.disc {
        return generate::disc(g.radius, g.rings);
    }
    if let Some(g) = &spec.cylinder {
        return cylinder(g);
    }
    if let Some(g) = &spec.cone {
        return generate::cone(g.base_radius, g.height, g.top_radius, g.around, g.along);
    }
    if let Some(g) = &spec.icosphere {
        return generate::icosphere(g.radius, g.subdivisions);
    }
    if let Some(g) = &spec.torus {
        return generate::torus(g.major_radius, g.minor_radius, g.around, g.tube);
    }
    if let Some(g) = &spec.cap {
        let hole = g.hole_degrees.map(f64::to_radians);
        let angle = g.degrees.to_radians();
        return match g.inset {
            None => generate::spherical_cap(g.radius, angle, hole, g.rings),
            Some(inset) => generate::inset_cap(g.radius, angle, hole, inset, g.rings),
        };
    }
    if let Some(g) = &spec.panel {
        let angles = g.degrees.map(f64::to_radians);
        let diagonals = diagonals(g.diagonals);
        return generate::cylinder_panel(g.radius, g.length, angles, g.cells, diagonals);
    }
    if let Some(g) = &spec.zone {
        let [longitudes, latitudes] =
            [g.longitudes, g.latitudes].map(|angles| angles.map(f64::to_radians));
        let diagonals = diagonals(g.diagonals);
        return generate::sphere_zone(g.radius, longitudes, latitudes, g.cells, diagonals);
    }
    if let Some(g) = &spec.vee {
        return generate::vee(g.length, g.width, g.degrees.to_radians(), g.along, g.across);
    }
    if let Some(g) = &spec.hat {
        let size = HatSize {
            radius: g.radius,
            height: g.height,
            brim: g.brim,
            slope: g.slope,
        };
        return generate::hat(size, g.around, g.rings);
    }
    // The scene's checks let exactly one shape through.
    Err(GeneratorError::Mesh(MeshError::Empty))
}

fn diagonals(given: Diagonals) -> GridDiagonals {
    match given {
        Diagonals::Uniform => GridDiagonals::Uniform,
        Diagonals::Alternating => GridDiagonals::Alternating,
        Diagonals::Checkerboard => GridDiagonals::Checkerboard,
    }
}

#[cfg(test)]
mod tests {
    use super::super::spec::{GridSpec, Units};
    use super::*;

    struct OneTriangle;

    impl MeshSource for OneTriangle {
        fn read(&self, _: &str, options: SurfaceOptions) -> Result<Surface, UnreadableMesh> {
            let positions = [[0.0, 0.0, 0.0], [0.0, 0.0, 10.0], [0.0, 20.0, 0.0]];
            let positions = positions.map(Vec3::from).to_vec();
            Ok(Surface::new(positions, vec![[0, 1, 2]], options).unwrap())
        }
    }

    #[test]
    fn files_are_scaled_turned_centred_and_moved_in_this_order() {
        let spec = MeshSpec {
            file: Some("a.obj".into()),
            units: Units::Millimetre,
            scale: 2.0,
            up: UpAxis::Y,
            center: true,
            translate: [1.0, 0.0, 0.0],
            ..MeshSpec::default()
        };
        let surface = place(&spec, &OneTriangle).unwrap();
        let (low, high) = surface.bounding_box();
        // 20 mm along the file's y, doubled, now stand along z; 10 mm along its z lie along −y.
        assert!((low - Vec3::new(1.0, -0.01, -0.02)).norm() < 1e-15, "{low}");
        assert!((high - Vec3::new(1.0, 0.01, 0.02)).norm() < 1e-15, "{high}");
    }

    #[test]
    fn a_generated_mesh_that_is_not_moved_keeps_its_exact_coordinates() {
        let spec = MeshSpec {
            grid: Some(GridSpec {
                size: [1.0, 1.0],
                cells: [3, 3],
                diagonals: Diagonals::Checkerboard,
            }),
            scale: 1.0,
            ..MeshSpec::default()
        };
        let expected = generate::grid(1.0, 1.0, 3, 3, GridDiagonals::Checkerboard).unwrap();
        assert_eq!(place(&spec, &NoFiles).unwrap(), expected);
    }
}
