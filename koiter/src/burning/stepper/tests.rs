use super::*;
use crate::burning::collisions::ColliderShape;
use crate::burning::measures::BurningMeasures;
use crate::burning::quad_mesh::QuadMesh;
use crate::burning::{BurningOptions, DoubleLayer, HeatSource, ProjectionOptions};

fn setup(mesh: QuadMesh, thickness: f64) -> BurningSetup {
    BurningSetup {
        shell: DoubleLayer::new(mesh, thickness),
        area_density: 0.08,
        temperature: 293.0,
        ambient_temperature: 293.0,
        cooling_rate: 2.0,
        diffusivity: 2e-6,
        diffusivity_factors: Vec::new(),
        burning: BurningOptions::default(),
        loss_factors: Vec::new(),
        projection: ProjectionOptions {
            sweeps: 4,
            ..ProjectionOptions::default()
        },
        self_collision: None,
        damping: 0.0,
    }
}

/// A hanging sheet that a hot ball crosses at half height, on a coarse mesh.
fn hot_sphere(n: usize) -> BurningSetup {
    let mut mesh = QuadMesh::grid([0.3, 0.3], [n, n]).unwrap();
    mesh.move_by(|x| Vec3::new(x.x, 0.0, x.y));
    setup(mesh, 0.3 / 80.0)
}

fn held_corners(shell: &DoubleLayer) -> Vec<(u32, Vec3)> {
    let corners = 0..shell.num_corners();
    let is_top = |v: &usize| {
        let x = shell.particles[*v];
        x.z > 0.149 && x.x.abs() > 0.149
    };
    corners
        .filter(is_top)
        .map(|v| (v as u32, shell.particles[v]))
        .collect()
}

fn run(burning: &mut BurningShell, dt: f64, steps: std::ops::Range<usize>) -> Vec<BurningMeasures> {
    let held = held_corners(&burning.setup.shell);
    let mut around = Surroundings::default();
    let mut surround = |time: f64, around: &mut Surroundings| {
        around.gravity = Vec3::new(0.0, 0.0, -9.81);
        around.held.clone_from(&held);
        around.sources.clear();
        around.sources.push(HeatSource {
            ball: Some((Vec3::new(-0.23 + 0.33 * time, 0.0, 0.0), 0.035)),
            temperature: 1000.0,
            rate: 25.0,
            intensity: Vec::new(),
        });
    };
    let mut measures = Vec::new();
    for step in steps {
        burning
            .step(step as f64 * dt, dt, &mut surround, &mut around)
            .unwrap();
        measures.push(burning.measures());
    }
    measures
}

#[test]
fn a_hot_sphere_cuts_a_hanging_sheet_in_two() {
    let end = |exponent: f64| {
        let mut options = hot_sphere(16);
        options.burning.shrinkage_exponent = exponent;
        let mut burning = BurningShell::new(options).unwrap();
        let measures = run(&mut burning, 0.004, 0..350);
        let falls = measures
            .windows(2)
            .all(|pair| pair[1].mean_mass <= pair[0].mean_mass);
        assert!(falls, "mass is only lost");
        measures.into_iter().last().unwrap()
    };
    let (cut, shrunk) = (end(0.0), end(1.0));
    assert_eq!(cut.pieces, 2, "{cut:?}");
    for last in [&cut, &shrunk] {
        assert!((0.6..0.85).contains(&last.kept_area), "{last:?}");
    }
    assert!(
        shrunk.fold_angle > 3.0 * cut.fold_angle,
        "{cut:?} {shrunk:?}"
    );
}

#[test]
fn without_ablation_the_sheet_wrinkles_and_stays_whole() {
    let mut options = hot_sphere(10);
    options.burning.loss_level = 0.4;
    let mut burning = BurningShell::new(options).unwrap();
    let last = run(&mut burning, 0.004, 0..350).pop().unwrap();
    assert!(
        (last.kept_area - 1.0).abs() < 1e-12 && last.pieces == 1,
        "{last:?}"
    );
    assert!(last.present_area < 0.97, "{last:?}");
}

#[test]
fn a_restored_shell_takes_the_same_steps() {
    let mut through = BurningShell::new(hot_sphere(8)).unwrap();
    run(&mut through, 0.01, 0..60);
    let mut paused = BurningShell::new(hot_sphere(8)).unwrap();
    for step in 0..60 {
        run(&mut paused, 0.01, step..step + 1);
        let state = paused.state().clone();
        paused = BurningShell::new(hot_sphere(8)).unwrap();
        paused.restore(&state).unwrap();
    }
    assert_eq!(through.state(), paused.state());
    assert!(through.measures().kept_area < 1.0, "something has burnt");
}

#[test]
fn a_state_of_another_shell_is_refused() {
    let mut burning = BurningShell::new(hot_sphere(4)).unwrap();
    let whole = burning.state().clone();
    let mut short = whole.clone();
    short.temperatures.pop();
    let mut nan = whole.clone();
    nan.velocities[3].y = f64::NAN;
    let mut heavy = whole.clone();
    heavy.mass_ratios[1] = 1.5;
    for state in [short, nan, heavy] {
        assert!(burning.restore(&state).is_err());
        assert_eq!(burning.state(), &whole);
    }
}

#[test]
fn everything_may_burn_and_nothing_may_ignite() {
    let mut options = hot_sphere(6);
    options.temperature = 2000.0;
    options.cooling_rate = 0.0;
    let mut burning = BurningShell::new(options).unwrap();
    let last = run(&mut burning, 0.01, 0..60).pop().unwrap();
    assert_eq!((last.pieces, last.kept_area), (0, 0.0));
    let mut options = hot_sphere(6);
    options.burning.ignition_temperature = 5000.0;
    let mut burning = BurningShell::new(options).unwrap();
    let last = run(&mut burning, 0.01, 0..60).pop().unwrap();
    assert_eq!((last.mean_mass, last.pieces), (1.0, 1));
    assert!(last.highest_temperature > 400.0);
}

#[test]
fn fast_burning_is_taken_in_parts() {
    let mut options = hot_sphere(4);
    options.temperature = 906.0;
    let mut burning = BurningShell::new(options).unwrap();
    let mut around = Surroundings::default();
    // 0.01 · 400 K · 0.01 s = 4 %.
    let report = burning
        .step(0.0, 0.01, &mut |_, _| (), &mut around)
        .unwrap();
    assert_eq!(report.parts, 4);
}

#[test]
fn a_torus_stays_on_a_ball_larger_than_its_hole() {
    let mut mesh = QuadMesh::torus(1.0, 0.35, [24, 12]).unwrap();
    mesh.move_by(|x| x + Vec3::new(0.0, 0.0, 0.7));
    let mut burning = BurningShell::new(BurningSetup {
        damping: 1.0,
        ..setup(mesh, 0.05)
    })
    .unwrap();
    let mut around = Surroundings {
        gravity: Vec3::new(0.0, 0.0, -9.81),
        colliders: vec![Collider {
            shape: ColliderShape::Ball {
                center: Vec3::zeros(),
                radius: 0.78,
            },
            velocity: Vec3::zeros(),
            friction: 0.0,
        }],
        ..Surroundings::default()
    };
    for step in 0..300 {
        burning
            .step(0.004 * f64::from(step), 0.004, &mut |_, _| (), &mut around)
            .unwrap();
    }
    let positions = &burning.state().positions;
    let height = positions.iter().map(|x| x.z).sum::<f64>() / positions.len() as f64;
    let strain = burning.mean_strain(crate::burning::Color::Blue as usize);
    assert!(
        height > 0.0 && strain < 0.01,
        "height {height}, strain {strain}"
    );
    let least = positions[..burning.setup.shell.num_corners()]
        .iter()
        .map(|x| x.norm())
        .fold(f64::MAX, f64::min);
    assert!(least > 0.78 - 1e-9, "{least}");
}

#[test]
fn numbers_out_of_range_are_refused_by_name() {
    let mut options = hot_sphere(2);
    options.burning.smallest_mass = 0.0;
    let error = BurningShell::new(options).err().unwrap();
    assert!(matches!(
        error,
        BurningError::Value {
            what: "smallest_mass",
            ..
        }
    ));
    let mut options = hot_sphere(2);
    options.diffusivity = f64::NAN;
    assert!(BurningShell::new(options).is_err());
}

#[test]
fn numbers_that_no_step_could_bear_are_refused() {
    let sound = || setup(QuadMesh::grid([0.1, 0.1], [2, 2]).unwrap(), 1e-3);
    let refused = |change: &dyn Fn(&mut BurningSetup)| {
        let mut setup = sound();
        change(&mut setup);
        match BurningShell::check(&setup) {
            Err(BurningError::Value { what, .. }) => what,
            other => panic!("{other:?}"),
        }
    };
    assert!(BurningShell::check(&sound()).is_ok());
    assert_eq!(
        refused(&|s| s.burning.smallest_mass = 1e-20),
        "smallest_mass"
    );
    assert_eq!(
        refused(&|s| s.burning.shrinkage_exponent = 3000.0),
        "shrinkage_exponent"
    );
    assert_eq!(refused(&|s| s.area_density = 1e-320), "area_density");
    assert_eq!(refused(&|s| s.projection.compliance = 1e-320), "compliance");
    // As a cube whose centres of faces meet in its middle.
    assert_eq!(
        refused(&|s| s.shell.springs[1].initial_lengths[0] = 0.0),
        "thickness"
    );
    let mut burning = BurningShell::new(sound()).unwrap();
    let step = burning.step(0.0, 0.0, &mut |_, _| (), &mut Surroundings::default());
    assert!(
        matches!(step, Err(BurningError::Value { what: "dt", .. })),
        "{step:?}"
    );
}

#[test]
fn heat_that_comes_at_any_rate_leaves_temperatures_between_those_of_shell_and_source() {
    for rate in [1e-300, 1.0, 1e306] {
        let mut burning = hot_sphere(4);
        burning.burning.heat_of_combustion = 0.0;
        let mut burning = BurningShell::new(burning).unwrap();
        let mut around = Surroundings::default();
        let mut surround = |_: f64, around: &mut Surroundings| {
            around.sources = vec![HeatSource {
                ball: Some((Vec3::zeros(), 1.0)),
                temperature: 400.0,
                rate,
                intensity: Vec::new(),
            }];
        };
        burning.step(0.0, 1e-3, &mut surround, &mut around).unwrap();
        // The system of conduction is solved to a share of 1e-10 or so.
        let is_between = |&t: &f64| (292.9..=400.1).contains(&t);
        assert!(burning.state().temperatures.iter().all(is_between));
    }
}
