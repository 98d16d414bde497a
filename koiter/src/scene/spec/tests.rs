mod constraint;
mod contact;
mod damping;
mod discrete_shells;
mod energy;
mod obstacle;
mod phase;
mod process;

use super::*;
use crate::scene::error::SceneErrorKind as Kind;

const SCENE: &str = r#"title = "Test"
time = { end = 1.0, dt = 0.02 }

[[shell]]
name = "cloth"
material = "cotton"
thickness = 1e-3
mesh.grid = { size = [1.0, 1.0], cells = [4, 4] }

[[obstacle]]
name = "ball"
sphere = { radius = 0.3 }

[[constraint]]
shell = "cloth"
select.boundary = 0

[[probe]]
name = "height"
quantity = "position"
shell = "cloth"
"#;

fn parse(text: &str) -> Result<SceneFile, SceneError> {
    SceneFile::parse("scene.toml", text, &[])
}

/// Parses the scene with one piece replaced; returns the error.
fn mistake(from: &str, to: &str) -> SceneError {
    assert!(SCENE.contains(from), "{from}");
    parse(&SCENE.replacen(from, to, 1)).unwrap_err()
}

/// Asserts kind, path, line, the marked text and words of message and help.
fn assert_mistake(
    error: &SceneError,
    kind: Kind,
    path: &str,
    line_and_text: (usize, &str),
    words: &[&str],
) {
    let location = error.location.as_ref().expect("the error has a place");
    let said = format!(
        "{} | {}",
        error.message,
        error.help.as_deref().unwrap_or("")
    );
    assert_eq!(error.kind, kind, "{said}");
    assert_eq!(error.path, path, "{said}");
    assert_eq!((location.line(), location.text()), line_and_text, "{said}");
    for word in words {
        assert!(said.contains(word), "'{word}' is not in: {said}");
    }
}

#[test]
fn a_sound_scene_has_its_defaults() {
    let spec = parse(SCENE).unwrap().spec;
    assert_eq!(spec.gravity, [0.0, 0.0, -9.81]);
    assert_eq!(spec.integrator, IntegratorKind::ImplicitEuler);
    assert_eq!(spec.shell[0].bending, BendingModel::Bac);
    assert_eq!(spec.shell[0].rest, RestSpec::Flat);
    assert_eq!(spec.shell[0].material.preset.as_deref(), Some("cotton"));
    assert_eq!(spec.shell[0].mesh.scale, 1.0);
    assert_eq!(spec.constraint[0].axes, "xyz");
    assert!(spec.contact.enabled);
}

#[test]
fn syntax_errors_point_at_their_line() {
    let error = mistake("dt = 0.02 }", "dt = 0.02 ]");
    assert_eq!(error.kind, Kind::Syntax);
    assert_eq!(error.location.as_ref().unwrap().line(), 2);
    let error = mistake("title = \"Test\"", "title = Test");
    assert_eq!(error.kind, Kind::Syntax);
    assert_eq!(error.location.as_ref().unwrap().line(), 1);
    let error = mistake("name = \"cloth\"", "name = \"cloth\"\nname = \"cloth\"");
    assert_eq!(error.location.as_ref().unwrap().line(), 6);
    assert!(error.message.contains("duplicate"), "{}", error.message);
}

#[test]
fn unknown_keys_name_the_nearest_valid_one() {
    let cases = [
        ("title =", "titel =", "titel", 1, "did you mean 'title'"),
        (
            "thickness =",
            "thicknes =",
            "shell.cloth.thicknes",
            7,
            "did you mean 'thickness'",
        ),
        (
            "mesh.grid",
            "mesh.gird",
            "shell.cloth.mesh.gird",
            8,
            "did you mean 'grid'",
        ),
        (
            "radius =",
            "raduis =",
            "obstacle.ball.sphere.raduis",
            12,
            "did you mean 'radius'",
        ),
        (
            "select.boundary",
            "select.boundry",
            "constraint.0.select.boundry",
            16,
            "did you mean 'boundary'",
        ),
    ];
    for (from, to, path, line, help) in cases {
        let key = path.rsplit('.').next().unwrap();
        let error = mistake(from, to);
        assert_mistake(&error, Kind::UnknownKey, path, (line, key), &[key, help]);
    }
    let error = mistake("title =", "wind =");
    assert!(error.help.unwrap().starts_with("there are: title, "));
}

#[test]
fn wrong_types_say_what_is_expected_and_found() {
    let cases = [
        (
            "thickness = 1e-3",
            "thickness = \"1 mm\"",
            "shell.cloth.thickness",
            (7, "\"1 mm\""),
            "expected a number, found the text \"1 mm\"",
        ),
        (
            "cells = [4, 4]",
            "cells = [4, 4.5]",
            "shell.cloth.mesh.grid.cells.1",
            (8, "4.5"),
            "expected a whole number",
        ),
        (
            "cells = [4, 4]",
            "cells = [4, -4]",
            "shell.cloth.mesh.grid.cells.1",
            (8, "-4"),
            "0 or larger",
        ),
        (
            "cells = [4, 4]",
            "cells = [4]",
            "shell.cloth.mesh.grid.cells",
            (8, "[4]"),
            "expected a list of 2",
        ),
        (
            "cells = [4, 4]",
            "cells = [4, 4, 4]",
            "shell.cloth.mesh.grid.cells",
            (8, "[4, 4, 4]"),
            "expected a list of 2",
        ),
        (
            "title = \"Test\"",
            "title = 3",
            "title",
            (1, "3"),
            "expected text in quotes, found the number 3",
        ),
        (
            "title = \"Test\"",
            "title = 2026-01-01",
            "",
            (1, "2026-01-01"),
            "seconds",
        ),
        (
            "title = \"Test\"",
            "contact = true",
            "contact",
            (1, "true"),
            "expected a table, found true",
        ),
        (
            "title = \"Test\"",
            "contact.enabled = 1",
            "contact.enabled",
            (1, "1"),
            "expected true or false",
        ),
        (
            "title = \"Test\"",
            "gravity_scale = [[0, 1, 2]]",
            "gravity_scale.0",
            (1, "[0, 1, 2]"),
            "pair [time, value]",
        ),
    ];
    for (from, to, path, place, words) in cases {
        assert_mistake(&mistake(from, to), Kind::WrongType, path, place, &[words]);
    }
}

#[test]
fn missing_keys_are_named() {
    let error = mistake("time = { end = 1.0, dt = 0.02 }", "time = { end = 1.0 }");
    assert_mistake(
        &error,
        Kind::MissingKey,
        "time",
        (2, "{ end = 1.0 }"),
        &["'dt'"],
    );
    let error = mistake("name = \"cloth\"\n", "");
    assert_mistake(
        &error,
        Kind::MissingKey,
        "shell.0",
        (4, "[[shell]]"),
        &["'name'"],
    );
    let error = mistake("material = \"cotton\"", "material = { young = 1e6 }");
    let place = (6, "{ young = 1e6 }");
    assert_mistake(
        &error,
        Kind::MissingKey,
        "shell.cloth.material.poisson",
        place,
        &["cotton"],
    );
    let error = mistake(
        "mesh.grid = { size = [1.0, 1.0], cells = [4, 4] }",
        "mesh = {}",
    );
    assert_mistake(
        &error,
        Kind::MissingKey,
        "shell.cloth.mesh",
        (8, "{}"),
        &["exactly one of file, grid"],
    );
    let error = mistake("select.boundary = 0", "select = {}");
    assert_mistake(
        &error,
        Kind::MissingKey,
        "constraint.0.select",
        (16, "{}"),
        &["nearest"],
    );
}

#[test]
fn values_out_of_range_point_at_the_value() {
    let cases = [
        (
            "dt = 0.02",
            "dt = 0",
            "time.dt",
            (2, "0"),
            "dt must be larger than 0, but it is 0 s",
        ),
        (
            "dt = 0.02",
            "dt = 1e-12",
            "time.dt",
            (2, "1e-12"),
            "1.0e12 time steps",
        ),
        (
            "end = 1.0",
            "end = -1",
            "time.end",
            (2, "-1"),
            "larger than 0",
        ),
        (
            "dt = 0.02",
            "dt = nan",
            "",
            (2, "nan"),
            "not a finite number",
        ),
        (
            "dt = 0.02",
            "dt = inf",
            "",
            (2, "inf"),
            "not a finite number",
        ),
        (
            "\"cotton\"",
            "{ preset = \"cotton\", young = -1 }",
            "shell.cloth.material.young",
            (6, "-1"),
            "young must be larger than 0, but it is -1 Pa",
        ),
        (
            "\"cotton\"",
            "{ preset = \"cotton\", poisson = 0.6 }",
            "shell.cloth.material.poisson",
            (6, "0.6"),
            "0.5",
        ),
        (
            "\"cotton\"",
            "{ preset = \"cotton\", density = 0 }",
            "shell.cloth.material.density",
            (6, "0"),
            "kg/m³",
        ),
        (
            "thickness = 1e-3",
            "thickness = -1e-3",
            "shell.cloth.thickness",
            (7, "-1e-3"),
            "thickness must be larger than 0, but it is -0.001 m",
        ),
        (
            "thickness = 1e-3",
            "friction = -0.1",
            "shell.cloth.friction",
            (7, "-0.1"),
            "must not be negative",
        ),
        (
            "mesh.grid",
            "mesh.scale = 0\nmesh.grid",
            "shell.cloth.mesh.scale",
            (8, "0"),
            "scale",
        ),
        (
            "mesh.grid",
            "mesh.rotate = { axis = [0, 0, 0], degrees = 3 }\nmesh.grid",
            "shell.cloth.mesh.rotate.axis",
            (8, "[0, 0, 0]"),
            "direction",
        ),
        (
            "radius = 0.3",
            "radius = 0",
            "obstacle.ball.sphere.radius",
            (12, "0"),
            "radius must be larger",
        ),
        (
            "title = \"Test\"",
            "contact.d_hat = 0.0",
            "contact.d_hat",
            (1, "0.0"),
            "d_hat must be larger",
        ),
        (
            "title = \"Test\"",
            "solver.max_iterations = 0",
            "solver.max_iterations",
            (1, "0"),
            "at least 1",
        ),
        (
            "title = \"Test\"",
            "output.every_steps = 0",
            "output.every_steps",
            (1, "0"),
            "at least 1",
        ),
        (
            "title = \"Test\"",
            "gravity_scale = [[0, 1], [0, 2]]",
            "gravity_scale.1",
            (1, "[0, 2]"),
            "increase",
        ),
        (
            "title = \"Test\"",
            "gravity_scale = []",
            "gravity_scale",
            (1, "[]"),
            "no keys",
        ),
        (
            "select.boundary = 0",
            "select.box = { min = [1, 0, 0], max = [0, 1, 1] }",
            "constraint.0.select.box",
            (16, "{ min = [1, 0, 0], max = [0, 1, 1] }"),
            "empty along x",
        ),
    ];
    for (from, to, path, place, words) in cases {
        assert_mistake(&mistake(from, to), Kind::OutOfRange, path, place, &[words]);
    }
}

#[test]
fn unknown_names_come_with_the_nearest_valid_one() {
    let cases = [
        (
            "\"cotton\"",
            "\"coton\"",
            "shell.cloth.material.preset",
            (6, "\"coton\""),
            "did you mean 'cotton'",
        ),
        (
            "thickness = 1e-3",
            "bending = \"bca\"",
            "shell.cloth.bending",
            (7, "\"bca\""),
            "did you mean 'bac'",
        ),
        (
            "thickness = 1e-3",
            "rest = \"flatt\"",
            "shell.cloth.rest",
            (7, "\"flatt\""),
            "did you mean 'flat'",
        ),
        (
            "title = \"Test\"",
            "integrator = \"quasistatic\"",
            "integrator",
            (1, "\"quasistatic\""),
            "did you mean 'quasi-static'",
        ),
        (
            "shell = \"cloth\"\nselect",
            "shell = \"clot\"\nselect",
            "constraint.0.shell",
            (15, "\"clot\""),
            "did you mean 'cloth'",
        ),
        (
            "quantity = \"position\"",
            "quantity = \"postion\"",
            "probe.height.quantity",
            (20, "\"postion\""),
            "did you mean 'position'",
        ),
        (
            "quantity = \"position\"\nshell = \"cloth\"",
            "quantity = \"energy\"\nenergy = \"kinetics\"",
            "probe.height.energy",
            (21, "\"kinetics\""),
            "did you mean 'kinetic'",
        ),
        (
            "title = \"Test\"",
            "output.fields = [\"strian\"]",
            "output.fields.0",
            (1, "\"strian\""),
            "did you mean 'strain'",
        ),
        (
            "title = \"Test\"",
            "output.color = \"curvature\"",
            "output.color",
            (1, "\"curvature\""),
            "mean_curvature",
        ),
        (
            "select.boundary = 0",
            "axes = \"xw\"\nselect.all = true",
            "constraint.0.axes",
            (16, "\"xw\""),
            "x, y and z",
        ),
        (
            "name = \"ball\"",
            "name = \"a ball\"",
            "obstacle.0.name",
            (11, "\"a ball\""),
            "letters, digits",
        ),
    ];
    for (from, to, path, place, words) in cases {
        assert_mistake(&mistake(from, to), Kind::UnknownName, path, place, &[words]);
    }
}

#[test]
fn keys_that_exclude_each_other_are_refused() {
    let cases = [
        (
            "mesh.grid",
            "mesh.file = \"a.obj\"\nmesh.grid",
            "shell.cloth.mesh.grid",
            (9, "{ size = [1.0, 1.0], cells = [4, 4] }"),
            "file, grid",
        ),
        (
            "sphere",
            "plane = {}\nsphere",
            "obstacle.ball.sphere",
            (13, "{ radius = 0.3 }"),
            "plane, sphere",
        ),
        (
            "title = \"Test\"",
            "output = { every_steps = 1, every_seconds = 0.1 }",
            "output.every_seconds",
            (1, "0.1"),
            "exclude",
        ),
        (
            "quantity = \"position\"",
            "quantity = \"energy\"",
            "probe.height.shell",
            (21, "\"cloth\""),
            "takes no 'shell'",
        ),
    ];
    for (from, to, path, place, words) in cases {
        assert_mistake(&mistake(from, to), Kind::Conflict, path, place, &[words]);
    }
    let error = mistake(
        "title = \"Test\"",
        "output = { fields = [], color = \"strain\" }",
    );
    let place = (1, "\"strain\"");
    assert_mistake(
        &error,
        Kind::Conflict,
        "output.color",
        place,
        &["not written"],
    );
    let twice = format!(
        "{SCENE}\n[[shell]]\nname = \"cloth\"\nmaterial = \"paper\"\nmesh.disc = {{ radius = 1, rings = 2 }}"
    );
    let error = parse(&twice).unwrap_err();
    assert_mistake(
        &error,
        Kind::Conflict,
        "shell.1.name",
        (24, "\"cloth\""),
        &["two [[shell]] are named 'cloth'"],
    );
}

#[test]
fn a_scene_without_shells_is_refused() {
    let error = parse("time = { end = 1, dt = 0.1 }").unwrap_err();
    assert_eq!(
        (error.kind, error.location.unwrap().line()),
        (Kind::MissingKey, 1)
    );
}

#[test]
fn a_scene_made_by_a_program_has_paths_but_no_places() {
    let mut spec = parse(SCENE).unwrap().spec;
    spec.time.as_mut().unwrap().dt = f64::NAN;
    let error = SceneFile::from_spec(spec).unwrap_err();
    assert_eq!((error.path.as_str(), error.location), ("time.dt", None));
}
