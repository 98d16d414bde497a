//! Obstacles that deform and turn while shells lie on them.
#![cfg(feature = "serde")]

use koiter::Vec3;
use koiter::mesh::generate::icosphere;
use koiter::mesh::{Surface, SurfaceOptions};
use koiter::scene::model::ObstacleShape;
use koiter::scene::{
    MeshSource, NoFiles, PointCache, Scene, SceneError, SceneFile, Simulation, UnreadableMesh,
};

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

/// The ball of [`GROWING`] as another program would write it: every 0.2 s, in millimetres.
struct GrowingBall {
    with_times: bool,
}

impl MeshSource for GrowingBall {
    fn read(&self, _: &str, options: SurfaceOptions) -> Result<Surface, UnreadableMesh> {
        let ball = icosphere(100.0, 3).unwrap();
        Ok(Surface::new(ball.positions, ball.mesh.faces().to_vec(), options).unwrap())
    }

    fn read_points(&self, file: &str) -> Result<PointCache, UnreadableMesh> {
        let mut radii = vec![100.0, 100.0, 125.0, 150.0];
        if file == "short.pc2" {
            radii.truncate(1);
        }
        let points = radii
            .into_iter()
            .map(|radius| icosphere(radius, 3).unwrap().positions);
        let mut frames: Vec<_> = points.collect();
        if file == "other.pc2" {
            frames[1].pop();
        }
        let times = match file {
            "disordered.npz" => vec![0.0, 0.4, 0.4, 0.6],
            _ => vec![0.0, 0.2, 0.4, 0.6],
        };
        Ok(PointCache {
            times: self.with_times.then_some(times),
            frames,
        })
    }
}

fn animated(animation: &str, with_times: bool) -> Result<Scene, SceneError> {
    let (before, rest) = GROWING.split_once("mesh.icosphere").unwrap();
    let (_, after) = rest.split_once("]\n").unwrap();
    let mesh = "mesh = { file = \"ball.obj\", units = \"mm\" }";
    let text = format!("{before}{mesh}\nanimation = {{ {animation} }}\n{after}");
    let file = SceneFile::parse("scene.toml", &text, &[])?;
    Scene::build(&file, &GrowingBall { with_times })
}

#[test]
fn an_obstacle_follows_a_file_of_positions_as_it_does_meshes() {
    let mut by_meshes = Simulation::new(build(GROWING).model).unwrap();
    let by_rate = animated("file = \"ball.pc2\", fps = 5", false).unwrap();
    let by_times = animated("file = \"ball.npz\"", true).unwrap();
    let mut animated = [by_rate, by_times].map(|scene| Simulation::new(scene.model).unwrap());
    for step in 0..20 {
        by_meshes.step(0.02).unwrap();
        for simulation in &mut animated {
            simulation.step(0.02).unwrap();
            let expected = by_meshes.display_positions();
            for (x, y) in simulation.display_positions().iter().zip(&expected) {
                // Millimetres are rounded otherwise than metres; the cloth amplifies that a little.
                assert!((x - y).norm() < 1e-9, "step {step}");
            }
        }
    }
}

#[test]
fn an_animation_begins_when_it_is_told_to_and_one_frame_is_a_shape() {
    let late = animated("file = \"ball.npz\", start = -0.4", true).unwrap();
    let start = late.model.obstacles[0].deformation.as_ref().unwrap();
    for (time, expected) in start.times.iter().zip([-0.4, -0.2, 0.0, 0.2]) {
        assert!((time - expected).abs() < 1e-15, "{time}");
    }
    // At time 0 the ball has grown by half of what it will, and the cloth would be in it.
    let ObstacleShape::Mesh(ball) = &late.model.obstacles[0].shape else {
        panic!("the obstacle is a mesh");
    };
    let center = Vec3::new(0.0, 0.0, -0.01);
    for x in &ball.positions {
        assert!(((x - center).norm() - 0.125).abs() < 1e-12);
    }
    assert!(Simulation::new(late.model.clone()).is_err());
    let one = animated("file = \"short.pc2\", fps = 24", false).unwrap();
    Simulation::new(one.model).unwrap().step(0.02).unwrap();
}

#[test]
fn animations_that_cannot_be_are_refused_with_their_place() {
    for (animation, with_times, path, said) in [
        ("file = \"ball.pc2\"", false, "", "says no times"),
        (
            "file = \"other.pc2\", fps = 5",
            false,
            ".file",
            "has 641 vertices, the mesh 642",
        ),
        (
            "file = \"disordered.npz\"",
            true,
            ".file",
            "frame 1 at 0.4 s is followed by 0.4 s",
        ),
        (
            "file = \"ball.npz\", fps = 0",
            true,
            ".fps",
            "larger than 0",
        ),
    ] {
        let error = animated(animation, with_times).unwrap_err();
        assert_eq!(
            error.path,
            format!("obstacle.ball.animation{path}"),
            "{error:?}"
        );
        assert!(error.message.contains(said), "{}", error.message);
        assert!(error.location.is_some());
    }
    let twice = GROWING.replace("motion", "animation = { file = \"a.pc2\" }\nmotion");
    let error = SceneFile::parse("scene.toml", &twice, &[]).unwrap_err();
    assert_eq!(error.path, "obstacle.ball.animation");
    assert!(error.message.contains("given twice"), "{}", error.message);
}
