//! Obstacles that deform and turn while shells lie on them.
#![cfg(feature = "serde")]

use koiter::Vec3;
use koiter::scene::{NoFiles, Scene, SceneFile, Simulation};

/// A cloth above a ball of triangles that grows by half, and in another time is where it was.
const GROWING: &str = r#"
time = { end = 0.6, dt = 0.02 }

[[shell]]
name = "cloth"
mesh = { grid = { size = [0.4, 0.4], cells = [10, 10] }, translate = [0, 0, 0.105] }
material = { young = 1e5, poisson = 0.3, density = 400 }
thickness = 1e-3

[[obstacle]]
name = "ball"
translate = [0, 0, -0.01]
mesh.icosphere = { radius = 0.1, subdivisions = 3 }
deform = [
    { time = 0.2, mesh = { icosphere = { radius = 0.1, subdivisions = 3 } } },
    { time = 0.6, mesh = { icosphere = { radius = 0.1, subdivisions = 3 }, scale = 1.5 } },
]
motion.translate = [[0, [0, 0, 0]], [1, [0.1, 0, 0]]]
"#;

fn build(text: &str) -> Scene {
    let file = SceneFile::parse("scene.toml", text, &[]).unwrap();
    Scene::build(&file, &NoFiles).unwrap()
}

#[test]
fn a_ball_that_grows_lifts_a_cloth() {
    let mut simulation = Simulation::new(build(GROWING).model).unwrap();
    let cloth = simulation.shell_positions(0).len();
    for step in 1..=30 {
        let report = simulation.step(0.02).unwrap();
        assert!(report.converged && report.min_gap > 0.0, "step {step}");
        let time = 0.02 * f64::from(step);
        let (center, grown) = (
            Vec3::new(0.1 * time, 0.0, -0.01),
            (time - 0.2).max(0.0) / 0.4,
        );
        for x in &simulation.display_positions()[cloth..] {
            let radius = 0.1 + 0.05 * grown;
            // Exact where it is shown; and where the solver has it, which no vertex of the cloth may enter.
            assert!(((x - center).norm() - radius).abs() < 1e-12, "step {step}");
        }
    }
    let top = simulation
        .shell_positions(0)
        .iter()
        .map(|x| x.z)
        .fold(f64::MIN, f64::max);
    assert!(top > 0.14, "the ball is 0.14 m high, the cloth {top} m");
    assert!(top < 0.16, "the cloth flew off to {top} m");
}

#[test]
fn other_shapes_of_an_obstacle_are_another_scene() {
    let fingerprint = |text: &str| build(text).model.fingerprints();
    let other = GROWING.replace("scale = 1.5", "scale = 1.4");
    assert_ne!(fingerprint(GROWING)[1], fingerprint(&other)[1]);
    assert_eq!(fingerprint(GROWING)[0], fingerprint(&other)[0]);
}

#[test]
fn a_large_turn_in_one_step_is_warned_about() {
    let warnings = |degrees: f64| {
        let text = format!(
            "{GROWING}motion.rotate = {{ axis = [0, 0, 1], degrees = [[0, 0], [0.1, {degrees}], [9, 0]] }}\n"
        );
        build(&text).warnings
    };
    assert!(warnings(145.0).is_empty());
    let found = warnings(-300.0);
    // 60° in a step of a fifth of the time: half the chord is at cos 30° of the radius.
    assert!(
        found[0].message.contains("60°") && found[0].message.contains("13 %"),
        "{found:?}"
    );
    assert_eq!(found[0].path, "obstacle.ball.motion.rotate.degrees");
    assert!(found[0].location.is_some());
}
