//! A hat that falls on a floor: impact, compression, rebound; Newmark's method with a barrier that is soft for its steps.

use koiter::Vec3;
use koiter::mesh::generate::{HatSize, hat};
use koiter::scene::Simulation;
use koiter::scene::model::*;

/// Speed at the impact [m/s], that of a fall by 30 cm.
const SPEED: f64 = 2.4;
/// Range of the barrier [m].
const D_HAT: f64 = 2e-3;

/// A coarse hat of 33 g just above the floor, with k_B [J] and k_D [J·s].
fn falling(stiffness: f64, damping: f64) -> Simulation {
    let size = HatSize {
        radius: 0.09,
        height: 0.11,
        brim: 0.06,
        slope: 0.1,
    };
    let mut surface = hat(size, 12, 6).unwrap();
    surface
        .positions
        .iter_mut()
        .for_each(|x| x.z += 1.1 * D_HAT);
    let shell = Shell {
        name: "hat".into(),
        velocities: vec![Vec3::new(0.0, 0.0, -SPEED); surface.positions.len()],
        rest_positions: surface.positions.clone(),
        surface,
        rest_curved: true,
        thickness: 1e-3,
        density: 300.0,
        // Of no consequence: all stiffnesses are given.
        youngs_modulus: 1e7,
        poissons_ratio: 0.4,
        composition: Composition {
            membrane: MembraneModel::DiscreteShells,
            springs: DiscreteStiffness {
                edges: Some(0.3),
                areas: Some(30.0),
            },
            hinges: HingeSprings {
                stiffness: Some(stiffness),
                ..Default::default()
            },
            damping: DampingOptions {
                hinges: damping,
                ..Default::default()
            },
            ..Composition::default()
        },
        bending: BendingModel::DsTheta,
        friction: 0.0,
        contact_offset: 0.0,
    };
    let floor = Obstacle {
        name: "floor".into(),
        shape: ObstacleShape::Plane {
            point: Vec3::zeros(),
            normal: Vec3::z(),
        },
        friction: 0.0,
        deformation: None,
        motion: Motion::default(),
    };
    let model = Model {
        shells: vec![shell],
        obstacles: vec![floor],
        gravity: Vec3::new(0.0, 0.0, -9.81),
        contact: ContactOptions {
            d_hat: Some(D_HAT),
            // As much by area as the energy at the impact: vertices stop in the middle of the barrier, which is not adapted.
            kappa: Some(1.0),
            ..Default::default()
        },
        solver: SolverOptions {
            velocity_tolerance: 1e-6,
            ..Default::default()
        },
        integrator: IntegratorKind::Newmark,
        ..Model::default()
    };
    Simulation::new(model).unwrap()
}

/// What happens in 30 ms.
struct Fall {
    /// Changes of energy over that of the impact, the largest and the last.
    largest: f64,
    last: f64,
    /// Least height of the top above the floor [m].
    top: f64,
    /// When the mean height is least [s], and how fast it rises at the end [m/s].
    turned: f64,
    rises: f64,
}

fn fall(mut simulation: Simulation, dt: f64) -> Fall {
    let total = |simulation: &Simulation| -> f64 {
        simulation.energies().iter().map(|(_, energy)| energy).sum()
    };
    let mean = |values: &[Vec3]| values.iter().map(|x| x.z).sum::<f64>() / values.len() as f64;
    let start = total(&simulation);
    let mass: f64 = simulation.masses().iter().step_by(3).sum();
    let impact = 0.5 * mass * SPEED * SPEED;
    let mut fall = Fall {
        largest: 0.0,
        last: 0.0,
        top: f64::INFINITY,
        turned: 0.0,
        rises: 0.0,
    };
    let (mut lowest, mut touched) = (f64::INFINITY, false);
    for _ in 0..(0.03 / dt).round() as usize {
        let report = simulation.step(dt).unwrap();
        assert!(report.converged && report.parts == 1, "{:?}", report.cut);
        touched |= report.contacts > 0;
        fall.last = (total(&simulation) - start) / impact;
        fall.largest = fall.largest.max(fall.last.abs());
        let positions = simulation.shell_positions(0);
        fall.top = fall.top.min(positions[positions.len() - 1].z);
        if mean(&positions) < lowest {
            (lowest, fall.turned) = (mean(&positions), simulation.time());
        }
    }
    assert!(touched);
    fall.rises = mean(&simulation.shell_velocities(0));
    fall
}

#[test]
fn an_undamped_hat_keeps_its_energy_up_to_the_square_of_the_step() {
    let [coarse, fine] = [1e-4, 5e-5].map(|dt| fall(falling(3e-4, 0.0), dt));
    // Measured 4.0: the barrier is twice differentiable where it begins.
    assert!(
        coarse.largest / fine.largest > 3.0,
        "{} {}",
        coarse.largest,
        fine.largest
    );
    assert!(fine.largest < 1e-3, "{}", fine.largest);
    for fall in [&coarse, &fine] {
        // Compression takes some milliseconds, and then it flies up again.
        assert!((4e-3..1.5e-2).contains(&fall.turned), "{}", fall.turned);
        assert!(fall.rises > 0.3, "{}", fall.rises);
    }
}

#[test]
fn the_crown_of_a_softer_hat_sinks_in_further() {
    let [soft, stiff] = [3e-4, 3e-3].map(|stiffness| fall(falling(stiffness, 0.0), 1e-4).top);
    // Measured 0.91; undeformed the top would be at 0.116 m.
    assert!(soft < 0.95 * stiff && stiff < 0.1, "{soft} {stiff}");
}

#[test]
fn a_hat_with_damped_hinges_loses_energy() {
    let damped = fall(falling(3e-4, 3e-8), 1e-4);
    let free = fall(falling(3e-4, 0.0), 1e-4);
    // Measured 1 % of the energy of the impact, in 30 ms.
    let taken = free.last - damped.last;
    assert!(taken > 0.005, "{taken}");
    assert!(damped.rises > 0.0, "{}", damped.rises);
}
