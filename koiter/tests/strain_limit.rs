//! Sheets that must not stretch further than their limit.

use koiter::Vec3;
use koiter::mesh::VertexId;
use koiter::mesh::generate::{GridDiagonals, grid};
use koiter::scene::model::*;
use koiter::scene::{BuildError, Simulation};

const LIMIT: StretchLimit = StretchLimit {
    stretch: 1.1,
    begin: 1.05,
    stiffness: 1e4 * 0.05 * 0.05,
};

/// A soft sheet in the plane y = 0 under its upper edge, which is held.
fn curtain(stretch_limit: Option<StretchLimit>) -> Model {
    let mut surface = grid(0.4, 0.4, 8, 8, GridDiagonals::Checkerboard).unwrap();
    let rest_positions = surface.positions.clone();
    for x in &mut surface.positions {
        *x = Vec3::new(x.x, 0.0, x.y);
    }
    let top = surface.positions.iter().map(|x| x.z).fold(0.0, f64::max);
    let held = (0..surface.positions.len() as u32).map(VertexId);
    let held = held.filter(|v| surface.positions[v.0 as usize].z > top - 1e-9);
    let constraint = Constraint {
        shell: 0,
        vertices: held.collect(),
        axes: [true; 3],
        motion: Motion::default(),
        clamp_directors: false,
        from: 0.0,
        until: f64::INFINITY,
    };
    let shell = Shell {
        name: "curtain".into(),
        velocities: vec![Vec3::zeros(); surface.positions.len()],
        surface,
        rest_positions,
        rest_curved: false,
        thickness: 1e-3,
        density: 500.0,
        // Without a limit its own weight stretches it by half.
        youngs_modulus: 1e4,
        poissons_ratio: 0.3,
        composition: Composition {
            stretch_limit,
            ..Composition::default()
        },
        bending: BendingModel::Bac,
        friction: 0.0,
        contact_offset: 0.0,
    };
    Model {
        shells: vec![shell],
        constraints: vec![constraint],
        gravity: Vec3::new(0.0, 0.0, -9.81 * 3.0),
        contact: ContactOptions {
            enabled: false,
            ..Default::default()
        },
        ..Model::default()
    }
}

/// Largest length over rest length in any face, from the largest Green strain.
fn largest_stretch(simulation: &Simulation) -> f64 {
    let fields = simulation.face_fields();
    let (_, strains) = fields.iter().find(|(name, _)| *name == "strain").unwrap();
    let largest = strains.iter().copied().fold(0.0, f32::max);
    (2.0 * f64::from(largest) + 1.0).sqrt()
}

fn energy(simulation: &Simulation, name: &str) -> f64 {
    let energies = simulation.energies();
    energies
        .iter()
        .filter(|(n, _)| *n == name)
        .map(|(_, e)| e)
        .sum()
}

#[test]
fn a_heavy_curtain_never_reaches_its_limit_which_it_passes_without() {
    let mut limited = Simulation::new(curtain(Some(LIMIT))).unwrap();
    let mut free = Simulation::new(curtain(None)).unwrap();
    let mut most = [0.0f64; 2];
    for _ in 0..15 {
        for (simulation, most) in [&mut limited, &mut free].into_iter().zip(&mut most) {
            let report = simulation.step(0.02).unwrap();
            assert!(report.converged, "{:?}", report.diagnosis);
            *most = most.max(largest_stretch(simulation));
        }
        assert!(largest_stretch(&limited) < LIMIT.stretch);
    }
    // The limit was needed, and used.
    assert!(most[1] > 1.2 && most[0] > 1.07, "{most:?}");
    assert!(energy(&limited, "strain_limit") > 0.0);
    assert_eq!(energy(&free, "strain_limit"), 0.0);
}

#[test]
fn a_limited_curtain_hangs_in_equilibrium() {
    let mut model = curtain(Some(LIMIT));
    model.integrator = IntegratorKind::QuasiStatic;
    let mut simulation = Simulation::new(model).unwrap();
    let report = simulation.step(1.0).unwrap();
    assert!(report.converged, "{:?}", report.diagnosis);
    let weight: f64 = simulation.masses().iter().step_by(3).take(81).sum::<f64>() * 9.81 * 3.0;
    let pull = simulation.reaction(0);
    // The last Newton step was below 1e-7 m, of a barrier of 1e4 Pa times its stiffening.
    assert!((pull.z / weight - 1.0).abs() < 1e-4, "{pull:?} of {weight}");
    assert!((1.05..1.1).contains(&largest_stretch(&simulation)));
}

#[test]
fn a_sheet_that_is_pulled_too_far_stops_at_its_limit_and_says_so() {
    let mut model = curtain(Some(LIMIT));
    model.gravity = Vec3::zeros();
    let bottom = model.shells[0].surface.positions.iter().map(|x| x.z);
    let bottom = bottom.fold(0.0, f64::min);
    let vertices = (0..model.shells[0].surface.positions.len() as u32).map(VertexId);
    let vertices = vertices
        .filter(|v| model.shells[0].surface.positions[v.0 as usize].z < bottom + 1e-9)
        .collect();
    let motion = Motion {
        translation: Some(Schedule {
            times: vec![0.0, 1.0],
            values: vec![Vec3::zeros(), Vec3::new(0.0, 0.0, -0.08)],
        }),
        ..Motion::default()
    };
    model.constraints.push(Constraint {
        vertices,
        motion,
        ..model.constraints[0].clone()
    });
    model.integrator = IntegratorKind::QuasiStatic;
    model.solver.smallest_step = 1.0;
    // Every iteration takes nine tenths of what is left to the limit: more of them end in round-off.
    model.solver.max_iterations = 10;
    let mut simulation = Simulation::new(model).unwrap();
    let near = simulation.step(0.4).unwrap();
    assert!(near.converged, "{:?}", near.diagnosis);
    let beyond = simulation.step(0.4).unwrap();
    assert!(!beyond.converged && largest_stretch(&simulation) < LIMIT.stretch);
    let diagnosis = beyond.diagnosis.unwrap();
    assert!(diagnosis.contains("strain_limit at face"), "{diagnosis}");
}

#[test]
fn a_start_beyond_the_limit_is_refused_with_its_face_and_its_stretch() {
    let mut model = curtain(Some(LIMIT));
    for x in &mut model.shells[0].surface.positions {
        x.z *= 1.2;
    }
    let error = Simulation::new(model).err().unwrap();
    assert!(matches!(error, BuildError::StretchedStart { face: 0, .. }));
    let message = error.to_string();
    assert!(
        message.contains("face 0 starts stretched to 1.2000 times"),
        "{message}"
    );
}
