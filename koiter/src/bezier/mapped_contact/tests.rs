use super::*;
use crate::bezier::problems::{RoofEdges, roof};
use crate::bezier::{
    BezierShell, DeadLoad, Dynamics, ElementKind, NewtonLimits, Section, ShellOptions, Supports,
};
use crate::contact::ObstacleBody;
use crate::mesh::Surface;
use crate::mesh::generate::{GridDiagonals, grid, icosphere};

const OPTIONS: ContactOptions = ContactOptions {
    d_hat: 0.1,
    kappa: 1e5,
    offset: 0.125,
    friction: 0.0,
    friction_speed: 1e-3,
};

fn obstacle(name: &str, surface: &Surface, friction: f64) -> CollisionObstacle {
    CollisionObstacle {
        name: name.to_owned(),
        body: ObstacleBody::Thickened {
            edges: surface.mesh.edges().to_vec(),
            faces: surface.mesh.faces().to_vec(),
            offset: 0.0,
        },
        points: surface.positions.clone(),
        friction,
    }
}

/// A plate under its weight on an inclined plane: with friction above the slope it stays, with less it slides.
#[test]
fn friction_holds_a_plate_on_a_slope_that_is_less_steep_than_it() {
    let plate = grid(1.0, 1.0, 2, 2, GridDiagonals::Uniform).unwrap();
    let section = Section {
        youngs_modulus: 1e7,
        poissons_ratio: 0.3,
        thickness: 0.02,
        density: 1000.0,
    };
    let options = ShellOptions {
        section,
        kind: ElementKind::Bezier,
        frame: None,
    };
    // Gravity leans by a slope of 0.3 instead of the plane.
    let gravity = Vec3::new(3.0, 0.0, -10.0);
    let slid = [0.5, 0.1].map(|friction| {
        let shell = BezierShell::new(&plate, &[Vec3::z(); 9], options).unwrap();
        let rest = shell.rest_pose();
        let plane = CollisionObstacle {
            name: "plane".to_owned(),
            body: ObstacleBody::Plane { normal: Vec3::z() },
            points: vec![Vec3::new(0.0, 0.0, -0.012)],
            friction,
        };
        let options = ContactOptions {
            d_hat: 4e-3,
            kappa: 10.0,
            offset: 0.01,
            friction,
            ..OPTIONS
        };
        let mapped = MappedSurface::subdivided(&shell, 1);
        let mut contact = MappedContact::new("plate", mapped, vec![plane], &rest, options);
        let mut load = DeadLoad::none(rest.len());
        load.add_gravity(&shell, gravity);
        let mut moving = Dynamics::new(shell, Supports::none(rest.len()));
        for _ in 0..50 {
            contact.begin_step(&moving.pose, 0.01);
            let limits = NewtonLimits {
                tolerance: 1e-6,
                ..NewtonLimits::for_edges(0.5)
            };
            let outcome = (moving.step(&mut [&mut contact, &mut load], 0.01, &limits)).unwrap();
            assert!(outcome.converged, "{outcome:?}");
        }
        moving.pose.positions.iter().map(|x| x.x).sum::<f64>() / 9.0
            - rest.positions.iter().map(|x| x.x).sum::<f64>() / 9.0
    });
    // Smoothed friction creeps at 1 mm/s at most; what slides is pulled by 3 − 0.1 · 10 m/s² for half a second: 0.25 m,
    // and 2 % more by the steps.
    assert!(slid[0].abs() < 1e-3, "{slid:?}");
    assert!((0.24..0.27).contains(&slid[1]), "{slid:?}");
}

#[test]
fn a_ball_pushes_the_roof_in_without_touching_it() {
    let problem = roof(ElementKind::Bezier, 6, RoofEdges::Clamped).unwrap();
    let rest = problem.shell.rest_pose();
    let mapped = MappedSurface::subdivided(&problem.shell, 3);
    let mut ball = icosphere(3.0, 2).unwrap();
    let at = Vec3::new(8.0, 15.0, 28.2);
    ball.positions.iter_mut().for_each(|x| *x += at);
    let start = ball.positions.clone();
    let obstacle = obstacle("ball", &ball, 0.0);
    let mut contact = MappedContact::new("roof", mapped, vec![obstacle], &rest, OPTIONS);
    let mut moving = Dynamics::new(problem.shell, problem.supports);
    let limits = NewtonLimits::for_edges(problem.edge);
    let mut pushed = 0;
    for step in 1..=10 {
        let down = Vec3::new(0.0, 0.0, -0.15 * step as f64);
        let towards: Vec<Vec3> = start.iter().map(|x| x + down).collect();
        for _ in 0..20 {
            let pose = moving.pose.clone();
            let (fraction, _) = contact.approach(&pose, &pose, &towards);
            let outcome = moving.settle(&mut [&mut contact], &limits).unwrap();
            assert!(outcome.iterations < 50, "{step}: {outcome:?}");
            if fraction == 1.0 {
                break;
            }
        }
        pushed = contact.forces(&moving.pose).len();
    }
    assert!((contact.obstacles()[0] - start[0]).norm() > 1.49);
    assert!(pushed > 0);
    // No fine vertex is within the ball and the offset; between the facets of the ball it is smaller than its radius.
    let centre = at + Vec3::new(0.0, 0.0, -1.5);
    let nearest = (contact.mapped().positions(&moving.pose).iter())
        .map(|x| (x - centre).norm())
        .fold(f64::INFINITY, f64::min);
    assert!(nearest > 2.9, "{nearest}");
    // Contact pushes inwards, and the shell pushes back: loads are in balance, so forces on nodes are those of the map.
    let forces = contact.forces(&moving.pose);
    let total: Vec3 = forces.iter().map(|(_, f)| f).sum();
    assert!(total.z < 0.0, "{total}");
}
