//! `[[load]]`: what pushes or turns a shell from outside.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::SelectSpec;
use crate::scene::schedule::Schedule;

/// `[[load]]`: exactly one of `force`, `force_each`, `force_per_length`, `force_per_area`, `pressure`, `moment_per_length` and
/// `moment_each`.
///
/// Lengths and areas are those of the rest shape. Forces keep their direction; pressure and moments follow the shell.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadSpec {
    /// Name, unique among the loads.
    pub name: String,
    /// The shell.
    pub shell: String,
    /// Which vertices; edges and faces are loaded if all their vertices are selected. Default, for `force_per_area` only:
    /// all.
    #[serde(default)]
    pub select: Option<SelectSpec>,
    /// Total force [N], shared equally by the vertices.
    #[serde(default)]
    pub force: Option<[f64; 3]>,
    /// Force on each vertex [N].
    #[serde(default)]
    pub force_each: Option<[f64; 3]>,
    /// Force by length along edges [N/m].
    #[serde(default)]
    pub force_per_length: Option<[f64; 3]>,
    /// Force by area [N/m²].
    #[serde(default)]
    pub force_per_area: Option<[f64; 3]>,
    /// Pressure on the whole shell [Pa], positive along its normals.
    #[serde(default)]
    pub pressure: Option<f64>,
    /// Moment by length about edges [N·m/m]; positive leans the directors of a boundary outwards.
    #[serde(default)]
    pub moment_per_length: Option<f64>,
    /// Moment on each vertex of a Bézier shell, about axes that stay [N·m].
    #[serde(default)]
    pub moment_each: Option<[f64; 3]>,
    /// Which edges, for loads by length.
    #[serde(default)]
    pub edges: EdgeChoice,
    /// The origin of volumes [m] for a pressure; matters at free edges only, and must be in all planes of symmetry.
    #[serde(default)]
    pub origin: Option<[f64; 3]>,
    /// Factor over time.
    #[serde(default)]
    pub scale: Option<Schedule<f64>>,
}

/// Edges between selected vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum EdgeChoice {
    /// Only edges of the boundary.
    #[default]
    Boundary,
    /// Inner edges too.
    All,
}

impl LoadSpec {
    /// The keys that say what sort of load it is: exactly one in a sound scene.
    pub fn given_kinds(&self) -> Vec<&'static str> {
        [
            ("force", self.force.is_some()),
            ("force_each", self.force_each.is_some()),
            ("force_per_length", self.force_per_length.is_some()),
            ("force_per_area", self.force_per_area.is_some()),
            ("pressure", self.pressure.is_some()),
            ("moment_per_length", self.moment_per_length.is_some()),
            ("moment_each", self.moment_each.is_some()),
        ]
        .into_iter()
        .filter_map(|(name, given)| given.then_some(name))
        .collect()
    }
}
