//! What a scene file says: the types of its keys, with their defaults. SI units; angles in degrees.
//!
//! ```
//! use koiter::scene::SceneFile;
//!
//! let text = r#"
//! time = { end = 1.0, dt = 0.02 }
//! [[shell]]
//! name = "cloth"
//! material = "cotton"
//! mesh.grid = { size = [1.0, 1.0], cells = [10, 10] }
//! "#;
//! let scene = SceneFile::parse("scene.toml", text, &[])?;
//! assert_eq!(scene.spec.shell[0].name, "cloth");
//!
//! let wrong = SceneFile::parse("scene.toml", &text.replace("cotton", "coton"), &[]).unwrap_err();
//! assert_eq!(wrong.path, "shell.cloth.material.preset");
//! # Ok::<(), koiter::scene::SceneError>(())
//! ```

mod bezier_shell;
mod check;
mod constraint;
mod contact;
mod damping;
mod discrete_shells;
mod double_layer;
mod energy;
mod load;
mod material;
mod newmark;
mod obstacle;
mod phase;
mod procedure;
mod process;
mod shape;
mod strain_limit;
mod symmetry;

pub use bezier_shell::{BezierShellSpec, FineSurfaceSpec};
pub use check::MAX_STEPS;
pub use constraint::{BoundsSpec, ConstraintSpec, SelectSpec};
pub use contact::{ContactSpec, PairSpec};
pub use damping::DampingSpec;
pub use discrete_shells::DiscreteShellsSpec;
pub(in crate::scene) use double_layer::ROOM_TEMPERATURE;
pub use double_layer::{
    BurningSpec, DoubleLayerSpec, HeatSourceSpec, ProjectionSpec, QuadGridSpec, QuadMeshSpec,
    SelfCollisionSpec,
};
pub use energy::{EnergySpec, ParameterSpec};
pub use load::{EdgeChoice, LoadSpec};
pub use material::{LayerSpec, MaterialSpec};
pub use newmark::NewmarkSpec;
pub use obstacle::{AnimationSpec, DeformSpec, ObstacleSpec};
pub use phase::PhaseSpec;
pub use procedure::{CloseSpec, CutSpec, OpenSpec, PatchSpec, ProcedureSpec, RowSpec, SewSpec};
pub use process::{CreaseSpec, CurlSpec, ProcessSpec, YieldSpec};
pub use shape::{
    BoxSpec, CapsuleSpec, CylinderBodySpec, MeshSpec, PlaneSpec, RotationSpec, SphereSpec, Units,
    UpAxis,
};
pub use shape::{
    CapSpec, ConeSpec, CorrugationSpec, CylinderSpec, Diagonals, DiscSpec, GridSpec, HatSpec,
    IcosphereSpec, IrregularSpec, PanelSpec, TorusSpec, VeeSpec, ZoneSpec,
};

pub use strain_limit::StrainLimitSpec;
pub use symmetry::SymmetrySpec;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::decode::decode;
use super::document::Document;
use super::error::SceneError;
use super::membrane_models::MembraneModel;
use super::model::{BendingModel, IntegratorKind};
use super::schedule::Schedule;

/// A scene as it was typed.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneSpec {
    /// One line.
    #[serde(default)]
    pub title: String,
    /// More lines.
    #[serde(default)]
    pub description: String,
    /// How long, in which steps; or else give phases.
    #[serde(default)]
    pub time: Option<TimeSpec>,
    /// Parts of the run, one after the other, each with its own steps.
    #[serde(default)]
    pub phase: Vec<PhaseSpec>,
    /// How the state advances.
    #[serde(default)]
    pub integrator: IntegratorKind,
    /// Gravitational acceleration [m/s²].
    #[serde(default = "standard_gravity")]
    pub gravity: [f64; 3],
    /// Factor on gravity over time.
    #[serde(default)]
    pub gravity_scale: Option<Schedule<f64>>,
    /// Shells.
    #[serde(default)]
    pub shell: Vec<ShellSpec>,
    /// Shells that burn: two layers of springs; in place of elastic shells.
    #[serde(default)]
    pub double_layer: Vec<DoubleLayerSpec>,
    /// Smooth shells of few elements that can be cut and sewn; in place of elastic shells.
    #[serde(default)]
    pub bezier_shell: Vec<BezierShellSpec>,
    /// What is done to Bézier shells, in the order of time.
    #[serde(default)]
    pub procedure: Vec<ProcedureSpec>,
    /// What heats double layers, and shells that burn.
    #[serde(default)]
    pub heat_source: Vec<HeatSourceSpec>,
    /// Obstacles.
    #[serde(default)]
    pub obstacle: Vec<ObstacleSpec>,
    /// Prescribed vertices.
    #[serde(default)]
    pub constraint: Vec<ConstraintSpec>,
    /// Planes of symmetry.
    #[serde(default)]
    pub symmetry: Vec<SymmetrySpec>,
    /// Loads.
    #[serde(default)]
    pub load: Vec<LoadSpec>,
    /// Energies, and forces that depend on velocity, as expressions.
    #[serde(default)]
    pub energy: Vec<EnergySpec>,
    /// What changes rest shapes over time.
    #[serde(default)]
    pub process: Vec<ProcessSpec>,
    /// Contact.
    #[serde(default)]
    pub contact: ContactSpec,
    /// Newton's method.
    #[serde(default)]
    pub solver: SolverSpec,
    /// What to measure.
    #[serde(default)]
    pub probe: Vec<ProbeSpec>,
    /// What to write.
    #[serde(default)]
    pub output: OutputSpec,
}

fn standard_gravity() -> [f64; 3] {
    [0.0, 0.0, -9.81]
}

/// `[time]`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimeSpec {
    /// End of the simulation [s].
    pub end: f64,
    /// Step [s].
    pub dt: f64,
}

/// `[[shell]]`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShellSpec {
    /// Name, unique in the scene.
    pub name: String,
    /// Start shape.
    pub mesh: MeshSpec,
    /// Material: a preset, numbers, or a preset with some numbers replaced.
    #[serde(default)]
    #[schemars(schema_with = "super::schema::material")]
    pub material: MaterialSpec,
    /// Thickness [m]; default: the preset's.
    #[serde(default)]
    pub thickness: Option<f64>,
    /// Bending model.
    #[serde(default)]
    pub bending: BendingModel,
    /// Membrane.
    #[serde(default)]
    pub membrane: MembraneModel,
    /// Stiffnesses and weights of Discrete Shells, for `membrane = "discrete-shells"` and for hinges; default: those of the
    /// material.
    #[serde(default)]
    pub discrete_shells: Option<DiscreteShellsSpec>,
    /// Damping in dynamics; default: none.
    #[serde(default)]
    pub damping: Option<DampingSpec>,
    /// Rest curvature.
    #[serde(default)]
    pub rest: RestSpec,
    /// A shape of the same triangles that gives the rest lengths (and, with `rest = "mesh"`, the rest curvature);
    /// default: the start shape.
    #[serde(default)]
    pub rest_mesh: Option<MeshSpec>,
    /// Factors on the rest lengths along the material's axis and across it.
    #[serde(default = "no_stretch")]
    pub rest_stretch: [f64; 2],
    /// Curvatures [1/m] along the material's axis and across it, added to those of `rest`; positive where normals fan
    /// out, whether or not a surface has them.
    #[serde(default)]
    pub rest_curvature: [f64; 2],
    /// JSON file with values of single faces, relative to the scene's folder: lists `thickness`, `young`, `poisson`,
    /// `density`, `young_across`, `shear`, `axis`, `first_form`, `second_form`, one value a face; forms as
    /// `[11, 12, 22]` in the basis of the edges from a face's first corner to the second and third.
    #[serde(default)]
    pub faces: Option<String>,
    /// Heat, mass loss, shrinkage and tearing; default: the shell does not burn.
    #[serde(default)]
    pub burning: Option<BurningSpec>,
    /// Temperature at the start of a shell that burns [K]; default: 293.
    #[serde(default)]
    pub temperature: Option<f64>,
    /// A stretch that is never reached; default: none.
    #[serde(default)]
    pub strain_limit: Option<StrainLimitSpec>,
    /// Start velocity of all vertices [m/s].
    #[serde(default)]
    pub velocity: [f64; 3],
    /// Friction coefficient.
    #[serde(default = "default_friction")]
    pub friction: f64,
    /// Distance [m] at which two midsurfaces touch, as if the shell were this thick; default 0.
    #[serde(default)]
    pub contact_thickness: f64,
}

fn no_stretch() -> [f64; 2] {
    [1.0; 2]
}

fn default_friction() -> f64 {
    0.3
}

/// Rest curvature of a shell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum RestSpec {
    /// The shell wants to be flat.
    #[default]
    Flat,
    /// The shell wants to be curved like its rest mesh.
    Mesh,
}

/// `[solver]`; defaults are those of [`super::model::SolverOptions`].
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SolverSpec {
    /// Newton stops when nothing moved faster than this [m/s].
    #[serde(default)]
    pub velocity_tolerance: Option<f64>,
    /// Statics: Newton stops when nothing moved further than this [m].
    #[serde(default)]
    pub displacement_tolerance: Option<f64>,
    /// Largest number of Newton iterations a step.
    #[serde(default)]
    pub max_iterations: Option<usize>,
    /// A step that fails is cut in half until its parts are this share of it; 1: never.
    #[serde(default)]
    pub smallest_step: Option<f64>,
    /// The numbers of Newmark's method.
    #[serde(default)]
    pub newmark: Option<NewmarkSpec>,
    /// Arc length: root mean square displacement of the first step [m]; default: a tenth of the smallest thickness.
    #[serde(default)]
    pub first_arc_length: Option<f64>,
    /// Arc length: largest root mean square displacement of a step [m]; default: ten times the first.
    #[serde(default)]
    pub largest_arc_length: Option<f64>,
    /// Arc length: the load factor at which the path ends when it rises to it; default: 1.
    #[serde(default)]
    pub last_load_factor: Option<f64>,
}

/// `[[probe]]`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProbeSpec {
    /// Name, the heading of its column.
    pub name: String,
    /// What is measured.
    pub quantity: ProbeQuantity,
    /// The shell; not for energies and reactions.
    #[serde(default)]
    pub shell: Option<String>,
    /// Which vertices; default: all of the shell.
    #[serde(default)]
    pub select: Option<SelectSpec>,
    /// Only this component.
    #[serde(default)]
    pub axis: Option<Axis>,
    /// Name of the energy, a built-in one or that of an `[[energy]]`; default: the sum.
    #[serde(default)]
    #[schemars(schema_with = "super::schema::energy_name")]
    pub energy: Option<String>,
    /// Name or number of the constraint, for a reaction.
    #[serde(default)]
    pub constraint: Option<String>,
}

/// What a probe measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ProbeQuantity {
    /// Mean position [m].
    Position,
    /// Mean displacement from the start [m].
    Displacement,
    /// Mean velocity [m/s].
    Velocity,
    /// Smallest z [m].
    Lowest,
    /// Largest z [m].
    Highest,
    /// Root mean square distance from the shape at the start, brought as near as a rigid motion can [m].
    Distortion,
    /// An energy [J].
    Energy,
    /// Force on a constraint [N].
    Reaction,
    /// The factor on scheduled loads, with integrator = "arc-length".
    LoadFactor,
}

/// A coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// First.
    X,
    /// Second.
    Y,
    /// Third, up.
    Z,
}

/// `[output]`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputSpec {
    /// A frame every so many steps.
    #[serde(default)]
    pub every_steps: Option<usize>,
    /// A frame every so many seconds of simulated time.
    #[serde(default)]
    pub every_seconds: Option<f64>,
    /// Face fields written with each frame; default: all but rest_curvature, which only processes change.
    #[serde(default = "usual_fields")]
    #[schemars(schema_with = "super::schema::field_names")]
    pub fields: Vec<String>,
    /// A checkpoint after a step once so many seconds have gone by since the last; 0: after every step.
    #[serde(default = "checkpoint_seconds")]
    pub checkpoint_seconds: f64,
    /// View of the pictures: `front`, `side`, `top`, `iso`, or `azimuth=30,elevation=20,zoom=1.2`.
    #[serde(default)]
    pub camera: Option<String>,
    /// Field that colours the pictures.
    #[serde(default)]
    #[schemars(schema_with = "super::schema::field_name")]
    pub color: Option<String>,
}

impl Default for OutputSpec {
    fn default() -> Self {
        Self {
            every_steps: None,
            every_seconds: None,
            fields: usual_fields(),
            checkpoint_seconds: checkpoint_seconds(),
            camera: None,
            color: None,
        }
    }
}

/// Names of the energies that a probe can measure; one that a scene has not is 0.
pub const ENERGY_NAMES: [&str; 9] = [
    "elastic",
    "membrane",
    "strain_limit",
    "bending",
    "clamps",
    "gravity",
    "loads",
    "kinetic",
    "contact",
];

/// Names of the face fields a run can write.
pub const FIELD_NAMES: [&str; 6] = [
    "strain",
    "bending_energy_density",
    "mean_curvature",
    "temperature",
    "mass_ratio",
    "rest_curvature",
];

/// Fields of shells that are not written unless they are named: they do not change without processes.
const FIELDS_ON_DEMAND: usize = 1;

/// A kill loses at most so much work and a step; writing takes a hundredth of it at a million unknowns.
fn checkpoint_seconds() -> f64 {
    10.0
}

/// Keys that change no step and no frame: a run may go on with other values of them.
pub const KEYS_OF_NO_STEP: [&str; 6] = [
    "title",
    "description",
    "time.end",
    "output.camera",
    "output.color",
    "output.checkpoint_seconds",
];

fn usual_fields() -> Vec<String> {
    let usual = &FIELD_NAMES[..FIELD_NAMES.len() - FIELDS_ON_DEMAND];
    usual.iter().map(|name| (*name).to_owned()).collect()
}

/// A scene with the text it was read from.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// What was typed.
    pub spec: SceneSpec,
    /// Where it was typed.
    pub document: Document,
}

impl SceneFile {
    /// Reads and checks a scene. `name` stands for the text in messages; `overrides` are `KEY=VALUE` texts.
    ///
    /// # Errors
    /// See [`super::SceneErrorKind`]; meshes and selections are checked later, by [`super::Scene::build`].
    pub fn parse(name: &str, text: &str, overrides: &[String]) -> Result<Self, SceneError> {
        let document = Document::parse(name, text, overrides)?;
        let spec = decode(&document.root).map_err(|error| document.place(error))?;
        let file = Self { spec, document };
        file.check()?;
        Ok(file)
    }

    /// A scene made by a program; errors then have a path but no place.
    ///
    /// # Errors
    /// Those of [`Self::parse`] that are not about text.
    pub fn from_spec(spec: SceneSpec) -> Result<Self, SceneError> {
        let document = Document::empty();
        let file = Self { spec, document };
        file.check()?;
        Ok(file)
    }

    fn check(&self) -> Result<(), SceneError> {
        check::check(&self.spec).map_err(|error| self.document.place(error))
    }
}

#[cfg(test)]
mod tests;
