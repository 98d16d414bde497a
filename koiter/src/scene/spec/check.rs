//! Checks that need no mesh: ranges, names, and keys that must stand alone.

mod bezier_shell;
mod double_layer;
mod friction;
mod heated;
mod loads;
mod motion;
mod obstacle;
mod phases;

use std::collections::HashSet;

use self::friction::check_friction;
use self::motion::check_motion;
pub(super) use self::motion::check_schedule;
use self::obstacle::check_obstacle;
pub use self::phases::MAX_STEPS;
use super::damping::check_damping;
use super::discrete_shells::check_discrete_shells;
use super::energy::check_energy;
use super::material::check_material;
use super::newmark::check_newmark;
use super::process::check_process;
use super::strain_limit::check_strain_limit;
use super::{
    ConstraintSpec, ENERGY_NAMES, FIELD_NAMES, MeshSpec, ProbeQuantity, ProbeSpec, RotationSpec,
    SceneSpec, SelectSpec, ShellSpec, SymmetrySpec,
};
use crate::scene::document::suggest;
use crate::scene::error::{SceneError, SceneErrorKind as Kind};
use crate::scene::model::IntegratorKind;

pub(super) type Checked = Result<(), SceneError>;

/// Checks a whole scene; the first mistake is returned with its path.
pub(super) fn check(spec: &SceneSpec) -> Checked {
    phases::check_phases(spec)?;
    if spec.shell_names().is_empty() && spec.double_layer.is_empty() {
        return Err(error(
            Kind::MissingKey,
            "",
            "the scene has no [[shell]]".into(),
        ));
    }
    double_layer::check_double_layers(spec)?;
    heated::check_heated(spec)?;
    bezier_shell::check_bezier_shells(spec)?;
    if let Some(schedule) = &spec.gravity_scale {
        check_schedule("gravity_scale", schedule)?;
    }
    unique(
        "shell",
        spec.shell.iter().map(|shell| Some(shell.name.as_str())),
    )?;
    unique(
        "obstacle",
        spec.obstacle
            .iter()
            .map(|obstacle| Some(obstacle.name.as_str())),
    )?;
    unique(
        "constraint",
        spec.constraint
            .iter()
            .map(|constraint| constraint.name.as_deref()),
    )?;
    unique(
        "load",
        spec.load.iter().map(|load| Some(load.name.as_str())),
    )?;
    unique(
        "probe",
        spec.probe.iter().map(|probe| Some(probe.name.as_str())),
    )?;
    for shell in &spec.shell {
        check_shell(&format!("shell.{}", shell.name), shell)?;
    }
    for obstacle in &spec.obstacle {
        check_obstacle(&format!("obstacle.{}", obstacle.name), obstacle)?;
    }
    for (index, constraint) in spec.constraint.iter().enumerate() {
        check_constraint(&constraint.path(index), constraint, spec)?;
    }
    for (index, plane) in spec.symmetry.iter().enumerate() {
        check_symmetry(&format!("symmetry.{index}"), plane, spec)?;
    }
    for load in &spec.load {
        loads::check_load(load, spec)?;
    }
    unique(
        "energy",
        (spec.energy.iter()).map(|energy| Some(energy.name.as_str())),
    )?;
    for energy in &spec.energy {
        check_energy(energy, spec)?;
    }
    unique(
        "process",
        (spec.process.iter()).map(|process| Some(process.name.as_str())),
    )?;
    for process in &spec.process {
        check_process(process, spec)?;
    }
    for probe in &spec.probe {
        check_probe(&format!("probe.{}", probe.name), probe, spec)?;
    }
    check_contact_and_solver(spec)?;
    check_newmark(spec)?;
    check_output(spec)
}

impl ConstraintSpec {
    /// Dotted path of the constraint with this number.
    pub(in crate::scene) fn path(&self, index: usize) -> String {
        format!("constraint.{}", self.id(index))
    }

    /// What others call the constraint with this number: its name, or the number.
    pub(in crate::scene) fn id(&self, index: usize) -> String {
        self.name.clone().unwrap_or_else(|| index.to_string())
    }
}

fn check_shell(path: &str, shell: &ShellSpec) -> Checked {
    let at = |key: &str| format!("{path}.{key}");
    check_mesh(&at("mesh"), &shell.mesh)?;
    if let Some(mesh) = &shell.rest_mesh {
        check_mesh(&at("rest_mesh"), mesh)?;
    }
    check_material(path, shell)?;
    if let Some(limit) = &shell.strain_limit {
        check_strain_limit(&at("strain_limit"), limit)?;
    }
    check_discrete_shells(path, shell)?;
    check_damping(path, shell)?;
    not_negative(&at("friction"), shell.friction, "")?;
    not_negative(&at("contact_thickness"), shell.contact_thickness, "m")
}

fn check_mesh(path: &str, mesh: &MeshSpec) -> Checked {
    exactly_one(
        path,
        &mesh.given_shapes(),
        "file, grid, irregular, disc, cylinder, cone, icosphere, torus, cap, panel, zone, vee, hat",
    )?;
    if mesh.scale == 0.0 {
        return Err(error(
            Kind::OutOfRange,
            &format!("{path}.scale"),
            "the scale must not be 0".into(),
        ));
    }
    positive(&format!("{path}.scale"), mesh.scale, "")?;
    for (axis, factor) in mesh.stretch.iter().flatten().enumerate() {
        positive(&format!("{path}.stretch.{axis}"), *factor, "")?;
    }
    mesh.rotate.as_ref().map_or(Ok(()), |rotate| {
        check_rotation(&format!("{path}.rotate"), rotate)
    })
}

fn check_rotation(path: &str, rotation: &RotationSpec) -> Checked {
    check_direction(&format!("{path}.axis"), rotation.axis)
}

pub(super) fn check_direction(path: &str, direction: [f64; 3]) -> Checked {
    if direction == [0.0; 3] {
        return Err(error(
            Kind::OutOfRange,
            path,
            "a direction must not be [0, 0, 0]".into(),
        ));
    }
    Ok(())
}

fn check_constraint(path: &str, constraint: &ConstraintSpec, spec: &SceneSpec) -> Checked {
    let at = |key: &str| format!("{path}.{key}");
    if spec.double_layer.is_empty() {
        check_shell_name(&at("shell"), &constraint.shell, spec)?;
    }
    check_select(&at("select"), &constraint.select)?;
    let axes = &constraint.axes;
    let repeated = axes
        .chars()
        .enumerate()
        .any(|(i, c)| axes.chars().take(i).any(|d| d == c));
    if axes.is_empty() || repeated || axes.chars().any(|c| !"xyz".contains(c)) {
        let message =
            format!("axes must be some of x, y and z, each once, but they are \"{axes}\"");
        return Err(error(Kind::UnknownName, &at("axes"), message)
            .with_help("write \"xyz\", \"z\", \"xy\", …"));
    }
    optional_positive(&at("until"), constraint.until, "s")?;
    let from = constraint.from.unwrap_or(0.0);
    not_negative(&at("from"), from, "s")?;
    if let Some(until) = constraint.until.filter(|until| *until <= from) {
        let message = format!("the constraint ends at {until} s, before it begins at {from} s");
        return Err(error(Kind::OutOfRange, &at("until"), message));
    }
    check_motion(&at("motion"), &constraint.motion)
}

fn check_symmetry(path: &str, plane: &SymmetrySpec, spec: &SceneSpec) -> Checked {
    check_shell_name(&format!("{path}.shell"), &plane.shell, spec)?;
    let shell = spec.shell.iter().find(|shell| shell.name == plane.shell);
    match shell.filter(|shell| !shell.bending.knows_symmetry()) {
        None => Ok(()),
        Some(shell) => {
            let message = format!(
                "at a plane of symmetry the bending model '{}' of shell '{}', which has no directors, bends freely, as at a hinge",
                shell.bending.info().name,
                shell.name
            );
            Err(error(Kind::Conflict, path, message).with_help(
                "use bending = \"bac\", \"dcs\", \"dso\" or \"dkt\", or simulate the whole shell",
            ))
        }
    }
}

pub(super) fn check_shell_name(path: &str, name: &str, spec: &SceneSpec) -> Checked {
    let names = spec.shell_names();
    if names.contains(&name) {
        return Ok(());
    }
    Err(error(
        Kind::UnknownName,
        path,
        format!("there is no shell '{name}'"),
    )
    .with_help(suggest(name, &names)))
}

pub(super) fn check_select(path: &str, select: &SelectSpec) -> Checked {
    let given = select.all
        || select.cuboid.is_some()
        || select.vertices.is_some()
        || select.boundary.is_some()
        || select.nearest.is_some();
    if !given {
        let message = "the selection has no condition".to_owned();
        return Err(error(Kind::MissingKey, path, message)
            .with_help("give some of all = true, box, vertices, boundary, nearest"));
    }
    if let Some(bounds) = &select.cuboid
        && let Some(axis) = (0..3).find(|&axis| bounds.min[axis] > bounds.max[axis])
    {
        let (low, high) = (bounds.min[axis], bounds.max[axis]);
        let message = format!(
            "the box is empty along {}: min {low} is above max {high}",
            ["x", "y", "z"][axis]
        );
        return Err(error(Kind::OutOfRange, &format!("{path}.box"), message));
    }
    Ok(())
}

fn check_probe(path: &str, probe: &ProbeSpec, spec: &SceneSpec) -> Checked {
    let at = |key: &str| format!("{path}.{key}");
    let (needed, what) = match probe.quantity {
        ProbeQuantity::Energy => (None, "an energy"),
        ProbeQuantity::Reaction => (Some("constraint"), "a reaction"),
        ProbeQuantity::LoadFactor => (None, "a load factor"),
        _ => (Some("shell"), "this quantity"),
    };
    if probe.quantity == ProbeQuantity::LoadFactor && spec.integrator != IntegratorKind::ArcLength {
        let message = "there is no load factor without integrator = \"arc-length\"".to_owned();
        return Err(error(Kind::Conflict, &at("quantity"), message));
    }
    let keys = [
        ("shell", probe.shell.is_some()),
        ("constraint", probe.constraint.is_some()),
        ("energy", probe.energy.is_some()),
        ("select", probe.select.is_some()),
    ];
    for (key, given) in keys {
        let allowed = needed == Some(key)
            || key == "energy" && probe.quantity == ProbeQuantity::Energy
            || key == "select" && needed == Some("shell");
        if given && !allowed {
            return Err(error(
                Kind::Conflict,
                &at(key),
                format!("{what} takes no '{key}'"),
            ));
        }
        if !given && needed == Some(key) {
            return Err(error(
                Kind::MissingKey,
                path,
                format!("the key '{key}' is missing: {what} needs it"),
            ));
        }
    }
    if let Some(name) = &probe.energy {
        let stored = spec.energy.iter().filter(|energy| energy.is_stored());
        let mut names = ENERGY_NAMES.to_vec();
        names.extend(stored.map(|energy| energy.name.as_str()));
        if !names.contains(&name.as_str()) {
            let message = format!("there is no energy '{name}'");
            return Err(
                error(Kind::UnknownName, &at("energy"), message).with_help(suggest(name, &names))
            );
        }
    }
    if let Some(shell) = &probe.shell {
        check_shell_name(&at("shell"), shell, spec)?;
    }
    if let Some(select) = &probe.select {
        check_select(&at("select"), select)?;
    }
    match &probe.constraint {
        Some(name) => check_constraint_name(&at("constraint"), name, spec),
        None => Ok(()),
    }
}

fn check_constraint_name(path: &str, name: &str, spec: &SceneSpec) -> Checked {
    let names = (0..spec.constraint.len()).map(|i| spec.constraint[i].id(i));
    let names: Vec<String> = names.collect();
    if names.iter().any(|known| known == name) {
        return Ok(());
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let message = format!("there is no constraint '{name}'");
    Err(error(Kind::UnknownName, path, message).with_help(suggest(name, &names)))
}

fn check_contact_and_solver(spec: &SceneSpec) -> Checked {
    let solver = &spec.solver;
    optional_positive("contact.d_hat", spec.contact.d_hat, "m")?;
    optional_positive("contact.kappa", spec.contact.kappa, "J/m²")?;
    positive("contact.friction_speed", spec.contact.friction_speed, "m/s")?;
    check_friction(spec)?;
    optional_positive(
        "solver.velocity_tolerance",
        solver.velocity_tolerance,
        "m/s",
    )?;
    optional_positive(
        "solver.displacement_tolerance",
        solver.displacement_tolerance,
        "m",
    )?;
    optional_positive("solver.smallest_step", solver.smallest_step, "")?;
    optional_positive("solver.first_arc_length", solver.first_arc_length, "m")?;
    optional_positive("solver.largest_arc_length", solver.largest_arc_length, "m")?;
    optional_positive("solver.last_load_factor", solver.last_load_factor, "")?;
    if let Some(share) = solver.smallest_step.filter(|share| *share > 1.0) {
        let message = format!("smallest_step is a share of a step, at most 1, but it is {share}");
        return Err(error(Kind::OutOfRange, "solver.smallest_step", message));
    }
    if solver.max_iterations == Some(0) {
        let message = "there must be at least 1 iteration".to_owned();
        return Err(error(Kind::OutOfRange, "solver.max_iterations", message));
    }
    Ok(())
}

fn check_output(spec: &SceneSpec) -> Checked {
    let output = &spec.output;
    if output.every_steps.is_some() && output.every_seconds.is_some() {
        let message = "every_steps and every_seconds exclude each other".to_owned();
        return Err(error(Kind::Conflict, "output.every_seconds", message));
    }
    if output.every_steps == Some(0) {
        return Err(error(
            Kind::OutOfRange,
            "output.every_steps",
            "must be at least 1".into(),
        ));
    }
    optional_positive("output.every_seconds", output.every_seconds, "s")?;
    not_negative("output.checkpoint_seconds", output.checkpoint_seconds, "s")?;
    let fields = output
        .fields
        .iter()
        .enumerate()
        .map(|(i, name)| (format!("output.fields.{i}"), name));
    let color = output
        .color
        .iter()
        .map(|name| ("output.color".to_owned(), name));
    for (path, name) in fields.chain(color) {
        if !FIELD_NAMES.contains(&name.as_str()) {
            return Err(error(
                Kind::UnknownName,
                &path,
                format!("there is no field '{name}'"),
            )
            .with_help(suggest(name, &FIELD_NAMES)));
        }
    }
    if let Some(color) = &output.color
        && !output.fields.contains(color)
    {
        let message =
            format!("the field '{color}' is not among output.fields, so it is not written");
        return Err(error(Kind::Conflict, "output.color", message));
    }
    Ok(())
}

fn unique<'a>(list: &str, names: impl Iterator<Item = Option<&'a str>>) -> Checked {
    let mut seen = HashSet::new();
    for (index, name) in names.enumerate() {
        let Some(name) = name else { continue };
        let path = format!("{list}.{index}.name");
        let plain = |c: char| c.is_alphanumeric() || "_-".contains(c);
        if name.is_empty() || !name.chars().all(plain) || name.chars().all(|c| c.is_ascii_digit()) {
            let message =
                format!("\"{name}\" is no name: use letters, digits, '-' and '_', not only digits");
            return Err(error(Kind::UnknownName, &path, message));
        }
        if !seen.insert(name) {
            return Err(error(
                Kind::Conflict,
                &path,
                format!("two [[{list}]] are named '{name}'"),
            ));
        }
    }
    Ok(())
}

fn exactly_one(path: &str, given: &[&str], all: &str) -> Checked {
    match given {
        [_] => Ok(()),
        [] => Err(error(Kind::MissingKey, path, "no shape is given".into())
            .with_help(format!("give exactly one of {all}"))),
        [_, second, ..] => {
            let message = format!("{} shapes are given: {}", given.len(), given.join(", "));
            Err(error(Kind::Conflict, &format!("{path}.{second}"), message)
                .with_help("keep one of them"))
        }
    }
}

pub(super) fn positive(path: &str, value: f64, unit: &str) -> Checked {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    let message = format!(
        "{} must be larger than 0, but it is {}",
        last_key(path),
        with_unit(value, unit)
    );
    Err(error(Kind::OutOfRange, path, message))
}

/// What a path ends with: a key, or a place in a list with the key of the list, such as `rest_stretch[0]`.
fn last_key(path: &str) -> String {
    let mut parts = path.rsplit('.');
    let last = parts.next().unwrap_or(path);
    match (last.parse::<usize>(), parts.next()) {
        (Ok(index), Some(list)) => format!("{list}[{index}]"),
        _ => last.to_owned(),
    }
}

pub(super) fn optional_positive(path: &str, value: Option<f64>, unit: &str) -> Checked {
    value.map_or(Ok(()), |value| positive(path, value, unit))
}

pub(super) fn not_negative(path: &str, value: f64, unit: &str) -> Checked {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    let message = format!(
        "{} must not be negative, but it is {}",
        last_key(path),
        with_unit(value, unit)
    );
    Err(error(Kind::OutOfRange, path, message))
}

/// Passes finite numbers.
pub(super) fn all_finite(path: &str, values: &[f64]) -> Checked {
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(error(
            Kind::OutOfRange,
            path,
            format!("{value} is not a finite number"),
        )),
        None => Ok(()),
    }
}

fn with_unit(value: f64, unit: &str) -> String {
    format!("{value} {unit}").trim_end().to_owned()
}

pub(super) fn error(kind: Kind, path: &str, message: String) -> SceneError {
    SceneError::new(kind, message).inside(path)
}
