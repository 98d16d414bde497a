use super::*;
use crate::burning::quad_mesh::QuadMesh;
use crate::burning::{BurningOptions, BurningShell, ProjectionOptions, Surroundings};

fn setup(stiffness: f64) -> BurningSetup {
    BurningSetup {
        shell: DoubleLayer::new(QuadMesh::grid([1.0; 2], [4; 2]).unwrap(), 0.1),
        area_density: 0.1,
        temperature: 293.0,
        ambient_temperature: 293.0,
        cooling_rate: 0.0,
        diffusivity: 0.0,
        diffusivity_factors: Vec::new(),
        burning: BurningOptions::default(),
        loss_factors: Vec::new(),
        projection: ProjectionOptions {
            method: ProjectionMethod::MassSpring,
            stiffness,
            ..ProjectionOptions::default()
        },
        self_collision: None,
        damping: 0.0,
    }
}

/// Of springs and motion [J].
fn energy(burning: &BurningShell, stiffness: f64) -> f64 {
    let (shell, state) = (&burning.setup().shell, burning.state());
    let mut energy = 0.0;
    for springs in &shell.springs {
        for (&ends, length) in springs.ends.iter().zip(&springs.initial_lengths) {
            let stretch = vector(ends, &state.positions).norm() - length;
            energy += 0.5 * stiffness * stretch * stretch;
        }
    }
    let masses = shell.masses(burning.setup().area_density);
    let kinetic = masses.iter().zip(&state.velocities);
    energy
        + kinetic
            .map(|(m, v)| 0.5 * m * v.norm_squared())
            .sum::<f64>()
}

#[test]
fn a_stretched_sheet_swings_with_its_energy_and_momentum() {
    let stiffness = 50.0;
    let mut burning = BurningShell::new(setup(stiffness)).unwrap();
    let mut state = burning.state().clone();
    for x in &mut state.positions {
        *x = Vec3::new(1.05 * x.x, x.y, x.z + 0.03 * x.x * x.x);
    }
    burning.restore(&state).unwrap();
    let (before, mut around) = (energy(&burning, stiffness), Surroundings::default());
    let (mut most, mut parts): (f64, usize) = (0.0, 0);
    for step in 0..300 {
        let time = 0.01 * f64::from(step);
        let report = burning
            .step(time, 0.01, &mut |_, _| (), &mut around)
            .unwrap();
        parts = report.parts;
        most = most.max((energy(&burning, stiffness) / before - 1.0).abs());
    }
    assert!(parts > 1, "the step is longer than what is stable");
    // Symplectic Euler swings by ω h / 2 about its energy, here less than a quarter, and does not drift.
    assert!(most > 1e-6 && most < 0.25, "{most}");
    let masses = burning.setup().shell.masses(0.1);
    let momentum: Vec3 = masses
        .iter()
        .zip(&burning.state().velocities)
        .map(|(m, v)| *m * v)
        .sum();
    assert!(momentum.norm() < 1e-12);
}

#[test]
fn a_soft_sheet_hangs_by_the_lengths_of_hookes_law() {
    let mut options = setup(100.0);
    // About critical for swinging, a few times a second.
    options.damping = 8.0;
    let mut burning = BurningShell::new(options).unwrap();
    let top = |x: &Vec3| x.y > 0.499;
    let particles = burning.setup().shell.particles.clone();
    let corners = burning.setup().shell.num_corners();
    let held = (0..corners).filter(|&p| top(&particles[p]));
    let mut around = Surroundings {
        gravity: Vec3::new(0.0, -9.81, 0.0),
        held: held.map(|p| (p as u32, particles[p])).collect(),
        ..Surroundings::default()
    };
    for step in 0..800 {
        let time = 0.01 * f64::from(step);
        burning
            .step(time, 0.01, &mut |_, _| (), &mut around)
            .unwrap();
    }
    // The pull of the held corners is the weight: forces of springs at them, summed.
    let (state, shell) = (burning.state(), &burning.setup().shell);
    let is_held = |p: u32| (p as usize) < corners && top(&particles[p as usize]);
    let mut pull = 0.0;
    for springs in &shell.springs {
        for (&[a, b], length) in springs.ends.iter().zip(&springs.initial_lengths) {
            let along = vector([a, b], &state.positions);
            let force = 100.0 * (1.0 - length / along.norm()) * along.y;
            pull += force * f64::from(i8::from(is_held(a)) - i8::from(is_held(b)));
        }
    }
    let masses = shell.masses(0.1);
    let hanging = (0..masses.len()).filter(|&p| !is_held(p as u32));
    let weight = 9.81 * hanging.map(|p| masses[p]).sum::<f64>();
    assert!((pull / weight - 1.0).abs() < 1e-3, "{pull} {weight}");
}
