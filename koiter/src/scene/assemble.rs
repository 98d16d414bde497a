//! From a checked model to energies, masses and contact.

use super::arc_length::ArcLengthError;
use super::clamps::Clamps;
use super::composition_error::CompositionError;
use super::elastic::{Elastic, rest_surface};
use super::expressions::expressions;
use super::loads::loads;
use super::model::{IntegratorKind, Model, Obstacle, ObstacleShape, Shell, Surface};
use super::processes::ProcessError;
use super::symmetry::symmetry_edges;
use crate::Vec3;
use crate::assembly::{Assembled, Dof, DofLayout};
use crate::bezier::BezierError;
use crate::burning::BurningError;
use crate::contact::{CollisionBody, CollisionMesh, Contact, StartError, UnknownBody};
use crate::energy::Gravity;
use crate::energy::expression::ExpressionError;
use crate::integrate::{OffsetSurfaces, ShellPart, System};
use crate::rest::RestError;
use crate::solve::LinearWorkspace;

/// Why a model cannot be simulated.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A rest state that cannot be used.
    #[error("shell '{shell}': {error}")]
    Rest {
        /// Name of the shell.
        shell: String,
        /// What is wrong.
        error: RestError,
    },
    /// A material or a rest state that cannot be.
    #[error("shell '{shell}': {error}")]
    Composition {
        /// Name of the shell.
        shell: String,
        /// What is wrong.
        error: CompositionError,
    },
    /// A double layer that cannot be set up.
    #[error("double layer '{double_layer}': {error}")]
    DoubleLayer {
        /// Name of the double layer.
        double_layer: String,
        /// What is wrong.
        error: BurningError,
    },
    /// A shell that cannot burn so.
    #[error("shell '{shell}': {error}")]
    Burning {
        /// Name of the shell.
        shell: String,
        /// What is wrong.
        error: BurningError,
    },
    /// A face that is stretched to its limit at the start.
    #[error(
        "shell '{shell}': face {face} starts stretched to {stretch:.4} times its rest length, but strain_limit.stretch is \
         {limit}: raise the limit, or start nearer to the rest shape"
    )]
    StretchedStart {
        /// Name of the shell.
        shell: String,
        /// Index of the face.
        face: usize,
        /// Its largest length over rest length.
        stretch: f64,
        /// The limit.
        limit: f64,
    },
    /// The barrier reaches further than the elements are large.
    #[error(
        "shell '{shell}': surfaces repel within {reach:.2e} m (d_hat and contact thickness), but its mean edge is \
         {mean_edge:.2e} m: every triangle would repel its neighbours; reduce d_hat or the thickness, or use larger triangles"
    )]
    ContactReach {
        /// Name of the shell.
        shell: String,
        /// d̂ + ξ [m].
        reach: f64,
        /// Mean rest edge [m].
        mean_edge: f64,
    },
    /// A plane that is to turn.
    #[error("obstacle '{obstacle}': a plane cannot rotate, only move; use a box or a mesh")]
    TurningPlane {
        /// Name of the obstacle.
        obstacle: String,
    },
    /// A moment on directors that are not there.
    #[error(
        "load '{load}': a moment turns directors, which the bending model of shell '{shell}' has not; use bac, dcs, dso or dkt"
    )]
    MomentWithoutDirectors {
        /// Name of the load.
        load: String,
        /// Name of the shell.
        shell: String,
    },
    /// A process that cannot act on its shell.
    #[error("process '{process}': {error}")]
    Process {
        /// Name of the process.
        process: String,
        /// Why.
        error: ProcessError,
    },
    /// A plane of symmetry that a model cannot feel.
    #[error(
        "shell '{shell}': at a plane of symmetry a bending model without directors bends freely, as at a hinge; use bac, dcs, \
         dso or dkt, or simulate the whole shell"
    )]
    SymmetryWithoutDirectors {
        /// Name of the shell.
        shell: String,
    },
    /// A model in which no path of loads can be followed.
    #[error(transparent)]
    ArcLength(#[from] ArcLengthError),
    /// Friction with a body that there is not.
    #[error(transparent)]
    Friction(#[from] UnknownBody),
    /// A Bézier shell that cannot be made, or a fine surface that is not its own.
    #[error("Bézier shell '{shell}': {error}")]
    Bezier {
        /// Name of the shell.
        shell: String,
        /// What is wrong.
        error: BezierError,
    },
    /// Explicit steps and contact.
    #[error(
        "explicit steps (solver.newmark.beta = 0) know no contact, which needs a line search: set contact.enabled = false, \
         or take implicit steps with beta = 0.25"
    )]
    ExplicitContact,
    /// Explicit steps and unknowns without mass.
    #[error(
        "explicit steps (solver.newmark.beta = 0) need masses, but the bending models of this scene have unknowns without: \
         take implicit steps with beta = 0.25"
    )]
    ExplicitWithoutMass,
    /// An expression that cannot be read.
    #[error("energy '{energy}': {error}")]
    Expression {
        /// Name of the energy.
        energy: String,
        /// What is wrong with it.
        error: ExpressionError,
    },
    /// An expression without a value or derivatives at the start.
    #[error(
        "energy '{energy}' is not defined at the start on {element}, or its derivatives are not: a division by zero, a root or \
         a logarithm of nothing? Add a small number under the root, or start elsewhere"
    )]
    UndefinedEnergy {
        /// Name of the energy.
        energy: String,
        /// The element.
        element: String,
    },
    /// An expression over no elements.
    #[error("energy '{energy}': the selection holds no whole {elements}")]
    NoElements {
        /// Name of the energy.
        energy: String,
        /// What it is of.
        elements: &'static str,
    },
    /// The volume of a shell that encloses none.
    #[error(
        "energy '{energy}': shell '{shell}' has a boundary and encloses no volume; use a closed mesh, or a [[load]] with \
         'pressure', which acts on open shells too"
    )]
    OpenShell {
        /// Name of the energy.
        energy: String,
        /// Name of the shell.
        shell: String,
    },
    /// Something touches or intersects at the start.
    #[error(transparent)]
    Start(#[from] StartError),
}

/// d̂ where the scene does not set it: this fraction of the mean edge of the shells …
const D_HAT_BY_EDGE: f64 = 0.1;
/// … and at most this fraction of the extent of the shells. Both keep the barrier within the size of an element.
const D_HAT_BY_EXTENT: f64 = 1e-3;

/// Pressure of the barrier, in units of the weight of the heaviest shell, that sets its stiffness where the scene does
/// not: at half of d̂ it carries about 40 layers of cloth, and it is still no stiffer than the shell's inertia at usual
/// steps. It is raised when gaps shrink.
const BARRIER_PRESSURE_BY_WEIGHT: f64 = 10.0;

/// A system with its start configuration.
pub(super) struct Assembly {
    pub(super) system: System,
    pub(super) q: Vec<f64>,
    pub(super) velocities: Vec<f64>,
    /// First unknown of each obstacle's points, and their positions at time 0.
    pub(super) obstacles: Vec<(Dof, Vec<Vec3>)>,
    pub(super) clamps: Clamps,
}

/// Builds energies, masses and contact, and refuses a start that touches.
pub(super) fn assemble(model: &Model) -> Result<Assembly, BuildError> {
    let unknowns = Unknowns::new(model);
    let (mut q, velocities) = unknowns.start(model);
    let Elastic {
        mut energies,
        masses,
        mut damping,
        parts,
    } = Elastic::new(model, &unknowns, &mut q)?;
    let written = expressions(model, &parts, &masses, &unknowns.layout, &q)?;
    energies.extend(written.potentials);
    damping.rates = written.rates;
    damping.dampers.extend(written.dampers);
    let (clamps, clamped_edges) = Clamps::new(model, &parts, &q);
    let symmetry = symmetry_edges(model, &parts, &q)?;
    let loads = loads(model, &parts, &unknowns.layout, &q)?;
    let gravity = Gravity {
        masses: vertex_masses(&parts, &masses),
        acceleration: model.all_phases()[0].gravity,
    };
    check_contact_reach(model)?;
    check_planes(model)?;
    check_explicit(model, &masses)?;
    let Unknowns {
        layout,
        vertices,
        obstacles,
        ..
    } = unknowns;
    let mut contact = build_contact(model, &vertices, &obstacles, &layout);
    if let Some(contact) = &mut contact {
        for pair in &model.contact.pairs {
            contact.set_friction(&pair.bodies, pair.friction)?;
        }
        contact.check_start(&q)?;
    }
    let system = System {
        clamps: Assembled::new(clamped_edges, &layout),
        symmetry: Assembled::new(symmetry, &layout),
        layout,
        elastic: energies,
        damping,
        gravity,
        loads,
        masses,
        is_dynamic: model.all_phases()[0].integrator.is_dynamic(),
        contact,
        friction_speed: model.contact.friction_speed,
        friction_iterations: model.contact.friction_iterations,
        space: OffsetSurfaces { shells: parts },
        workspace: LinearWorkspace::default(),
        max_iterations: model.solver.max_iterations,
    };
    Ok(Assembly {
        system,
        q,
        velocities,
        obstacles,
        clamps,
    })
}

/// Where the unknowns of every shell and the points of every obstacle stand in `q`.
pub(super) struct Unknowns {
    pub(super) layout: DofLayout,
    /// First vertex unknown of each shell.
    pub(super) vertices: Vec<Dof>,
    /// First of the extra unknowns of each shell's bending model.
    pub(super) extras: Vec<Dof>,
    /// First unknown of each obstacle's points, and their positions at time 0.
    obstacles: Vec<(Dof, Vec<Vec3>)>,
}

impl Unknowns {
    /// All vertices, then what the bending models add to them, then the obstacles, whose motion is prescribed.
    pub(super) fn new(model: &Model) -> Self {
        let mut layout = DofLayout::new();
        let vertices = push_vertices(model, &mut layout, true);
        let extras = push_extras(model, &mut layout);
        let obstacles = model
            .obstacles
            .iter()
            .map(|o| {
                let points = o.start_points();
                (layout.push_nodes(points.len(), 3, false), points)
            })
            .collect();
        Self {
            layout,
            vertices,
            extras,
            obstacles,
        }
    }

    /// Only what the bending models add is solved for; the vertices come after it and are held. Without obstacles.
    pub(super) fn with_held_vertices(model: &Model) -> Self {
        let mut layout = DofLayout::new();
        let extras = push_extras(model, &mut layout);
        let vertices = push_vertices(model, &mut layout, false);
        Self {
            layout,
            vertices,
            extras,
            obstacles: Vec::new(),
        }
    }

    /// Positions and velocities at time 0; the extra unknowns are not known yet.
    pub(super) fn start(&self, model: &Model) -> (Vec<f64>, Vec<f64>) {
        let mut q = vec![0.0; self.layout.num_dofs()];
        let mut velocities = q.clone();
        for (shell, first) in model.shells.iter().zip(&self.vertices) {
            write_points(&mut q, *first, &shell.surface.positions);
            write_points(&mut velocities, *first, &shell.velocities);
        }
        for (obstacle, (first, points)) in model.obstacles.iter().zip(&self.obstacles) {
            write_points(&mut q, *first, &obstacle.points_at(points, 0.0));
        }
        (q, velocities)
    }
}

fn push_vertices(model: &Model, layout: &mut DofLayout, solved: bool) -> Vec<Dof> {
    let mut push = |s: &Shell| layout.push_nodes(s.surface.mesh.num_vertices(), 3, solved);
    model.shells.iter().map(&mut push).collect()
}

fn push_extras(model: &Model, layout: &mut DofLayout) -> Vec<Dof> {
    let mut push = |s: &Shell| {
        let extra = s.bending.info().unknowns;
        layout.push_nodes(extra.num_nodes(&s.surface.mesh), extra.node_size(), true)
    };
    model.shells.iter().map(&mut push).collect()
}

pub(super) fn write_points(q: &mut [f64], first: Dof, points: &[Vec3]) {
    for (i, x) in points.iter().enumerate() {
        let start = first.0 as usize + 3 * i;
        q[start..start + 3].copy_from_slice(x.as_slice());
    }
}

fn vertex_masses(parts: &[ShellPart], masses: &[f64]) -> Vec<(Dof, f64)> {
    parts
        .iter()
        .flat_map(|p| p.vertex_dofs().step_by(3))
        .map(|start| (Dof(start as u32), masses[start]))
        .collect()
}

fn build_contact(
    model: &Model,
    vertices: &[Dof],
    obstacles: &[(Dof, Vec<Vec3>)],
    layout: &DofLayout,
) -> Option<Contact> {
    if !model.contact.enabled || model.shells.is_empty() {
        return None;
    }
    let mut bodies: Vec<CollisionBody> = model
        .shells
        .iter()
        .zip(vertices)
        .map(|(shell, first)| shell_body(shell, *first))
        .collect();
    let mut planes = Vec::new();
    for (obstacle, (first, points)) in model.obstacles.iter().zip(obstacles) {
        let body = obstacle.collision(points.clone());
        body.add_to(*first, &mut bodies, &mut planes);
    }
    let d_hat = model
        .contact
        .d_hat
        .unwrap_or_else(|| default_d_hat(model.shells.iter().map(|shell| size(&shell.surface))));
    let kappa = model
        .contact
        .kappa
        .unwrap_or_else(|| default_kappa(model.shells.iter(), &model.gravity, d_hat));
    Some(Contact::new(
        CollisionMesh::new(bodies),
        planes,
        layout.clone(),
        d_hat,
        kappa,
    ))
}

/// A plane is a point and a normal that stays as it is.
fn check_planes(model: &Model) -> Result<(), BuildError> {
    let turning = |o: &&Obstacle| {
        matches!(o.shape, ObstacleShape::Plane { .. }) && o.motion.rotation.is_some()
    };
    match model.obstacles.iter().find(turning) {
        Some(obstacle) => Err(BuildError::TurningPlane {
            obstacle: obstacle.name.clone(),
        }),
        None => Ok(()),
    }
}

/// Refuses explicit steps where they cannot be taken.
fn check_explicit(model: &Model, masses: &[f64]) -> Result<(), BuildError> {
    let mut phases = model.all_phases().into_iter();
    let is_explicit = model.solver.newmark.is_explicit()
        && phases.any(|phase| phase.integrator == IntegratorKind::Newmark);
    match is_explicit {
        true if model.contact.enabled => Err(BuildError::ExplicitContact),
        true if masses.contains(&0.0) => Err(BuildError::ExplicitWithoutMass),
        _ => Ok(()),
    }
}

/// Largest reach of contact in mean edges: beyond it, elements would touch their neighbours' neighbours at rest.
pub(super) const LARGEST_REACH_BY_EDGE: f64 = 0.5;

/// Refuses a barrier that reaches beyond an element: its pairs would be all neighbours, and their number without bound.
fn check_contact_reach(model: &Model) -> Result<(), BuildError> {
    let d_hat = model.contact.d_hat.unwrap_or(0.0);
    for shell in model.shells.iter().filter(|_| model.contact.enabled) {
        let reach = d_hat + 2.0 * shell.contact_offset;
        let mean_edge = rest_surface(shell).mean_edge_length();
        if reach > LARGEST_REACH_BY_EDGE * mean_edge {
            return Err(BuildError::ContactReach {
                shell: shell.name.clone(),
                reach,
                mean_edge,
            });
        }
    }
    Ok(())
}

fn shell_body(shell: &Shell, first_dof: Dof) -> CollisionBody {
    CollisionBody {
        name: shell.name.clone(),
        first_dof,
        num_vertices: shell.surface.mesh.num_vertices(),
        edges: shell.surface.mesh.edges().to_vec(),
        faces: shell.surface.mesh.faces().to_vec(),
        rest_positions: shell.rest_positions.clone(),
        offset: shell.contact_offset,
        is_obstacle: false,
        friction: shell.friction,
    }
}

/// Mean edge and extent of a surface [m].
fn size(surface: &Surface) -> (f64, f64) {
    let (low, high) = surface.bounding_box();
    (surface.mean_edge_length(), (high - low).norm())
}

/// d̂ for surfaces of these mean edges and extents [m].
pub(super) fn default_d_hat(sizes: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (edge, extent) = sizes.fold((f64::INFINITY, 0.0), |(edge, extent), size| {
        (size.0.min(edge), size.1.max(extent))
    });
    (D_HAT_BY_EDGE * edge).min(D_HAT_BY_EXTENT * extent)
}

/// Stiffness of the barrier for shells under gravity.
pub(super) fn default_kappa<'a>(
    shells: impl Iterator<Item = &'a Shell>,
    gravity: &Vec3,
    d_hat: f64,
) -> f64 {
    // Scenes without gravity are given the weight they would have on Earth: it only sets a scale.
    let gravity = gravity.norm().max(9.81);
    let weight = shells
        .map(|s| s.density * s.thickness * gravity)
        .fold(0.0, f64::max);
    BARRIER_PRESSURE_BY_WEIGHT * weight * d_hat
}
