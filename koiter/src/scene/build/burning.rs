//! From `[[double_layer]]` and `[[heat_source]]` to what is stepped.

use super::{Builder, mesh_error, move_point};
use crate::Vec3;
use crate::burning::{
    BurningError, BurningOptions, BurningSetup, BurningShell, DoubleLayer, ProjectionOptions,
    QuadMesh, QuadMeshError, SelfCollisionOptions, Side, Texture,
};
use crate::mesh::{Surface, SurfaceOptions};
use crate::scene::burning::{DoubleLayerPart, HeatSourcePart, Held};
use crate::scene::document::suggest;
use crate::scene::error::{SceneError, SceneErrorKind as Kind};
use crate::scene::heated::HeatedPart;
use crate::scene::placement::ShapeError;
use crate::scene::selection::select;
use crate::scene::spec::{BurningSpec, DoubleLayerSpec, HeatSourceSpec, QuadMeshSpec};

impl Builder<'_> {
    pub(super) fn double_layers(&self) -> Result<Vec<DoubleLayerPart>, SceneError> {
        self.check_constraint_names()?;
        self.spec
            .double_layer
            .iter()
            .map(|spec| self.double_layer(spec))
            .collect()
    }

    pub(super) fn heat_sources(
        &self,
        layers: &[DoubleLayerPart],
        heated: &[HeatedPart],
    ) -> Result<Vec<HeatSourcePart>, SceneError> {
        let source = |spec: &HeatSourceSpec| -> Result<HeatSourcePart, SceneError> {
            let path = format!("heat_source.{}.texture", spec.name);
            let meshes = layers.iter().map(|layer| &layer.setup.shell);
            let on_layers = meshes.map(|shell| self.factors(&path, spec.texture.as_deref(), shell));
            let mut intensity: Vec<Vec<f64>> = on_layers.collect::<Result<_, _>>()?;
            for (factors, layer) in intensity.iter_mut().zip(layers) {
                keep_side(spec.side, &layer.setup.shell, factors);
            }
            for part in heated {
                let surface = &part.setup.rest;
                intensity.push(self.shell_factors(&path, spec.texture.as_deref(), surface)?);
            }
            Ok(HeatSourcePart {
                name: spec.name.clone(),
                ball: (spec.sphere.as_ref()).map(|s| (Vec3::from(s.center), s.radius)),
                motion: spec.motion.to_motion(),
                temperature: spec.temperature,
                rate: spec.rate,
                side: spec.side,
                intensity,
            })
        };
        self.spec.heat_source.iter().map(source).collect()
    }

    fn double_layer(&self, spec: &DoubleLayerSpec) -> Result<DoubleLayerPart, SceneError> {
        let path = format!("double_layer.{}", spec.name);
        let mesh = self.quad_mesh(&format!("{path}.mesh"), &spec.mesh)?;
        let held = self.held(spec, &mesh)?;
        let shell = DoubleLayer::new(mesh, spec.thickness);
        let BurningSpec {
            loss_texture,
            diffusivity_texture,
            ..
        } = &spec.burning;
        let factors = |key: &str, file: &Option<String>| {
            self.factors(&format!("{path}.burning.{key}"), file.as_deref(), &shell)
        };
        let setup = BurningSetup {
            loss_factors: factors("loss_texture", loss_texture)?,
            diffusivity_factors: factors("diffusivity_texture", diffusivity_texture)?,
            area_density: spec.area_density,
            temperature: spec.temperature,
            ambient_temperature: spec.burning.ambient_temperature,
            cooling_rate: spec.burning.cooling_rate,
            diffusivity: spec.burning.diffusivity,
            burning: burning_options(&spec.burning),
            projection: ProjectionOptions {
                method: spec.projection.method,
                compliance: spec.projection.compliance,
                stiffness: spec.projection.stiffness,
                sweeps: spec.projection.sweeps,
                tolerance: spec.projection.tolerance,
                gradient_iterations: spec.projection.iterations,
                longest_move: spec.projection.longest_move,
                weights: spec.projection.weights,
                ..ProjectionOptions::default()
            },
            self_collision: (spec.self_collision.as_ref()).map(|own| SelfCollisionOptions {
                distance: own.distance.unwrap_or(spec.thickness),
                friction: own.friction,
            }),
            damping: spec.damping,
            shell,
        };
        BurningShell::check(&setup).map_err(|error| number_error(&error, &path))?;
        Ok(DoubleLayerPart {
            name: spec.name.clone(),
            setup,
            held,
        })
    }

    fn quad_mesh(&self, path: &str, spec: &QuadMeshSpec) -> Result<QuadMesh, SceneError> {
        let quad_error = |key: &str, error: QuadMeshError| {
            SceneError::new(Kind::Mesh, error.to_string()).inside(&format!("{path}.{key}"))
        };
        let mut mesh = match (&spec.file, &spec.grid, &spec.torus) {
            (Some(file), ..) => (self.source.read_quads(file))
                .map_err(|error| mesh_error(ShapeError::File(error), &format!("{path}.file")))?,
            (_, Some(grid), _) => {
                QuadMesh::grid(grid.size, grid.cells).map_err(|error| quad_error("grid", error))?
            }
            (.., Some(torus)) => {
                let cells = [torus.around, torus.tube];
                QuadMesh::torus(torus.major_radius, torus.minor_radius, cells)
                    .map_err(|error| quad_error("torus", error))?
            }
            _ => return Err(SceneError::new(Kind::MissingKey, "no shape is given").inside(path)),
        };
        mesh.move_by(|x| move_point(x * spec.scale, spec.rotate.as_ref(), spec.translate));
        // A scale may push coordinates out of the range where areas can be computed.
        mesh.check().map_err(|error| quad_error("scale", error))?;
        Ok(mesh)
    }

    /// Brightness of a texture at the particles; without a texture none.
    fn factors(
        &self,
        path: &str,
        file: Option<&str>,
        shell: &DoubleLayer,
    ) -> Result<Vec<f64>, SceneError> {
        let Some(texture) = self.texture(path, file)? else {
            return Ok(Vec::new());
        };
        let at_vertices = texture
            .at_vertices(&shell.mesh)
            .map_err(|error| SceneError::new(Kind::Mesh, error.to_string()).inside(path))?;
        Ok(shell.on_particles(&at_vertices))
    }

    pub(super) fn texture(
        &self,
        path: &str,
        file: Option<&str>,
    ) -> Result<Option<Texture>, SceneError> {
        let read = file.map(|file| self.source.read_texture(file)).transpose();
        read.map_err(|error| mesh_error(ShapeError::File(error), path))
    }

    fn held(&self, spec: &DoubleLayerSpec, mesh: &QuadMesh) -> Result<Vec<Held>, SceneError> {
        let constraints = self.spec.constraint.iter().enumerate();
        let own = constraints.filter(|(_, constraint)| constraint.shell == spec.name);
        own.map(|(index, constraint)| {
            let path = format!("{}.select", constraint.path(index));
            let chosen = select(&constraint.select, &triangles(mesh)?).map_err(|error| {
                SceneError::new(Kind::EmptySelection, format!("'{}': {error}", spec.name))
                    .inside(&path)
            })?;
            Ok(Held {
                particles: chosen.into_iter().map(|vertex| vertex.0).collect(),
                motion: constraint.motion.to_motion(),
                until: constraint.until.unwrap_or(f64::INFINITY),
            })
        })
        .collect()
    }

    fn check_constraint_names(&self) -> Result<(), SceneError> {
        let names: Vec<&str> = self
            .spec
            .double_layer
            .iter()
            .map(|l| l.name.as_str())
            .collect();
        if names.is_empty() {
            return Ok(());
        }
        for (index, constraint) in self.spec.constraint.iter().enumerate() {
            if !names.contains(&constraint.shell.as_str()) {
                let message = format!("there is no double layer '{}'", constraint.shell);
                let path = format!("{}.shell", constraint.path(index));
                return Err(SceneError::new(Kind::UnknownName, message)
                    .inside(&path)
                    .with_help(suggest(&constraint.shell, &names)));
            }
        }
        Ok(())
    }
}

/// A mesh of quads as triangles of the same vertices, in which vertices are selected.
fn triangles(mesh: &QuadMesh) -> Result<Surface, SceneError> {
    let halves = |&[a, b, c, d]: &[u32; 4]| [[a, b, c], [a, c, d]];
    let faces = mesh.quads().iter().flat_map(halves).collect();
    Surface::new(mesh.positions().to_vec(), faces, SurfaceOptions::default())
        .map_err(|error| SceneError::new(Kind::Mesh, error.to_string()))
}

/// A source on one side leaves the particles of the other layer alone.
fn keep_side(side: Side, shell: &DoubleLayer, factors: &mut Vec<f64>) {
    if side == Side::Both {
        return;
    }
    factors.resize(shell.particles.len(), 1.0);
    let (corners, lattice) = factors.split_at_mut(shell.num_corners());
    match side.heats(Side::Top) {
        true => corners.fill(0.0),
        false => lattice.fill(0.0),
    }
}

pub(super) fn burning_options(spec: &BurningSpec) -> BurningOptions {
    BurningOptions {
        ignition_temperature: spec.ignition_temperature,
        loss_rate: spec.loss_rate,
        heat_of_combustion: spec.heat_of_combustion,
        loss_level: spec.loss_level,
        smallest_mass: spec.smallest_mass,
        shrinkage_exponent: spec.shrinkage_exponent,
        largest_change: spec.largest_change,
    }
}

/// A number out of its range, at its key.
pub(super) fn number_error(error: &BurningError, path: &str) -> SceneError {
    let key = match error {
        BurningError::Value { what, .. } => match *what {
            "thickness" | "area_density" | "temperature" | "damping" => format!("{path}.{what}"),
            "tolerance" | "weights" | "compliance" | "stiffness" => {
                format!("{path}.projection.{what}")
            }
            "distance" | "friction" => format!("{path}.self_collision.{what}"),
            _ => format!("{path}.burning.{what}"),
        },
        BurningError::CrossesItself { .. } => format!("{path}.mesh"),
        _ => path.to_owned(),
    };
    SceneError::new(Kind::OutOfRange, error.to_string()).inside(&key)
}
