use super::*;
use crate::burning::quad_mesh::QuadMesh;
use crate::burning::setup::{BurningSetup, Surroundings};
use crate::burning::stepper::BurningShell;
use crate::burning::{BurningOptions, ProjectionOptions};

const OPTIONS: SelfCollisionOptions = SelfCollisionOptions {
    distance: 0.1,
    friction: 0.0,
};

/// Two quads of side 1, the second `height` above the first.
fn two_quads(height: f64) -> DoubleLayer {
    let square =
        |z: f64| [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, z));
    let positions = [square(0.0), square(height)].concat();
    DoubleLayer::new(
        QuadMesh::new(positions, vec![[0, 1, 2, 3], [4, 5, 6, 7]]).unwrap(),
        0.02,
    )
}

fn is_upper(shell: &DoubleLayer, particle: usize) -> bool {
    (4..8).contains(&particle) || particle == shell.lattice(1)
}

/// The particles with the upper quad moved.
fn moved(shell: &DoubleLayer, by: Vec3) -> Vec<Vec3> {
    let shift = |p: usize| {
        if is_upper(shell, p) {
            by
        } else {
            Vec3::zeros()
        }
    };
    let particles = shell.particles.iter().enumerate();
    particles.map(|(p, x)| x + shift(p)).collect()
}

fn begun(shell: &DoubleLayer, options: SelfCollisionOptions, goal: &[Vec3]) -> SelfCollision {
    let mut collision = SelfCollision::new(shell, options);
    collision.begin(&shell.particles, goal, 1.0, &[true; 8], |_| 1.0);
    collision
}

#[test]
fn what_is_close_or_has_passed_through_is_pushed_back_and_momentum_is_kept() {
    // To just above the lower quad, and to below it.
    let shell = two_quads(0.18);
    for drop in [0.14, 0.22] {
        let mut x = moved(&shell, Vec3::new(0.1, 0.05, -drop));
        let collision = begun(&shell, OPTIONS, &x);
        let inverse: Vec<f64> = (0..10).map(|p| 1.0 + 0.1 * f64::from(p)).collect();
        let momentum = |x: &[Vec3]| -> Vec3 { x.iter().zip(&inverse).map(|(x, w)| x / *w).sum() };
        let before = momentum(&x);
        for _ in 0..50 {
            collision.push_apart(&shell.particles, &mut x, &inverse);
        }
        let height = |x: &[Vec3]| x.iter().map(|x| x.z).sum::<f64>() / 4.0;
        assert!(height(&x[4..8]) - height(&x[..4]) > 0.08, "{drop}: {x:?}");
        for near in &collision.near {
            let apart = collision.apart(near, &shell.particles, &x);
            assert!(apart.distance > 0.9 * near.wanted, "{drop}: {near:?}");
        }
        assert!((momentum(&x) - before).norm() < 1e-12);
    }
}

#[test]
fn what_begins_too_close_is_let_out_by_a_tenth_in_a_step() {
    let shell = two_quads(0.02);
    let mut x = shell.particles.clone();
    let collision = begun(&shell, OPTIONS, &x);
    for _ in 0..50 {
        collision.push_apart(&shell.particles, &mut x, &[1.0; 10]);
    }
    assert!(
        collision
            .near
            .iter()
            .all(|near| near.wanted <= 0.03 + 1e-12)
    );
    assert!((x[4].z - x[0].z - 0.03).abs() < 1e-3, "{}", x[4].z - x[0].z);
}

#[test]
fn motion_ends_before_it_crosses_and_held_corners_go_on() {
    let shell = two_quads(0.3);
    let goal = moved(&shell, Vec3::new(0.0, 0.0, -1.0));
    let mut collision = begun(&shell, OPTIONS, &goal);
    let mut x = goal.clone();
    let stopped = collision.hold_back(&shell.particles, &mut x, &[1.0; 10]);
    assert_eq!(stopped, 4);
    assert!((0.02..0.1).contains(&x[5].z), "{}", x[5].z);
    // Its lattice particle with it.
    assert!((x[shell.lattice(1)].z - x[5].z - 0.02).abs() < 1e-12);
    let mut held = [1.0; 10];
    held[4..8].fill(0.0);
    let mut x = goal.clone();
    collision.hold_back(&shell.particles, &mut x, &held);
    assert_eq!(x[4..8], goal[4..8]);
    // Past each other, none.
    let mut x = moved(&shell, Vec3::new(5.0, 0.0, 0.2));
    let expected = x.clone();
    assert_eq!(collision.hold_back(&shell.particles, &mut x, &[1.0; 10]), 0);
    assert_eq!(x, expected);
}

#[test]
fn friction_takes_its_share_of_the_sliding() {
    let shell = two_quads(0.1);
    let slide = |friction: f64| {
        let options = SelfCollisionOptions {
            friction,
            ..OPTIONS
        };
        let mut x = moved(&shell, Vec3::new(0.01, 0.0, 0.0));
        let mut collision = begun(&shell, options, &x);
        collision.rub(&shell.particles, &mut x, &[1.0; 10], 1.0);
        let [lower, upper] = [&x[..4], &x[4..8]].map(|x| x.iter().map(|x| x.x).sum::<f64>() / 4.0);
        upper - lower
    };
    assert!((slide(0.0) - 0.01).abs() < 1e-12);
    let half = slide(0.5);
    // The pairs of a corner share it: about a half, not a half of what the one before has left.
    assert!((0.003..0.008).contains(&half), "{half}");
    assert!(slide(1.0) < 0.2 * half);
}

#[test]
fn a_start_that_crosses_itself_is_refused() {
    let mut positions = two_quads(0.3).mesh.positions().to_vec();
    positions[4].z = -0.1;
    let mesh = QuadMesh::new(positions, vec![[0, 1, 2, 3], [4, 5, 6, 7]]).unwrap();
    let error = SelfCollision::check_start(&DoubleLayer::new(mesh, 0.02)).unwrap_err();
    assert!(error.to_string().contains("crosses itself"), "{error}");
    assert!(SelfCollision::check_start(&two_quads(0.3)).is_ok());
}

/// A strip bent into a U whose lower half is held and whose upper half falls on it.
fn bent_strip() -> DoubleLayer {
    let (radius, straight) = (0.1, 0.5);
    let mut mesh = QuadMesh::grid([1.2, 0.2], [12, 2]).unwrap();
    mesh.move_by(|x| {
        let s = x.x + 0.6 - straight;
        let angle = (s / radius).clamp(0.0, std::f64::consts::PI);
        let past = (s - radius * std::f64::consts::PI).max(0.0);
        Vec3::new(
            s.min(0.0) + radius * angle.sin() - past,
            x.y,
            radius * (1.0 - angle.cos()),
        )
    });
    DoubleLayer::new(mesh, 0.02)
}

/// How many edges of the surface cross faces, at worst in a second, and at the end the strip.
fn fall(self_collision: Option<SelfCollisionOptions>) -> (usize, BurningShell) {
    let shell = bent_strip();
    let held = (0..shell.num_corners()).filter(|&p| shell.particles[p].z < 1e-9);
    let held: Vec<(u32, Vec3)> = held.map(|p| (p as u32, shell.particles[p])).collect();
    let mut strip = BurningShell::new(BurningSetup {
        area_density: 0.1,
        temperature: 293.0,
        ambient_temperature: 293.0,
        cooling_rate: 0.0,
        diffusivity: 0.0,
        diffusivity_factors: Vec::new(),
        burning: BurningOptions::default(),
        loss_factors: Vec::new(),
        projection: ProjectionOptions {
            // So soft in bending that it falls.
            weights: [0.2, 0.2, 1.0, 1.0],
            sweeps: 4,
            ..ProjectionOptions::default()
        },
        self_collision,
        damping: 1.0,
        shell,
    })
    .unwrap();
    let mut around = Surroundings {
        gravity: Vec3::new(0.0, 0.0, -9.81),
        held,
        ..Surroundings::default()
    };
    let mut worst = 0;
    for step in 0..250 {
        let time = 0.004 * f64::from(step);
        strip
            .step(time, 0.004, &mut |_, _| (), &mut around)
            .unwrap();
        worst = worst.max(crossings(&strip));
    }
    (worst, strip)
}

fn crossings(strip: &BurningShell) -> usize {
    let surface = strip.surface();
    let x = surface.positions(&strip.setup().shell, &strip.state().positions);
    let sides = |f: &[u32; 3]| [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]];
    let edges: Vec<[u32; 2]> = surface.faces.iter().flat_map(sides).collect();
    intersections(&x, &edges, &surface.faces, |_, _| false).len()
}

#[test]
fn a_flap_that_falls_on_itself_comes_to_lie_there() {
    let (without, through) = fall(None);
    assert!(without > 0, "it passes through itself");
    let (with, lying) = fall(Some(SelfCollisionOptions {
        distance: 0.02,
        friction: 0.1,
    }));
    assert_eq!(with, 0);
    let lowest = |strip: &BurningShell| {
        let x = strip.state().positions.iter();
        x.map(|x| x.z).fold(f64::INFINITY, f64::min)
    };
    assert!(lowest(&through) < -0.05 && lowest(&lying) > -0.02);
}
