//! `[contact]`: how surfaces touch.

use schemars::JsonSchema;
use serde::Deserialize;

/// `[contact]`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ContactSpec {
    /// Whether contact is on.
    #[serde(default = "yes")]
    pub enabled: bool,
    /// Distance [m] at which surfaces begin to repel; default: from the mesh.
    #[serde(default)]
    pub d_hat: Option<f64>,
    /// Barrier stiffness [J/m²]; default: adapted.
    #[serde(default)]
    pub kappa: Option<f64>,
    /// Sliding speed [m/s] below which friction is smoothed.
    #[serde(default = "friction_speed")]
    pub friction_speed: f64,
    /// Solves of a step at most, each with the normal forces and directions at the end of the last, until they settle; 1:
    /// those at the start of the step hold for all of it.
    #[serde(default = "one")]
    pub friction_iterations: usize,
    /// Friction between two bodies, in place of the geometric mean of their coefficients.
    #[serde(default)]
    pub pair: Vec<PairSpec>,
}

/// `[[contact.pair]]`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PairSpec {
    /// Names of two shells, of a shell and an obstacle, or of a shell twice: with itself.
    pub bodies: [String; 2],
    /// Friction coefficient.
    pub friction: f64,
}

impl Default for ContactSpec {
    fn default() -> Self {
        Self {
            enabled: true,
            d_hat: None,
            kappa: None,
            friction_speed: friction_speed(),
            friction_iterations: 1,
            pair: Vec::new(),
        }
    }
}

fn yes() -> bool {
    true
}

fn friction_speed() -> f64 {
    1e-3
}

fn one() -> usize {
    1
}
