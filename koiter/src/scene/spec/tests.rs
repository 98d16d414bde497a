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
fn windows_and_motions_of_constraints_are_checked() {
    let cases = [
        ("from = -1", "from", "-1", "must not be negative"),
        (
            "from = 2\nuntil = 1",
            "until",
            "1",
            "before it begins at 2 s",
        ),
        ("until = 0", "until", "0", "larger than 0"),
        (
            "motion.scale = { factor = [[0, 1], [1, 0]] }",
            "motion.scale.factor.1.1",
            "0",
            "larger than 0",
        ),
        (
            "motion.scale = { along = [0, 0, 0], factor = [[0, 1]] }",
            "motion.scale.along",
            "[0, 0, 0]",
            "a direction must not be",
        ),
        (
            "motion.scale = { factor = [] }",
            "motion.scale.factor",
            "[]",
            "no keys",
        ),
    ];
    for (keys, path, text, words) in cases {
        let error = mistake(
            "select.boundary = 0",
            &format!("select.boundary = 0\n{keys}"),
        );
        let line = 16 + keys.lines().count();
        let path = format!("constraint.0.{path}");
        assert_mistake(&error, Kind::OutOfRange, &path, (line, text), &[words]);
    }
    let scaled = "sphere = { radius = 0.3 }\nmotion.scale = { factor = [[0, 1]] }";
    let error = mistake("sphere = { radius = 0.3 }", scaled);
    assert_eq!(
        (error.kind, error.path.as_str()),
        (Kind::Conflict, "obstacle.ball.motion.scale")
    );
    assert!(
        error.message.contains("a sphere cannot be scaled"),
        "{}",
        error.message
    );
}

#[test]
fn shapes_of_an_obstacle_come_one_after_the_other() {
    let ball = "sphere = { radius = 0.3 }";
    let shape = "mesh.icosphere = { radius = 0.3, subdivisions = 1 }";
    let mesh = format!("{shape}\ndeform = [{{ time = 1, {shape} }}, {{ time = 1.0, {shape} }}]");
    let error = mistake(ball, &mesh);
    let path = "obstacle.ball.deform.1.time";
    assert_mistake(
        &error,
        Kind::OutOfRange,
        path,
        (13, "1.0"),
        &["1 s is followed by 1 s"],
    );
    let error = mistake(ball, &format!("{ball}\ndeform = [{{ time = 1, {shape} }}]"));
    assert_eq!(
        (error.kind, error.path.as_str()),
        (Kind::Conflict, "obstacle.ball.deform")
    );
    let error = mistake(
        ball,
        &format!("{shape}\ndeform = [{{ time = 1, mesh = {{}} }}]"),
    );
    assert_eq!(
        (error.kind, error.path.as_str()),
        (Kind::MissingKey, "obstacle.ball.deform.0.mesh")
    );
}

#[test]
fn phases_are_checked_with_the_names_they_use() {
    let time = "time = { end = 1.0, dt = 0.02 }";
    let wrong = |keys: &str| {
        let phases = format!("phase = [{{ name = \"a\", end = 1, dt = 0.1 }}, {{ {keys} }}]");
        mistake(time, &phases)
    };
    let cases = [
        (
            "name = \"b\", end = 1, dt = 0.1",
            Kind::OutOfRange,
            "phase.b.end",
            "1",
            "the one before ends at 1 s",
        ),
        (
            "name = \"b\", end = 2, dt = 0",
            Kind::OutOfRange,
            "phase.b.dt",
            "0",
            "larger than 0",
        ),
        (
            "name = \"b\", end = 2, dt = 1e-12",
            Kind::OutOfRange,
            "phase.b.dt",
            "1e-12",
            "1.0e12 time steps",
        ),
        (
            "name = \"b\", end = 2, dt = 1, loads = [\"wind\"]",
            Kind::UnknownName,
            "phase.b.loads.0",
            "\"wind\"",
            "no load 'wind'",
        ),
        (
            "name = \"b\", end = 2, dt = 1, constraints = [\"1\"]",
            Kind::UnknownName,
            "phase.b.constraints.0",
            "\"1\"",
            "no constraint '1'",
        ),
        (
            "name = \"b\", end = 2, dt = 1, every_steps = 0",
            Kind::OutOfRange,
            "phase.b.every_steps",
            "0",
            "at least 1",
        ),
        (
            "name = \"b\", end = 2, dt = 1, integrator = \"quasistatic\"",
            Kind::UnknownName,
            "phase.b.integrator",
            "\"quasistatic\"",
            "quasi-static",
        ),
    ];
    for (keys, kind, path, text, words) in cases {
        assert_mistake(&wrong(keys), kind, path, (2, text), &[words]);
    }
    let twice = wrong("name = \"a\", end = 2, dt = 1");
    assert!(twice.message.contains("'a'"), "{}", twice.message);
    let both = mistake(
        time,
        &format!("{time}\nphase = [{{ name = \"a\", end = 1, dt = 0.1 }}]"),
    );
    assert_mistake(
        &both,
        Kind::Conflict,
        "time",
        (2, "{ end = 1.0, dt = 0.02 }"),
        &["each phase has its own"],
    );
    let neither = mistake(time, "");
    assert_eq!(neither.kind, Kind::MissingKey);
    assert!(neither.message.contains("'time'"), "{}", neither.message);
}

#[test]
fn pairs_of_bodies_are_checked() {
    let ball = "sphere = { radius = 0.3 }";
    let with = |pair: &str| {
        let floor = "[[obstacle]]\nname = \"floor\"\nplane = {}";
        mistake(ball, &format!("{ball}\n{floor}\n[[contact.pair]]\n{pair}"))
    };
    let both = "bodies = [\"ball\", \"cloth\"]\nfriction = 0.1";
    let cases = [
        (
            "bodies = [\"cloth\", \"bal\"]\nfriction = 1",
            Kind::UnknownName,
            "0.bodies.1",
            (17, "\"bal\""),
            "did you mean 'ball'",
        ),
        (
            "bodies = [\"floor\", \"ball\"]\nfriction = 1",
            Kind::Conflict,
            "0.bodies",
            (17, "[\"floor\", \"ball\"]"),
            "do not touch each other",
        ),
        (
            "bodies = [\"cloth\", \"cloth\"]\nfriction = -1",
            Kind::OutOfRange,
            "0.friction",
            (18, "-1"),
            "must not be negative",
        ),
    ];
    for (pair, kind, path, place, words) in cases {
        assert_mistake(
            &with(pair),
            kind,
            &format!("contact.pair.{path}"),
            place,
            &[words],
        );
    }
    let twice = with(&format!(
        "{both}\n[[contact.pair]]\nbodies = [\"cloth\", \"ball\"]\nfriction = 1"
    ));
    assert_eq!(
        (twice.kind, twice.path.as_str()),
        (Kind::Conflict, "contact.pair.1.bodies")
    );
    let never = mistake("title = \"Test\"", "contact.friction_iterations = 0");
    assert_mistake(
        &never,
        Kind::OutOfRange,
        "contact.friction_iterations",
        (1, "0"),
        &["at least 1 solve"],
    );
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
        &["two shells named 'cloth'"],
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
