//! `[[symmetry]]`: where a shell goes on as its mirror image.

use schemars::JsonSchema;
use serde::Deserialize;

use super::Axis;

/// `[[symmetry]]`: a plane across a coordinate axis on which the shell ends; behind it is its mirror image.
///
/// Vertices on the plane stay on it, directors there stay in it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SymmetrySpec {
    /// The shell.
    pub shell: String,
    /// The axis that the plane is normal to.
    pub normal: Axis,
    /// Where the plane cuts the axis [m].
    #[serde(default)]
    pub at: f64,
}
