//! Checks of double layers and sources of heat.

use super::heated::burns;
use super::motion::check_motion;
use super::{Checked, all_finite, check_rotation, error, exactly_one, positive, unique};
use crate::burning::ProjectionMethod;
use crate::scene::error::SceneErrorKind as Kind;
use crate::scene::spec::{DoubleLayerSpec, HeatSourceSpec, ProjectionSpec, SceneSpec};

/// Checks what a scene with double layers has beside them.
pub(super) fn check_double_layers(spec: &SceneSpec) -> Checked {
    let names = spec
        .double_layer
        .iter()
        .map(|layer| Some(layer.name.as_str()));
    unique("double_layer", names)?;
    unique(
        "heat_source",
        spec.heat_source
            .iter()
            .map(|source| Some(source.name.as_str())),
    )?;
    for layer in &spec.double_layer {
        check_layer(&format!("double_layer.{}", layer.name), layer)?;
    }
    for source in &spec.heat_source {
        check_source(&format!("heat_source.{}", source.name), source)?;
    }
    match (spec.double_layer.first(), spec.heat_source.first()) {
        (None, Some(_)) if burns(spec) => Ok(()),
        (None, Some(source)) => {
            let message =
                "a source of heat acts on double layers and on shells with [shell.burning], and the scene has neither"
                    .to_owned();
            Err(error(
                Kind::Conflict,
                &format!("heat_source.{}", source.name),
                message,
            ))
        }
        (None, None) => Ok(()),
        (Some(_), _) => check_company(spec),
    }
}

/// What has no meaning beside a double layer is refused rather than ignored.
fn check_company(spec: &SceneSpec) -> Checked {
    let others = [
        ("shell", !spec.shell.is_empty()),
        ("bezier_shell", !spec.bezier_shell.is_empty()),
        ("phase", !spec.phase.is_empty()),
        ("symmetry", !spec.symmetry.is_empty()),
        ("load", !spec.load.is_empty()),
        ("process", !spec.process.is_empty()),
        ("probe", !spec.probe.is_empty()),
    ];
    if let Some((key, _)) = others.iter().find(|(_, is_there)| *is_there) {
        let message = format!("a scene with a [[double_layer]] has no [[{key}]]");
        return Err(error(Kind::Conflict, &format!("{key}.0"), message)
            .with_help("double layers are stepped by projections, apart from elastic shells"));
    }
    for obstacle in &spec.obstacle {
        if obstacle.plane.is_none() && obstacle.sphere.is_none() {
            let message = "double layers collide with planes and spheres only".to_owned();
            return Err(error(
                Kind::Conflict,
                &format!("obstacle.{}", obstacle.name),
                message,
            ));
        }
    }
    for (index, constraint) in spec.constraint.iter().enumerate() {
        let path = constraint.path(index);
        let is_partial = constraint.axes.len() != 3;
        for (key, given) in [
            ("axes", is_partial),
            ("clamp", constraint.clamp),
            ("from", constraint.from.is_some()),
        ] {
            if given {
                let message = format!(
                    "the key '{key}' has no meaning for a double layer: its corners are held as a whole, from the start"
                );
                return Err(error(Kind::Conflict, &format!("{path}.{key}"), message));
            }
        }
    }
    Ok(())
}

fn check_layer(path: &str, layer: &DoubleLayerSpec) -> Checked {
    let mesh = &layer.mesh;
    let at = |key: &str| format!("{path}.mesh.{key}");
    exactly_one(
        &format!("{path}.mesh"),
        &mesh.given_shapes(),
        "file, grid, torus",
    )?;
    positive(&at("scale"), mesh.scale, "")?;
    all_finite(&at("translate"), &mesh.translate)?;
    if let Some(rotate) = &mesh.rotate {
        check_rotation(&at("rotate"), rotate)?;
    }
    for (key, count) in [
        ("sweeps", layer.projection.sweeps),
        ("iterations", layer.projection.iterations),
    ] {
        if count == 0 {
            let message = format!("{key} must be at least 1");
            return Err(error(
                Kind::OutOfRange,
                &format!("{path}.projection.{key}"),
                message,
            ));
        }
    }
    check_method(path, &layer.projection)?;
    for (key, given) in [
        ("exchange_rate", layer.burning.exchange_rate.is_some()),
        ("strength", layer.burning.strength.is_some()),
    ] {
        if given {
            let message = format!("a double layer has no '{key}': it is a key of [shell.burning]");
            let path = format!("{path}.burning.{key}");
            return Err(error(Kind::Conflict, &path, message));
        }
    }
    positive(
        &format!("{path}.projection.longest_move"),
        layer.projection.longest_move,
        "",
    )
}

/// Numbers that the chosen way does not read are refused.
fn check_method(path: &str, projection: &ProjectionSpec) -> Checked {
    let usual = ProjectionSpec::default();
    let changed = [
        ("weights", projection.weights != usual.weights),
        ("iterations", projection.iterations != usual.iterations),
        ("sweeps", projection.sweeps != usual.sweeps),
        ("tolerance", projection.tolerance != usual.tolerance),
        (
            "longest_move",
            projection.longest_move != usual.longest_move,
        ),
        ("compliance", projection.compliance != usual.compliance),
        ("stiffness", projection.stiffness != usual.stiffness),
    ];
    let (method, unread, help): (_, &[&str], _) = match projection.method {
        ProjectionMethod::Successive => (
            "successive",
            &["stiffness"],
            "how stiff successive sweeps are follows from their number and their 'weights'",
        ),
        ProjectionMethod::Global => (
            "global",
            &["weights", "iterations", "stiffness"],
            "the global method has a 'compliance', and solves directly",
        ),
        ProjectionMethod::MassSpring => (
            "mass-spring",
            &[
                "weights",
                "iterations",
                "sweeps",
                "tolerance",
                "longest_move",
                "compliance",
            ],
            "springs by Hooke's law have a 'stiffness' and are not projected",
        ),
    };
    let wrong = changed.iter().find(|(key, is)| *is && unread.contains(key));
    match wrong {
        None => Ok(()),
        Some((key, _)) => {
            let message = format!("the method \"{method}\" has no '{key}'");
            let path = format!("{path}.projection.{key}");
            Err(error(Kind::Conflict, &path, message).with_help(help))
        }
    }
}

fn check_source(path: &str, source: &HeatSourceSpec) -> Checked {
    let at = |key: &str| format!("{path}.{key}");
    positive(&at("temperature"), source.temperature, "K")?;
    positive(&at("rate"), source.rate, "1/s")?;
    if let Some(sphere) = &source.sphere {
        positive(&at("sphere.radius"), sphere.radius, "m")?;
        all_finite(&at("sphere.center"), &sphere.center)?;
    }
    check_motion(&at("motion"), &source.motion)
}
