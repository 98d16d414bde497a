//! How integrators converge in time, what they conserve, and where they refuse.

use koiter::Vec3;
use koiter::integrate::{Memory, StepError};
use koiter::mesh::VertexId;
use koiter::mesh::generate::{GridDiagonals, grid};
use koiter::scene::model::*;
use koiter::scene::{BuildError, Simulation};

const LENGTH: f64 = 0.1;

/// A thick, soft strip without gravity: its vibrations are slow enough for steps of a tenth of a millisecond.
fn strip(bending: BendingModel) -> Model {
    let surface = grid(LENGTH, 0.04, 6, 2, GridDiagonals::Checkerboard).unwrap();
    let shell = Shell {
        name: "strip".into(),
        velocities: vec![Vec3::zeros(); surface.positions.len()],
        rest_positions: surface.positions.clone(),
        surface,
        rest_curved: false,
        thickness: 0.01,
        density: 500.0,
        youngs_modulus: 1e5,
        poissons_ratio: 0.3,
        composition: Composition::default(),
        bending,
        friction: 0.0,
        contact_offset: 0.0,
    };
    Model {
        shells: vec![shell],
        contact: ContactOptions {
            enabled: false,
            ..Default::default()
        },
        // Far below the errors and the round-off that are measured.
        solver: SolverOptions {
            velocity_tolerance: 1e-10,
            ..Default::default()
        },
        ..Model::default()
    }
}

/// Held at one end, struck upwards.
fn vibrating(bending: BendingModel, integrator: IntegratorKind) -> Model {
    let mut model = strip(bending);
    let shell = &mut model.shells[0];
    let left = shell
        .surface
        .positions
        .iter()
        .map(|x| x.x)
        .fold(0.0, f64::min);
    for (x, v) in shell.surface.positions.iter().zip(&mut shell.velocities) {
        let along = (x.x - left) / LENGTH;
        *v = Vec3::new(0.0, 0.0, along * along);
    }
    let all = (0..shell.surface.positions.len() as u32).map(VertexId);
    let held = all.filter(|v| shell.surface.positions[v.0 as usize].x < left + 0.02);
    model.constraints = vec![Constraint {
        shell: 0,
        vertices: held.collect(),
        axes: [true; 3],
        motion: Motion::default(),
        clamp_directors: false,
        from: 0.0,
        until: f64::INFINITY,
    }];
    for vertex in &model.constraints[0].vertices {
        model.shells[0].velocities[vertex.0 as usize] = Vec3::zeros();
    }
    model.gravity = Vec3::new(0.0, 0.0, -9.81);
    model.integrator = integrator;
    model
}

/// Bent, turning and flying.
fn flying(integrator: IntegratorKind) -> Model {
    let mut model = strip(BendingModel::DsTheta);
    let shell = &mut model.shells[0];
    for (x, v) in (shell.surface.positions.iter_mut()).zip(&mut shell.velocities) {
        x.z = 3e-3 * (40.0 * x.x + 10.0 * x.y).sin();
        *v = Vec3::new(0.7, -0.3, 0.5) + Vec3::new(5.0, 8.0, -6.0).cross(x);
    }
    model.integrator = integrator;
    model
}

fn explicit(mut model: Model) -> Model {
    model.solver.newmark.beta = 0.0;
    model
}

/// Positions after `seconds` in steps of `dt`.
fn after(model: Model, seconds: f64, dt: f64) -> Vec<Vec3> {
    let mut simulation = Simulation::new(model).unwrap();
    for _ in 0..(seconds / dt).round() as usize {
        let report = simulation.step(dt).unwrap();
        assert!(report.converged, "{:?}", report.diagnosis);
        assert_eq!((report.parts, report.cut), (1, None));
    }
    simulation.shell_positions(0)
}

/// Exponents of the step in the error, from differences of three and more runs whose steps are halved.
fn orders(model: &Model, seconds: f64, largest: f64) -> Vec<f64> {
    let runs: Vec<_> = (0..4)
        .map(|k| after(model.clone(), seconds, largest * 0.5f64.powi(k)))
        .collect();
    let difference = |pair: &[Vec<Vec3>]| {
        let distances = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).norm());
        distances.fold(0.0, f64::max)
    };
    let errors: Vec<f64> = runs.windows(2).map(difference).collect();
    errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect()
}

fn assert_order(model: &Model, seconds: f64, largest: f64, expected: f64) {
    let orders = orders(model, seconds, largest);
    // What is left of the next order at these steps.
    let last = orders.last().unwrap();
    assert!((last - expected).abs() < 0.1, "{orders:?} for {expected}");
}

#[test]
fn implicit_euler_is_of_first_order() {
    for bending in [BendingModel::DsTheta, BendingModel::Bac] {
        let model = vibrating(bending, IntegratorKind::ImplicitEuler);
        assert_order(&model, 0.01, 1e-4, 1.0);
    }
}

#[test]
fn bdf2_is_of_second_order() {
    for bending in [BendingModel::DsTheta, BendingModel::Bac] {
        let model = vibrating(bending, IntegratorKind::Bdf2);
        assert_order(&model, 0.01, 1e-4, 2.0);
    }
}

#[test]
fn newmark_is_of_second_order() {
    for bending in [BendingModel::DsTheta, BendingModel::Bac] {
        let model = vibrating(bending, IntegratorKind::Newmark);
        assert_order(&model, 0.01, 1e-4, 2.0);
        assert_order(&explicit(model), 0.004, 4e-5, 2.0);
    }
}

#[test]
fn damping_keeps_the_order() {
    for bending in [BendingModel::DsTheta, BendingModel::Bac] {
        for (integrator, order) in [
            (IntegratorKind::ImplicitEuler, 1.0),
            (IntegratorKind::Bdf2, 2.0),
            (IntegratorKind::Newmark, 2.0),
        ] {
            let mut model = vibrating(bending, integrator);
            model.shells[0].composition.damping = DampingOptions {
                mass: 20.0,
                stiffness: 1e-3,
                hinges: 1e-6,
            };
            assert_order(&model, 0.01, 1e-4, order);
        }
    }
}

#[test]
fn bdf2_keeps_its_order_with_steps_that_change() {
    let model = vibrating(BendingModel::DsTheta, IntegratorKind::Bdf2);
    let run = |dt: f64| {
        let mut simulation = Simulation::new(model.clone()).unwrap();
        // Halved and doubled as the control of steps does it: 2 + 1 + 1 + 2 + 4 twentieths of a millisecond.
        for _ in 0..5 {
            for share in [2.0, 1.0, 1.0, 2.0, 4.0] {
                for _ in 0..(5e-5 / dt).round() as usize {
                    simulation.step(share * dt).unwrap();
                }
            }
        }
        simulation.shell_positions(0)
    };
    let runs = [2.5e-5, 1.25e-5, 6.25e-6, 3.125e-6].map(run);
    let error = |a: &[Vec3], b: &[Vec3]| {
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).norm())
            .fold(0.0, f64::max)
    };
    let errors = [0, 1, 2].map(|k| error(&runs[k], &runs[k + 1]));
    let order = (errors[1] / errors[2]).log2();
    assert!((order - 2.0).abs() < 0.15, "{errors:?}");
}

/// Mass, position, velocity and acceleration of every vertex.
fn particles(simulation: &Simulation) -> Vec<(f64, [Vec3; 3])> {
    let state = simulation.state();
    let count = simulation.model().shells[0].surface.positions.len();
    let vector = |values: &[f64], v: usize| Vec3::from_column_slice(&values[3 * v..3 * v + 3]);
    let all = |v| [&state.q, &state.velocities, &state.accelerations].map(|x| vector(x, v));
    (0..count)
        .map(|v| (simulation.masses()[3 * v], all(v)))
        .collect()
}

#[test]
fn momenta_are_conserved() {
    for (model, dt, has_angular) in [
        (flying(IntegratorKind::Bdf2), 1e-3, false),
        (flying(IntegratorKind::Newmark), 1e-3, true),
        (explicit(flying(IntegratorKind::Newmark)), 1e-4, true),
    ] {
        let what = (model.integrator, model.solver.newmark.beta);
        let shift = model.solver.newmark.beta * dt * dt;
        let mut simulation = Simulation::new(model).unwrap();
        simulation.step(dt).unwrap();
        let start = simulation.momenta(shift);
        for _ in 0..100 {
            simulation.step(dt).unwrap();
            let now = simulation.momenta(shift);
            let drift = [0, 1].map(|k| (now[k] - start[k]).norm() / start[k].norm());
            // Newton's steps end below 1e-10 m/s.
            assert!(drift[0] < 1e-10, "{what:?}: {drift:?}");
            assert!(!has_angular || drift[1] < 1e-10, "{what:?}: {drift:?}");
        }
    }
}

/// Largest change of the sum of energies in 0.05 s.
fn energy_error(model: Model, dt: f64) -> f64 {
    let mut simulation = Simulation::new(model).unwrap();
    let energy = |s: &Simulation| s.energies().iter().map(|(_, e)| e).sum::<f64>();
    let start = energy(&simulation);
    let mut largest = 0.0f64;
    for _ in 0..(0.05 / dt).round() as usize {
        simulation.step(dt).unwrap();
        largest = largest.max((energy(&simulation) - start).abs());
    }
    largest
}

#[test]
fn the_energy_error_of_newmark_falls_by_four_with_half_the_step() {
    let implicit = flying(IntegratorKind::Newmark);
    for (model, dt) in [(implicit.clone(), 2e-4), (explicit(implicit), 1e-4)] {
        let errors = [dt, 0.5 * dt, 0.25 * dt].map(|dt| energy_error(model.clone(), dt));
        for pair in errors.windows(2) {
            let ratio = pair[0] / pair[1];
            assert!((3.7..4.3).contains(&ratio), "{errors:?}");
        }
    }
}

#[test]
fn newmark_damps_with_a_larger_gamma_and_bdf2_less_than_euler() {
    let lost = |integrator, gamma| {
        let mut model = flying(integrator);
        model.solver.newmark = NewmarkOptions {
            beta: 0.5 * gamma,
            gamma,
            ..Default::default()
        };
        energy_error(model, 1e-3)
    };
    let newmark = lost(IntegratorKind::Newmark, 0.5);
    let damped = lost(IntegratorKind::Newmark, 0.7);
    let euler = lost(IntegratorKind::ImplicitEuler, 0.5);
    let bdf2 = lost(IntegratorKind::Bdf2, 0.5);
    assert!(damped > 2.0 * newmark, "{damped} {newmark}");
    assert!(bdf2 < 0.7 * euler, "{bdf2} {euler}");
}

#[test]
fn explicit_steps_beyond_the_stable_one_are_refused_and_below_it_stay_bounded() {
    for bending in [BendingModel::DsTheta, BendingModel::Bac] {
        let mut model = explicit(flying(IntegratorKind::Newmark));
        model.shells[0].bending = bending;
        let mut simulation = Simulation::new(model.clone()).unwrap();
        let before = simulation.snapshot();
        let Err(StepError::Unstable { stable_dt, dt, .. }) = simulation.step(0.01) else {
            panic!("a step of 0.01 s was taken");
        };
        assert_eq!(dt, 0.01);
        assert_eq!(simulation.snapshot().state.q, before.state.q);
        // A wave crosses an edge of 2 cm in 1.4 ms.
        assert!((1e-5..1.4e-3).contains(&stable_dt), "{stable_dt}");
        assert!(simulation.step(1.001 * stable_dt).is_err());
        let kinetic = |s: &Simulation| {
            let energies = s.energies();
            energies
                .iter()
                .find(|(name, _)| *name == "kinetic")
                .unwrap()
                .1
        };
        let start = kinetic(&simulation);
        for _ in 0..500 {
            // Its shape changes a little, and the stable step with it.
            simulation.step(0.98 * stable_dt).unwrap();
            assert!(kinetic(&simulation) < 1.5 * start);
        }
        assert!(matches!(
            simulation.state().memory,
            Memory::Accelerated { .. }
        ));
    }
}

/// With γ above 1/2 steps must be shorter: dt² ω² < 2/γ.
#[test]
fn the_stable_explicit_step_falls_with_gamma() {
    let stable = |gamma: f64| {
        let mut model = explicit(flying(IntegratorKind::Newmark));
        model.solver.newmark.gamma = gamma;
        let mut simulation = Simulation::new(model).unwrap();
        let Err(StepError::Unstable { stable_dt, .. }) = simulation.step(0.01) else {
            panic!("a step of 0.01 s was taken");
        };
        for _ in 0..300 {
            simulation.step(0.97 * stable_dt).unwrap();
        }
        stable_dt
    };
    let ratio = stable(1.0) / stable(0.5);
    assert!((ratio - 0.5f64.sqrt()).abs() < 1e-9, "{ratio}");
}

/// A shell at rest gains nothing but round-off, and the watch does not mind.
#[test]
fn the_watch_on_energy_does_not_mind_round_off() {
    let mut model = flying(IntegratorKind::Newmark);
    model.shells[0].velocities.fill(Vec3::zeros());
    model.shells[0].surface.positions = model.shells[0].rest_positions.clone();
    model.solver.newmark.energy_growth = Some(1e-3);
    let mut simulation = Simulation::new(model).unwrap();
    for _ in 0..3 {
        assert_eq!(simulation.step(1e-3).unwrap().parts, 1);
    }
}

#[test]
fn explicit_steps_know_no_contact() {
    let mut model = explicit(flying(IntegratorKind::Newmark));
    model.contact.enabled = true;
    let refused = Simulation::new(model).err().unwrap();
    assert!(matches!(refused, BuildError::ExplicitContact));
}

#[test]
fn reactions_hold_the_weight_and_the_inertia() {
    for integrator in [IntegratorKind::Bdf2, IntegratorKind::Newmark] {
        let mut simulation = Simulation::new(vibrating(BendingModel::DsTheta, integrator)).unwrap();
        for _ in 0..20 {
            simulation.step(2e-4).unwrap();
        }
        let forces: Vec3 = (particles(&simulation).iter())
            .map(|(m, [_, _, a])| (a - simulation.model().gravity) * *m)
            .sum();
        let reaction = simulation.reaction(0);
        // Newton's steps end below 1e-10 m/s, far below what stiffness times 1e-14 m can push.
        assert!(
            (reaction - forces).norm() < 1e-6 * forces.norm(),
            "{reaction} {forces}"
        );
    }
}

#[test]
fn an_accelerated_clamp_neither_rings_nor_remembers() {
    // The held end jumps to a speed of 1 m/s and stops: velocities there are those of the motion.
    let mut model = vibrating(BendingModel::DsTheta, IntegratorKind::Newmark);
    model.constraints[0].motion.translation = Some(Schedule {
        times: vec![0.0, 1e-3, 2e-3],
        values: vec![Vec3::zeros(), Vec3::z() * 1e-3, Vec3::z() * 1e-3],
    });
    let held = model.constraints[0].vertices[0].0 as usize;
    let mut simulation = Simulation::new(model).unwrap();
    for step in 1..=20 {
        simulation.step(1e-4).unwrap();
        let velocity = simulation.shell_velocities(0)[held].z;
        let expected = if step <= 10 { 1.0 } else { 0.0 };
        assert!((velocity - expected).abs() < 1e-9, "{step}: {velocity}");
    }
}

/// Struck so hard that a step of 20 ms takes more than the few iterations allowed, until it has calmed down.
fn struck(integrator: IntegratorKind) -> Model {
    let mut model = vibrating(BendingModel::Bac, integrator);
    for v in &mut model.shells[0].velocities {
        *v *= 4.0;
    }
    model.solver.velocity_tolerance = 1e-3;
    model.solver.max_iterations = 6;
    // Undamped steps as long as these gain energy.
    model.solver.newmark = NewmarkOptions {
        beta: 0.4,
        gamma: 0.8,
        ..Default::default()
    };
    model
}

#[test]
fn a_dynamic_step_that_fails_is_taken_in_parts_that_grow_again() {
    for integrator in [
        IntegratorKind::ImplicitEuler,
        IntegratorKind::Bdf2,
        IntegratorKind::Newmark,
    ] {
        let mut whole = struck(integrator);
        whole.solver.smallest_step = 1.0;
        let mut simulation = Simulation::new(whole).unwrap();
        let failed = simulation.step(0.02).unwrap();
        assert!(!failed.converged && failed.parts == 1 && failed.cut.is_none());
        let mut simulation = Simulation::new(struck(integrator)).unwrap();
        let mut parts = Vec::new();
        for step in 1..=60 {
            let before = simulation.snapshot();
            let report = simulation.step(0.02).unwrap();
            assert!(report.converged, "{integrator:?} {:?}", report.diagnosis);
            let time = 0.02 * f64::from(step);
            assert_eq!((report.step, report.dt), (step as usize, 0.02));
            assert!((report.time - time).abs() < 1e-12 && report.time == simulation.time());
            if report.parts > 1 && parts.len() < 5 {
                if let (1, reason) = (step, report.cut.as_deref().unwrap_or_default()) {
                    assert!(reason.contains("Newton's method stopped"), "{reason}");
                }
                let mut resumed = Simulation::new(struck(integrator)).unwrap();
                resumed.restore(&before).unwrap();
                resumed.step(0.02).unwrap();
                assert!(resumed.snapshot() == simulation.snapshot());
            }
            parts.push(report.parts);
        }
        assert!(
            parts[0] > 1 && parts.contains(&1),
            "{integrator:?}: {parts:?}"
        );
    }
}

#[test]
fn explicit_steps_are_resumed_to_the_same_bits() {
    let model = || explicit(flying(IntegratorKind::Newmark));
    let mut whole = Simulation::new(model()).unwrap();
    // Past the second estimate of the stable step.
    for step in 0..120 {
        let before = whole.snapshot();
        whole.step(1e-4).unwrap();
        let mut resumed = Simulation::new(model()).unwrap();
        resumed.restore(&before).unwrap();
        resumed.step(1e-4).unwrap();
        assert!(resumed.snapshot() == whole.snapshot(), "step {step}");
    }
}
