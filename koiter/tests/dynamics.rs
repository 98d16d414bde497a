//! What dynamics conserves, and what it must not produce.

use koiter::Vec3;
use koiter::mesh::Surface;
use koiter::mesh::generate::{GridDiagonals, grid, icosphere};
use koiter::scene::Simulation;
use koiter::scene::model::*;

const MODELS: [BendingModel; 4] = [
    BendingModel::Bac,
    BendingModel::Dcs,
    BendingModel::Dso,
    BendingModel::DsTheta,
];

/// Cloth-like constants: bends easily, hardly stretches.
fn shell(surface: Surface, bending: BendingModel) -> Shell {
    Shell {
        name: "sheet".into(),
        velocities: vec![Vec3::zeros(); surface.positions.len()],
        rest_positions: surface.positions.clone(),
        surface,
        rest_curved: false,
        thickness: 5e-3,
        density: 500.0,
        youngs_modulus: 1e6,
        poissons_ratio: 0.3,
        composition: Composition::default(),
        bending,
        friction: 0.0,
        contact_offset: 0.0,
    }
}

/// Without gravity, contact and obstacles.
fn free(shell: Shell) -> Model {
    Model {
        shells: vec![shell],
        contact: ContactOptions {
            enabled: false,
            ..Default::default()
        },
        // Far below what the conservation laws are tested to.
        solver: SolverOptions {
            velocity_tolerance: 1e-9,
            ..Default::default()
        },
        ..Model::default()
    }
}

fn sheet(cells: usize) -> Surface {
    grid(1.0, 0.7, cells, cells, GridDiagonals::Checkerboard).unwrap()
}

/// A sheet that was flat at rest, bent into a wave, flying and turning.
fn flying(bending: BendingModel) -> Model {
    let mut shell = shell(sheet(6), bending);
    for (x, v) in shell
        .surface
        .positions
        .iter_mut()
        .zip(&mut shell.velocities)
    {
        x.z = 0.05 * (4.0 * x.x + x.y).sin() + 0.03 * (5.0 * x.y).cos();
        *v = Vec3::new(0.7, -0.3, 0.5) + Vec3::new(1.0, 2.0, -1.5).cross(x);
    }
    free(shell)
}

/// Mass, position and velocity of every vertex.
fn particles(simulation: &Simulation) -> Vec<(f64, Vec3, Vec3)> {
    let masses = simulation.masses().iter().step_by(3);
    let (x, v) = (
        simulation.shell_positions(0),
        simulation.shell_velocities(0),
    );
    masses.zip(x).zip(v).map(|((m, x), v)| (*m, x, v)).collect()
}

fn energy(simulation: &Simulation) -> f64 {
    simulation.energies().iter().map(|(_, e)| e).sum()
}

fn linear_momentum(simulation: &Simulation) -> Vec3 {
    particles(simulation).iter().map(|(m, _, v)| v * *m).sum()
}

fn angular_momentum(simulation: &Simulation) -> Vec3 {
    particles(simulation)
        .iter()
        .map(|(m, x, v)| x.cross(&(v * *m)))
        .sum()
}

#[test]
fn free_flight_conserves_momentum_and_never_gains_energy() {
    for bending in MODELS {
        let mut simulation = Simulation::new(flying(bending)).unwrap();
        let (start, spin) = (linear_momentum(&simulation), angular_momentum(&simulation));
        let mut worst = [0.0f64; 2];
        let mut energies = vec![energy(&simulation)];
        for _ in 0..50 {
            let before = particles(&simulation);
            let report = simulation.step(0.01).unwrap();
            assert!(report.converged, "{bending:?}: {:?}", report.diagnosis);
            worst[0] = worst[0].max((linear_momentum(&simulation) - start).norm() / start.norm());
            // Internal forces at the end of the step have no torque about the end positions, so this holds exactly for
            // implicit Euler, whatever the step.
            let torque: Vec3 = particles(&simulation)
                .iter()
                .zip(&before)
                .map(|((m, x, v), (_, _, w))| x.cross(&((v - w) * *m)))
                .sum();
            worst[1] = worst[1].max(torque.norm() / spin.norm());
            energies.push(energy(&simulation));
        }
        // Newton's step is below 1e-9 m/s; momentum is linear and exact to round-off, torque to the residual.
        assert!(
            worst[0] < 1e-10 && worst[1] < 1e-10,
            "{bending:?}: {worst:?}"
        );
        for pair in energies.windows(2) {
            assert!(pair[1] <= pair[0] * (1.0 + 1e-12), "{bending:?}: {pair:?}");
        }
        assert!(energies[50] < energies[0]);
    }
}

#[test]
fn implicit_euler_loses_angular_momentum_in_first_order() {
    // What conservation of the discrete identity above does not promise; half the step, half the loss.
    let loss = [0.01, 0.005, 0.0025].map(|dt: f64| {
        let mut simulation = Simulation::new(flying(BendingModel::DsTheta)).unwrap();
        let spin = angular_momentum(&simulation).norm();
        for _ in 0..(0.1 / dt).round() as usize {
            simulation.step(dt).unwrap();
        }
        1.0 - angular_momentum(&simulation).norm() / spin
    });
    // First order is a ratio of 2; vibrations that the longer steps damp at once make it a little smaller.
    for pair in loss.windows(2) {
        assert!((1.6..2.6).contains(&(pair[0] / pair[1])), "{loss:?}");
    }
}

#[test]
fn free_fall_is_that_of_implicit_euler_to_round_off() {
    for bending in MODELS {
        let mut model = flying(bending);
        model.gravity = Vec3::new(0.0, 0.0, -9.81);
        let mut simulation = Simulation::new(model).unwrap();
        let center = |s: &Simulation| {
            let particles = particles(s);
            let mass: f64 = particles.iter().map(|(m, _, _)| m).sum();
            particles.iter().map(|(m, x, _)| x * *m).sum::<Vec3>() / mass
        };
        let start = center(&simulation);
        let velocity =
            linear_momentum(&simulation) / particles(&simulation).iter().map(|p| p.0).sum::<f64>();
        let dt = 0.01;
        for n in 1..=50 {
            simulation.step(dt).unwrap();
            let t = f64::from(n) * dt;
            let expected = start + velocity * t - Vec3::z() * (9.81 * t * (t + dt) / 2.0);
            // Round-off of 50 steps of metres.
            assert!(
                (center(&simulation) - expected).norm() < 1e-12,
                "{bending:?} step {n}"
            );
        }
    }
}

fn stays_at_rest(shell: Shell) {
    let (bending, start) = (shell.bending, shell.surface.positions.clone());
    let mut simulation = Simulation::new(free(shell)).unwrap();
    for _ in 0..3 {
        simulation.step(0.01).unwrap();
    }
    let moved = simulation
        .shell_positions(0)
        .iter()
        .zip(&start)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max);
    // Forces of rounded strains are resisted by the stiffness they come from: positions stay within round-off of 1 m.
    assert!(moved < 1e-15, "{bending:?}: {moved:.1e}");
}

#[test]
fn a_flat_sheet_without_load_stays_at_rest() {
    for bending in MODELS {
        stays_at_rest(shell(sheet(8), bending));
    }
}

#[test]
fn a_curved_shell_without_load_stays_at_rest() {
    for bending in MODELS {
        let mut ball = shell(icosphere(0.5, 2).unwrap(), bending);
        ball.rest_curved = true;
        stays_at_rest(ball);
    }
}

#[test]
fn a_turned_and_moved_shell_feels_no_force() {
    for bending in MODELS {
        for (curved, surface) in [(false, sheet(8)), (true, icosphere(0.5, 2).unwrap())] {
            let mut shell = shell(surface, bending);
            shell.rest_curved = curved;
            let turn = nalgebra::Rotation3::from_euler_angles(0.7, -1.9, 2.5);
            for x in &mut shell.surface.positions {
                *x = turn * *x + Vec3::new(3.0, -2.0, 1.0);
            }
            let dt = 0.01;
            let scale = shell.youngs_modulus * shell.thickness * 1.0;
            let mut simulation = Simulation::new(free(shell)).unwrap();
            simulation.step(dt).unwrap();
            let force = particles(&simulation)
                .iter()
                .map(|(m, _, v)| v.norm() * m / dt)
                .fold(0.0, f64::max);
            // Rounded positions of metres strain edges of 0.1 m by 1e-15.
            assert!(force < 1e-12 * scale, "{bending:?}: {force:.1e}");
        }
    }
}

#[test]
fn a_plate_dropped_flat_gains_nothing_from_the_bounce() {
    for bending in [BendingModel::Bac, BendingModel::DsTheta] {
        let mut plate = shell(sheet(6), bending);
        plate.surface.positions.iter_mut().for_each(|x| x.z += 0.05);
        plate.rest_positions = plate.surface.positions.clone();
        let mut model = free(plate);
        model.gravity = Vec3::new(0.0, 0.0, -9.81);
        model.contact = ContactOptions {
            d_hat: Some(2e-3),
            ..Default::default()
        };
        model.obstacles = vec![Obstacle {
            name: "floor".into(),
            shape: ObstacleShape::Plane {
                point: Vec3::zeros(),
                normal: Vec3::z(),
            },
            friction: 0.0,
            deformation: None,
            motion: Motion::default(),
        }];
        let mut simulation = Simulation::new(model).unwrap();
        let (mut energies, mut touched, mut sideways, mut spin) =
            (vec![energy(&simulation)], false, 0.0f64, 0.0f64);
        for _ in 0..150 {
            let report = simulation.step(0.002).unwrap();
            assert!(report.converged, "{:?}", report.diagnosis);
            touched |= report.contacts > 0;
            energies.push(energy(&simulation));
            let momentum = linear_momentum(&simulation);
            sideways = sideways.max(momentum.x.hypot(momentum.y));
            spin = spin.max(angular_momentum(&simulation).z.abs());
        }
        let impact: f64 =
            particles(&simulation).iter().map(|p| p.0).sum::<f64>() * (2.0 * 9.81 * 0.05f64).sqrt();
        assert!(touched);
        // A frictionless plane pushes along its normal only; what is left is the round-off of the solve.
        assert!(
            sideways < 1e-9 * impact && spin < 1e-9 * impact,
            "{sideways:.1e} {spin:.1e} of {impact:.1e}"
        );
        for pair in energies.windows(2) {
            assert!(pair[1] <= pair[0] + 1e-9 * energies[0].abs(), "{pair:?}");
        }
    }
}

/// A sheet that fell on a ball, with friction: all positions after ten steps.
#[cfg(feature = "parallel")]
fn draped(threads: usize) -> Vec<Vec3> {
    let run = || {
        let mut cloth = shell(sheet(12), BendingModel::Bac);
        cloth.surface.positions.iter_mut().for_each(|x| x.z += 0.26);
        cloth.rest_positions = cloth.surface.positions.clone();
        cloth.thickness = 1e-3;
        cloth.friction = 0.3;
        let mut model = free(cloth);
        model.gravity = Vec3::new(0.0, 0.0, -9.81);
        model.contact = ContactOptions {
            d_hat: Some(5e-3),
            ..Default::default()
        };
        model.solver = SolverOptions::default();
        model.obstacles = vec![Obstacle {
            name: "ball".into(),
            shape: ObstacleShape::Mesh(icosphere(0.25, 2).unwrap()),
            friction: 0.3,
            deformation: None,
            motion: Motion::default(),
        }];
        let mut simulation = Simulation::new(model).unwrap();
        let contacts: usize = (0..10)
            .map(|_| simulation.step(0.02).unwrap().contacts)
            .sum();
        assert!(contacts > 0);
        simulation.shell_positions(0)
    };
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap()
        .install(run)
}

#[cfg(feature = "parallel")]
#[test]
fn one_thread_and_two_give_the_same_bits_and_so_does_a_second_run() {
    let [one, two, again] = [1, 2, 2].map(draped);
    assert_eq!(one, two);
    assert_eq!(two, again);
}
