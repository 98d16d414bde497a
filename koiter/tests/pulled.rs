//! Hands pull at shells while a simulation goes on.

use koiter::Vec3;
use koiter::scene::{NoFiles, PullError, Scene, SceneFile, Simulation, VertexPull};

/// A cloth, a Bézier shell or both, without weight, damped by implicit Euler.
fn simulation(shell: &str) -> Simulation {
    let text = format!(
        "title = \"Pulled\"\ntime = {{ end = 1.0, dt = 0.02 }}\ngravity = [0, 0, 0]\n{shell}
[[obstacle]]\nname = \"floor\"\nplane = {{ point = [0, 0, -1], normal = [0, 0, 1] }}\n"
    );
    let file = SceneFile::parse("scene.toml", &text, &[]).unwrap();
    let scene = Scene::build(&file, &NoFiles).unwrap();
    Simulation::new(scene.model).unwrap()
}

const CLOTH: &str = "[[shell]]\nname = \"cloth\"\nmaterial = \"cotton\"\nthickness = 1e-3
mesh.grid = { size = [0.4, 0.4], cells = [4, 4] }";
const BEZIER: &str =
    "[[bezier_shell]]\nname = \"patch\"\nmaterial = { young = 1e6, poisson = 0.3, density = 500 }
thickness = 1e-3\nmesh.grid = { size = [0.4, 0.4], cells = [2, 2] }\n[contact]\nenabled = false";

#[test]
fn what_is_pulled_comes_to_the_hand_and_what_is_let_go_does_not() {
    for shell in [CLOTH, BEZIER] {
        let mut pulled = simulation(shell);
        let start = pulled.parts()[0].start_positions[0];
        let target = start + Vec3::new(0.05, -0.02, 0.1);
        pulled
            .set_pulls(&[VertexPull { vertex: 0, target }])
            .unwrap();
        for _ in 0..200 {
            pulled.step(0.02).unwrap();
        }
        // Nothing holds it back: in the end it rests where the hand is.
        let end = pulled.display_positions()[0];
        assert!((end - target).norm() < 1e-3, "{shell}: {end}");
        // The hand that goes away takes nothing along.
        let away = [VertexPull {
            vertex: 0,
            target: target + Vec3::x(),
        }];
        pulled.set_pulls(&away).unwrap();
        pulled.set_pulls(&[]).unwrap();
        pulled.step(0.02).unwrap();
        assert!((pulled.display_positions()[0] - end).norm() < 1e-3);
    }
}

#[test]
fn what_cannot_be_pulled_is_refused() {
    let mut simulation = simulation(CLOTH);
    let refused = |simulation: &mut Simulation, vertex, x| {
        let target = Vec3::new(x, 0.0, 0.0);
        simulation
            .set_pulls(&[VertexPull { vertex, target }])
            .unwrap_err()
    };
    assert_eq!(
        refused(&mut simulation, 999, 0.0),
        PullError::NoSuchVertex(999)
    );
    assert_eq!(
        refused(&mut simulation, 3, f64::NAN),
        PullError::NotFinite(3)
    );
    let part = "floor".to_owned();
    assert_eq!(
        refused(&mut simulation, 25, 0.0),
        PullError::NoShell { vertex: 25, part }
    );
}
