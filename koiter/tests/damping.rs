//! Damping takes energy and no momentum, at the rates that linear theory says.

use std::f64::consts::TAU;

use koiter::Vec3;
use koiter::integrate::StepError;
use koiter::mesh::generate::{GridDiagonals, grid};
use koiter::scene::Simulation;
use koiter::scene::model::*;

/// A soft strip, bent, turning and flying.
fn flying(integrator: IntegratorKind, bending: BendingModel, damping: DampingOptions) -> Model {
    let mut surface = grid(0.1, 0.04, 6, 2, GridDiagonals::Checkerboard).unwrap();
    let rest_positions = surface.positions.clone();
    let mut velocities = Vec::new();
    for x in &mut surface.positions {
        x.z = 3e-3 * (40.0 * x.x + 10.0 * x.y).sin();
        velocities.push(Vec3::new(0.7, -0.3, 0.5) + Vec3::new(5.0, 8.0, -6.0).cross(x));
    }
    let shell = Shell {
        name: "strip".into(),
        surface,
        velocities,
        rest_positions,
        rest_curved: false,
        thickness: 0.01,
        density: 500.0,
        youngs_modulus: 1e5,
        poissons_ratio: 0.3,
        composition: Composition {
            damping,
            ..Composition::default()
        },
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
        solver: SolverOptions {
            // Far below the errors and the round-off that are measured.
            velocity_tolerance: 1e-10,
            ..Default::default()
        },
        integrator,
        ..Model::default()
    }
}

const OF_STRAINS: DampingOptions = DampingOptions {
    mass: 0.0,
    stiffness: 2e-3,
    hinges: 1e-5,
};

#[test]
fn damping_of_strains_takes_energy_and_no_momentum() {
    for (integrator, beta, dt) in [
        (IntegratorKind::ImplicitEuler, 0.25, 1e-3),
        (IntegratorKind::Bdf2, 0.25, 1e-3),
        (IntegratorKind::Newmark, 0.25, 1e-3),
        (IntegratorKind::Newmark, 0.0, 5e-5),
    ] {
        let mut model = flying(integrator, BendingModel::DsTheta, OF_STRAINS);
        model.solver.newmark.beta = beta;
        let mut simulation = Simulation::new(model).unwrap();
        let shift = beta * dt * dt;
        let before = simulation.total_energy();
        simulation.step(dt).unwrap();
        let start = simulation.momenta(shift);
        let mut last = simulation.total_energy();
        let mut taken = 0.0;
        for _ in 0..100 {
            let report = simulation.step(dt).unwrap();
            let now = simulation.momenta(shift);
            let drift = [0, 1].map(|k| (now[k] - start[k]).norm() / start[k].norm());
            // Newton's steps end below 1e-10 m/s. Backward differences keep angular momentum up to their order only.
            assert!(drift[0] < 1e-10, "{integrator:?}: {drift:?}");
            let has_angular = integrator == IntegratorKind::Newmark;
            assert!(!has_angular || drift[1] < 1e-10, "{beta}: {drift:?}");
            let damped = report.energies.iter().find(|(name, _)| *name == "damping");
            taken += damped.unwrap().1;
            if integrator == IntegratorKind::ImplicitEuler {
                assert!(simulation.total_energy() <= last, "{integrator:?}");
            }
            last = simulation.total_energy();
        }
        assert!(
            last < before && taken > 0.0,
            "{integrator:?} {beta}: {before} {last} {taken}"
        );
    }
}

#[test]
fn newmark_with_damping_never_has_more_energy_than_it_began_with() {
    for bending in [BendingModel::DsTheta, BendingModel::Bac, BendingModel::Dkt] {
        let model = flying(IntegratorKind::Newmark, bending, OF_STRAINS);
        let mut simulation = Simulation::new(model).unwrap();
        let mut last = simulation.total_energy();
        let mut rises = 0.0f64;
        let start = last;
        for _ in 0..100 {
            simulation.step(2e-4).unwrap();
            rises = rises.max(simulation.total_energy() - last);
            last = simulation.total_energy();
        }
        // Of the undamped method, whose energy is kept up to the square of the step.
        assert!(rises < 1e-6 * start, "{bending:?}: {rises} of {start}");
        assert!(last < 0.999 * start, "{bending:?}: {last} of {start}");
    }
}

#[test]
fn the_rest_of_the_balance_is_what_damping_took() {
    // The forces at the end of a step are those of its middle up to the length of the step: halved, so is the difference.
    let gap = |dt: f64| {
        let model = flying(IntegratorKind::Newmark, BendingModel::DsTheta, OF_STRAINS);
        let mut simulation = Simulation::new(model).unwrap();
        let start = simulation.total_energy();
        let mut taken = 0.0;
        for _ in 0..(0.02 / dt).round() as usize {
            let report = simulation.step(dt).unwrap();
            taken += report
                .energies
                .iter()
                .find(|(name, _)| *name == "damping")
                .unwrap()
                .1;
        }
        let lost = start - simulation.total_energy();
        assert!(lost > 0.0);
        (lost - taken).abs() / lost
    };
    let (coarse, fine) = (gap(2e-4), gap(1e-4));
    assert!(fine < 0.7 * coarse && fine < 0.1, "{coarse} {fine}");
}

#[test]
fn drag_takes_momentum_at_its_rate() {
    let rate = 30.0;
    let drag = DampingOptions {
        mass: rate,
        ..Default::default()
    };
    for (integrator, beta, dt) in [
        (IntegratorKind::Bdf2, 0.25, 1e-3),
        (IntegratorKind::Newmark, 0.25, 1e-3),
        (IntegratorKind::Newmark, 0.0, 1e-4),
    ] {
        let mut model = flying(integrator, BendingModel::DsTheta, drag);
        model.solver.newmark.beta = beta;
        let mut simulation = Simulation::new(model).unwrap();
        let start = simulation.momenta(0.0);
        let steps = (0.05f64 / dt).round() as usize;
        (0..steps).for_each(|_| drop(simulation.step(dt).unwrap()));
        let share = (-rate * 0.05f64).exp();
        for (now, start) in simulation.momenta(0.0).iter().zip(start) {
            // Half of rate times the step, of first order in explicit steps and of the rest squared.
            let error = (now - start * share).norm() / (start.norm() * share);
            assert!(error < 0.01, "{integrator:?} {beta}: {error}");
        }
    }
}

#[test]
fn a_rigid_motion_is_not_damped() {
    for bending in [
        BendingModel::DsTheta,
        BendingModel::Dcs,
        BendingModel::Dkt,
        BendingModel::QbCr,
        BendingModel::QbPl,
        BendingModel::QbInt,
    ] {
        let mut model = flying(IntegratorKind::Newmark, bending, OF_STRAINS);
        let shell = &mut model.shells[0];
        shell.surface.positions = shell.rest_positions.clone();
        shell.velocities.fill(Vec3::new(0.3, -0.2, 1.0));
        let mut simulation = Simulation::new(model).unwrap();
        let start = simulation.total_energy();
        (0..50).for_each(|_| drop(simulation.step(1e-3).unwrap()));
        assert!(
            (simulation.total_energy() / start - 1.0).abs() < 1e-12,
            "{bending:?}"
        );
    }
    // A strip that turns is stretched, and steadily: what is lost is the vibration of the beginning, of the fourth order in ω.
    let lost = |speed: f64| {
        let mut model = flying(IntegratorKind::Newmark, BendingModel::DsTheta, OF_STRAINS);
        let shell = &mut model.shells[0];
        shell.surface.positions = shell.rest_positions.clone();
        let turning = shell
            .rest_positions
            .iter()
            .map(|x| Vec3::z().cross(x) * speed);
        shell.velocities = turning.collect();
        let mut simulation = Simulation::new(model).unwrap();
        let start = simulation.total_energy();
        (0..200).for_each(|_| drop(simulation.step(2e-4).unwrap()));
        1.0 - simulation.total_energy() / start
    };
    let [slow, fast] = [2.0, 4.0].map(lost);
    assert!(
        slow < 1e-4 && (fast / slow - 4.0).abs() < 0.5,
        "{slow} {fast}"
    );
}

/// The share of the energy that a free vibration keeps over one period, and its angular frequency, for each damping.
fn kept(bending: BendingModel, damping: DampingOptions) -> [f64; 2] {
    let mut model = flying(IntegratorKind::Newmark, bending, damping);
    let shell = &mut model.shells[0];
    shell.surface.positions = shell.rest_positions.clone();
    shell.velocities.fill(Vec3::zeros());
    let mut simulation = Simulation::new(model.clone()).unwrap();
    let modes = simulation.vibration_modes(7).unwrap();
    let omega = modes[6].omega_squared.sqrt();
    let mut snapshot = simulation.snapshot();
    for (v, shape) in snapshot.state.velocities.iter_mut().zip(&modes[6].shape) {
        *v = 1e-6 * shape;
    }
    let mut simulation = Simulation::new(model).unwrap();
    simulation.restore(&snapshot).unwrap();
    let start = simulation.total_energy();
    (0..200).for_each(|_| drop(simulation.step(TAU / omega / 200.0).unwrap()));
    [simulation.total_energy() / start, omega]
}

#[test]
fn vibrations_decay_as_rayleigh_says() {
    for bending in [
        BendingModel::DsTheta,
        BendingModel::Bac,
        BendingModel::Dkt,
        BendingModel::QbCr,
        BendingModel::QbPl,
        BendingModel::QbInt,
    ] {
        let omega = kept(bending, DampingOptions::default())[1];
        let (mass, stiffness) = (0.02 * omega, 0.01 / omega);
        let only = |mass, stiffness| DampingOptions {
            mass,
            stiffness,
            hinges: 0.0,
        };
        let decay = |damping| -kept(bending, damping)[0].ln() * omega / TAU;
        let plain = decay(DampingOptions::default());
        assert!(plain.abs() < 1e-4 * omega, "{plain}");
        // Energies fall with exp(−a t) and exp(−b ω² t); the damping shifts the phase of the period by its square.
        for (damping, expected) in [
            (only(mass, 0.0), mass),
            (only(0.0, stiffness), stiffness * omega * omega),
        ] {
            let found = decay(damping);
            assert!(
                (found / expected - 1.0).abs() < 0.01,
                "{bending:?}: {found} {expected}"
            );
        }
    }
}

#[test]
fn hinge_damping_of_twice_stiffness_times_a_time_is_damping_by_that_time() {
    // k_D = 2 k_B b, k_B = C/2.
    let time = 5e-4;
    let rigidity = 1e5 * 0.01f64.powi(3) / (12.0 * (1.0 - 0.09));
    let of_hinges = DampingOptions {
        hinges: rigidity * time,
        ..Default::default()
    };
    let of_stiffness = DampingOptions {
        stiffness: time,
        ..Default::default()
    };
    let [hinges, stiffness] =
        [of_hinges, of_stiffness].map(|damping| 1.0 - kept(BendingModel::DsTheta, damping)[0]);
    // The lowest vibration bends and hardly stretches.
    assert!(
        hinges > 1e-3 && (hinges / stiffness - 1.0).abs() < 0.01,
        "{hinges} {stiffness}"
    );
}

/// A strip whose bending and stretching are texts, and what the built-in energies make of it.
#[test]
fn texts_are_damped_as_the_built_in_energies_are() {
    let damping = DampingOptions {
        stiffness: 2e-3,
        ..Default::default()
    };
    let text = |name: &str, on, text: &str| TextEnergy {
        name: name.into(),
        shell: 0,
        on,
        value: TextValue {
            is_dissipation: false,
            is_density: true,
        },
        text: text.into(),
        parameters: Vec::new(),
        vertices: None,
    };
    let mut built_in = flying(IntegratorKind::Newmark, BendingModel::DsTheta, damping);
    let composition = &mut built_in.shells[0].composition;
    composition.membrane = MembraneModel::DiscreteShells;
    composition.springs = DiscreteStiffness {
        edges: Some(30.0),
        areas: Some(500.0),
    };
    composition.hinges.stiffness = Some(4e-3);
    let mut written = flying(IntegratorKind::Newmark, BendingModel::None, damping);
    // A membrane next to nothing, which every shell has.
    written.shells[0].composition.membrane = MembraneModel::DiscreteShells;
    written.shells[0].composition.springs = DiscreteStiffness {
        edges: Some(1e-9),
        areas: Some(1e-9),
    };
    written.energies = vec![
        text(
            "edges",
            ElementKind::Edge,
            "30 * (1 - length / rest_length)^2",
        ),
        text("areas", ElementKind::Face, "500 * (1 - area / rest_area)^2"),
        text("hinges", ElementKind::Hinge, "4e-3 * angle^2 / rest_height"),
    ];
    let [built_in, written] = [built_in, written].map(|model| {
        let mut simulation = Simulation::new(model).unwrap();
        let start = simulation.total_energy();
        let first = simulation.step(2e-4).unwrap();
        assert!(first.converged);
        let momenta = simulation.momenta(0.25 * 2e-4 * 2e-4);
        (0..100).for_each(|_| drop(simulation.step(2e-4).unwrap()));
        let now = simulation.momenta(0.25 * 2e-4 * 2e-4);
        for k in 0..2 {
            assert!((now[k] - momenta[k]).norm() < 1e-9 * momenta[k].norm());
        }
        start - simulation.total_energy()
    });
    // Measures are lengths and not their squares: the same to first order in the rates.
    assert!(
        built_in > 0.0 && (written / built_in - 1.0).abs() < 1e-3,
        "{written} {built_in}"
    );
}

/// The same energy of hinges as a density and by hinge is damped alike.
#[test]
fn the_damping_of_a_text_does_not_depend_on_its_spelling() {
    let lost = |is_density: bool, text: &str| {
        let damping = DampingOptions {
            stiffness: 5e-3,
            ..Default::default()
        };
        let mut model = flying(IntegratorKind::Newmark, BendingModel::None, damping);
        model.energies = vec![TextEnergy {
            name: "hinges".into(),
            shell: 0,
            on: ElementKind::Hinge,
            value: TextValue {
                is_dissipation: false,
                is_density,
            },
            text: text.into(),
            parameters: Vec::new(),
            vertices: None,
        }];
        let mut simulation = Simulation::new(model).unwrap();
        let start = simulation.total_energy();
        (0..50).for_each(|_| drop(simulation.step(2e-4).unwrap()));
        start - simulation.total_energy()
    };
    let density = lost(true, "4e-3 * (angle - rest_angle)^2 / rest_height");
    let energy = lost(
        false,
        "4e-3 * rest_length / rest_height * (angle - rest_angle)^2",
    );
    assert!(
        density > 0.0 && (energy / density - 1.0).abs() < 1e-6,
        "{density} {energy}"
    );
}

/// Points of patches have no mass, and no velocity that a step could go by.
#[test]
fn damping_of_second_order_shells_takes_energy() {
    let only = DampingOptions {
        stiffness: 1e-3,
        ..Default::default()
    };
    let mut simulation =
        Simulation::new(flying(IntegratorKind::Newmark, BendingModel::Ds2nd, only)).unwrap();
    simulation.step(1e-3).unwrap();
    let mut last = simulation.total_energy();
    for _ in 0..4 {
        let report = simulation.step(1e-3).unwrap();
        let damped = report.energies.iter().find(|(name, _)| *name == "damping");
        assert!(damped.unwrap().1 > 0.0, "{damped:?}");
        let now = simulation.total_energy();
        assert!(now < last, "{now} {last}");
        last = now;
    }
}

#[test]
fn damping_shortens_the_stable_explicit_step() {
    let stable = |stiffness: f64| {
        let damping = DampingOptions {
            stiffness,
            ..Default::default()
        };
        let mut model = flying(IntegratorKind::Newmark, BendingModel::DsTheta, damping);
        model.solver.newmark.beta = 0.0;
        let mut dt = 0.01;
        // The estimate is right near the step that is asked for.
        for _ in 0..20 {
            let mut simulation = Simulation::new(model.clone()).unwrap();
            match simulation.step(dt) {
                Err(StepError::Unstable { stable_dt, .. }) => dt = 0.999 * stable_dt,
                Err(error) => panic!("{error}"),
                Ok(_) => {
                    let start = simulation.total_energy();
                    (0..300).for_each(|_| drop(simulation.step(0.97 * dt).unwrap()));
                    assert!(simulation.total_energy() < 1.5 * start);
                    return dt;
                }
            }
        }
        panic!("no stable step");
    };
    // Steps are checked against 95 % of the estimate.
    let free = stable(0.0) / 0.95;
    let time = 0.5 * free;
    // √(b² + 4/ω²) − b, with 2/ω without damping.
    let expected = 0.95 * ((time * time + free * free).sqrt() - time);
    let found = stable(time);
    assert!(
        (found / expected - 1.0).abs() < 0.005,
        "{free} {found} {expected}"
    );
}
