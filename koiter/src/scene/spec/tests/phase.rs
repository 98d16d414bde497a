//! Parts of a run.

use super::*;

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
