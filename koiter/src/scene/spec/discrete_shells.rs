//! `discrete_shells` of a shell: the numbers of the paper of that name, in place of those of the material.

use schemars::JsonSchema;
use serde::Deserialize;

use super::ShellSpec;
use super::check::{Checked, error, not_negative, optional_positive};
use crate::energy::DiscreteStiffness;
use crate::energy::bending::{HingeSprings, HingeWeight};
use crate::scene::error::SceneErrorKind as Kind;
use crate::scene::membrane_models::MembraneModel;
use crate::scene::model::BendingModel;

/// Stiffnesses of `membrane = "discrete-shells"` and of `bending = "ds-theta"` or `"ds-tan"`, as they stand in the formulas;
/// where one is absent, it is that of the material.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DiscreteShellsSpec {
    /// k_L of the springs k_L Σ (1 − ℓ/ℓ̄)² ℓ̄ on the lengths of edges [N].
    #[serde(default)]
    pub edge_stiffness: Option<f64>,
    /// k_A of the springs k_A Σ (1 − A/Ā)² Ā on the areas of triangles [N/m].
    #[serde(default)]
    pub area_stiffness: Option<f64>,
    /// k_B of the springs k_B Σ (θ − θ̄)² ℓ̄/h̄ on the angles of hinges [J]; with hinge_weight = "simplified" [N].
    #[serde(default)]
    pub hinge_stiffness: Option<f64>,
    /// What stands for ℓ̄/h̄: how much a hinge counts.
    #[serde(default)]
    pub hinge_weight: HingeWeight,
}

impl DiscreteShellsSpec {
    /// Of the membrane.
    pub(in crate::scene) fn membrane(&self) -> DiscreteStiffness {
        DiscreteStiffness {
            edges: self.edge_stiffness,
            areas: self.area_stiffness,
        }
    }

    /// Of the hinges.
    pub(in crate::scene) fn hinges(&self) -> HingeSprings {
        HingeSprings {
            weight: self.hinge_weight,
            stiffness: self.hinge_stiffness,
        }
    }
}

/// Checks the ranges of `discrete_shells` of a shell, and that each number has a spring.
pub(super) fn check_discrete_shells(path: &str, shell: &ShellSpec) -> Checked {
    let Some(numbers) = &shell.discrete_shells else {
        return Ok(());
    };
    let at = |key: &str| format!("{path}.discrete_shells.{key}");
    optional_positive(&at("edge_stiffness"), numbers.edge_stiffness, "N")?;
    not_negative(
        &at("area_stiffness"),
        numbers.area_stiffness.unwrap_or(0.0),
        "N/m",
    )?;
    optional_positive(&at("hinge_stiffness"), numbers.hinge_stiffness, "J")?;
    let has_springs = shell.membrane == MembraneModel::DiscreteShells;
    let is_damped = (shell.damping.as_ref()).is_some_and(|damping| damping.hinges > 0.0);
    let has_hinges = matches!(shell.bending, BendingModel::DsTheta | BendingModel::DsTan);
    let of_membrane = "membrane = \"discrete-shells\"";
    let of_hinges = "bending = \"ds-theta\" or \"ds-tan\"";
    for (key, given, has, needed) in [
        (
            "edge_stiffness",
            numbers.edge_stiffness.is_some(),
            has_springs,
            of_membrane,
        ),
        (
            "area_stiffness",
            numbers.area_stiffness.is_some(),
            has_springs,
            of_membrane,
        ),
        (
            "hinge_stiffness",
            numbers.hinge_stiffness.is_some(),
            has_hinges,
            of_hinges,
        ),
        (
            "hinge_weight",
            numbers.hinge_weight != HingeWeight::default(),
            has_hinges || is_damped,
            of_hinges,
        ),
    ] {
        if given && !has {
            let message = format!(
                "{key} belongs to {needed}, which shell '{}' has not",
                shell.name
            );
            return Err(error(Kind::Conflict, &at(key), message)
                .with_help(format!("write {needed} too, or leave {key} out")));
        }
    }
    Ok(())
}
