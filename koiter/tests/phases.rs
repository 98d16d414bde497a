//! Phases: a run that is loaded at rest, then released, or changes in other ways on its way.
#![cfg(feature = "serde")]

use koiter::Vec3;
use koiter::scene::{NoFiles, Scene, SceneFile, Simulation, Snapshot};

/// A strip that is bent up at rest, then let go: its lowest frequency is 4 Hz.
const RELEASE: &str = r#"
gravity = [0, 0, 0]
contact.enabled = false

[[phase]]
name = "bend"
integrator = "quasi-static"
end = 0.4
dt = 0.1

[[phase]]
name = "swing"
end = 0.46
dt = 1e-3
constraints = ["root"]

[[shell]]
name = "strip"
mesh.grid = { size = [0.2, 0.05], cells = [8, 2] }
material = { young = 1e9, poisson = 0.3, density = 1000 }
thickness = 1e-3

[[constraint]]
name = "root"
shell = "strip"
select.box = { max = [-0.1, 1, 1] }
clamp = true

[[constraint]]
name = "tip"
shell = "strip"
select.box = { min = [0.1, -1, -1] }
axes = "z"
motion.translate = [[0, [0, 0, 0]], [0.4, [0, 0, 0.02]]]
"#;

fn build(text: &str) -> Scene {
    let file = SceneFile::parse("scene.toml", text, &[]).unwrap();
    Scene::build(&file, &NoFiles).unwrap()
}

struct Run {
    simulation: Simulation,
    scene: Scene,
}

impl Run {
    fn new(text: &str) -> Self {
        let scene = build(text);
        let simulation = Simulation::new(scene.model.clone()).unwrap();
        Self { simulation, scene }
    }

    /// Takes the next step of the scene.
    fn step(&mut self) -> f64 {
        let step = self.simulation.step_count() + 1;
        let report = self.simulation.step(self.scene.timeline.dt(step)).unwrap();
        assert!(report.converged, "step {step}");
        report.energies.iter().map(|(_, energy)| energy).sum()
    }

    fn steps(&mut self, count: usize) {
        for _ in 0..count {
            self.step();
        }
    }

    fn position(&self, vertex: usize) -> Vec3 {
        self.simulation.shell_positions(0)[vertex]
    }
}

/// The middle of the right end.
const TIP: usize = 17;

#[test]
fn what_was_bent_at_rest_swings_when_it_is_released() {
    let mut run = Run::new(RELEASE);
    assert_eq!(run.scene.timeline.num_steps(), 4 + 60);
    run.steps(3);
    let bent = run.step();
    assert!((run.position(TIP).z - 0.02).abs() < 1e-12);
    assert!(run.simulation.reaction(1).z > 0.0);
    let velocities = run.simulation.shell_velocities(0);
    assert!(
        velocities.iter().all(|v| *v == Vec3::zeros()),
        "statics left a velocity"
    );
    let after_one = run.step();
    assert_eq!(run.simulation.reaction(1), Vec3::zeros());
    // Implicit Euler only loses energy, and in one step of a 200th of a period, little.
    assert!(
        after_one <= bent * (1.0 + 1e-9),
        "{after_one} J from {bent} J"
    );
    assert!(after_one > 0.9 * bent, "{after_one} J from {bent} J");
    run.steps(59);
    let time = run.simulation.time();
    assert!((time - 0.46).abs() < 1e-9, "{time}");
    // A quarter of a period later the tip passes the plane.
    let height = run.position(TIP).z;
    assert!(height.abs() < 0.01, "{height}");
    assert!(run.simulation.shell_velocities(0)[TIP].z < -0.2);
}

/// A sheet that flies, then is pushed and pulled, then is held where it is.
const FLIGHT: &str = r#"
[[phase]]
name = "fly"
end = 0.2
dt = 0.1
gravity = [0, 0, 0]
constraints = []
loads = []

[[phase]]
name = "fall"
end = 0.3
dt = 0.03
constraints = []

[[phase]]
name = "hold"
end = 0.5
dt = 0.1

[[shell]]
name = "sheet"
mesh.grid = { size = [0.2, 0.2], cells = [4, 4] }
material = "cotton"
thickness = 1e-3
velocity = [1, 0, 0]

[[constraint]]
shell = "sheet"
select.all = true

[[load]]
name = "wind"
shell = "sheet"
force_per_area = [0, 2, 0]

[[obstacle]]
name = "floor"
plane = { point = [0, 0, -0.062] }
"#;

#[test]
fn each_phase_has_its_steps_gravity_loads_and_constraints() {
    let mut run = Run::new(FLIGHT);
    let density = run.scene.model.shells[0].density * 1e-3;
    let start = run.position(0);
    run.steps(2);
    assert!((run.position(0) - start - Vec3::new(0.2, 0.0, 0.0)).norm() < 1e-9);
    // 0.1 s in equal steps of at most 0.03 s: four of 0.025 s, in which implicit Euler falls g dt² n (n + 1) / 2.
    assert!((run.scene.timeline.dt(3) - 0.025).abs() < 1e-15);
    run.steps(4);
    let fallen = 0.025f64.powi(2) * 10.0;
    let expected = Vec3::new(0.3, 2.0 / density * fallen, -9.81 * fallen);
    let moved = run.position(0) - start;
    assert!((moved - expected).norm() < 1e-6, "{moved} for {expected}");
    run.steps(2);
    assert_eq!(run.position(0) - start, moved);
    assert!((run.simulation.time() - 0.5).abs() < 1e-12);
}

#[test]
fn a_pause_anywhere_in_any_phase_changes_no_bit() {
    for text in [FLIGHT, &RELEASE.replace("end = 0.46", "end = 0.405")] {
        let mut whole = Run::new(text);
        let steps = whole.scene.timeline.num_steps();
        let mut snapshots = vec![whole.simulation.snapshot()];
        for _ in 0..steps {
            whole.step();
            snapshots.push(whole.simulation.snapshot());
        }
        for pause in 0..steps {
            let mut resumed = Run::new(text);
            resumed.simulation.restore(&snapshots[pause]).unwrap();
            let restored = resumed.simulation.snapshot();
            assert_same_bits(&restored, &snapshots[pause], pause);
            for after in &snapshots[pause + 1..] {
                resumed.step();
                assert_same_bits(&resumed.simulation.snapshot(), after, pause);
            }
        }
    }
}

fn assert_same_bits(a: &Snapshot, b: &Snapshot, pause: usize) {
    let bits = |s: &Snapshot| -> Vec<u64> {
        let values = s.state.q.iter().chain(&s.state.velocities);
        values.map(|v| v.to_bits()).collect()
    };
    assert!(bits(a) == bits(b) && a == b, "after a pause at {pause}");
}

#[test]
fn a_free_part_is_one_of_the_static_phase() {
    let warnings = |text: &str| build(text).warnings;
    assert!(warnings(RELEASE).is_empty(), "{:?}", warnings(RELEASE));
    let free = RELEASE.replace("dt = 0.1\n", "dt = 0.1\nconstraints = [\"tip\"]\n");
    let [warning] = &warnings(&free)[..] else {
        panic!("{:?}", warnings(&free));
    };
    assert!(warning.message.contains("x, y"), "{}", warning.message);
}
