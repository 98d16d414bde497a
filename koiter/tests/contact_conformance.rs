//! The energies that are not sums over fixed elements pass their part of the conformance suite.

use koiter::Vec3;
use koiter::assembly::{Dof, DofLayout, Energy};
use koiter::contact::{CollisionBody, CollisionMesh, CollisionPlane, Contact, Friction};
use koiter::energy::loads::Pull;
use koiter::energy::{Gravity, Inertia};
use koiter::testing::check_global;

/// Two crossing sheets of two triangles a small gap apart, a plane below, a ball above; the last two do not move freely.
fn scene(offset: f64) -> (Contact, DofLayout, Vec<f64>) {
    let mut layout = DofLayout::new();
    let lower = layout.push_nodes(4, 3, true);
    let upper = layout.push_nodes(4, 3, true);
    let ball = layout.push_nodes(1, 3, false);
    let plane = layout.push_nodes(1, 3, false);
    // Turned against each other: where edges are exactly parallel the mollified barrier has no second derivative.
    let sheet = |shift: [f64; 3], turn: f64| -> Vec<Vec3> {
        [
            [0.0, 0.0, 0.0],
            [1.0, 0.1, 0.0],
            [1.1, 1.0, 0.02],
            [-0.1, 0.9, 0.01],
        ]
        .iter()
        .map(|p| {
            Vec3::new(
                p[0] - turn * p[1] + shift[0],
                p[1] + turn * p[0] + shift[1],
                p[2] + shift[2],
            )
        })
        .collect()
    };
    let positions = [
        sheet([0.0, 0.0, 0.03], 0.0),
        sheet([0.33, 0.27, 0.08], 0.3),
        vec![Vec3::new(0.9, 0.8, 0.63)],
        vec![Vec3::zeros()],
    ];
    let q = positions
        .iter()
        .flatten()
        .flat_map(|x| [x.x, x.y, x.z])
        .collect();
    let body = |name: &str, first_dof, rest: &Vec<Vec3>, radius: Option<f64>| CollisionBody {
        name: name.into(),
        first_dof,
        num_vertices: rest.len(),
        edges: if radius.is_some() {
            vec![]
        } else {
            vec![[0, 1], [1, 2], [0, 2], [2, 3], [0, 3]]
        },
        faces: if radius.is_some() {
            vec![]
        } else {
            vec![[0, 1, 2], [0, 2, 3]]
        },
        rest_positions: rest.clone(),
        offset: radius.unwrap_or(offset),
        is_obstacle: radius.is_some(),
        friction: 0.5,
    };
    let bodies = vec![
        body("lower", lower, &positions[0], None),
        body("upper", upper, &positions[1], None),
        body("ball", ball, &positions[2], Some(0.5)),
    ];
    let plane = CollisionPlane {
        name: "floor".into(),
        point: plane,
        normal: Vec3::z(),
        friction: 0.5,
    };
    let contact = Contact::new(
        CollisionMesh::new(bodies),
        vec![plane],
        layout.clone(),
        0.072,
        2.0,
    );
    (contact, layout, q)
}

#[test]
fn contact_conforms_with_and_without_thickness() {
    for offset in [0.0, 0.01] {
        let (mut contact, layout, q) = scene(offset);
        check_global(&mut contact, &layout, &q).unwrap();
        let statistics = contact.statistics();
        assert!(statistics.contacts >= 10, "{statistics:?}");
    }
}

#[test]
fn contact_far_apart_exerts_no_force() {
    let (mut contact, _, mut q) = scene(0.0);
    for (i, x) in q.iter_mut().enumerate().take(24) {
        if i % 3 == 2 {
            *x += if i < 12 { 0.2 } else { 0.4 };
        }
    }
    q[26] += 2.0;
    contact.prepare(&q);
    contact.begin_iteration(&q);
    let mut gradient = vec![0.0; q.len()];
    contact.add_gradient(&q, &mut gradient);
    assert_eq!(contact.value(&q), 0.0);
    assert!(gradient.iter().all(|g| *g == 0.0));
}

#[test]
fn contact_forces_balance() {
    let (mut contact, _, q) = scene(0.01);
    contact.prepare(&q);
    contact.begin_iteration(&q);
    let mut gradient = vec![0.0; q.len()];
    contact.add_gradient(&q, &mut gradient);
    let size = gradient.iter().fold(0.0f64, |m, g| m.max(g.abs()));
    for axis in 0..3 {
        let sum: f64 = gradient.iter().skip(axis).step_by(3).sum();
        // Obstacles take the opposite force; the rest is round-off of some twenty terms.
        assert!(sum.abs() < 1e-13 * size);
    }
}

#[test]
fn friction_conforms_sticking_and_sliding() {
    let (mut contact, layout, q) = scene(0.0);
    contact.prepare(&q);
    contact.begin_iteration(&q);
    for slide in [1e-3, 0.3] {
        let start = q
            .iter()
            .enumerate()
            .map(|(i, x)| x - slide * ((i + 1) as f64).sin())
            .collect();
        let mut friction = Friction {
            contacts: vec![],
            start,
            smoothing: 0.02,
            layout: layout.clone(),
        };
        contact.lag(&q, &mut friction);
        check_global(&mut friction, &layout, &q).unwrap();
    }
}

#[test]
fn inertia_gravity_and_pulls_conform() {
    let (_, layout, q) = scene(0.0);
    let mut pull = Pull {
        vertex: Dof(3),
        node: layout.node(Dof(3)),
        target: Vec3::new(0.3, 0.2, 0.1),
        stiffness: 7.0,
    };
    check_global(&mut pull, &layout, &q).unwrap();
    let masses: Vec<f64> = (0..24).map(|i| 0.1 + 0.01 * f64::from(i)).collect();
    let prediction = q.iter().map(|x| x + 0.1).collect();
    check_global(
        &mut Inertia {
            masses,
            prediction,
            dt: 0.05,
        },
        &layout,
        &q,
    )
    .unwrap();
    let masses = (0..8)
        .map(|v| (Dof(3 * v), 0.1 + 0.02 * f64::from(v)))
        .collect();
    check_global(
        &mut Gravity {
            masses,
            acceleration: Vec3::new(0.1, 0.2, -9.81),
        },
        &layout,
        &q,
    )
    .unwrap();
}

#[test]
fn the_barrier_is_stiffened_by_a_small_gap_that_shrinks_and_not_by_one_that_opens() {
    let (mut contact, _, q) = scene(0.0);
    contact.prepare(&q);
    let gap = contact.statistics().min_gap;
    let start = contact.kappa();
    // The lower sheet is nearest to the floor; raised this far the floor leaves a gap below 2 % of d̂, 1.44e-3 m.
    let raised = |left: f64| {
        let mut q = q.clone();
        q[29] += gap - left;
        q
    };
    for step in 1..6 {
        let q = raised(1e-3 + 5e-5 * f64::from(step));
        contact.prepare(&q);
        contact.begin_iteration(&q);
        assert!(contact.statistics().min_gap < 1.44e-3);
    }
    assert_eq!(contact.kappa(), start);
    contact.begin_iteration(&raised(1e-3));
    assert_eq!(contact.kappa(), 2.0 * start);
}

#[test]
fn the_barrier_is_stiffened_by_a_small_gap_that_keeps_steps_short() {
    let (mut contact, _, q) = scene(0.0);
    contact.prepare(&q);
    let gap = contact.statistics().min_gap;
    let start = contact.kappa();
    // The floor of the test above, 1 mm below the sheet: every step would raise it by ten times that.
    let mut near = q;
    near[29] += gap - 1e-3;
    contact.prepare(&near);
    contact.begin_iteration(&near);
    let mut direction = vec![0.0; near.len()];
    direction[29] = 1e-2;
    assert!(contact.max_step(&near, &direction) < 0.1);
    contact.begin_iteration(&near);
    assert_eq!(contact.kappa(), 2.0 * start);
    // A step that may be taken whole says nothing.
    direction[29] = 1e-4;
    assert_eq!(contact.max_step(&near, &direction), 1.0);
    contact.begin_iteration(&near);
    assert_eq!(contact.kappa(), 2.0 * start);
}
