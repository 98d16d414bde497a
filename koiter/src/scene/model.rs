//! A checked scene, ready to be simulated: shells, obstacles, constraints, loads.

pub use super::bezier::{BezierModel, BezierPart, FineSurface, Procedure, ProcedureKind};
pub use super::burning::{DoubleLayerPart, HeatSourcePart, Held};
use crate::Vec3;
use crate::mesh::{EdgeId, FaceId, VertexId};

pub use super::composition::{Composition, FaceValues, MaterialLaw, RestPrescription};
pub use super::damping::DampingOptions;
pub use super::expressions::{TextEnergy, TextValue};
pub use super::heated::HeatedPart;
pub use super::material_models::MaterialModel;
pub use super::membrane_models::MembraneModel;
pub use super::processes::{ProcessKind, RestProcess};
pub use crate::energy::bending::{HingeSprings, HingeWeight};
pub use crate::energy::expression::ElementKind;
pub use crate::energy::{DiscreteStiffness, StretchLimit};
pub use crate::material::Layer;
pub use crate::mesh::Surface;

/// Which second fundamental form (or hinge) a shell bends with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Deserialize, serde::Serialize, schemars::JsonSchema),
    serde(rename_all = "kebab-case")
)]
#[non_exhaustive]
pub enum BendingModel {
    /// Bending-Active Cosserat: mid-edge directors, tangent profile.
    #[default]
    Bac,
    /// Mid-edge directors, sine profile.
    Dcs,
    /// Mid-edge directors, second-order profile.
    Dso,
    /// Discrete Kirchhoff triangle: unit directors at the vertices.
    Dkt,
    /// Second-order discrete shells: quadratic patches with a point on every edge, as studied; its energy is wrong.
    #[cfg_attr(feature = "serde", serde(rename = "ds-2nd"))]
    Ds2nd,
    /// Averaged mid-edge normals: the director models without directors.
    MeAverage,
    /// Discrete Shells hinge, energy quadratic in the hinge angle.
    DsTheta,
    /// Discrete Shells hinge with the tangent of the half angle: a barrier against closed hinges.
    DsTan,
    /// Corotational hinge, curvature of edges.
    ChEs,
    /// Corotational hinge, curvatures of faces.
    ChFs,
    /// Quadratic bending with Crouzeix–Raviart elements, for flat rest shapes.
    QbCr,
    /// Quadratic bending with the Laplacian at vertices and its boundary term, for flat rest shapes.
    QbPl,
    /// The same with the Laplacian of the intrinsic Delaunay triangulation.
    QbInt,
    /// No bending energy: a pure membrane.
    None,
}

/// A shell in its start configuration.
#[derive(Clone, Debug)]
pub struct Shell {
    /// Name, unique in the scene.
    pub name: String,
    /// Start configuration.
    pub surface: Surface,
    /// Start velocities [m/s], one a vertex.
    pub velocities: Vec<Vec3>,
    /// Positions of the rest configuration [m]: they give the rest first fundamental form.
    pub rest_positions: Vec<Vec3>,
    /// Whether the rest second fundamental form is that of `rest_positions` (else zero: rest flat).
    pub rest_curved: bool,
    /// Thickness [m].
    pub thickness: f64,
    /// Mass density [kg/m³].
    pub density: f64,
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Its law, where that is not isotropic St. Venant–Kirchhoff.
    pub composition: Composition,
    /// Bending model.
    pub bending: BendingModel,
    /// Friction coefficient of the surface.
    pub friction: f64,
    /// Half the distance at which two midsurfaces touch [m]; 0: midsurfaces may come arbitrarily close.
    pub contact_offset: f64,
}

/// Shape of an obstacle at time 0.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum ObstacleShape {
    /// Half-space below a plane; `normal` is a unit vector and points to the free side.
    Plane {
        /// A point of the plane [m].
        point: Vec3,
        /// Unit normal.
        normal: Vec3,
    },
    /// Solid ball.
    Sphere {
        /// Centre [m].
        center: Vec3,
        /// Radius [m].
        radius: f64,
    },
    /// A ball swept along a segment: an exact cylinder with round ends.
    Capsule {
        /// Ends of the axis [m].
        ends: [Vec3; 2],
        /// Radius [m].
        radius: f64,
    },
    /// A triangle mesh, closed or open (boxes and flat-ended cylinders are meshes).
    Mesh(Surface),
}

/// An obstacle: it acts on shells and is not acted upon.
#[derive(Clone, Debug)]
pub struct Obstacle {
    /// Name, unique in the scene.
    pub name: String,
    /// Shape at time 0.
    pub shape: ObstacleShape,
    /// Friction coefficient of the surface.
    pub friction: f64,
    /// Of a mesh: where its vertices are over time, before the motion; `None`: where they are in `shape`.
    pub deformation: Option<Schedule<Vec<Vec3>>>,
    /// Motion relative to time 0.
    pub motion: Motion,
}

/// A value that is piecewise linear in time, constant before the first and after the last key.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule<T> {
    /// Key times [s], increasing.
    pub times: Vec<f64>,
    /// Values at the keys.
    pub values: Vec<T>,
}

/// A scheduled motion: scaled, then turned, then moved.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    /// Scaling, if any.
    pub scaling: Option<Scaling>,
    /// Rotation, if any.
    pub rotation: Option<Rotation>,
    /// Translation [m].
    pub translation: Option<Schedule<Vec3>>,
}

/// A scheduled scaling about a fixed point: x(t) = pivot + S(t) (x(0) − pivot), with S = f 1 or, along a unit vector a,
/// S = 1 + (f − 1) a aᵀ.
#[derive(Clone, Debug)]
pub struct Scaling {
    /// The point that stays [m].
    pub pivot: Vec3,
    /// Unit direction in which lengths change; `None`: in all.
    pub along: Option<Vec3>,
    /// Factor f on lengths, larger than 0.
    pub factor: Schedule<f64>,
}

/// A scheduled rotation about a fixed axis.
#[derive(Clone, Debug)]
pub struct Rotation {
    /// A point of the axis [m].
    pub pivot: Vec3,
    /// Unit direction of the axis.
    pub axis: Vec3,
    /// Angle [rad].
    pub angle: Schedule<f64>,
}

/// Vertices whose motion is prescribed.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// Index of the shell.
    pub shell: usize,
    /// Constrained vertices.
    pub vertices: Vec<VertexId>,
    /// Which of x, y, z are prescribed.
    pub axes: [bool; 3],
    /// Motion relative to the start positions; of a constraint that begins later, what of it is still to come then,
    /// relative to the positions at that time.
    pub motion: Motion,
    /// Whether the directors of edges between constrained vertices are held too (a clamp): they keep the direction they
    /// have when the constraint begins, turned with the motion. Needs all three axes; models without directors hold
    /// whole faces instead.
    pub clamp_directors: bool,
    /// The constraint begins at this time [s] (from the start: 0).
    pub from: f64,
    /// The constraint ends at this time [s] (never: infinity).
    pub until: f64,
}

impl Constraint {
    /// Whether the time window of the constraint has a step in it that ends at `time` [s], up to the rounding of times
    /// that are sums of steps.
    pub fn is_due(&self, time: f64) -> bool {
        let rounding = TIME_ROUNDING * time;
        time - self.from > rounding && time - self.until <= rounding
    }
}

/// Relative error that the sum of all steps of a run may have.
const TIME_ROUNDING: f64 = 1e-9;

/// A plane across a coordinate axis behind which a shell goes on as its mirror image: vertices on it stay on it, and
/// directors there stay in it. Only for bending models with directors.
#[derive(Clone, Debug)]
pub struct SymmetryPlane {
    /// Index of the shell.
    pub shell: usize,
    /// The plane is normal to x, y or z: 0, 1 or 2.
    pub axis: usize,
    /// The vertices on the plane.
    pub vertices: Vec<VertexId>,
}

/// What pushes or turns a shell from outside.
#[derive(Clone, Debug)]
pub struct Load {
    /// Name, unique in the scene.
    pub name: String,
    /// Index of the shell.
    pub shell: usize,
    /// Where and how much.
    pub kind: LoadKind,
    /// Factor over time (`None`: 1).
    pub scale: Option<Schedule<f64>>,
}

/// Kinds of loads; lengths and areas are those of the rest shape.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum LoadKind {
    /// The same force on each of some vertices; it keeps its direction.
    Point {
        /// The vertices.
        vertices: Vec<VertexId>,
        /// Force on each [N].
        force: Vec3,
    },
    /// A force by length along edges; it keeps its direction.
    Edge {
        /// The edges.
        edges: Vec<EdgeId>,
        /// Force by rest length [N/m].
        force: Vec3,
    },
    /// A force by area; it keeps its direction.
    Area {
        /// The faces.
        faces: Vec<FaceId>,
        /// Force by rest area of the midsurface [N/m²].
        force: Vec3,
    },
    /// Pressure on the whole shell; it follows the normals.
    Pressure {
        /// Pressure along the normals [Pa].
        pressure: f64,
        /// The origin of volumes [m], which matters at free edges: see [`crate::energy::loads::Pressure`].
        origin: Vec3,
    },
    /// The same moment on each of some vertices of a Bézier shell, about an axis that stays.
    Turning {
        /// The vertices.
        vertices: Vec<VertexId>,
        /// Moment on each [N·m].
        moment: Vec3,
    },
    /// A moment about edges that turns their directors, right-handed about the edge as its face traverses it, the surface
    /// on the left (an inner edge: from its smaller to its larger vertex). Only for bending models with directors.
    Moment {
        /// The edges.
        edges: Vec<EdgeId>,
        /// Moment by rest length [N·m/m].
        moment: f64,
    },
}

/// How surfaces touch.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactOptions {
    /// Whether contact is on.
    pub enabled: bool,
    /// Distance [m] below which the barrier acts, measured between the offset surfaces; `None`: chosen from the mesh.
    pub d_hat: Option<f64>,
    /// Barrier stiffness [J/m²]; `None`: chosen and adapted.
    pub kappa: Option<f64>,
    /// Speed [m/s] below which friction is smoothed.
    pub friction_speed: f64,
    /// Solves of a step at most, each with the normal forces of the last, until they settle.
    pub friction_iterations: usize,
    /// Friction between two bodies, where it is not the geometric mean of their coefficients.
    pub pairs: Vec<FrictionPair>,
}

/// Friction between two bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionPair {
    /// Names of two shells, or of a shell and an obstacle; a shell twice: with itself.
    pub bodies: [String; 2],
    /// Friction coefficient.
    pub friction: f64,
}

impl Default for ContactOptions {
    fn default() -> Self {
        Self {
            enabled: true,
            d_hat: None,
            kappa: None,
            friction_speed: 1e-3,
            friction_iterations: 1,
            pairs: Vec::new(),
        }
    }
}

/// Newton's method.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverOptions {
    /// Newton stops when no point of the offset surfaces moved faster than this [m/s] (dynamics).
    pub velocity_tolerance: f64,
    /// Newton stops when no point of the offset surfaces moved further than this [m] (statics).
    pub displacement_tolerance: f64,
    /// Largest number of Newton iterations a step.
    pub max_iterations: usize,
    /// A step that fails is cut in half until its parts are this share of it; 1: never.
    pub smallest_step: f64,
    /// Newmark dynamics.
    pub newmark: NewmarkOptions,
    /// Arc length: root mean square displacement of the first step [m]; `None`: a tenth of the smallest thickness.
    pub first_arc_length: Option<f64>,
    /// Arc length: largest root mean square displacement of a step [m]; `None`: ten times the first.
    pub largest_arc_length: Option<f64>,
    /// Arc length: the load factor at which the path ends when it rises to it.
    pub last_load_factor: f64,
}

impl Default for SolverOptions {
    fn default() -> Self {
        Self {
            velocity_tolerance: 1e-3,
            displacement_tolerance: 1e-7,
            max_iterations: 200,
            smallest_step: 1.0 / 64.0,
            newmark: NewmarkOptions::default(),
            first_arc_length: None,
            largest_arc_length: None,
            last_load_factor: 1.0,
        }
    }
}

/// The numbers of Newmark's method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewmarkOptions {
    /// β: 0 for explicit steps, else from γ/2 on, where every step is stable.
    pub beta: f64,
    /// γ, from 1/2 to 1: more than 1/2 damps, in first order.
    pub gamma: f64,
    /// A step that gains more energy than this share of the largest kinetic energy so far is taken in parts; `None`: gains
    /// are not watched.
    pub energy_growth: Option<f64>,
}

impl Default for NewmarkOptions {
    fn default() -> Self {
        Self {
            beta: 0.25,
            gamma: 0.5,
            energy_growth: None,
        }
    }
}

impl NewmarkOptions {
    /// Whether steps take no more than the forces at their start.
    pub fn is_explicit(&self) -> bool {
        self.beta == 0.0
    }
}

/// How the state advances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Deserialize, serde::Serialize, schemars::JsonSchema),
    serde(rename_all = "kebab-case")
)]
#[non_exhaustive]
pub enum IntegratorKind {
    /// Implicit Euler dynamics: it damps what moves fast.
    #[default]
    ImplicitEuler,
    /// Dynamics by backward differences of second order: it damps little but what moves within a few steps.
    Bdf2,
    /// Newmark dynamics, undamped and of second order by default: it gains energy where steps are long for a stiff membrane
    /// or for contact, unless `solver.newmark.gamma` damps it. Explicit with `solver.newmark.beta = 0`.
    Newmark,
    /// A sequence of static equilibria along the schedules; one step is one static solve.
    QuasiStatic,
    /// Small displacements: each step is the response of the structure as it is at the start of the step.
    LinearStatic,
    /// A path of static equilibria through limit points: one step is one point, its load factor is the time of the
    /// schedules of loads.
    ArcLength,
}

impl IntegratorKind {
    /// Whether there is motion, with inertia and kinetic energy; else every step ends at rest.
    pub fn is_dynamic(self) -> bool {
        match self {
            Self::ImplicitEuler | Self::Bdf2 | Self::Newmark => true,
            Self::QuasiStatic | Self::LinearStatic | Self::ArcLength => false,
        }
    }
}

/// A part of a run with its own way to advance. Motion ends with a static phase: one that follows begins at rest.
#[derive(Clone, Debug)]
pub struct Phase {
    /// Name, unique in the scene.
    pub name: String,
    /// Number of steps; the last phase goes on for as long as steps are taken.
    pub steps: usize,
    /// How the state advances.
    pub integrator: IntegratorKind,
    /// Gravitational acceleration [m/s²].
    pub gravity: Vec3,
    /// Which constraints hold, within their time windows; one that held not before holds things where they are then.
    pub constraints: Vec<bool>,
    /// Which loads act.
    pub loads: Vec<bool>,
}

/// Everything a [`super::Simulation`] is made of; by default nothing, without gravity.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Shells.
    pub shells: Vec<Shell>,
    /// Double layers that burn; a model has either these or shells.
    pub double_layers: Vec<DoubleLayerPart>,
    /// Shells that burn, of those above.
    pub heated_shells: Vec<HeatedPart>,
    /// Bézier shells, with what holds, loads and changes them; a model has either these or shells.
    pub bezier: Option<BezierModel>,
    /// Sources of heat, which act on double layers and on shells that burn.
    pub heat_sources: Vec<HeatSourcePart>,
    /// Obstacles.
    pub obstacles: Vec<Obstacle>,
    /// Prescribed vertices.
    pub constraints: Vec<Constraint>,
    /// Planes of symmetry.
    pub symmetry_planes: Vec<SymmetryPlane>,
    /// Loads.
    pub loads: Vec<Load>,
    /// Energies and forces that are written as texts.
    pub energies: Vec<TextEnergy>,
    /// What changes rest curvatures over time.
    pub processes: Vec<RestProcess>,
    /// Gravitational acceleration [m/s²].
    pub gravity: Vec3,
    /// Factor on gravity over time (`None`: 1).
    pub gravity_scale: Option<Schedule<f64>>,
    /// Contact.
    pub contact: ContactOptions,
    /// Newton's method.
    pub solver: SolverOptions,
    /// Integrator.
    pub integrator: IntegratorKind,
    /// What follows one another in a run; by default one phase with the integrator and the gravity of the model, in
    /// which all constraints and loads act.
    pub phases: Vec<Phase>,
}
