//! Energies written as texts, in whole simulations.

use koiter::Vec3;
use koiter::integrate::{LinearError, StepError};
use koiter::mesh::generate::{GridDiagonals, grid, icosphere};
use koiter::mesh::{Surface, VertexId};
use koiter::scene::model::*;
use koiter::scene::{BuildError, Simulation};

fn shell(surface: Surface) -> Shell {
    Shell {
        name: "sheet".into(),
        velocities: vec![Vec3::zeros(); surface.positions.len()],
        rest_positions: surface.positions.clone(),
        surface,
        rest_curved: false,
        thickness: 1e-3,
        density: 500.0,
        youngs_modulus: 1e5,
        poissons_ratio: 0.3,
        composition: Composition::default(),
        bending: BendingModel::DsTheta,
        friction: 0.0,
        contact_offset: 0.0,
    }
}

fn sheet() -> Shell {
    shell(grid(0.4, 0.3, 4, 3, GridDiagonals::Checkerboard).unwrap())
}

const ENERGY: TextValue = TextValue {
    is_dissipation: false,
    is_density: false,
};
const DENSITY: TextValue = TextValue {
    is_dissipation: false,
    is_density: true,
};
const DISSIPATION_DENSITY: TextValue = TextValue {
    is_dissipation: true,
    is_density: true,
};

fn energy(name: &str, on: ElementKind, value: TextValue, text: &str) -> TextEnergy {
    TextEnergy {
        name: name.into(),
        shell: 0,
        on,
        value,
        text: text.into(),
        parameters: Vec::new(),
        vertices: None,
    }
}

fn model(shell: Shell, energies: Vec<TextEnergy>, integrator: IntegratorKind) -> Model {
    Model {
        shells: vec![shell],
        energies,
        contact: ContactOptions {
            enabled: false,
            ..Default::default()
        },
        solver: SolverOptions {
            // Far below what is measured.
            velocity_tolerance: 1e-10,
            displacement_tolerance: 1e-10,
            ..Default::default()
        },
        integrator,
        ..Model::default()
    }
}

fn named(simulation: &Simulation, name: &str) -> f64 {
    let energies = simulation.energies();
    energies.iter().find(|(n, _)| n == name).unwrap().1
}

fn pinned(vertices: Vec<u32>) -> Constraint {
    Constraint {
        shell: 0,
        vertices: vertices.into_iter().map(VertexId).collect(),
        axes: [true; 3],
        motion: Motion::default(),
        clamp_directors: false,
        from: 0.0,
        until: f64::INFINITY,
    }
}

#[test]
fn gravity_as_a_text_is_gravity() {
    for integrator in [
        IntegratorKind::ImplicitEuler,
        IntegratorKind::Newmark,
        IntegratorKind::QuasiStatic,
    ] {
        let weight = energy("weight", ElementKind::Vertex, ENERGY, "mass * 9.81 * z");
        let mut written = model(sheet(), vec![weight], integrator);
        let mut built_in = model(sheet(), Vec::new(), integrator);
        built_in.gravity = Vec3::new(0.0, 0.0, -9.81);
        let [written, built_in] = [&mut written, &mut built_in].map(|model| {
            model.constraints.push(pinned(vec![0, 1, 2, 3, 4]));
            let mut simulation = Simulation::new(model.clone()).unwrap();
            for _ in 0..5 {
                assert!(simulation.step(0.01).unwrap().converged);
            }
            simulation
        });
        let difference = (written.state().q.iter().zip(&built_in.state().q))
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        // The tolerance of Newton's method.
        assert!(difference < 1e-9, "{integrator:?}: {difference}");
        let [a, b] = [named(&written, "weight"), named(&built_in, "gravity")];
        assert!((a - b).abs() < 1e-9 * b.abs().max(1e-3), "{a} {b}");
    }
}

/// Wind across a free sheet: per area the force ½ ρ c u|u| of the relative velocity u takes it along.
fn drifting(integrator: IntegratorKind, dt: f64) -> f64 {
    let text = "u = (8 - vx) * nx - vy * ny + (w - vz) * nz; rho * c / 6 * abs(u)^3";
    let mut wind = energy("wind", ElementKind::Face, DISSIPATION_DENSITY, text);
    let constant = |value| Schedule {
        times: vec![0.0],
        values: vec![value],
    };
    wind.parameters = vec![
        ("rho".into(), constant(RHO)),
        ("c".into(), constant(C)),
        ("w".into(), constant(WIND)),
    ];
    let mut model = model(sheet(), vec![wind], integrator);
    if dt < 1e-3 {
        model.solver.newmark.beta = 0.0;
    }
    let mut simulation = Simulation::new(model).unwrap();
    let steps = (0.2 / dt).round() as usize;
    for _ in 0..steps {
        let report = simulation.step(dt).unwrap();
        assert!(report.converged);
        // Wind gives energy until the sheet is as fast.
        let taken = report
            .energies
            .iter()
            .find(|(name, _)| name == "wind")
            .unwrap()
            .1;
        assert!(taken < 0.0, "{taken}");
    }
    let velocities = simulation.shell_velocities(0);
    velocities.iter().map(|v| v.z).sum::<f64>() / velocities.len() as f64
}

const RHO: f64 = 1.2;
const C: f64 = 1.3;
const WIND: f64 = 5.0;

#[test]
fn wind_takes_a_free_sheet_along_as_the_closed_form_says() {
    // σ u̇ = −½ ρ c u²: u = w/(1 + k w t).
    let k = RHO * C / (2.0 * 0.5);
    let exact = WIND - WIND / (1.0 + k * WIND * 0.2);
    let errors =
        [0.02, 0.01, 0.005].map(|dt| (drifting(IntegratorKind::ImplicitEuler, dt) - exact).abs());
    for pair in errors.windows(2) {
        assert!(
            (1.7..2.3).contains(&(pair[0] / pair[1])),
            "first order: {errors:?}"
        );
    }
    // The normal does not turn, so nothing is late: second order with a method of second order.
    let errors = [0.02, 0.01, 0.005].map(|dt| (drifting(IntegratorKind::Bdf2, dt) - exact).abs());
    for pair in errors.windows(2) {
        assert!(
            (3.0..5.0).contains(&(pair[0] / pair[1])),
            "second order: {errors:?}"
        );
    }
    let explicit = drifting(IntegratorKind::Newmark, 1e-4);
    assert!(
        (explicit - exact).abs() < 1e-3 * exact,
        "{explicit} {exact}"
    );
}

#[test]
fn wind_does_not_pull_at_a_sheet_that_lies_along_it() {
    // Along the normal nothing blows: u = 0 whatever w is along x.
    let text = "u = (8 - vx) * nx - vy * ny - vz * nz; 0.2 * abs(u)^3";
    let wind = energy("wind", ElementKind::Face, DISSIPATION_DENSITY, text);
    let model = model(sheet(), vec![wind], IntegratorKind::ImplicitEuler);
    let mut simulation = Simulation::new(model).unwrap();
    for _ in 0..3 {
        simulation.step(0.02).unwrap();
    }
    let fastest = simulation
        .shell_velocities(0)
        .iter()
        .map(Vec3::norm)
        .fold(0.0, f64::max);
    assert!(fastest < 1e-9, "{fastest}");
}

/// A ball blown up by an energy of its volume: Newton's method with a matrix that is dense.
#[test]
fn a_ball_takes_the_volume_that_is_asked_of_it() {
    let mut ball = shell(icosphere(0.1, 2).unwrap());
    ball.bending = BendingModel::None;
    let start = ball.surface.clone();
    let text = "k * (volume / rest_volume - 1.3)^2";
    let mut volume = energy("volume", ElementKind::Shell, ENERGY, text);
    // So stiff that the ball has no choice: a thousand times the energy that the membrane takes.
    volume.parameters = vec![(
        "k".into(),
        Schedule {
            times: vec![0.0],
            values: vec![1e4],
        },
    )];
    let mut model = model(ball, vec![volume], IntegratorKind::QuasiStatic);
    let [north, east, south] = [
        Vec3::new(0.0, 0.0, 1.0),
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(0.0, 0.0, -1.0),
    ]
    .map(|direction| {
        let positions = start.positions.iter().enumerate();
        let furthest = positions.max_by(|a, b| a.1.dot(&direction).total_cmp(&b.1.dot(&direction)));
        furthest.unwrap().0 as u32
    });
    // Six coordinates keep it from moving away.
    for (vertex, axes) in [
        (north, [true, true, false]),
        (south, [true, true, false]),
        (east, [false, true, true]),
    ] {
        model.constraints.push(Constraint {
            axes,
            ..pinned(vec![vertex])
        });
    }
    let mut simulation = Simulation::new(model).unwrap();
    let report = simulation.step(1.0).unwrap();
    assert!(report.converged);
    // With the dense term left out it takes hundreds: the step towards the volume is then off by a factor of 10⁴.
    assert!(
        report.newton_iterations < 40,
        "{}",
        report.newton_iterations
    );
    let positions = simulation.shell_positions(0);
    let volume = |x: &[Vec3]| -> f64 {
        let faces = start.mesh.faces().iter();
        let of_face = |f: &[u32; 3]| {
            let [a, b, c] = f.map(|v| x[v as usize]);
            a.dot(&b.cross(&c)) / 6.0
        };
        faces.map(of_face).sum()
    };
    let ratio = volume(&positions) / volume(&start.positions);
    assert!((ratio - 1.3).abs() < 1e-3, "{ratio}");
}

#[test]
fn parameters_follow_their_schedules() {
    let mut pull = energy(
        "pull",
        ElementKind::Vertex,
        ENERGY,
        "-f * x * smoothstep(0, 1, time)",
    );
    pull.parameters = vec![(
        "f".into(),
        Schedule {
            times: vec![0.0, 1.0],
            values: vec![0.0, 2.0],
        },
    )];
    pull.vertices = Some(vec![VertexId(19)]);
    let mut model = model(sheet(), vec![pull], IntegratorKind::QuasiStatic);
    model.constraints.push(pinned(vec![0, 5, 10, 15]));
    let mut simulation = Simulation::new(model).unwrap();
    let x = |s: &Simulation| s.shell_positions(0)[19].x;
    for time in [0.5, 1.0] {
        assert!(simulation.step(0.5).unwrap().converged);
        let step = time * time * (3.0 - 2.0 * time);
        let expected = -2.0 * time * step * x(&simulation);
        // Round-off.
        assert!((named(&simulation, "pull") - expected).abs() < 1e-13);
    }
    assert!(x(&simulation) > 0.2 + 1e-3);
}

#[test]
fn a_run_with_texts_goes_on_to_the_same_bits() {
    let wind = energy(
        "wind",
        ElementKind::Face,
        DISSIPATION_DENSITY,
        "u = 3 * nx + (4 - vz) * nz; 0.2 * abs(u)^3 * (1 + sin(9 * time))",
    );
    let spring = energy(
        "spring",
        ElementKind::Hinge,
        DENSITY,
        "1e-4 * (angle - 0.3 * time)^2",
    );
    let mut model = model(sheet(), vec![wind, spring], IntegratorKind::Bdf2);
    model.constraints.push(pinned(vec![0, 5, 10, 15]));
    let mut whole = Simulation::new(model.clone()).unwrap();
    for _ in 0..3 {
        whole.step(0.01).unwrap();
    }
    let mut resumed = Simulation::new(model).unwrap();
    resumed.restore(&whole.snapshot()).unwrap();
    for _ in 0..3 {
        whole.step(0.01).unwrap();
        resumed.step(0.01).unwrap();
    }
    assert_eq!(whole.state(), resumed.state());
}

#[test]
fn what_is_not_defined_at_the_start_is_refused_with_its_element() {
    let refused = |energy: TextEnergy| {
        let model = model(sheet(), vec![energy], IntegratorKind::ImplicitEuler);
        Simulation::new(model).err().expect("it is refused")
    };
    let flat = energy("flat", ElementKind::Hinge, ENERGY, "1 / angle");
    let message = refused(flat).to_string();
    assert!(
        message.contains("'flat'") && message.contains("edge "),
        "{message}"
    );
    // A root of zero has a value but no slope.
    let root = energy("root", ElementKind::Face, ENERGY, "sqrt(strain_trace)");
    assert!(matches!(refused(root), BuildError::UndefinedEnergy { .. }));
    let mut none = energy("none", ElementKind::Edge, ENERGY, "length");
    none.vertices = Some(vec![VertexId(0)]);
    assert!(matches!(refused(none), BuildError::NoElements { .. }));
    let open = energy("open", ElementKind::Shell, ENERGY, "volume");
    assert!(matches!(refused(open), BuildError::OpenShell { .. }));
    let wrong = energy("wrong", ElementKind::Shell, ENERGY, "volum");
    assert!(matches!(refused(wrong), BuildError::Expression { .. }));
}

/// A drag that grows with the cube of the speed is no danger at rest, but to what flies; and parameters change before the
/// hundred steps are over for which an estimate is kept.
#[test]
fn explicit_steps_are_refused_when_speed_or_parameters_make_them_unstable() {
    let explicit = |energy: TextEnergy, speed: f64| {
        let mut model = model(sheet(), vec![energy], IntegratorKind::Newmark);
        model.solver.newmark.beta = 0.0;
        model.shells[0].velocities.fill(Vec3::x() * speed);
        let mut simulation = Simulation::new(model).unwrap();
        for step in 0..200 {
            if let Err(error) = simulation.step(1e-4) {
                assert!(matches!(error, StepError::Unstable { .. }), "{error}");
                return step;
            }
            let velocities = simulation.shell_velocities(0);
            let fastest = velocities.iter().map(Vec3::norm).fold(0.0, f64::max);
            assert!(fastest < 1.1 * speed + 0.1, "step {step}");
        }
        200
    };
    // c = 12 k v²: for 0.5 kg/m² and steps of 0.1 ms the limit 2/dt of c by mass is at v = 0.37 m/s.
    let drag = |speed: f64| {
        let text = "6e3 * (vx^2 + vy^2 + vz^2)^2";
        let drag = energy("drag", ElementKind::Vertex, DISSIPATION_DENSITY, text);
        explicit(drag, speed)
    };
    assert_eq!([drag(0.5), drag(0.25)], [0, 200]);
    // Springs that grow stiff within a few steps of the first estimate.
    let mut growing = energy(
        "springs",
        ElementKind::Edge,
        DENSITY,
        "k * (length - rest_length)^2",
    );
    growing.parameters = vec![(
        "k".into(),
        Schedule {
            times: vec![0.0, 2e-3, 4e-3],
            values: vec![1.0, 1.0, 1e10],
        },
    )];
    let stopped = explicit(growing, 0.0);
    assert!((20..40).contains(&stopped), "{stopped}");
}

/// Where damping limits steps, a longer one is looked at anew; and wind that drives is no gain out of nothing.
#[test]
fn phases_of_other_steps_are_judged_anew_and_wind_may_drive() {
    let drag = energy(
        "drag",
        ElementKind::Vertex,
        DISSIPATION_DENSITY,
        "2000 * (vx^2 + vy^2 + vz^2)",
    );
    let mut steps = model(sheet(), vec![drag], IntegratorKind::Newmark);
    steps.solver.newmark.beta = 0.0;
    let mut simulation = Simulation::new(steps).unwrap();
    // 2 c/σ = 8000/s: up to 0.25 ms by damping alone.
    (0..5).for_each(|_| drop(simulation.step(1e-6).unwrap()));
    let refused = simulation.step(3e-4);
    assert!(
        matches!(refused, Err(StepError::Unstable { .. })),
        "{refused:?}"
    );
    let wind = energy(
        "wind",
        ElementKind::Face,
        DISSIPATION_DENSITY,
        "0.2 * abs(nz * (5 - vz))^3",
    );
    let mut watched = model(sheet(), vec![wind], IntegratorKind::Newmark);
    watched.solver.newmark.energy_growth = Some(1e-2);
    let mut simulation = Simulation::new(watched).unwrap();
    for _ in 0..10 {
        assert_eq!(simulation.step(1e-3).unwrap().parts, 1);
    }
}

#[test]
fn powers_know_negative_bases_and_rest() {
    // A name is as good as a number.
    let named = energy(
        "named",
        ElementKind::Vertex,
        ENERGY,
        "n = 2; 5 * (z - 1)^n + 0 * n",
    );
    let plain = energy("plain", ElementKind::Vertex, ENERGY, "5 * (z - 1)^2");
    let cubic = energy(
        "cubic",
        ElementKind::Vertex,
        DISSIPATION_DENSITY,
        "0.1 * (vx^2 + vy^2 + vz^2)^1.5",
    );
    let model = model(
        sheet(),
        vec![named, plain, cubic],
        IntegratorKind::ImplicitEuler,
    );
    let mut simulation = Simulation::new(model).unwrap();
    assert!(simulation.step(0.01).unwrap().converged);
    let [a, b] = [
        self::named(&simulation, "named"),
        self::named(&simulation, "plain"),
    ];
    assert_eq!(a, b);
}

#[test]
fn vibrations_of_energies_of_whole_shells_are_refused_unless_they_are_linear() {
    let modes = |text: &str| {
        let ball = shell(icosphere(0.1, 1).unwrap());
        let whole = energy("whole", ElementKind::Shell, ENERGY, text);
        let model = model(ball, vec![whole], IntegratorKind::ImplicitEuler);
        Simulation::new(model).unwrap().vibration_modes(7)
    };
    for dense in [
        "1e3 * (volume / rest_volume)^2",
        "-1e-3 * (area / rest_area)^2",
    ] {
        assert!(
            matches!(modes(dense), Err(LinearError::Dense { .. })),
            "{dense}"
        );
    }
    assert!(modes("-1e-6 * volume").is_ok());
}
