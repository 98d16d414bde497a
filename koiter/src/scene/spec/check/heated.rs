//! Checks of shells that burn: what has no meaning beside fire is refused rather than ignored.

use super::{Checked, error};
use crate::scene::error::SceneErrorKind as Kind;
use crate::scene::model::{BendingModel, IntegratorKind};
use crate::scene::spec::{SceneSpec, ShellSpec};

/// Whether a shell of the scene burns.
pub(super) fn burns(spec: &SceneSpec) -> bool {
    spec.shell.iter().any(|shell| shell.burning.is_some())
}

/// Checks the shells that burn, and what the scene has beside them.
pub(super) fn check_heated(spec: &SceneSpec) -> Checked {
    for shell in &spec.shell {
        let path = format!("shell.{}", shell.name);
        if shell.burning.is_some() {
            check_shell(&path, shell)?;
        } else if shell.temperature.is_some() {
            let message = "only a shell that burns has a temperature".to_owned();
            return Err(error(Kind::Conflict, &format!("{path}.temperature"), message)
                .with_help("give the shell a [shell.burning], with an ignition_temperature out of reach if it is only to be warm"));
        }
    }
    match burns(spec) {
        true => check_company(spec),
        false => Ok(()),
    }
}

fn check_shell(path: &str, shell: &ShellSpec) -> Checked {
    let bending = shell.bending;
    if !bending.can_shrink() {
        let message = format!(
            "bending model '{}' compares no curvature of faces or hinges with a rest value that fire could move",
            bending.info().name
        );
        return Err(error(Kind::Conflict, &format!("{path}.bending"), message)
            .with_help("take bac, dcs, dso, dkt, me-average, ds-theta, ds-tan or none"));
    }
    if shell.strain_limit.is_some() {
        let message = "a limit of stretch is that of lengths which fire changes".to_owned();
        return Err(error(
            Kind::Conflict,
            &format!("{path}.strain_limit"),
            message,
        ));
    }
    let strains = (shell.damping.as_ref()).is_some_and(|d| d.stiffness > 0.0 || d.hinges > 0.0);
    if strains {
        let message = "damping of strains does not know which faces have burnt: a shell that burns is damped by 'mass' only";
        return Err(error(
            Kind::Conflict,
            &format!("{path}.damping"),
            message.into(),
        ));
    }
    Ok(())
}

fn check_company(spec: &SceneSpec) -> Checked {
    let burning = |name: &str| {
        let mut shells = spec.shell.iter();
        shells.any(|shell| shell.name == name && shell.burning.is_some())
    };
    let refuse = |path: String, what: &str| {
        let message = format!("{what} does not know which faces of a shell have burnt");
        Err(error(Kind::Conflict, &path, message))
    };
    if let Some(load) = spec.load.iter().find(|load| burning(&load.shell)) {
        return refuse(format!("load.{}", load.name), "a load");
    }
    if let Some(index) = spec.symmetry.iter().position(|plane| burning(&plane.shell)) {
        return refuse(format!("symmetry.{index}"), "a plane of symmetry");
    }
    if let Some(energy) = spec.energy.iter().find(|energy| burning(&energy.shell)) {
        return refuse(
            format!("energy.{}", energy.name),
            "an energy written as a text",
        );
    }
    let mut constraints = spec.constraint.iter().enumerate();
    if let Some((index, constraint)) = constraints.find(|(_, c)| c.clamp && burning(&c.shell)) {
        let path = format!("{}.clamp", constraint.path(index));
        return refuse(path, "a clamp of directors");
    }
    let of_phases = spec.phase.iter().filter_map(|phase| phase.integrator);
    let mut integrators = of_phases.chain([spec.integrator]);
    let is_path = |kind| {
        matches!(
            kind,
            IntegratorKind::LinearStatic | IntegratorKind::ArcLength
        )
    };
    if integrators.any(is_path) {
        let message = "nothing burns in linear statics, nor on a path by arc length".to_owned();
        return Err(error(Kind::Conflict, "integrator", message)
            .with_help("use integrator = \"quasi-static\", or dynamics"));
    }
    Ok(())
}

impl BendingModel {
    /// Whether rest values of curvature can follow layers that shrink; a shell without bending has none to follow.
    fn can_shrink(self) -> bool {
        match self {
            Self::Bac
            | Self::Dcs
            | Self::Dso
            | Self::Dkt
            | Self::MeAverage
            | Self::DsTheta
            | Self::DsTan
            | Self::None => true,
            Self::Ds2nd | Self::ChEs | Self::ChFs | Self::QbCr | Self::QbPl | Self::QbInt => false,
        }
    }
}
