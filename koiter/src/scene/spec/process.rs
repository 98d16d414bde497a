//! `[[process]]`: what changes the rest curvature of a shell over time, and what of it can be checked without a mesh.

use schemars::JsonSchema;
use serde::Deserialize;

use super::check::{
    Checked, check_direction, check_schedule, check_shell_name, error, not_negative,
    optional_positive, positive,
};
use super::{SceneSpec, SelectSpec};
use crate::scene::error::{SceneError, SceneErrorKind as Kind};
use crate::scene::model::{BendingModel, IntegratorKind};
use crate::scene::processes::ProcessError;
use crate::scene::schedule::Schedule;

/// `[[process]]`: exactly one of `curl`, `crease` and `yield`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProcessSpec {
    /// Name, unique among the processes.
    pub name: String,
    /// The shell.
    pub shell: String,
    /// The shell curls to a cylinder.
    #[serde(default)]
    pub curl: Option<CurlSpec>,
    /// The shell is creased.
    #[serde(default)]
    pub crease: Option<CreaseSpec>,
    /// The shell yields where it is bent too far.
    #[serde(default, rename = "yield")]
    pub yielding: Option<YieldSpec>,
    /// Factor over time, on the curvature of a curl and the angle of a crease; default: 1, from the start.
    #[serde(default)]
    pub scale: Option<Schedule<f64>>,
}

/// A cylinder to which a shell curls: at a factor f its radius is `radius` over f.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CurlSpec {
    /// Radius [m]; positive where normals fan out.
    pub radius: f64,
    /// Direction of the axis.
    pub axis: [f64; 3],
}

/// A crease along the inner edges on a line, or between selected vertices.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CreaseSpec {
    /// Two ends of a line [m] in the start shape: the edges on it are creased.
    #[serde(default)]
    pub line: Option<[[f64; 3]; 2]>,
    /// The edges between these vertices are creased.
    #[serde(default)]
    pub select: Option<SelectSpec>,
    /// Angle by which normals turn across the crease [°]; positive where they fan out.
    pub degrees: f64,
}

/// Plastic flow, where the rest curvature goes after the curvature.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct YieldSpec {
    /// Hinges (ds-theta, ds-tan): how far the angle of an edge may be from its rest angle [°].
    #[serde(default)]
    pub degrees: Option<f64>,
    /// Other bending models: how far curvature may be from rest curvature [1/m].
    #[serde(default)]
    pub curvature: Option<f64>,
    /// Share of the excess that flows in a second [1/s]; default: all of it in every step.
    #[serde(default)]
    pub rate: Option<f64>,
    /// By how much the threshold grows with what has flowed; default: 0.
    #[serde(default)]
    pub hardening: f64,
}

/// Whether measures of bending are hinge angles.
fn has_hinges(bending: BendingModel) -> bool {
    matches!(bending, BendingModel::DsTheta | BendingModel::DsTan)
}

/// Checks one process.
pub(super) fn check_process(process: &ProcessSpec, spec: &SceneSpec) -> Checked {
    let path = format!("process.{}", process.name);
    let at = |key: &str| format!("{path}.{key}");
    check_shell_name(&at("shell"), &process.shell, spec)?;
    let kinds = [
        ("curl", process.curl.is_some()),
        ("crease", process.crease.is_some()),
        ("yield", process.yielding.is_some()),
    ];
    let given: Vec<&str> = (kinds.iter().filter(|(_, given)| *given))
        .map(|(name, _)| *name)
        .collect();
    match given[..] {
        [_] => {}
        [] => {
            return Err(
                error(Kind::MissingKey, &path, "the process does nothing".into())
                    .with_help("give exactly one of curl, crease, yield"),
            );
        }
        [first, second, ..] => {
            let message = format!("'{first}' and '{second}' are two processes");
            return Err(error(Kind::Conflict, &at(second), message)
                .with_help("write a [[process]] for each"));
        }
    }
    let of_phases = spec.phase.iter().filter_map(|phase| phase.integrator);
    let mut integrators = of_phases.chain([spec.integrator]);
    if integrators.any(|kind| {
        matches!(
            kind,
            IntegratorKind::LinearStatic | IntegratorKind::ArcLength
        )
    }) {
        let message = "rest shapes do not change in linear statics, nor on a path by arc length";
        return Err(error(Kind::Conflict, &path, message.into())
            .with_help("use integrator = \"quasi-static\", or dynamics"));
    }
    let shell = spec.shell.iter().find(|shell| shell.name == process.shell);
    let bending = shell.map_or(BendingModel::default(), |shell| shell.bending);
    check_model(&path, process, bending)?;
    if let Some(curl) = &process.curl {
        if !(curl.radius != 0.0 && curl.radius.is_finite()) {
            let message = format!("radius must not be 0, but it is {} m", curl.radius);
            return Err(error(Kind::OutOfRange, &at("curl.radius"), message));
        }
        check_direction(&at("curl.axis"), curl.axis)?;
    }
    if let Some(crease) = &process.crease {
        check_crease(&at("crease"), crease, bending)?;
    }
    if let Some(yielding) = &process.yielding {
        check_yield(&at("yield"), yielding, bending)?;
        if process.scale.is_some() {
            let message = "yielding has no factor over time: it follows the shape".to_owned();
            return Err(error(Kind::Conflict, &at("scale"), message));
        }
    }
    (process.scale.as_ref()).map_or(Ok(()), |scale| check_schedule(&at("scale"), scale))
}

/// Whether the bending model has what the process changes.
fn check_model(path: &str, process: &ProcessSpec, bending: BendingModel) -> Checked {
    let name = bending.info().name;
    let (error, help) = match () {
        () if !bending.measures_curvature() => (
            ProcessError::NoMeasures(name),
            "bac, dcs, dso, dkt, ds-theta and others have rest values",
        ),
        () if process.crease.is_some() && !bending.has_creases() => (
            ProcessError::NoCrease(name),
            "directors at vertices, and curvatures of several edges at once, smooth a crease out",
        ),
        () => return Ok(()),
    };
    Err(SceneError::new(Kind::Conflict, error.to_string())
        .inside(path)
        .with_help(help))
}

fn check_crease(path: &str, crease: &CreaseSpec, bending: BendingModel) -> Checked {
    let at = |key: &str| format!("{path}.{key}");
    if crease.line.is_some() == crease.select.is_some() {
        let message = "a crease is either on a 'line' or between the vertices of 'select'";
        let kind = match crease.line {
            Some(_) => Kind::Conflict,
            None => Kind::MissingKey,
        };
        return Err(error(kind, path, message.into()).with_help("give one of line, select"));
    }
    if let Some([a, b]) = crease.line
        && a == b
    {
        let message = "the ends of the line are one point".to_owned();
        return Err(error(Kind::OutOfRange, &at("line"), message));
    }
    // A hinge angle may be any number; a director never lies in its face.
    let largest = match bending {
        BendingModel::DsTheta => 360.0,
        _ => 180.0,
    };
    if !(crease.degrees.abs() < largest) {
        let message = format!(
            "degrees must lie between −{largest} and {largest} with this bending model, but it is {}",
            crease.degrees
        );
        return Err(error(Kind::OutOfRange, &at("degrees"), message));
    }
    Ok(())
}

fn check_yield(path: &str, yielding: &YieldSpec, bending: BendingModel) -> Checked {
    let at = |key: &str| format!("{path}.{key}");
    let by_degrees = ("degrees", yielding.degrees, "°");
    let by_curvature = ("curvature", yielding.curvature, "1/m");
    let ((key, threshold, unit), (other, odd, _)) = match has_hinges(bending) {
        true => (by_degrees, by_curvature),
        false => (by_curvature, by_degrees),
    };
    let name = bending.info().name;
    if odd.is_some() {
        let message = format!("bending model '{name}' yields by '{key}', not by '{other}'");
        return Err(error(Kind::Conflict, &at(other), message));
    }
    let Some(threshold) = threshold else {
        let message = format!("the key '{key}' is missing: bending model '{name}' yields by it");
        return Err(error(Kind::MissingKey, path, message));
    };
    positive(&at(key), threshold, unit)?;
    optional_positive(&at("rate"), yielding.rate, "1/s")?;
    not_negative(&at("hardening"), yielding.hardening, "")
}
