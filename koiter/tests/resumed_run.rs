//! A simulation that is dropped and restored from its snapshot goes on to the same bits.
#![cfg(feature = "serde")]

use koiter::integrate::{Memory, StepReport};
use koiter::scene::{Anchor, NoFiles, Scene, SceneFile, Simulation, Snapshot};

/// All that has a memory: self-contact, friction, a ball that moves, a mesh that turns, a plane, a clamp that is let
/// go and one that takes hold, gravity that changes, directors.
const SCENE: &str = r#"
time = { end = 0.6, dt = 0.02 }
gravity_scale = [[0.0, 1.0], [0.3, 1.5], [0.6, 0.5]]
contact = { d_hat = 4e-3, kappa = 1e-3 }

[[shell]]
name = "cloth"
mesh = { grid = { size = [0.4, 0.4], cells = [12, 12] }, rotate = { axis = [1, 0, 0], degrees = 70 }, translate = [0, 0, 0.3] }
material = { young = 2e5, poisson = 0.3, density = 400 }
thickness = 1e-3
friction = 0.4

[[obstacle]]
name = "floor"
plane = { point = [0, 0, 0.08], normal = [0, 0, 1] }

[[obstacle]]
name = "ball"
sphere = { center = [0, 0.3, 0.2], radius = 0.08 }
motion.translate = [[0.0, [0, 0, 0]], [0.4, [0, -0.25, 0]]]

[[obstacle]]
name = "block"
box = { size = [0.2, 0.06, 0.06] }
translate = [0, -0.25, 0.14]
motion.rotate = { axis = [1, 0, 0], through = [0, -0.25, 0.14], degrees = [[0, 0], [0.6, 90]] }

[[constraint]]
name = "edge"
shell = "cloth"
select.box = { min = [-1, 0.06, -1] }
clamp = true
until = 0.13

[[constraint]]
name = "corner"
shell = "cloth"
select.box = { max = [-0.15, -0.04, 9] }
clamp = true
from = 0.2
until = 0.4
motion.rotate = { axis = [0, 1, 0], degrees = [[0, 0], [0.4, 20]] }
"#;

const STEPS: usize = 24;

fn simulation() -> Simulation {
    simulation_with("bac")
}

fn simulation_with(bending: &str) -> Simulation {
    simulation_set(&[format!("shell.cloth.bending={bending}")])
}

fn simulation_set(overrides: &[String]) -> Simulation {
    let file = SceneFile::parse("scene.toml", SCENE, overrides).unwrap();
    let scene = Scene::build(&file, &NoFiles).unwrap();
    Simulation::new(scene.model).unwrap()
}

/// All that a step tells, apart from the clock.
fn figures(report: &StepReport) -> String {
    let report = StepReport {
        seconds: vec![],
        ..report.clone()
    };
    format!("{report:?}")
}

/// Snapshots before every step and after the last, and the reports of the steps.
fn straight(simulation: &mut Simulation) -> (Vec<Snapshot>, Vec<String>) {
    let mut snapshots = vec![simulation.snapshot()];
    let mut reports = Vec::new();
    for _ in 0..STEPS {
        reports.push(figures(&simulation.step(0.02).unwrap()));
        snapshots.push(simulation.snapshot());
    }
    (snapshots, reports)
}

fn assert_same_bits(a: &Snapshot, b: &Snapshot, what: &str) {
    let bits = |values: &[f64]| -> Vec<u64> { values.iter().map(|v| v.to_bits()).collect() };
    assert!(bits(&a.state.q) == bits(&b.state.q), "positions {what}");
    assert!(a == b, "velocities, forces or the solver's past {what}");
}

#[test]
fn a_restored_simulation_takes_the_same_steps() {
    let (snapshots, reports) = straight(&mut simulation());
    let kappas = snapshots.iter().map(|s| s.kappa.unwrap());
    assert!(kappas.fold(0.0, f64::max) > 1e-3, "the barrier never grew");
    let coupled = |s: &Snapshot| !s.solver.changing_pairs.is_empty();
    assert!(snapshots.iter().any(coupled), "no contact");
    assert!(
        snapshots.iter().any(|s| !s.anchors.is_empty()),
        "nothing took hold"
    );
    // A pause before every step shows all that a step remembers; a longer way on shows what comes out later.
    for k in 0..STEPS {
        let steps = if k == STEPS / 2 { STEPS - k } else { 1 };
        let mut resumed = simulation();
        resumed.restore(&snapshots[k]).unwrap();
        assert_same_bits(&resumed.snapshot(), &snapshots[k], "when restored");
        for step in k..k + steps {
            let what = format!("of step {} after a pause at {k}", step + 1);
            let told = figures(&resumed.step(0.02).unwrap());
            assert_eq!(told, reports[step], "{what}");
            assert_same_bits(&resumed.snapshot(), &snapshots[step + 1], &what);
        }
    }
}

/// Directors of vertices, clamped ones among them, and whatever else models add to the positions.
#[test]
fn other_unknowns_are_restored_to_the_same_bits() {
    for bending in ["dkt"] {
        let mut whole = simulation_with(bending);
        for step in 0..8 {
            let before = whole.snapshot();
            let told = figures(&whole.step(0.02).unwrap());
            let mut resumed = simulation_with(bending);
            resumed.restore(&before).unwrap();
            let what = format!("of {bending} after a pause at {step}");
            assert_eq!(figures(&resumed.step(0.02).unwrap()), told, "{what}");
            assert_same_bits(&resumed.snapshot(), &whole.snapshot(), &what);
        }
    }
}

/// BDF2 and Newmark remember more of the last step, and steps that were cut the share at which they ended.
#[test]
fn other_integrators_and_cut_steps_are_restored_to_the_same_bits() {
    for integrator in ["implicit-euler", "bdf2", "newmark"] {
        let set = ["solver.max_iterations=10", "shell.cloth.bending=ds-theta"].map(String::from);
        let set = [&set[..], &[format!("integrator={integrator}")]].concat();
        let mut whole = simulation_set(&set);
        let mut parts = 0;
        for step in 0..16 {
            let before = whole.snapshot();
            let report = whole.step(0.02).unwrap();
            let mut resumed = simulation_set(&set);
            resumed.restore(&before).unwrap();
            let what = format!("of {integrator} after a pause at {step}");
            let again = resumed.step(0.02).unwrap();
            assert_eq!(figures(&again), figures(&report), "{what}");
            assert_same_bits(&resumed.snapshot(), &whole.snapshot(), &what);
            parts = parts.max(report.parts);
        }
        assert!(parts > 1, "{integrator}: no step was cut");
    }
}

#[cfg(feature = "parallel")]
#[test]
fn one_and_two_threads_leave_the_same_snapshots() {
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| straight(&mut simulation()))
    };
    let ((one, told_by_one), (two, told_by_two)) = (with(1), with(2));
    assert_eq!(told_by_one, told_by_two);
    for (step, (a, b)) in one.iter().zip(&two).enumerate() {
        assert_same_bits(a, b, &format!("after step {step}"));
    }
}

#[test]
fn a_snapshot_of_another_model_is_refused() {
    let mut simulation = simulation();
    simulation.step(0.02).unwrap();
    let good = simulation.snapshot();
    let mut refused = |change: &dyn Fn(&mut Snapshot)| {
        let mut bad = good.clone();
        change(&mut bad);
        let error = simulation.restore(&bad).unwrap_err().to_string();
        assert_eq!(simulation.snapshot(), good, "it was changed by {error}");
        error
    };
    assert!(refused(&|s| s.state.q.push(0.0)).contains("positions for"));
    assert!(refused(&|s| s.state.velocities[3] = f64::NAN).contains("velocities is NaN"));
    assert!(
        refused(&|s| s.state.accelerations[0] = f64::INFINITY).contains("accelerations is inf")
    );
    let kept = Memory::Before {
        dt: 0.02,
        q: vec![],
        velocities: vec![],
    };
    assert!(refused(&|s| s.state.memory = kept.clone()).contains("integrator kept"));
    assert!(refused(&|s| s.state.time = -1.0).contains("time is -1"));
    let anchor = |constraint, len| Anchor {
        constraints: vec![constraint],
        time: 0.0,
        q: vec![0.0; len],
    };
    assert!(refused(&|s| s.anchors.push(anchor(9, s.state.q.len()))).contains("does not exist"));
    assert!(refused(&|s| s.anchors.push(anchor(0, 2))).contains("2 positions for"));
    assert!(refused(&|s| s.kappa = None).contains("stiffness is None"));
    assert!(refused(&|s| s.solver.node_order[0] = s.solver.node_order[1]).contains("order"));
    assert!(refused(&|s| s.solver.changing_pairs.push([4, 4])).contains("nodes 4 and 4"));
    assert!(refused(&|s| s.solver.changing_pairs.push([4, 1 << 30])).contains("couples"));
}
