//! `[[constraint]]`: which vertices are held, and how they are chosen.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::schedule::MotionSpec;

/// `[[constraint]]`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConstraintSpec {
    /// Name, to be addressed by; default: its number.
    #[serde(default)]
    pub name: Option<String>,
    /// The shell.
    pub shell: String,
    /// Which vertices.
    pub select: SelectSpec,
    /// Which of x, y, z are prescribed.
    #[serde(default = "all_axes")]
    #[schemars(regex(pattern = "^[xyz]{1,3}$"))]
    pub axes: String,
    /// Motion over time; default: none, the vertices are pinned. A constraint with `from` makes what is left of it then.
    #[serde(default)]
    pub motion: MotionSpec,
    /// Whether the directors are held too: they turn with the motion.
    #[serde(default)]
    pub clamp: bool,
    /// The constraint begins at this time [s] and holds vertices where they are then; default: at the start.
    #[serde(default)]
    pub from: Option<f64>,
    /// The constraint ends at this time [s]; vertices go on with the velocity they have then.
    #[serde(default)]
    pub until: Option<f64>,
}

fn all_axes() -> String {
    "xyz".to_owned()
}

/// `select`: vertices that meet all the conditions given, in the start shape.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SelectSpec {
    /// All vertices.
    #[serde(default)]
    pub all: bool,
    /// Inside a box, faces included.
    #[serde(default, rename = "box")]
    pub cuboid: Option<BoundsSpec>,
    /// By number, from 0.
    #[serde(default)]
    pub vertices: Option<Vec<u32>>,
    /// On a boundary loop; loops are numbered from 0 in the order of their smallest vertices.
    #[serde(default)]
    pub boundary: Option<usize>,
    /// The one vertex nearest to a point [m].
    #[serde(default)]
    pub nearest: Option<[f64; 3]>,
}

/// A box by its corners [m].
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoundsSpec {
    /// Smallest coordinates; default: no limit.
    #[serde(default = "no_minimum")]
    pub min: [f64; 3],
    /// Largest coordinates; default: no limit.
    #[serde(default = "no_maximum")]
    pub max: [f64; 3],
}

fn no_minimum() -> [f64; 3] {
    [f64::NEG_INFINITY; 3]
}

fn no_maximum() -> [f64; 3] {
    [f64::INFINITY; 3]
}
