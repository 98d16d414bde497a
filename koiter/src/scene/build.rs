//! From what was typed to a model that can be simulated: meshes read, selections resolved, plausibility checked.

mod arc_length;
mod bezier;
mod burning;
mod composition;
mod deformation;
mod energies;
mod heated;
mod loads;
mod phases;
mod processes;
mod symmetry;

use super::document::Document;
use super::error::{SceneError, SceneErrorKind as Kind, Warning};
use super::memory;
use super::model::{
    Constraint, ContactOptions, FrictionPair, Model, Obstacle, ObstacleShape, Shell, SolverOptions,
};
use super::phases::Timeline;
use super::placement::{MeshSource, ShapeError, move_point, move_to, place, turn};
use super::probe::{Probe, ProbeTarget};
use super::selection::{SelectionError, select};
use super::spec::{
    MeshSpec, ObstacleSpec, OutputSpec, ProbeQuantity, ProbeSpec, RestSpec, SceneFile, SceneSpec,
    SelectSpec, ShellSpec,
};
use super::warnings;
use crate::Vec3;
use crate::mesh::generate::{box_mesh, solid_cylinder};
use crate::mesh::{Surface, VertexId};

/// A checked scene: the model, how far to run it, what to measure and what to write.
#[derive(Clone, Debug)]
pub struct Scene {
    /// One line.
    pub title: String,
    /// What is simulated.
    pub model: Model,
    /// How far to run it, in which steps.
    pub timeline: Timeline,
    /// What to measure.
    pub probes: Vec<Probe>,
    /// What to write.
    pub output: OutputSpec,
    /// What is implausible.
    pub warnings: Vec<Warning>,
}

impl Scene {
    /// Reads and generates the meshes, resolves selections, and checks the whole.
    ///
    /// # Errors
    /// A mesh that cannot be read, made or used; a rest mesh of other triangles; a selection without vertices.
    pub fn build(file: &SceneFile, source: &dyn MeshSource) -> Result<Self, SceneError> {
        Self::build_within(file, source, u64::MAX)
    }

    /// [`Self::build`] where no more than `memory` [bytes] can be had: generated meshes are counted before they are
    /// made, meshes from files before they are assembled.
    ///
    /// # Errors
    /// As of [`Self::build`], and a scene that is estimated to need more.
    pub fn build_within(
        file: &SceneFile,
        source: &dyn MeshSource,
        memory: u64,
    ) -> Result<Self, SceneError> {
        let place = |error| file.document.place(error);
        memory::check_spec(&file.spec, memory).map_err(place)?;
        let builder = Builder {
            spec: &file.spec,
            source,
        };
        let model = builder.model().map_err(place)?;
        memory::check_model(&model, memory).map_err(place)?;
        arc_length::check_arc_length(&model, &file.spec).map_err(place)?;
        let probes = builder.probes(&model).map_err(place)?;
        let spec = &file.spec;
        let warnings = located(warnings::find(&model, spec), &file.document);
        Ok(Self {
            title: spec.title.clone(),
            timeline: phases::timeline(spec),
            probes,
            output: spec.output.clone(),
            warnings,
            model,
        })
    }
}

fn located(warnings: Vec<Warning>, document: &Document) -> Vec<Warning> {
    warnings
        .into_iter()
        .map(|warning| Warning {
            location: document.locate(&warning.path),
            ..warning
        })
        .collect()
}

struct Builder<'a> {
    spec: &'a SceneSpec,
    source: &'a dyn MeshSource,
}

impl Builder<'_> {
    fn model(&self) -> Result<Model, SceneError> {
        let spec = self.spec;
        let shells = spec
            .shell
            .iter()
            .map(|s| self.shell(s))
            .collect::<Result<Vec<_>, _>>()?;
        let obstacles = spec
            .obstacle
            .iter()
            .map(|o| self.obstacle(o))
            .collect::<Result<_, _>>()?;
        let double_layers = self.double_layers()?;
        let heated_shells = self.heated_shells(&shells)?;
        let heat_sources = self.heat_sources(&double_layers, &heated_shells)?;
        let bezier = self.bezier()?;
        let (constraints, loads, symmetry_planes) = match &bezier {
            // Those of Bézier shells are with them.
            Some(_) => Default::default(),
            None => (
                self.constraints(&shells)?,
                self.loads(&shells)?,
                self.symmetry_planes(&shells)?,
            ),
        };
        let energies = self.energies(&shells)?;
        let processes = self.processes(&shells)?;
        let (contact, solver) = (&spec.contact, SolverOptions::default());
        Ok(Model {
            shells,
            double_layers,
            heated_shells,
            bezier,
            heat_sources,
            obstacles,
            constraints,
            symmetry_planes,
            loads,
            energies,
            processes,
            gravity: Vec3::from(spec.gravity),
            gravity_scale: spec.gravity_scale.clone(),
            contact: ContactOptions {
                enabled: contact.enabled,
                d_hat: contact.d_hat,
                kappa: contact.kappa,
                friction_speed: contact.friction_speed,
                friction_iterations: contact.friction_iterations,
                pairs: (contact.pair.iter())
                    .map(|pair| FrictionPair {
                        bodies: pair.bodies.clone(),
                        friction: pair.friction,
                    })
                    .collect(),
            },
            solver: SolverOptions {
                velocity_tolerance: spec
                    .solver
                    .velocity_tolerance
                    .unwrap_or(solver.velocity_tolerance),
                displacement_tolerance: spec
                    .solver
                    .displacement_tolerance
                    .unwrap_or(solver.displacement_tolerance),
                max_iterations: spec.solver.max_iterations.unwrap_or(solver.max_iterations),
                smallest_step: spec.solver.smallest_step.unwrap_or(solver.smallest_step),
                newmark: (spec.solver.newmark.as_ref())
                    .map_or(solver.newmark, |newmark| newmark.resolve()),
                first_arc_length: spec.solver.first_arc_length,
                largest_arc_length: spec.solver.largest_arc_length,
                last_load_factor: (spec.solver.last_load_factor).unwrap_or(solver.last_load_factor),
            },
            integrator: spec.integrator,
            phases: phases::phases(spec),
        })
    }

    fn shell(&self, shell: &ShellSpec) -> Result<Shell, SceneError> {
        self.shell_at(&format!("shell.{}", shell.name), shell)
    }

    fn shell_at(&self, path: &str, shell: &ShellSpec) -> Result<Shell, SceneError> {
        let surface = self.mesh(&format!("{path}.mesh"), &shell.mesh)?;
        let rest_positions = match &shell.rest_mesh {
            None => surface.positions.clone(),
            Some(mesh) => self.rest_positions(&format!("{path}.rest_mesh"), mesh, &surface)?,
        };
        let (nominal, composition) = composition::compose(shell, self.source)?;
        let velocities = vec![Vec3::from(shell.velocity); surface.positions.len()];
        let shell = Shell {
            name: shell.name.clone(),
            velocities,
            rest_positions,
            rest_curved: shell.rest == RestSpec::Mesh,
            thickness: nominal.thickness,
            density: nominal.density,
            youngs_modulus: nominal.youngs_modulus,
            poissons_ratio: nominal.poissons_ratio,
            composition,
            bending: shell.bending,
            friction: shell.friction,
            contact_offset: shell.contact_thickness / 2.0,
            surface,
        };
        composition::check(&shell)?;
        Ok(shell)
    }

    fn rest_positions(
        &self,
        path: &str,
        mesh: &MeshSpec,
        surface: &Surface,
    ) -> Result<Vec<Vec3>, SceneError> {
        let rest = self.mesh(path, mesh)?;
        check_same_triangles(path, ["rest", "start"], &rest, surface)?;
        Ok(rest.positions)
    }

    fn mesh(&self, path: &str, spec: &MeshSpec) -> Result<Surface, SceneError> {
        let shape = spec.given_shapes().first().copied().unwrap_or("file");
        place(spec, self.source).map_err(|error| mesh_error(error, &format!("{path}.{shape}")))
    }

    fn obstacle(&self, obstacle: &ObstacleSpec) -> Result<Obstacle, SceneError> {
        let mut shape = self.obstacle_shape(obstacle)?;
        let mut deformation = None;
        if let ObstacleShape::Mesh(start) = &mut shape {
            deformation = self.deformation(obstacle, start)?;
            if let Some(points) = &deformation {
                start.positions = points.points_at(0.0);
            }
        }
        Ok(Obstacle {
            name: obstacle.name.clone(),
            deformation,
            shape,
            friction: obstacle.friction,
            motion: obstacle.motion.to_motion(),
        })
    }

    fn obstacle_shape(&self, obstacle: &ObstacleSpec) -> Result<ObstacleShape, SceneError> {
        let path = |key: &str| format!("obstacle.{}.{key}", obstacle.name);
        let rotate = obstacle.rotate.as_ref();
        let moved = |x: [f64; 3]| move_point(Vec3::from(x), rotate, obstacle.translate);
        if let Some(plane) = &obstacle.plane {
            let normal = Vec3::from(plane.normal).normalize();
            let normal = rotate.map_or(normal, |rotate| turn(rotate) * normal);
            return Ok(ObstacleShape::Plane {
                point: moved(plane.point),
                normal,
            });
        }
        if let Some(sphere) = &obstacle.sphere {
            return Ok(ObstacleShape::Sphere {
                center: moved(sphere.center),
                radius: sphere.radius,
            });
        }
        if let Some(capsule) = &obstacle.capsule {
            return Ok(ObstacleShape::Capsule {
                ends: capsule.ends.map(moved),
                radius: capsule.radius,
            });
        }
        let generated = |key: &str, result: Result<Surface, _>| {
            result.map_err(|error| mesh_error(ShapeError::Generator(error), &path(key)))
        };
        let mut surface = if let Some(cuboid) = &obstacle.cuboid {
            generated("box", box_mesh(cuboid.size))?
        } else if let Some(body) = &obstacle.cylinder {
            generated(
                "cylinder",
                solid_cylinder(body.radius, body.height, body.sides),
            )?
        } else if let Some(mesh) = &obstacle.mesh {
            self.mesh(&path("mesh"), mesh)?
        } else {
            return Err(SceneError::new(Kind::MissingKey, "no shape is given").inside(&path("")));
        };
        move_to(&mut surface, rotate, obstacle.translate);
        Ok(ObstacleShape::Mesh(surface))
    }

    fn constraints(&self, shells: &[Shell]) -> Result<Vec<Constraint>, SceneError> {
        let mut constraints = Vec::new();
        if shells.is_empty() {
            // They hold double layers, and are with them.
            return Ok(constraints);
        }
        for (index, constraint) in self.spec.constraint.iter().enumerate() {
            let path = constraint.path(index);
            let shell = self.shell_index(&format!("{path}.shell"), &constraint.shell)?;
            constraints.push(Constraint {
                shell,
                vertices: vertices(
                    &format!("{path}.select"),
                    &constraint.select,
                    &shells[shell],
                )?,
                axes: ['x', 'y', 'z'].map(|axis| constraint.axes.contains(axis)),
                motion: constraint.motion.to_motion(),
                clamp_directors: constraint.clamp,
                from: constraint.from.unwrap_or(0.0),
                until: constraint.until.unwrap_or(f64::INFINITY),
            });
        }
        Ok(constraints)
    }

    fn shell_index(&self, path: &str, name: &str) -> Result<usize, SceneError> {
        let index = (self.spec.shell_names().iter()).position(|shell| *shell == name);
        index.ok_or_else(|| {
            SceneError::new(Kind::UnknownName, format!("there is no shell '{name}'")).inside(path)
        })
    }

    fn probes(&self, model: &Model) -> Result<Vec<Probe>, SceneError> {
        self.spec
            .probe
            .iter()
            .map(|probe| self.probe(probe, model))
            .collect()
    }

    fn probe(&self, probe: &ProbeSpec, model: &Model) -> Result<Probe, SceneError> {
        let path = |key: &str| format!("probe.{}.{key}", probe.name);
        let target = match probe.quantity {
            ProbeQuantity::Energy => ProbeTarget::Energy(probe.energy.clone()),
            ProbeQuantity::LoadFactor => ProbeTarget::LoadFactor,
            ProbeQuantity::Reaction => {
                let name = probe.constraint.as_deref().unwrap_or_default();
                let mut constraints = self.spec.constraint.iter().enumerate();
                let index = constraints.position(|(i, c)| c.id(i) == name);
                ProbeTarget::Reaction(index.ok_or_else(|| {
                    let message = format!("there is no constraint '{name}'");
                    SceneError::new(Kind::UnknownName, message).inside(&path("constraint"))
                })?)
            }
            quantity => {
                let shell =
                    self.shell_index(&path("shell"), probe.shell.as_deref().unwrap_or_default())?;
                let all = SelectSpec {
                    all: true,
                    ..SelectSpec::default()
                };
                let selection = probe.select.as_ref().unwrap_or(&all);
                let vertices: Vec<usize> =
                    vertices(&path("select"), selection, model.observed_shell(shell))?
                        .into_iter()
                        .map(|vertex| vertex.0 as usize)
                        .collect();
                let positions = &model.observed_shell(shell).surface.positions;
                let start = vertices.iter().map(|&vertex| positions[vertex]).collect();
                ProbeTarget::Vertices {
                    quantity,
                    shell,
                    vertices,
                    start,
                }
            }
        };
        Ok(Probe {
            name: probe.name.clone(),
            target,
            axis: probe.axis,
        })
    }
}

/// Refuses a mesh that is not a shape of the triangles of another; both with their names.
fn check_same_triangles(
    path: &str,
    [name, of_name]: [&str; 2],
    mesh: &Surface,
    of: &Surface,
) -> Result<(), SceneError> {
    if mesh.mesh.faces() == of.mesh.faces() {
        return Ok(());
    }
    let message = format!(
        "the {name} mesh must have the triangles of the {of_name} mesh, in the same order: it has {} vertices and {} \
         triangles, the {of_name} mesh {} and {}",
        mesh.positions.len(),
        mesh.mesh.num_faces(),
        of.positions.len(),
        of.mesh.num_faces()
    );
    Err(SceneError::new(Kind::Mesh, message).inside(path))
}

fn mesh_error(error: ShapeError, path: &str) -> SceneError {
    let help = match &error {
        ShapeError::File(error) => error.help.clone(),
        _ => None,
    };
    let error = SceneError::new(Kind::Mesh, error.to_string()).inside(path);
    match help {
        Some(help) => error.with_help(help),
        None => error,
    }
}

fn vertices(path: &str, spec: &SelectSpec, shell: &Shell) -> Result<Vec<VertexId>, SceneError> {
    select(spec, &shell.surface).map_err(|error| {
        let key = match error {
            SelectionError::NoSuchVertex { .. } => "vertices",
            SelectionError::NoSuchLoop { .. } => "boundary",
            SelectionError::Empty { .. } => "",
        };
        let path = format!("{path}.{key}");
        let message = format!("shell '{}': {error}", shell.name);
        SceneError::new(Kind::EmptySelection, message).inside(path.trim_end_matches('.'))
    })
}

#[cfg(test)]
mod tests;
