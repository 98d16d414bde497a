//! Windows and motions of constraints.

use super::*;

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
