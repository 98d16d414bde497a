//! `[[phase]]`: parts of a run.

use schemars::JsonSchema;
use serde::Deserialize;

use super::SceneSpec;
use crate::scene::model::IntegratorKind;

/// `[[phase]]`: a part of the run, from the end of the phase before. Motion ends with a static phase: what follows it
/// begins at rest.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PhaseSpec {
    /// Name, unique among the phases.
    pub name: String,
    /// End [s], counted from the start of the run.
    pub end: f64,
    /// Largest step [s]: the phase is divided into equal steps.
    pub dt: f64,
    /// How the state advances; default: as the scene says.
    #[serde(default)]
    pub integrator: Option<IntegratorKind>,
    /// Gravitational acceleration [m/s²]; default: that of the scene.
    #[serde(default)]
    pub gravity: Option<[f64; 3]>,
    /// Names or numbers of the constraints that hold; default: all. What held not in the phase before is held where it
    /// is when the phase begins.
    #[serde(default)]
    pub constraints: Option<Vec<String>>,
    /// Names of the loads that act; default: all.
    #[serde(default)]
    pub loads: Option<Vec<String>>,
    /// A frame every so many steps of this phase; default: as `output` says.
    #[serde(default)]
    pub every_steps: Option<usize>,
}

impl SceneSpec {
    /// The beginning [s], end [s] and largest step [s] of every phase; of a scene without phases, those of `time`.
    pub(in crate::scene) fn windows(&self) -> Vec<[f64; 3]> {
        let whole = self.time.iter().map(|time| [0.0, time.end, time.dt]);
        let mut start = 0.0;
        let phases = self.phase.iter().map(|phase| {
            let window = [start, phase.end, phase.dt];
            start = phase.end;
            window
        });
        whole.chain(phases).collect()
    }
}
