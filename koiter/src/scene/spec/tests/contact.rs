//! Pairs of bodies.

use super::*;

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
