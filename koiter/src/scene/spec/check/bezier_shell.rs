//! Checks of Bézier shells and of what is done to them.

use super::{
    Checked, all_finite, check_mesh, check_select, check_shell, check_shell_name, error,
    not_negative, optional_positive, positive, unique,
};
use crate::bezier::ElementKind;
use crate::scene::document::suggest;
use crate::scene::error::SceneErrorKind as Kind;
use crate::scene::material_models::MaterialModel;
use crate::scene::model::IntegratorKind;
use crate::scene::spec::{BezierShellSpec, FineSurfaceSpec, ProcedureSpec, SceneSpec};

/// Most triangles on an edge of an element.
const MOST_PARTS: usize = 64;

/// Checks Bézier shells, procedures, and what a scene with them has beside them.
pub(super) fn check_bezier_shells(spec: &SceneSpec) -> Checked {
    let names = spec
        .bezier_shell
        .iter()
        .map(|shell| Some(shell.name.as_str()));
    unique("bezier_shell", names)?;
    let names = spec.procedure.iter().map(|done| Some(done.name.as_str()));
    unique("procedure", names)?;
    let Some(first) = spec.bezier_shell.first() else {
        return match spec.procedure.first() {
            None => Ok(()),
            Some(done) => {
                let message = "a procedure acts on Bézier shells, and the scene has none";
                let path = format!("procedure.{}", done.name);
                Err(error(Kind::Conflict, &path, message.to_owned()))
            }
        };
    };
    for shell in &spec.bezier_shell {
        let path = format!("bezier_shell.{}", shell.name);
        check_one(&path, shell)?;
        check_alike(&path, shell, first)?;
    }
    check_company(spec)?;
    for (index, done) in spec.procedure.iter().enumerate() {
        check_procedure(index, done, spec)?;
    }
    Ok(())
}

fn check_one(path: &str, shell: &BezierShellSpec) -> Checked {
    let at = |key: &str| format!("{path}.{key}");
    check_shell(path, &shell.as_shell())?;
    if shell.material.model != MaterialModel::default() {
        let message = "a Bézier shell is isotropic and linear".to_owned();
        return Err(error(Kind::Conflict, &at("material.model"), message));
    }
    not_negative(&at("damping"), shell.damping, "1/s")?;
    all_finite(&at("velocity"), &shell.velocity)?;
    let FineSurfaceSpec {
        subdivide,
        mesh,
        reach,
    } = &shell.surface;
    if !(1..=MOST_PARTS).contains(subdivide) {
        let message = format!("subdivide must be from 1 to {MOST_PARTS}, but it is {subdivide}");
        return Err(error(Kind::OutOfRange, &at("surface.subdivide"), message));
    }
    optional_positive(&at("surface.reach"), *reach, "m")?;
    match mesh {
        Some(mesh) => check_mesh(&at("surface.mesh"), mesh),
        None => Ok(()),
    }
}

/// All Bézier shells of a scene may be sewn to each other: what belongs to all of them is the same.
fn check_alike(path: &str, shell: &BezierShellSpec, first: &BezierShellSpec) -> Checked {
    let name = ElementKind::name;
    let differing = [
        ("element", name(shell.element) != name(first.element)),
        ("damping", shell.damping != first.damping),
        ("friction", shell.friction != first.friction),
        (
            "contact_thickness",
            shell.contact_thickness != first.contact_thickness,
        ),
        (
            "surface.subdivide",
            shell.surface.subdivide != first.surface.subdivide,
        ),
    ];
    match differing.iter().find(|(_, differs)| *differs) {
        None => Ok(()),
        Some((key, _)) => {
            let message = format!(
                "all Bézier shells of a scene have the same '{key}', but that of '{}' is another than that of '{}'",
                shell.name, first.name
            );
            Err(error(Kind::Conflict, &format!("{path}.{key}"), message))
        }
    }
}

/// What has no meaning beside a Bézier shell is refused rather than ignored.
fn check_company(spec: &SceneSpec) -> Checked {
    let others = [
        ("shell", !spec.shell.is_empty()),
        ("double_layer", !spec.double_layer.is_empty()),
        ("phase", !spec.phase.is_empty()),
        ("process", !spec.process.is_empty()),
        ("energy", !spec.energy.is_empty()),
    ];
    if let Some((key, _)) = others.iter().find(|(_, is_there)| *is_there) {
        let message = format!("a scene with a [[bezier_shell]] has no [[{key}]]");
        return Err(
            error(Kind::Conflict, &format!("{key}.0"), message).with_help(
                "Bézier shells have unknowns and steps of their own, apart from other shells",
            ),
        );
    }
    match spec.integrator {
        IntegratorKind::ImplicitEuler
        | IntegratorKind::QuasiStatic
        | IntegratorKind::LinearStatic => {}
        _ => {
            let message = "Bézier shells advance by \"implicit-euler\", \"quasi-static\" or \"linear-static\"";
            return Err(error(Kind::Conflict, "integrator", message.to_owned()));
        }
    }
    for (index, constraint) in spec.constraint.iter().enumerate() {
        if constraint.from.is_some() {
            let path = format!("{}.from", constraint.path(index));
            let message = "constraints on Bézier shells begin at the start".to_owned();
            return Err(error(Kind::Conflict, &path, message));
        }
    }
    if let Some(load) = spec.load.iter().find(|load| load.origin.is_some()) {
        let path = format!("load.{}.origin", load.name);
        let message = "pressure on Bézier shells has no origin: its forces are those of every step";
        return Err(error(Kind::Conflict, &path, message.to_owned()));
    }
    Ok(())
}

fn check_procedure(index: usize, done: &ProcedureSpec, spec: &SceneSpec) -> Checked {
    let path = format!("procedure.{}", done.name);
    let at = |key: &str| format!("{path}.{key}");
    match done.given_kinds()[..] {
        [_] => {}
        [] => {
            return Err(
                error(Kind::MissingKey, &path, "nothing is to be done".into())
                    .with_help("give exactly one of cut, open, patch, close, sew"),
            );
        }
        [first, second, ..] => {
            let message = format!("'{first}' and '{second}' are two procedures");
            return Err(error(Kind::Conflict, &at(second), message)
                .with_help("write a [[procedure]] for each"));
        }
    }
    not_negative(&at("at"), done.at, "s")?;
    let before = &spec.procedure[..index];
    if let Some(previous) = before.last().filter(|previous| previous.at > done.at) {
        let message = format!(
            "procedures are written in the order of their times: '{}' is at {} s",
            previous.name, previous.at
        );
        return Err(error(Kind::OutOfRange, &at("at"), message));
    }
    if let Some(cut) = done.needed_cut() {
        check_cut_name(
            &format!("{path}.{}.cut", done.given_kinds()[0]),
            cut,
            before,
        )?;
    }
    if let Some(cut) = &done.cut {
        check_shell_name(&at("cut.shell"), &cut.shell, spec)?;
        if cut.path.len() < 2 {
            let message = format!(
                "a path has two points or more, but this has {}",
                cut.path.len()
            );
            return Err(error(Kind::OutOfRange, &at("cut.path"), message));
        }
        all_finite(&at("cut.path"), cut.path.as_flattened())?;
    }
    if let Some(open) = &done.open {
        all_finite(&at("open.force"), &[open.force])?;
        all_finite(&at("open.lift"), &[open.lift])?;
        not_negative(&at("open.ramp"), open.ramp, "s")?;
        positive(&at("open.until"), open.until, "s")?;
    }
    if let Some(patch) = &done.patch {
        positive(&at("patch.width"), patch.width, "m")?;
        optional_positive(&at("patch.young"), patch.young, "Pa")?;
        optional_positive(&at("patch.thickness"), patch.thickness, "m")?;
        if !(2..=MOST_PARTS).contains(&patch.across) {
            let message = format!(
                "across must be from 2 to {MOST_PARTS}, but it is {}",
                patch.across
            );
            return Err(error(Kind::OutOfRange, &at("patch.across"), message));
        }
    }
    if let Some(sew) = &done.sew {
        positive(&at("sew.reach"), sew.reach, "m")?;
        for (key, row) in [("first", &sew.first), ("second", &sew.second)] {
            check_shell_name(&at(&format!("sew.{key}.shell")), &row.shell, spec)?;
            check_select(&at(&format!("sew.{key}.select")), &row.select)?;
        }
    }
    Ok(())
}

/// A cut that was made before.
fn check_cut_name(path: &str, name: &str, before: &[ProcedureSpec]) -> Checked {
    let cuts = before.iter().filter(|done| done.cut.is_some());
    let names: Vec<&str> = cuts.map(|done| done.name.as_str()).collect();
    if names.contains(&name) {
        return Ok(());
    }
    let message = format!("there is no cut '{name}' before this");
    Err(error(Kind::UnknownName, path, message).with_help(suggest(name, &names)))
}
