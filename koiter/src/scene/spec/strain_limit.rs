//! `strain_limit` of a shell, and what of it can be checked without a mesh.

use schemars::JsonSchema;
use serde::Deserialize;

use super::check::{Checked, error, optional_positive};
use crate::energy::StretchLimit;
use crate::scene::error::SceneErrorKind as Kind;

/// A limit of stretch, the same in all directions; compression is not limited.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StrainLimitSpec {
    /// Length over rest length that no line in a face ever reaches: 1.1 is a tenth more.
    pub stretch: f64,
    /// Length over rest length up to which the material is left as it is, at least 1; default: half of the way from 1 to
    /// `stretch`.
    #[serde(default)]
    pub begin: Option<f64>,
    /// Stiffness of the barrier [Pa]; default: Young's modulus times (stretch − begin)², which makes the barrier some six
    /// times as stiff as the material at the middle of its range.
    #[serde(default)]
    pub stiffness: Option<f64>,
}

impl StrainLimitSpec {
    /// The limit with its defaults filled in.
    pub(in crate::scene) fn resolve(&self, youngs_modulus: f64) -> StretchLimit {
        let begin = self.begin.unwrap_or(0.5 * (1.0 + self.stretch));
        let range = self.stretch - begin;
        StretchLimit {
            stretch: self.stretch,
            begin,
            stiffness: self.stiffness.unwrap_or(youngs_modulus * range * range),
        }
    }
}

/// Checks the ranges of `strain_limit` of a shell.
pub(super) fn check_strain_limit(path: &str, limit: &StrainLimitSpec) -> Checked {
    let at = |key: &str| format!("{path}.{key}");
    if !(limit.stretch > 1.0 && limit.stretch.is_finite()) {
        let message = format!(
            "stretch must be larger than 1, the length at rest, but it is {}",
            limit.stretch
        );
        return Err(error(Kind::OutOfRange, &at("stretch"), message)
            .with_help("a limit of 10 % is stretch = 1.1"));
    }
    if let Some(begin) = limit.begin
        && !(begin >= 1.0 && begin < limit.stretch)
    {
        let message = format!(
            "begin must be at least 1 and less than stretch = {}, but it is {begin}",
            limit.stretch
        );
        return Err(error(Kind::OutOfRange, &at("begin"), message));
    }
    optional_positive(&at("stiffness"), limit.stiffness, "Pa")
}
