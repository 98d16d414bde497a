//! `damping` of a shell, and what of it can be checked without a mesh.

use schemars::JsonSchema;
use serde::Deserialize;

use super::ShellSpec;
use super::check::{Checked, not_negative};
use crate::scene::damping::DampingOptions;

/// Damping in dynamics: of Rayleigh, and of hinges; 0 damps nothing.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DampingSpec {
    /// Drag proportional to mass and velocity [1/s], as in a fluid at rest: it slows rigid motions too, momenta fall at this
    /// rate.
    #[serde(default)]
    pub mass: f64,
    /// Time by which stress runs ahead of strain [s]: damping proportional to the stiffness of membrane, bending and
    /// energies written as texts. A vibration of angular frequency ω has half of stiffness times ω of the critical damping. Rigid motions are not damped.
    #[serde(default)]
    pub stiffness: f64,
    /// k_D of the damping k_D ℓ̄/h̄ θ̇ of hinge angles [J·s], whatever the bending model; weights of hinges are those of
    /// discrete_shells.
    #[serde(default)]
    pub hinges: f64,
}

impl DampingSpec {
    pub(in crate::scene) fn resolve(&self) -> DampingOptions {
        DampingOptions {
            mass: self.mass,
            stiffness: self.stiffness,
            hinges: self.hinges,
        }
    }
}

/// Checks the ranges of `damping` of a shell.
pub(super) fn check_damping(path: &str, shell: &ShellSpec) -> Checked {
    let Some(damping) = &shell.damping else {
        return Ok(());
    };
    let at = |key: &str| format!("{path}.damping.{key}");
    not_negative(&at("mass"), damping.mass, "1/s")?;
    not_negative(&at("stiffness"), damping.stiffness, "s")?;
    not_negative(&at("hinges"), damping.hinges, "J·s")
}
