//! The system of "Discrete Shells": conservation, order in time, and beams, against an independent implementation
//! (`benchmarks/discrete-shells`). Its figures are in centimetres, grams and seconds; here all is SI.

use koiter::Vec3;
use koiter::integrate::StepError;
use koiter::mesh::VertexId;
use koiter::mesh::generate::{GridDiagonals, grid};
use koiter::scene::Simulation;
use koiter::scene::model::*;

/// Stiffnesses of a sheet, k_L [N], k_A [N/m], k_B [J].
#[derive(Clone, Copy)]
struct Springs {
    edges: f64,
    areas: f64,
    hinges: f64,
}

/// A sheet of 0.1 kg/m² from x = 0, centred in y, folded along its length by 90° if it is a V, each flange 45° down.
fn sheet(size: [f64; 2], cells: [usize; 2], is_vee: bool, springs: Springs) -> Model {
    let mut surface = grid(
        size[0],
        size[1],
        cells[0],
        cells[1],
        GridDiagonals::Checkerboard,
    )
    .unwrap();
    for x in &mut surface.positions {
        x.x += 0.5 * size[0];
        if is_vee {
            let root = 0.5f64.sqrt();
            (x.y, x.z) = (root * x.y, -root * x.y.abs());
        }
    }
    let shell = Shell {
        name: "sheet".into(),
        velocities: vec![Vec3::zeros(); surface.positions.len()],
        rest_positions: surface.positions.clone(),
        surface,
        rest_curved: true,
        thickness: 1e-3,
        density: 100.0,
        // Of no consequence: all stiffnesses are given.
        youngs_modulus: 1e6,
        poissons_ratio: 0.4,
        composition: Composition {
            membrane: MembraneModel::DiscreteShells,
            springs: DiscreteStiffness {
                edges: Some(springs.edges),
                areas: Some(springs.areas),
            },
            hinges: HingeSprings {
                stiffness: Some(springs.hinges),
                ..Default::default()
            },
            ..Composition::default()
        },
        bending: BendingModel::DsTheta,
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
            // Far below the errors that are measured; in shorter steps line searches feel the round-off of energies.
            velocity_tolerance: 1e-11,
            ..Default::default()
        },
        integrator: IntegratorKind::Newmark,
        ..Model::default()
    }
}

/// A free V, turning and bending.
fn plate(springs: Springs, beta: f64) -> Model {
    let mut model = sheet([0.05, 0.02], [10, 4], true, springs);
    model.solver.newmark.beta = beta;
    let shell = &mut model.shells[0];
    for (x, v) in shell.surface.positions.iter().zip(&mut shell.velocities) {
        *v = Vec3::new(6.0, -4.0, 9.0).cross(x) + Vec3::new(0.02, 0.03, -0.01);
        v.z += 0.1 * (60.0 * x.x).sin();
    }
    model
}

const STIFF: Springs = Springs {
    edges: 0.03,
    areas: 3.0,
    hinges: 2e-5,
};

const SOFT: Springs = Springs {
    edges: 3e-3,
    areas: 0.3,
    hinges: 2e-6,
};

/// Largest relative drifts of the momenta, and of the energy, in `seconds`.
fn drifts(beta: f64, dt: f64, seconds: f64) -> [f64; 4] {
    let mut model = plate(STIFF, beta);
    if dt < 5e-4 {
        model.solver.velocity_tolerance = 1e-9;
    }
    let mut simulation = Simulation::new(model).unwrap();
    let start = simulation.total_energy();
    let mut before = None;
    let mut largest = [0.0f64; 4];
    for _ in 0..(seconds / dt).round() as usize {
        let report = simulation.step(dt).unwrap();
        assert!(
            report.converged && report.parts == 1,
            "{:?}",
            report.diagnosis
        );
        let [linear, modified] = simulation.momenta(beta * dt * dt);
        let now = [linear, simulation.momenta(0.0)[1], modified];
        // Accelerations are those of the equation of motion from the first step on.
        let first = *before.get_or_insert(now);
        for k in 0..3 {
            largest[k] = largest[k].max((now[k] - first[k]).norm() / first[k].norm());
        }
        largest[3] = largest[3].max((simulation.total_energy() / start - 1.0).abs());
    }
    largest
}

#[test]
fn explicit_newmark_conserves_both_momenta_and_energy_up_to_the_square_of_the_step() {
    let runs = [8e-5, 4e-5, 2e-5].map(|dt| drifts(0.0, dt, 0.05));
    for [linear, angular, modified, energy] in runs {
        assert!(
            linear < 1e-10 && angular < 1e-10 && modified < 1e-10,
            "{runs:?}"
        );
        assert!(energy < 1e-3, "{runs:?}");
    }
    for pair in runs.windows(2) {
        let ratio = pair[0][3] / pair[1][3];
        assert!((ratio - 4.0).abs() < 0.3, "{runs:?}");
    }
}

#[test]
fn implicit_newmark_conserves_the_modified_angular_momentum() {
    // Steps that are cut for want of accuracy would change it: see the line search of Newton's method.
    for dt in [1e-3, 5e-4] {
        let [linear, angular, modified, _] = drifts(0.25, dt, 0.5);
        assert!(linear < 1e-10 && modified < 1e-10, "{linear} {modified}");
        assert!(angular > 1e-8, "{angular}");
    }
    // What is called angular momentum is kept up to the square of the step, as is energy.
    let runs = [4e-4, 2e-4, 1e-4].map(|dt| drifts(0.25, dt, 0.06));
    for pair in runs.windows(2) {
        for k in [1, 3] {
            let ratio = pair[0][k] / pair[1][k];
            assert!((ratio - 4.0).abs() < 0.3, "{k}: {runs:?}");
        }
    }
}

#[test]
fn both_are_of_second_order() {
    for (beta, largest) in [(0.0, 8e-5), (0.25, 1e-4)] {
        let run = |dt: f64| {
            let mut simulation = Simulation::new(plate(SOFT, beta)).unwrap();
            (0..(0.01 / dt).round() as usize).for_each(|_| drop(simulation.step(dt).unwrap()));
            simulation.shell_positions(0)
        };
        let runs = [1.0, 0.5, 0.25, 0.125].map(|share| run(share * largest));
        let difference = |pair: &[Vec<Vec3>]| {
            let distances = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).norm());
            distances.fold(0.0, f64::max)
        };
        let errors: Vec<f64> = runs.windows(2).map(difference).collect();
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((order - 2.0).abs() < 0.1, "{beta}: {errors:?}");
        }
    }
}

#[test]
fn explicit_steps_end_where_the_fastest_vibration_says() {
    // 2/ω_max = 1.47e-4 s by an independent eigenvalue; steps are checked against 95 % of it.
    let mut simulation = Simulation::new(plate(STIFF, 0.0)).unwrap();
    assert!(simulation.step(1.35e-4).is_ok());
    let mut simulation = Simulation::new(plate(STIFF, 0.0)).unwrap();
    assert!(simulation.step(1.47e-4).is_err());
}

/// A beam of 10 × 3 cm with its first two columns held, under gravity.
fn beam(is_vee: bool, springs: Springs) -> Model {
    let mut model = sheet([0.1, 0.03], [20, 6], is_vee, springs);
    let positions = &model.shells[0].surface.positions;
    let held = (0..positions.len()).filter(|&v| positions[v].x < 0.0051);
    model.constraints = vec![Constraint {
        shell: 0,
        vertices: held.map(|v| VertexId(v as u32)).collect(),
        axes: [true; 3],
        motion: Motion::default(),
        clamp_directors: false,
        from: 0.0,
        until: f64::INFINITY,
    }];
    model.gravity = Vec3::new(0.0, 0.0, -9.81);
    model.solver.velocity_tolerance = 1e-7;
    model
}

const BEAM: Springs = Springs {
    edges: 1.0,
    areas: 100.0,
    hinges: 1e-3,
};

#[test]
fn beams_sink_as_deep_as_in_the_reference() {
    // k_B = 10 000 erg: the tip of the flat beam, the ridge of the V.
    for (is_vee, lowest) in [(false, -0.4450e-2), (true, -0.2020e-2)] {
        let mut simulation = Simulation::new(beam(is_vee, BEAM)).unwrap();
        let start = simulation.total_energy();
        let positions = simulation.shell_positions(0);
        let mut tip = (0..positions.len())
            .filter(|&v| positions[v].x > 0.0999 && positions[v].y.abs() < 1e-9);
        let tip = tip.next_back().unwrap();
        let (mut deepest, mut kinetic, mut error) = (0.0f64, 0.0f64, 0.0f64);
        for _ in 0..300 {
            simulation.step(1e-3).unwrap();
            deepest = deepest.min(simulation.shell_positions(0)[tip].z - positions[tip].z);
            kinetic = kinetic.max(kinetic_energy(&simulation));
            error = error.max((simulation.total_energy() - start).abs());
        }
        assert!(
            (deepest / lowest - 1.0).abs() < 0.02,
            "{is_vee}: {deepest} for {lowest}"
        );
        assert!(error < 2e-3 * kinetic, "{is_vee}: {error} of {kinetic}");
    }
}

/// A flat beam with a membrane ten times as stiff, in steps of 2 ms: the largest gain of energy over the largest kinetic energy
/// in 0.66 s, and the steps that were taken in parts.
fn overstrained(change: impl Fn(&mut Model)) -> (f64, usize) {
    let springs = Springs {
        edges: 10.0,
        areas: 1000.0,
        hinges: 1e-5,
    };
    let mut model = beam(false, springs);
    change(&mut model);
    let mut simulation = Simulation::new(model).unwrap();
    let start = simulation.total_energy();
    let (mut kinetic, mut gain, mut cut) = (0.0f64, 0.0f64, 0);
    for _ in 0..330 {
        let report = simulation.step(2e-3).unwrap();
        cut += usize::from(report.parts > 1);
        kinetic = kinetic.max(kinetic_energy(&simulation));
        gain = gain.max(simulation.total_energy() - start);
    }
    (gain / kinetic, cut)
}

fn kinetic_energy(simulation: &Simulation) -> f64 {
    let energies = simulation.energies();
    let kinetic = energies.iter().find(|(name, _)| *name == "kinetic");
    kinetic.unwrap().1
}

#[test]
fn a_stiff_membrane_in_long_steps_gains_energy_unless_it_is_watched_or_damped() {
    // In the reference too energy is kept to 1e-3 for some tenths of a second, and then grows by multiples.
    let (free, _) = overstrained(|_| {});
    assert!(free > 0.3, "{free}");
    let (watched, cut) = overstrained(|model| {
        model.solver.newmark.energy_growth = Some(1e-3);
    });
    assert!(watched < 0.02 && cut > 0, "{watched} {cut}");
    let (damped, _) = overstrained(|model| {
        model.shells[0].composition.damping.stiffness = 1e-3;
    });
    assert!(damped < 0.01, "{damped}");
}

#[test]
fn a_watched_step_that_cannot_be_cut_is_an_error() {
    let mut model = plate(STIFF, 0.25);
    // Less than what the method keeps.
    model.solver.newmark.energy_growth = Some(1e-12);
    model.solver.smallest_step = 1.0;
    let mut simulation = Simulation::new(model).unwrap();
    let refused = (0..50).find_map(|_| simulation.step(2e-3).err());
    assert!(matches!(refused, Some(StepError::EnergyGrew { gained, .. }) if gained > 0.0));
}

#[test]
fn the_work_of_what_is_moved_is_no_gain() {
    // The clamp of a beam is driven up and down: it gives and takes energy, and nothing is cut.
    let mut model = beam(false, BEAM);
    let (mut times, mut values) = (Vec::new(), Vec::new());
    for i in 0..80 {
        let time = 1e-3 * f64::from(i);
        times.push(time);
        values.push(Vec3::z() * (5e-3 * (60.0 * time).sin()));
    }
    model.constraints[0].motion.translation = Some(Schedule { times, values });
    model.solver.newmark.energy_growth = Some(0.02);
    let mut simulation = Simulation::new(model).unwrap();
    let start = simulation.total_energy();
    let mut given = 0.0f64;
    for _ in 0..70 {
        let report = simulation.step(1e-3).unwrap();
        assert_eq!(report.parts, 1, "{:?}", report.cut);
        given = given.max((simulation.total_energy() - start).abs());
    }
    assert!(given > 1e-5, "{given}");
}
