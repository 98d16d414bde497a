//! Checks of `[[load]]`.

use super::{Checked, Kind, check_schedule, check_select, check_shell_name, error};
use crate::energy::bending::ExtraUnknowns;
use crate::scene::spec::{EdgeChoice, LoadSpec, SceneSpec};

const KINDS: &str =
    "force, force_each, force_per_length, force_per_area, pressure, moment_per_length, moment_each";

pub(super) fn check_load(load: &LoadSpec, spec: &SceneSpec) -> Checked {
    let path = format!("load.{}", load.name);
    let at = |key: &str| format!("{path}.{key}");
    check_shell_name(&at("shell"), &load.shell, spec)?;
    let kind = match load.given_kinds()[..] {
        [kind] => kind,
        [] => {
            return Err(
                error(Kind::MissingKey, &path, "the load has no magnitude".into())
                    .with_help(format!("give exactly one of {KINDS}")),
            );
        }
        [first, second, ..] => {
            let message = format!("'{first}' and '{second}' are two loads");
            return Err(
                error(Kind::Conflict, &at(second), message).with_help("write a [[load]] for each")
            );
        }
    };
    let by_length = kind.ends_with("per_length");
    let odd = [
        ("select", load.select.is_some(), kind != "pressure"),
        ("edges", load.edges != EdgeChoice::default(), by_length),
        ("origin", load.origin.is_some(), kind == "pressure"),
    ];
    for (key, given, allowed) in odd {
        if given && !allowed {
            let message = format!("a load by '{kind}' takes no '{key}'");
            let refusal = error(Kind::Conflict, &at(key), message);
            return Err(match key {
                "select" => refusal.with_help(
                    "pressure acts on the whole shell: part of one has no potential; force_per_area acts on a part",
                ),
                _ => refusal,
            });
        }
    }
    match &load.select {
        Some(select) => check_select(&at("select"), select)?,
        None if ["pressure", "force_per_area"].contains(&kind) => {}
        None => {
            let message = format!("the key 'select' is missing: a load by '{kind}' needs it");
            return Err(error(Kind::MissingKey, &path, message)
                .with_help("give some of all = true, box, vertices, boundary, nearest"));
        }
    }
    if kind == "moment_each" && spec.bezier_shell.is_empty() {
        let message = "only the vertices of Bézier shells turn".to_owned();
        return Err(error(Kind::Conflict, &at(kind), message)
            .with_help("moment_per_length turns the directors of edges"));
    }
    if kind == "moment_per_length" {
        check_directors(&at(kind), load, spec)?;
    }
    (load.scale.as_ref()).map_or(Ok(()), |scale| check_schedule(&at("scale"), scale))
}

fn check_directors(path: &str, load: &LoadSpec, spec: &SceneSpec) -> Checked {
    let shell = spec.shell.iter().find(|shell| shell.name == load.shell);
    let bending = shell.map(|shell| shell.bending.info());
    let with_directors = [ExtraUnknowns::EdgeAngles, ExtraUnknowns::VertexDirectors];
    match bending.filter(|info| !with_directors.contains(&info.unknowns)) {
        None => Ok(()),
        Some(info) => {
            let message = format!(
                "a moment turns directors, which the bending model '{}' of shell '{}' has not",
                info.name, load.shell
            );
            Err(error(Kind::Conflict, path, message)
                .with_help("use bending = \"bac\", \"dcs\", \"dso\" or \"dkt\""))
        }
    }
}
