//! Small scenes with everything that can touch: nothing intersects, and friction is that of Coulomb.
//!
//! A step checks its result by exact predicates and is an error if anything intersects, so every step taken here is a
//! test of that.

use koiter::Vec3;
use koiter::integrate::StepReport;
use koiter::mesh::VertexId;
use koiter::mesh::generate::{GridDiagonals, box_mesh, grid, solid_cylinder};
use koiter::scene::Simulation;
use koiter::scene::model::*;

/// Gap at which contact begins [m].
const D_HAT: f64 = 2e-3;

fn cloth(width: f64, cells: usize, height: f64) -> Shell {
    let mut surface = grid(width, width, cells, cells, GridDiagonals::Checkerboard).unwrap();
    surface.positions.iter_mut().for_each(|x| x.z += height);
    Shell {
        name: "cloth".into(),
        velocities: vec![Vec3::zeros(); surface.positions.len()],
        rest_positions: surface.positions.clone(),
        surface,
        rest_curved: false,
        thickness: 1e-3,
        density: 500.0,
        youngs_modulus: 1e6,
        poissons_ratio: 0.3,
        composition: Composition::default(),
        bending: BendingModel::Bac,
        friction: 0.4,
        contact_offset: 0.0,
    }
}

fn obstacle(name: &str, shape: ObstacleShape) -> Obstacle {
    Obstacle {
        name: name.into(),
        shape,
        friction: 0.4,
        deformation: None,
        motion: Motion::default(),
    }
}

fn floor(height: f64) -> Obstacle {
    obstacle(
        "floor",
        ObstacleShape::Plane {
            point: Vec3::z() * height,
            normal: Vec3::z(),
        },
    )
}

fn scene(shells: Vec<Shell>, obstacles: Vec<Obstacle>) -> Model {
    Model {
        shells,
        obstacles,
        gravity: Vec3::new(0.0, 0.0, -9.81),
        contact: ContactOptions {
            d_hat: Some(D_HAT),
            ..Default::default()
        },
        ..Model::default()
    }
}

/// Runs and checks every step; returns the simulation and the reports.
fn run(model: Model, steps: usize, dt: f64) -> (Simulation, Vec<StepReport>) {
    let mut simulation = Simulation::new(model).unwrap();
    let reports: Vec<StepReport> = (0..steps)
        .map(|_| {
            let report = simulation.step(dt).unwrap();
            assert!(
                report.converged,
                "step {}: {:?}",
                report.step, report.diagnosis
            );
            assert!(
                report.min_gap > 0.0 && report.intersections == 0,
                "step {}",
                report.step
            );
            report
        })
        .collect();
    assert!(reports.iter().any(|r| r.contacts > 0), "nothing touched");
    (simulation, reports)
}

fn lowest(simulation: &Simulation) -> f64 {
    simulation
        .shell_positions(0)
        .iter()
        .map(|x| x.z)
        .fold(f64::INFINITY, f64::min)
}

fn highest(simulation: &Simulation) -> f64 {
    simulation
        .shell_positions(0)
        .iter()
        .map(|x| x.z)
        .fold(f64::NEG_INFINITY, f64::max)
}

fn moving_up(mut obstacle: Obstacle, by: f64, until: f64) -> Obstacle {
    let values = vec![Vec3::zeros(), Vec3::z() * by];
    obstacle.motion.translation = Some(Schedule {
        times: vec![0.0, until],
        values,
    });
    obstacle
}

#[test]
fn a_cloth_comes_to_rest_on_a_plane() {
    let (simulation, reports) = run(
        scene(vec![cloth(0.5, 10, 0.05)], vec![floor(0.0)]),
        40,
        0.02,
    );
    // It lies within the reach of the barrier, and no longer moves.
    assert!(lowest(&simulation) > 0.0 && highest(&simulation) < D_HAT);
    let kinetic = reports[29]
        .energies
        .iter()
        .find(|e| e.0 == "kinetic")
        .unwrap()
        .1;
    assert!(kinetic < 1e-6);
}

#[test]
fn a_cloth_drapes_over_a_ball() {
    let ball = obstacle(
        "ball",
        ObstacleShape::Sphere {
            center: Vec3::zeros(),
            radius: 0.15,
        },
    );
    let (simulation, reports) = run(
        scene(vec![cloth(0.5, 10, 0.16)], vec![ball, floor(-0.3)]),
        25,
        0.02,
    );
    assert!(
        reports[24].contacts > 0 && lowest(&simulation) < 0.0,
        "{}",
        lowest(&simulation)
    );
}

#[test]
fn a_cloth_drapes_over_a_capsule() {
    let ends = [Vec3::new(-0.1, 0.05, 0.0), Vec3::new(0.12, -0.03, 0.02)];
    let rod = obstacle("rod", ObstacleShape::Capsule { ends, radius: 0.06 });
    let (simulation, _) = run(scene(vec![cloth(0.5, 10, 0.1)], vec![rod]), 25, 0.02);
    assert!(lowest(&simulation) < 0.0);
}

#[test]
fn the_corner_of_a_box_pokes_at_the_middle_of_a_face() {
    let mut body = box_mesh([0.2, 0.2, 0.2]).unwrap();
    // On its corner: the space diagonal upright, the upper corner under the inside of a face.
    let up = nalgebra::Rotation3::rotation_between(&Vec3::new(1.0, 1.0, 1.0), &Vec3::z()).unwrap();
    let corner = 0.1 * 3f64.sqrt();
    body.positions
        .iter_mut()
        .for_each(|x| *x = up * *x + Vec3::new(0.03, 0.012, -corner));
    let spike = obstacle("box", ObstacleShape::Mesh(body));
    let (simulation, _) = run(scene(vec![cloth(0.5, 10, 0.02)], vec![spike]), 25, 0.02);
    assert!(lowest(&simulation) < -0.05);
}

#[test]
fn a_cloth_drapes_over_a_cylinder_of_triangles() {
    let body = solid_cylinder(0.1, 0.2, 16).unwrap();
    let top = body.bounding_box().1.z;
    let body = obstacle("cylinder", ObstacleShape::Mesh(body));
    let (simulation, _) = run(
        scene(vec![cloth(0.5, 10, top + 0.02)], vec![body]),
        25,
        0.02,
    );
    assert!(lowest(&simulation) < top - 0.05);
}

#[test]
fn a_rising_ball_lifts_a_cloth_whose_corners_are_held() {
    let ball = obstacle(
        "ball",
        ObstacleShape::Sphere {
            center: Vec3::new(0.013, 0.02, -0.12),
            radius: 0.1,
        },
    );
    let mut model = scene(vec![cloth(0.5, 10, 0.0)], vec![moving_up(ball, 0.15, 0.3)]);
    let corner = |x: &Vec3| x.x.abs() > 0.249 && x.y.abs() > 0.249;
    let positions = &model.shells[0].surface.positions;
    let vertices = (0..positions.len())
        .filter(|v| corner(&positions[*v]))
        .map(|v| VertexId(v as u32));
    model.constraints.push(Constraint {
        shell: 0,
        vertices: vertices.collect(),
        axes: [true; 3],
        motion: Motion::default(),
        clamp_directors: false,
        from: 0.0,
        until: f64::INFINITY,
    });
    let (simulation, _) = run(model, 20, 0.02);
    assert!(highest(&simulation) > 0.12);
}

#[test]
fn a_rising_plane_lifts_a_cloth() {
    let (simulation, _) = run(
        scene(
            vec![cloth(0.5, 10, 0.01)],
            vec![moving_up(floor(0.0), 0.4, 0.4)],
        ),
        25,
        0.02,
    );
    assert!(lowest(&simulation) > 0.4);
}

#[test]
fn a_fast_shot_does_not_tunnel() {
    // 100 m/s: 2 m a step, twenty times the size of the ball and a thousand times the reach of the barrier.
    let mut bullet = cloth(0.1, 10, 0.5);
    bullet
        .velocities
        .iter_mut()
        .for_each(|v| *v = Vec3::new(0.0, 0.0, -100.0));
    let ball = obstacle(
        "ball",
        ObstacleShape::Sphere {
            center: Vec3::new(0.003, 0.004, 0.0),
            radius: 0.1,
        },
    );
    let wall = obstacle(
        "wall",
        ObstacleShape::Mesh(box_mesh([2.0, 2.0, 0.01]).unwrap()),
    );
    for target in [ball, wall, floor(0.0)] {
        let mut model = scene(vec![bullet.clone()], vec![target]);
        // Sideways held, so that it cannot slip past the ball.
        model.constraints.push(Constraint {
            shell: 0,
            vertices: (0..121).map(VertexId).collect(),
            axes: [true, true, false],
            motion: Motion::default(),
            clamp_directors: false,
            from: 0.0,
            until: f64::INFINITY,
        });
        let (simulation, _) = run(model, 5, 0.02);
        assert!(lowest(&simulation) > 0.0);
    }
}

/// A strip bent over to a hairpin, lower half on the floor, upper half falling on it.
fn hairpin(offset: f64) -> Shell {
    let mut shell = cloth(0.4, 14, 0.0);
    let radius = 0.03;
    shell.contact_offset = offset;
    for x in &mut shell.surface.positions {
        let bend = std::f64::consts::PI * radius;
        let s = x.x;
        let (px, pz) = if s < -0.5 * bend {
            (-s - 0.5 * bend, 0.0)
        } else if s > 0.5 * bend {
            (s - 0.5 * bend, 2.0 * radius)
        } else {
            let angle = (s + 0.5 * bend) / radius;
            (-radius * angle.sin(), radius * (1.0 - angle.cos()))
        };
        *x = Vec3::new(px, x.y, pz + 0.01);
    }
    shell
}

#[test]
fn a_fold_closes_on_itself() {
    for offset in [0.0, 3e-3] {
        let (simulation, _) = run(scene(vec![hairpin(offset)], vec![floor(0.0)]), 25, 0.02);
        let x = simulation.shell_positions(0);
        // The free end of the upper half has come down on the lower one.
        let height = x[14].z;
        // Floor to lower half once the offset, lower to upper half twice, and gaps within the barrier.
        assert!(
            (3.0 * offset..3.0 * offset + 2.0 * D_HAT + 1e-3).contains(&height),
            "{height}"
        );
    }
}

#[test]
fn a_cloth_dropped_on_its_edge_crumples() {
    let mut upright = cloth(0.3, 10, 0.0);
    let lean = nalgebra::Rotation3::from_euler_angles(0.1, 1.45, 0.2);
    upright
        .surface
        .positions
        .iter_mut()
        .for_each(|x| *x = lean * *x + Vec3::z() * 0.2);
    let (simulation, reports) = run(scene(vec![upright], vec![floor(0.0)]), 40, 0.02);
    // It began 0.35 m high; now it lies in folds that touch each other.
    assert!(highest(&simulation) < 0.1 && reports[39].contacts > 20);
}

#[test]
fn a_thick_cloth_keeps_its_distance() {
    let mut thick = cloth(0.5, 10, 0.2);
    thick.contact_offset = 0.01;
    let ball = obstacle(
        "ball",
        ObstacleShape::Sphere {
            center: Vec3::zeros(),
            radius: 0.15,
        },
    );
    let (simulation, reports) = run(scene(vec![thick], vec![ball, floor(-0.3)]), 25, 0.02);
    // The gap is measured between the surfaces of thickness; the midsurface stays further away.
    let nearest = simulation
        .shell_positions(0)
        .iter()
        .map(|x| x.norm())
        .fold(f64::INFINITY, f64::min);
    assert!(
        reports[24].contacts > 0 && (0.16..0.17).contains(&nearest),
        "{nearest}"
    );
}

/// A stiff plate on a plane inclined by `slope`: its distance down the slope and its speed after each step.
fn sliding(slope: f64, friction: f64, steps: usize, dt: f64) -> Vec<[f64; 2]> {
    // The plane stays horizontal and gravity leans: the same physics, without round-off from turning.
    let mut block = cloth(0.1, 3, 0.5 * D_HAT);
    block.name = "block".into();
    (block.thickness, block.youngs_modulus, block.friction) = (5e-3, 1e8, friction);
    let mut plane = floor(0.0);
    plane.friction = friction;
    let mut model = scene(vec![block], vec![plane]);
    model.gravity = Vec3::new(slope.sin(), 0.0, -slope.cos()) * 9.81;
    model.solver.velocity_tolerance = 1e-6;
    let mut simulation = Simulation::new(model).unwrap();
    (0..steps)
        .map(|_| {
            let report = simulation.step(dt).unwrap();
            assert!(
                report.converged && report.min_gap > 0.0,
                "{:?}",
                report.diagnosis
            );
            let mean = |v: &[Vec3]| v.iter().map(|v| v.x).sum::<f64>() / v.len() as f64;
            [
                mean(&simulation.shell_positions(0)),
                mean(&simulation.shell_velocities(0)),
            ]
        })
        .collect()
}

#[test]
fn a_block_sticks_below_the_angle_of_friction() {
    let slope = 0.3f64;
    let states = sliding(slope, 1.2 * slope.tan(), 60, 0.01);
    // Friction grows with the speed v as 2 y − y², y = v / 1 mm/s, and balances the weight at 1/1.2 of its limit. The lag
    // of the normal force is nothing here, as it does not change.
    let creep = 1e-3 * (1.0 - (1.0 - 1.0 / 1.2f64).sqrt());
    assert!(
        (states[59][1] / creep - 1.0).abs() < 1e-3,
        "{} {creep}",
        states[59][1]
    );
}

#[test]
fn a_block_slides_above_the_angle_of_friction() {
    let slope = 0.3f64;
    for friction in [0.0, 0.5 * slope.tan(), 0.9 * slope.tan()] {
        let states = sliding(slope, friction, 60, 0.01);
        let acceleration = (states[59][1] - states[29][1]) / 0.3;
        let expected = 9.81 * (slope.sin() - friction * slope.cos());
        // Implicit Euler is exact for constant accelerations; the rest is the tolerance of the solver.
        assert!(
            (acceleration / expected - 1.0).abs() < 1e-6,
            "{friction}: {acceleration} {expected}"
        );
    }
}

#[test]
fn a_moving_floor_carries_a_block_along() {
    let (speed, friction, dt) = (0.4, 0.5, 0.005);
    let table = obstacle(
        "table",
        ObstacleShape::Mesh(box_mesh([1.0, 1.0, 0.1]).unwrap()),
    );
    for (mut carrier, top) in [(floor(0.0), 0.0), (table, 0.05)] {
        let mut block = cloth(0.1, 3, top + 0.9 * D_HAT);
        (block.thickness, block.youngs_modulus, block.friction) = (5e-3, 1e8, friction);
        carrier.friction = friction;
        let values = vec![Vec3::zeros(), Vec3::zeros(), Vec3::x() * speed];
        carrier.motion.translation = Some(Schedule {
            times: vec![0.0, 0.2, 1.2],
            values,
        });
        let (simulation, _) = run(scene(vec![block], vec![carrier]), 80, dt);
        let v = simulation.shell_velocities(0).iter().sum::<Vec3>() / 16.0;
        // 0.2 s after the start of the motion; friction needs v / (μ g) = 0.08 s to bring the block to that speed.
        assert!(
            (v.x / speed - 1.0).abs() < 0.01 && v.y.abs() < 1e-3 * speed,
            "{v}"
        );
    }
}

#[test]
fn a_start_that_intersects_is_refused_with_names_and_distances() {
    let refused = |model: Model| match Simulation::new(model) {
        Ok(_) => panic!("the start was accepted"),
        Err(error) => error.to_string(),
    };
    let through = obstacle(
        "box",
        ObstacleShape::Mesh(box_mesh([0.2, 0.2, 0.2]).unwrap()),
    );
    let message = refused(scene(vec![cloth(0.5, 10, 0.0)], vec![through]));
    assert!(
        message.contains("intersects")
            && message.contains("of 'box'")
            && message.contains("of 'cloth'")
    );
    let message = refused(scene(vec![cloth(0.5, 2, -0.25)], vec![floor(0.0)]));
    assert!(message.contains("vertex 0 of 'cloth' is below 'floor' (gap -2.500e-1 m)"));
    let mut thick = cloth(0.5, 2, 0.004);
    thick.contact_offset = 0.005;
    let message = refused(scene(vec![thick], vec![floor(0.0)]));
    assert!(message.contains("(gap -1.000e-3 m)"));
    let ball = obstacle(
        "ball",
        ObstacleShape::Sphere {
            center: Vec3::new(0.01, 0.02, 0.0),
            radius: 0.1,
        },
    );
    let message = refused(scene(vec![cloth(0.5, 2, 0.09)], vec![ball]));
    assert!(message.contains("touches 'ball'") || message.contains("'ball' touches"));
    assert!(message.contains("(gap -1.000e-2 m)"));
}

#[test]
fn a_barrier_that_reaches_beyond_an_element_is_refused() {
    let mut model = scene(vec![cloth(0.5, 2, 1.0)], vec![floor(0.0)]);
    model.contact.d_hat = Some(0.6);
    let message = Simulation::new(model).err().expect("a refusal").to_string();
    assert!(
        message.contains("'cloth'") && message.contains("reduce d_hat"),
        "{message}"
    );
}

#[test]
fn a_shell_that_starts_inside_a_box_is_refused() {
    let inside = cloth(0.1, 2, 0.0);
    let solid = obstacle(
        "box",
        ObstacleShape::Mesh(box_mesh([0.4, 0.4, 0.4]).unwrap()),
    );
    let message = Simulation::new(scene(vec![inside], vec![solid]))
        .err()
        .expect("a refusal")
        .to_string();
    assert!(message.contains("lies inside 'box'"), "{message}");
}

#[test]
fn a_plane_that_is_to_turn_is_refused() {
    let mut plane = floor(-1.0);
    plane.motion.rotation = Some(Rotation {
        pivot: Vec3::zeros(),
        axis: Vec3::x(),
        angle: Schedule {
            times: vec![0.0, 1.0],
            values: vec![0.0, 1.0],
        },
    });
    let message = Simulation::new(scene(vec![cloth(0.5, 2, 0.0)], vec![plane]))
        .err()
        .expect("a refusal");
    assert!(message.to_string().contains("a plane cannot rotate"));
}
