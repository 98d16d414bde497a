//! Paths through limit points: a closed form, and the same equilibria under prescribed displacements.

use koiter::Vec3;
use koiter::mesh::generate::{GridDiagonals, grid};
use koiter::mesh::{Surface, VertexId};
use koiter::scene::Simulation;
use koiter::scene::model::*;

fn shell(surface: Surface, thickness: f64, (young, poisson): (f64, f64)) -> Shell {
    Shell {
        name: "roof".into(),
        velocities: vec![Vec3::zeros(); surface.positions.len()],
        rest_positions: surface.positions.clone(),
        surface,
        rest_curved: true,
        thickness,
        density: 1000.0,
        youngs_modulus: young,
        poissons_ratio: poisson,
        composition: Default::default(),
        bending: BendingModel::Bac,
        friction: 0.0,
        contact_offset: 0.0,
    }
}

fn vertices(surface: &Surface, at: impl Fn(&Vec3) -> bool) -> Vec<VertexId> {
    let all = surface.positions.iter().enumerate();
    all.filter(|(_, x)| at(x))
        .map(|(v, _)| VertexId(v as u32))
        .collect()
}

fn held(vertices: Vec<VertexId>, axes: [bool; 3]) -> Constraint {
    Constraint {
        shell: 0,
        vertices,
        axes,
        motion: Motion::default(),
        clamp_directors: false,
        from: 0.0,
        until: f64::INFINITY,
    }
}

fn proportional() -> Option<Schedule<f64>> {
    Some(Schedule {
        times: vec![0.0, 1.0],
        values: vec![0.0, 1.0],
    })
}

fn model(shell: Shell, constraints: Vec<Constraint>, loaded: Vec<VertexId>, force: Vec3) -> Model {
    Model {
        shells: vec![shell],
        constraints,
        loads: vec![Load {
            name: "push".into(),
            shell: 0,
            kind: LoadKind::Point {
                vertices: loaded,
                force,
            },
            scale: proportional(),
        }],
        contact: ContactOptions {
            enabled: false,
            ..Default::default()
        },
        integrator: IntegratorKind::ArcLength,
        ..Model::default()
    }
}

/// Two plates that lean against each other, hinged at the ridge and at the ground: half the span, height, width [m].
const TRUSS: [f64; 3] = [1.0, 0.2, 0.5];
const TRUSS_YOUNG: f64 = 1e6;
const TRUSS_THICKNESS: f64 = 1e-2;

/// The truss of von Mises as a sheet without bending stiffness, whose ridge moves up and down only.
fn truss() -> Model {
    let [half_span, height, width] = TRUSS;
    let mut surface = grid(2.0 * half_span, width, 2, 1, GridDiagonals::Checkerboard).unwrap();
    for x in &mut surface.positions {
        x.z = height * (1.0 - x.x.abs() / half_span);
    }
    let ridge = vertices(&surface, |x| x.x.abs() < 1e-9);
    let ground = vertices(&surface, |x| x.x.abs() > 1e-9);
    let mut sheet = shell(surface, TRUSS_THICKNESS, (TRUSS_YOUNG, 0.0));
    sheet.bending = BendingModel::None;
    let constraints = vec![
        held(ground, [true; 3]),
        held(ridge.clone(), [true, true, false]),
    ];
    let mut model = model(sheet, constraints, ridge, -Vec3::z());
    // In all P = 2 λ newtons: more than the limit load, 2 E h w H³ / (3 √3 L³) = 14.5 N.
    model.solver.last_load_factor = 10.0;
    model.solver.first_arc_length = Some(0.005);
    model.solver.largest_arc_length = Some(0.02);
    model.solver.displacement_tolerance = 1e-12;
    model
}

/// P(z) = E h w z (H² − z²) / L³: the force that holds the ridge at height z, from the Green strain (z² − H²) / 2L² of both
/// plates.
fn truss_load(z: f64) -> f64 {
    let [half_span, height, width] = TRUSS;
    let length = half_span.hypot(height);
    TRUSS_YOUNG * TRUSS_THICKNESS * width * z * (height * height - z * z) / length.powi(3)
}

#[test]
fn the_truss_of_von_mises_follows_its_closed_form() {
    let mut simulation = Simulation::new(truss()).unwrap();
    let height = TRUSS[1];
    let ridge = simulation.model().constraints[1].vertices[0].0 as usize;
    let (mut lowest, mut highest, mut unstable) = (0.0f64, 0.0f64, 0);
    while !simulation.has_ended() {
        let report = simulation.step(1.0).unwrap();
        let z = simulation.shell_positions(0)[ridge].z;
        let load = 2.0 * report.load_factor.unwrap();
        // Round-off and the tolerance of 1e-12 m.
        let expected = truss_load(z);
        assert!(
            (load - expected).abs() < 1e-8,
            "{load} for {expected} at {z}"
        );
        (lowest, highest) = (lowest.min(load), highest.max(load));
        // Between the limit points the load falls with the height; one direction at least is unstable.
        let is_between = z.abs() < height / 3.0f64.sqrt();
        assert_eq!(report.negative_eigenvalues.unwrap() > 0, is_between, "{z}");
        unstable += usize::from(is_between);
        assert!(report.step < 200, "no end at {load} N, {z} m");
    }
    let limit = truss_load(height / 3.0f64.sqrt());
    assert!(unstable > 5 && highest == 20.0, "{unstable} {highest}");
    // The path passes through the lower limit point, where the load pulls upwards.
    assert!(lowest < -0.95 * limit, "{lowest} {limit}");
}

/// A hinged cylindrical roof, its crown at x = y = 0: radius, length [m], half the angle.
const ROOF: [f64; 3] = [2.54, 0.508, 0.1];

/// The roof of K. Y. Sze, X. H. Liu, S. H. Lo, Finite Elements in Analysis and Design 40 (2004), section 3.7.
fn roof(cells: usize, thickness: f64) -> Model {
    let [radius, length, angle] = ROOF;
    let mut surface = grid(2.0, 1.0, cells, cells, GridDiagonals::Checkerboard).unwrap();
    for x in &mut surface.positions {
        let turn = angle * x.x;
        let (across, up) = (radius * turn.sin(), radius * (turn.cos() - 1.0));
        *x = Vec3::new(across, length * x.y, up);
    }
    let edge = radius * angle.sin();
    let hinged = vertices(&surface, |x| x.x.abs() > edge - 1e-9);
    let crown = vertices(&surface, |x| x.x.abs() < 1e-9 && x.y.abs() < 1e-9);
    let panel = shell(surface, thickness, (3102.75e6, 0.3));
    let constraints = vec![held(hinged, [true; 3])];
    let mut model = model(panel, constraints, crown, ROOF_LOAD * -Vec3::z());
    model.solver.displacement_tolerance = 1e-10;
    model
}

/// The load at a factor of 1 [N].
const ROOF_LOAD: f64 = 3000.0;

/// Heights of the crown and load factors along the path, and how many directions each point falls in.
fn path(model: Model) -> Vec<(f64, f64, usize)> {
    let crown = match &model.loads[0].kind {
        LoadKind::Point { vertices, .. } => vertices[0].0 as usize,
        _ => unreachable!(),
    };
    let mut simulation = Simulation::new(model).unwrap();
    let mut points = Vec::new();
    while !simulation.has_ended() {
        let report = simulation.step(1.0).unwrap();
        let z = simulation.shell_positions(0)[crown].z;
        points.push((
            z,
            report.load_factor.unwrap(),
            report.negative_eigenvalues.unwrap(),
        ));
        assert!(points.len() < 200, "no end");
    }
    points
}

#[test]
fn the_hinged_roof_snaps_through_as_under_a_prescribed_displacement() {
    let roof = roof(6, 12.7e-3);
    let points = path(roof.clone());
    // The same roof whose crown is pushed down to the heights of the path: statics without arc length.
    let mut pushed = roof;
    let load = pushed.loads.remove(0);
    let LoadKind::Point { vertices, .. } = load.kind else {
        unreachable!();
    };
    let times = (0..=points.len()).map(|step| step as f64);
    let heights = points.iter().map(|(z, ..)| Vec3::new(0.0, 0.0, *z));
    let motion = Motion {
        translation: Some(Schedule {
            times: times.collect(),
            values: std::iter::once(Vec3::zeros()).chain(heights).collect(),
        }),
        ..Motion::default()
    };
    pushed.constraints.push(Constraint {
        motion,
        ..held(vertices, [false, false, true])
    });
    pushed.integrator = IntegratorKind::QuasiStatic;
    let mut simulation = Simulation::new(pushed).unwrap();
    for (z, load_factor, falling) in &points {
        let report = simulation.step(1.0).unwrap();
        assert!(report.converged, "{:?}", report.diagnosis);
        let reaction = -simulation.reaction(1).z / ROOF_LOAD;
        // The tolerance of 1e-10 m in both, times a stiffness of up to 1e3 load factors a metre.
        let agrees = (reaction - load_factor).abs() < 1e-7;
        // The held crown takes one direction; where the path falls in a second one, the roof leaves it to one side.
        assert_eq!(agrees, *falling < 2, "{reaction} for {load_factor} at {z}");
    }
}

#[test]
fn the_thin_roof_snaps_back() {
    // On meshes half as fine the path has loops that this one has not.
    let points = path(roof(16, 6.35e-3));
    let turns = |values: &mut dyn Iterator<Item = f64>| {
        let values: Vec<f64> = values.collect();
        let changes = values.windows(2).map(|pair| pair[1] > pair[0]);
        let changes: Vec<bool> = changes.collect();
        changes.windows(2).filter(|pair| pair[0] != pair[1]).count()
    };
    // Both the load and the height of the crown turn twice: neither alone could lead along this path.
    assert_eq!(turns(&mut points.iter().map(|point| point.1)), 2);
    assert_eq!(turns(&mut points.iter().map(|point| point.0)), 2);
    assert!(points.iter().any(|point| point.1 < 0.0));
}

#[test]
fn a_path_that_is_taken_up_again_goes_on_to_the_same_bits() {
    let mut first = Simulation::new(truss()).unwrap();
    for _ in 0..12 {
        first.step(1.0).unwrap();
    }
    let mut second = Simulation::new(truss()).unwrap();
    second.restore(&first.snapshot()).unwrap();
    for _ in 0..5 {
        first.step(1.0).unwrap();
        second.step(1.0).unwrap();
        assert_eq!(first.snapshot(), second.snapshot());
    }
}
