//! Bent shapes of known energy on meshes of any resolution: the convergence benchmark of "Better Bending" (2026),
//! section 8, with the misprints of the parametrisations corrected.
//!
//! ```text
//! cylinder    r(x, y) = (R cos(x/R), R sin(x/R), y)              x ∈ [0, πR], y ∈ [0, H]; R = 0.0325, H = 0.122
//!             rest: the rectangle, or curved the other way: (R cos(y/R), R sin(y/R), x)
//! sphere      radius R = 0.03; rest flat in its own metric
//! half-torus  r(x, y) = ((R + r cos(y/r)) cos(x/R), (R + r cos(y/r)) sin(x/R), r sin(y/r))
//!             x ∈ [0, 2πR], open at the seam, y ∈ [0, πr]; R = 0.03, r = 0.015; rest flat in its own metric
//! helix       r(x, y) = (R cos φ − (H + y) sin φ, R sin φ + (H + y) cos φ, P (x + y) / 2πR),  φ = x/R
//!             rest: (ρ cos ψ − (H + y) a/R sin ψ, ρ sin ψ + (H + y) a/R cos ψ, 0),  ψ = x/a, ρ = a²/R
//!             a² = R² + (P/2π)²; x ∈ [0, 2πR], y ∈ [0, H]; R = 0.02, H = P = 0.1
//! ```
//!
//! All lengths in metres.

use std::f64::consts::PI;

use crate::Vec3;
use crate::mesh::Surface;
use crate::mesh::generate::{GeneratorError, GridDiagonals, delaunay, grid, random_sphere};
use crate::scene::model::BendingModel;

const CYLINDER_RADIUS: f64 = 0.0325;
const CYLINDER_LENGTH: f64 = 0.122;
const SPHERE_RADIUS: f64 = 0.03;
const TORUS_RADII: [f64; 2] = [0.03, 0.015];
const HELIX_RADIUS: f64 = 0.02;
/// H and P.
const HELIX_HEIGHT: f64 = 0.1;
/// The points of the sphere.
const SPHERE_SEED: u64 = 1;

/// The nine shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KnownShape {
    /// Half a cylinder on a regular grid.
    CylinderRegular,
    /// On irregular triangles.
    CylinderIrregular,
    /// On irregular triangles that were squeezed to a quarter along the axis.
    CylinderAnisotropic,
    /// With a rest shape that is a cylinder about the other direction, bent to the other side; irregular triangles.
    CylinderRestCurved,
    /// A sphere without membrane stress whose rest state is flat; hull of random points.
    Sphere,
    /// The outer half of a torus, in the same way; regular grid.
    HalfTorusRegular,
    /// On irregular triangles.
    HalfTorusIrregular,
    /// The tangent developable of a helix on a regular grid of its parameters.
    HelixRegular,
    /// On irregular triangles of its parameters.
    HelixIrregular,
}

/// A shape on a mesh, with its exact energies.
#[derive(Clone, Debug)]
pub struct KnownSurface {
    /// The shape.
    pub deformed: Surface,
    /// Rest positions of its vertices.
    pub rest_positions: Vec<Vec3>,
    /// Whether the rest curvature is that of the rest positions.
    pub rest_curved: bool,
}

/// Which smooth energy a discrete one stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SmoothEnergy {
    /// Squared Curvature: (h³/24) (α + 2β) ∫ (tr S)² dĀ.
    SquaredCurvature,
    /// Koiter: (h³/12) ∫ (α/2 (tr S)² + β tr S²) dĀ.
    Koiter,
}

impl SmoothEnergy {
    /// What a bending model stands for; `None` for the absence of one.
    pub fn of(model: BendingModel) -> Option<Self> {
        match model {
            BendingModel::Bac
            | BendingModel::Dcs
            | BendingModel::Dso
            | BendingModel::Dkt
            | BendingModel::MeAverage => Some(Self::Koiter),
            BendingModel::Ds2nd
            | BendingModel::DsTheta
            | BendingModel::DsTan
            | BendingModel::ChEs
            | BendingModel::ChFs
            | BendingModel::QbCr
            | BendingModel::QbPl
            | BendingModel::QbInt => Some(Self::SquaredCurvature),
            BendingModel::None => None,
        }
    }
}

impl KnownShape {
    /// In the order of the published table.
    pub const ALL: [Self; 9] = [
        Self::CylinderRegular,
        Self::CylinderIrregular,
        Self::CylinderAnisotropic,
        Self::CylinderRestCurved,
        Self::Sphere,
        Self::HalfTorusRegular,
        Self::HalfTorusIrregular,
        Self::HelixRegular,
        Self::HelixIrregular,
    ];

    /// Name on the command line and in data files.
    pub fn name(self) -> &'static str {
        match self {
            Self::CylinderRegular => "cylinder-regular",
            Self::CylinderIrregular => "cylinder-irregular",
            Self::CylinderAnisotropic => "cylinder-anisotropic",
            Self::CylinderRestCurved => "cylinder-rest-curved",
            Self::Sphere => "sphere",
            Self::HalfTorusRegular => "half-torus-regular",
            Self::HalfTorusIrregular => "half-torus-irregular",
            Self::HelixRegular => "helix-regular",
            Self::HelixIrregular => "helix-irregular",
        }
    }

    /// The shape with triangles of about (regular) or at most (irregular) `area` [m²].
    ///
    /// # Errors
    /// An area that is not positive, too many faces.
    pub fn surface(self, area: f64) -> Result<KnownSurface, GeneratorError> {
        let cylinder = |sheet: Surface| KnownSurface::mapped(&sheet, roll, lay_flat);
        let [torus_width, torus_depth] = [2.0 * PI * TORUS_RADII[0], PI * TORUS_RADII[1]];
        let (width, length) = (PI * CYLINDER_RADIUS, CYLINDER_LENGTH);
        let helix_width = 2.0 * PI * HELIX_RADIUS;
        Ok(match self {
            Self::CylinderRegular => cylinder(regular(width, length, area)?),
            Self::CylinderIrregular => cylinder(irregular(width, length, area)?),
            Self::CylinderAnisotropic => {
                let mut sheet = irregular(width, 4.0 * length, 4.0 * area)?;
                sheet.positions.iter_mut().for_each(|x| x.y *= 0.25);
                cylinder(sheet)
            }
            Self::CylinderRestCurved => KnownSurface {
                rest_curved: true,
                ..KnownSurface::mapped(&irregular(width, length, area)?, roll, |x| {
                    let back = roll(&Vec3::new(x.y, x.x, 0.0));
                    Vec3::new(back.x, back.y, x.x)
                })
            },
            Self::Sphere => {
                let count = 2.0 * PI * SPHERE_RADIUS * SPHERE_RADIUS / area + 2.0;
                let ball = random_sphere(SPHERE_RADIUS, count as usize, SPHERE_SEED)?;
                KnownSurface::without_membrane_stress(ball)
            }
            Self::HalfTorusRegular => {
                let sheet = regular(torus_width, torus_depth, area)?;
                KnownSurface::without_membrane_stress(mapped(&sheet, half_torus))
            }
            Self::HalfTorusIrregular => {
                let sheet = irregular(torus_width, torus_depth, area)?;
                KnownSurface::without_membrane_stress(mapped(&sheet, half_torus))
            }
            Self::HelixRegular => {
                let sheet = regular(helix_width, HELIX_HEIGHT, area)?;
                KnownSurface::mapped(&sheet, helix, helix_at_rest)
            }
            Self::HelixIrregular => {
                let sheet = irregular(helix_width, HELIX_HEIGHT, area)?;
                KnownSurface::mapped(&sheet, helix, helix_at_rest)
            }
        })
    }

    /// The exact energy [J] of the smooth shape with thickness h and plane-stress Lamé constants α, β: Eqs. (55) to (59),
    /// with the h³ that (58) lacks and the R that (59) lacks. On the curved rest shape the mean curvatures are opposite
    /// with the parametrisations as printed, so that the Squared Curvature energy is four times that of the cylinder and
    /// not zero.
    pub fn exact_energy(self, energy: SmoothEnergy, h: f64, [alpha, beta]: [f64; 2]) -> f64 {
        let h3 = h.powi(3);
        let cylinder = (0.5 * alpha + beta) * PI * h3 * CYLINDER_LENGTH / (12.0 * CYLINDER_RADIUS);
        match (self, energy) {
            (Self::CylinderRestCurved, SmoothEnergy::SquaredCurvature) => 4.0 * cylinder,
            (Self::CylinderRestCurved, SmoothEnergy::Koiter) => {
                (alpha + beta) * PI * h3 * CYLINDER_LENGTH / (6.0 * CYLINDER_RADIUS)
            }
            (Self::CylinderRegular | Self::CylinderIrregular | Self::CylinderAnisotropic, _) => {
                cylinder
            }
            (Self::Sphere, SmoothEnergy::SquaredCurvature) => {
                2.0 / 3.0 * (alpha + 2.0 * beta) * PI * h3
            }
            (Self::Sphere, SmoothEnergy::Koiter) => 2.0 / 3.0 * (alpha + beta) * PI * h3,
            (Self::HalfTorusRegular | Self::HalfTorusIrregular, _) => {
                let [big, small] = TORUS_RADII;
                let root = (big * big - small * small).sqrt();
                h3 * (PI * big).powi(2) * (alpha + 2.0 * beta) / (12.0 * small * root)
            }
            (Self::HelixRegular | Self::HelixIrregular, _) => {
                let (pitch, turn) = (HELIX_HEIGHT, 2.0 * PI * HELIX_RADIUS);
                h3 * pitch * pitch * (alpha + 2.0 * beta) * 2f64.ln()
                    / (24.0 * HELIX_RADIUS * pitch.hypot(turn))
            }
        }
    }
}

impl KnownSurface {
    fn mapped(
        sheet: &Surface,
        deform: impl Fn(&Vec3) -> Vec3,
        rest: impl Fn(&Vec3) -> Vec3,
    ) -> Self {
        Self {
            deformed: mapped(sheet, deform),
            rest_positions: sheet.positions.iter().map(rest).collect(),
            rest_curved: false,
        }
    }

    fn without_membrane_stress(deformed: Surface) -> Self {
        Self {
            rest_positions: deformed.positions.clone(),
            deformed,
            rest_curved: false,
        }
    }
}

/// A strip of `width` × `length` = 0.01 × 0.1 m, creased along its middle line to the dihedral angle `angle` [rad]: the
/// benchmark of section 9, Eq. (60), on a regular grid of triangles of about `area` [m²] with edges along the crease.
///
/// # Errors
/// An area that is not positive, too many faces.
pub fn creased_vee(angle: f64, area: f64) -> Result<KnownSurface, GeneratorError> {
    let (width, length) = (0.01, 0.1);
    let edge = (2.0 * area).sqrt();
    let n = 2 * cells(0.5 * width, edge);
    let sheet = grid(
        width,
        length,
        n,
        cells(length, edge),
        GridDiagonals::Uniform,
    )?;
    let (sin, cos) = (0.5 * angle).sin_cos();
    let fold = |x: &Vec3| Vec3::new(x.x * sin, x.y, x.x.abs() * cos);
    Ok(KnownSurface::mapped(&sheet, fold, |x| *x))
}

fn cells(length: f64, edge: f64) -> usize {
    ((length / edge) as usize).max(1)
}

/// [0, width] × [0, depth] in right triangles with legs of about √(2 area), all diagonals alike.
fn regular(width: f64, depth: f64, area: f64) -> Result<Surface, GeneratorError> {
    let edge = (2.0 * area).sqrt();
    let (n, m) = (cells(width, edge), cells(depth, edge));
    Ok(from_corner(grid(
        width,
        depth,
        n,
        m,
        GridDiagonals::Uniform,
    )?))
}

/// [0, width] × [0, depth] in Delaunay triangles of at most `area`, with the boundary of the regular one.
fn irregular(width: f64, depth: f64, area: f64) -> Result<Surface, GeneratorError> {
    let edge = (2.0 * area).sqrt();
    let counts = [cells(width, edge), cells(depth, edge)];
    Ok(from_corner(delaunay(width, depth, counts, area)?))
}

/// Generated rectangles are centred; the parameters begin at 0.
fn from_corner(mut sheet: Surface) -> Surface {
    let (low, _) = sheet.bounding_box();
    sheet.positions.iter_mut().for_each(|x| *x -= low);
    sheet
}

fn mapped(sheet: &Surface, map: impl Fn(&Vec3) -> Vec3) -> Surface {
    Surface {
        mesh: sheet.mesh.clone(),
        positions: sheet.positions.iter().map(map).collect(),
    }
}

fn lay_flat(x: &Vec3) -> Vec3 {
    *x
}

fn roll(x: &Vec3) -> Vec3 {
    let (sin, cos) = (x.x / CYLINDER_RADIUS).sin_cos();
    Vec3::new(CYLINDER_RADIUS * cos, CYLINDER_RADIUS * sin, x.y)
}

fn half_torus(x: &Vec3) -> Vec3 {
    let [big, small] = TORUS_RADII;
    let ((sin_x, cos_x), (sin_y, cos_y)) = ((x.x / big).sin_cos(), (x.y / small).sin_cos());
    let radius = big + small * cos_y;
    Vec3::new(radius * cos_x, radius * sin_x, small * sin_y)
}

fn helix(x: &Vec3) -> Vec3 {
    let (sin, cos) = (x.x / HELIX_RADIUS).sin_cos();
    let along = HELIX_HEIGHT + x.y;
    Vec3::new(
        HELIX_RADIUS * cos - along * sin,
        HELIX_RADIUS * sin + along * cos,
        HELIX_HEIGHT * (x.x + x.y) / (2.0 * PI * HELIX_RADIUS),
    )
}

fn helix_at_rest(x: &Vec3) -> Vec3 {
    let a = HELIX_RADIUS.hypot(HELIX_HEIGHT / (2.0 * PI));
    let (sin, cos) = (x.x / a).sin_cos();
    let (radius, along) = (
        a * a / HELIX_RADIUS,
        (HELIX_HEIGHT + x.y) * a / HELIX_RADIUS,
    );
    Vec3::new(radius * cos - along * sin, radius * sin + along * cos, 0.0)
}

/// Discrete Shells on a curved rest shape as the published table has it: with the sizes of the hinge angles only,
/// Σ 3 C ℓ² / (2 (A + A')) (|θ| − |θ̄|)² [J], C the `rigidity` [N·m]. The model itself, Eq. (7), has signed angles.
pub fn unsigned_hinge_energy(surface: &KnownSurface, rigidity: f64) -> f64 {
    let rest = Surface {
        mesh: surface.deformed.mesh.clone(),
        positions: surface.rest_positions.clone(),
    };
    let turn = |shape: &Surface, faces: [usize; 2]| {
        let [n0, n1] = faces.map(|f| {
            let [a, b, c] = shape.corners(f);
            (b - a).cross(&(c - a))
        });
        n0.cross(&n1).norm().atan2(n0.dot(&n1))
    };
    let mut sum = 0.0;
    for (edge, sides) in rest.mesh.edge_faces().iter().enumerate() {
        let [Some(first), Some(second)] = sides else {
            continue;
        };
        let faces = [first.0 as usize, second.0 as usize];
        let change = turn(&surface.deformed, faces) - turn(&rest, faces);
        let area = rest.face_area(faces[0]) + rest.face_area(faces[1]);
        sum += 1.5 * rest.edge_length(edge).powi(2) / area * change * change;
    }
    rigidity * sum
}
