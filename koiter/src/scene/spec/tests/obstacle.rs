//! Obstacles that deform.

use super::*;

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
