//! `solver.newmark`, and its ranges.

use schemars::JsonSchema;
use serde::Deserialize;

use super::SceneSpec;
use super::check::{Checked, error, optional_positive};
use crate::scene::error::SceneErrorKind as Kind;
use crate::scene::model::{IntegratorKind, NewmarkOptions};

/// The numbers of Newmark's method.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NewmarkSpec {
    /// 0: explicit steps, without contact, refused where they are longer than the fastest vibration allows; else from
    /// gamma/2 to 1, stable for all steps of linear problems; default: (gamma + 1/2)²/4, which is 0.25.
    #[serde(default)]
    pub beta: Option<f64>,
    /// From 0.5 to 1: 0.5 damps nothing, more damps what moves fast; default: 0.5.
    #[serde(default)]
    pub gamma: Option<f64>,
    /// Watches energy: a step that gains more than this share of the largest kinetic energy so far, beyond the work at what
    /// is prescribed, is cut in half, down to solver.smallest_step, and then an error; default: energy is not watched. 1e-3
    /// catches steps that are too long for a stiff membrane before they show.
    #[serde(default)]
    pub energy_growth: Option<f64>,
}

impl NewmarkSpec {
    /// The numbers with their defaults filled in.
    pub(in crate::scene) fn resolve(&self) -> NewmarkOptions {
        let default = NewmarkOptions::default();
        let gamma = self.gamma.unwrap_or(default.gamma);
        NewmarkOptions {
            // Damps what moves fastest most, of those that are stable: 1/4 for gamma = 1/2.
            beta: self.beta.unwrap_or(0.25 * (gamma + 0.5) * (gamma + 0.5)),
            gamma,
            energy_growth: self.energy_growth,
        }
    }
}

/// Checks `solver.newmark` of a scene.
pub(super) fn check_newmark(spec: &SceneSpec) -> Checked {
    let Some(newmark) = &spec.solver.newmark else {
        return Ok(());
    };
    let refuse = |kind, key: &str, message: String, help: &str| {
        let path = format!("solver.newmark{key}");
        Err(error(kind, &path, message).with_help(help))
    };
    let of_phases = spec.phase.iter().filter_map(|phase| phase.integrator);
    let mut integrators = of_phases.chain([spec.integrator]);
    if integrators.all(|integrator| integrator != IntegratorKind::Newmark) {
        let message = "only the integrator \"newmark\" has these numbers".to_owned();
        let help = "write integrator = \"newmark\", or leave solver.newmark out";
        return refuse(Kind::Conflict, "", message, help);
    }
    optional_positive("solver.newmark.energy_growth", newmark.energy_growth, "")?;
    let NewmarkOptions { beta, gamma, .. } = newmark.resolve();
    if !(0.5..=1.0).contains(&gamma) {
        let message = format!("gamma must lie between 0.5 and 1, but it is {gamma}");
        let help = "0.5 damps nothing; less gains energy without bound";
        return refuse(Kind::OutOfRange, ".gamma", message, help);
    }
    if beta != 0.0 && !(0.5 * gamma..=1.0).contains(&beta) {
        let message = format!(
            "beta must be 0, for explicit steps, or lie between gamma/2 = {} and 1, but it is {beta}",
            0.5 * gamma
        );
        let help = "between 0 and gamma/2 steps are implicit and yet not stable";
        return refuse(Kind::OutOfRange, ".beta", message, help);
    }
    if beta == 0.0 && spec.contact.enabled {
        let message = "explicit steps (beta = 0) know no contact".to_owned();
        let help = "set contact.enabled = false, or take implicit steps with beta = 0.25";
        return refuse(Kind::Conflict, ".beta", message, help);
    }
    Ok(())
}
