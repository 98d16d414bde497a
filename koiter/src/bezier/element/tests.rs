//! What an element owes to mechanics, whichever it is.

use nalgebra::{SymmetricEigen, Vector3};

use super::*;

const SECTION: Section = Section {
    youngs_modulus: 2e5,
    poissons_ratio: 0.3,
    thickness: 0.05,
    density: 1000.0,
};

/// A scalene triangle, tilted in space, with normals of a curved surface.
fn rest() -> RestElement {
    let corners = [[0.1, 0.2, 0.3], [1.3, 0.1, 0.5], [0.5, 1.1, 0.2]].map(Vec3::from);
    let normal = (corners[1] - corners[0])
        .cross(&(corners[2] - corners[0]))
        .normalize();
    let centroid = (corners[0] + corners[1] + corners[2]) / 3.0;
    RestElement {
        corners,
        normals: corners.map(|x| (normal + 0.3 * (x - centroid)).normalize()),
        attached: [UnitQuaternion::identity(); 3],
        section: SECTION,
    }
}

fn flat(points: [[f64; 2]; 3]) -> RestElement {
    RestElement {
        corners: points.map(|[x, y]| Vec3::new(x, y, 0.0)),
        normals: [Vec3::z(); 3],
        attached: [UnitQuaternion::identity(); 3],
        section: SECTION,
    }
}

fn element(rest: &RestElement, kind: ElementKind, rule: FrameRule) -> Element {
    Element::new(rest, kind, rule, 0).unwrap()
}

const RULES: [FrameRule; 3] = [FrameRule::Polar, FrameRule::Edge, FrameRule::PRINTED];

/// A pose far from rest: turned by 1 rad, and deformed by `size`.
fn pose(rest: &RestElement, size: f64) -> ([Vec3; 3], [UnitQuaternion<f64>; 3]) {
    let turn = UnitQuaternion::from_scaled_axis(Vec3::new(0.5, -0.7, 0.5));
    let wobble = |i: usize, k: f64| {
        size * Vec3::new(
            (k * i as f64).sin(),
            (2.0 * k + i as f64).cos(),
            (3.1 * k * i as f64).cos(),
        )
    };
    let x = [0, 1, 2].map(|i| turn * rest.corners[i] + wobble(i, 1.3) + Vec3::new(2.0, 0.0, 1.0));
    let turns = [0, 1, 2].map(|i| UnitQuaternion::from_scaled_axis(wobble(i, 2.2)) * turn);
    (x, turns)
}

fn moved(
    (x, turns): &([Vec3; 3], [UnitQuaternion<f64>; 3]),
    unknown: usize,
    by: f64,
) -> ([Vec3; 3], [UnitQuaternion<f64>; 3]) {
    let (mut x, mut turns) = (*x, *turns);
    let (corner, k) = (unknown / 6, unknown % 6);
    if k < 3 {
        x[corner][k] += by;
    } else {
        turns[corner] = UnitQuaternion::from_scaled_axis(Vec3::ith(k - 3, by)) * turns[corner];
    }
    (x, turns)
}

#[test]
fn a_turn_by_one_radian_costs_nothing() {
    let rest = rest();
    let (x, turns) = pose(&rest, 0.0);
    for kind in ElementKind::ALL {
        for rule in RULES {
            let state = element(&rest, kind, rule).state(&x, &turns).unwrap();
            let scale = SECTION.youngs_modulus * SECTION.thickness;
            // Round-off of positions of size 2, times the membrane stiffness.
            assert!(
                state.gradient.norm() < 1e-13 * scale,
                "{kind:?} {rule:?}: {}",
                state.gradient.norm()
            );
        }
    }
}

#[test]
fn membrane_and_bending_have_three_motions_without_stiffness_each() {
    // With normals that are not those of the triangle the control points lie a little off its edges in projection, and to
    // first order a turn costs some 10⁻⁵ of the largest stiffness.
    for kind in ElementKind::ALL {
        let stiffness = *element(&flat(SCALENE), kind, FrameRule::Polar).stiffness();
        for unknowns in [[0, 1, 5], [2, 3, 4]] {
            let place = |k: usize| 6 * (k / 3) + unknowns[k % 3];
            let block = SMatrix::<f64, 9, 9>::from_fn(|i, j| stiffness[(place(i), place(j))]);
            let mut values: Vec<f64> = SymmetricEigen::new(block)
                .eigenvalues
                .iter()
                .copied()
                .collect();
            values.sort_by(f64::total_cmp);
            // Round-off of sums of the largest; the weakest motion that counts, corners turning in the plane against
            // each other, is seven orders above it.
            let zero = 1e-13 * values[8];
            assert!(
                values[2].abs() < zero && values[0].abs() < zero,
                "{kind:?} {values:?}"
            );
            assert!(values[3] > 1e-6 * values[8], "{kind:?} {values:?}");
        }
    }
}

#[test]
fn forces_are_the_derivatives_of_the_energy() {
    let rest = rest();
    let at = pose(&rest, 0.2);
    for kind in ElementKind::ALL {
        for rule in [FrameRule::Polar, FrameRule::Edge] {
            let element = element(&rest, kind, rule);
            let state = element.state(&at.0, &at.1).unwrap();
            assert!(state.energy > 1.0 && state.gradient.norm() > 1.0);
            for unknown in 0..18 {
                let h = 1e-5;
                let energy = |by| {
                    let (x, turns) = moved(&at, unknown, by);
                    element.energy(&x, &turns).unwrap()
                };
                let difference = (energy(h) - energy(-h)) / (2.0 * h);
                let error = (difference - state.gradient[unknown]).abs();
                // Truncation h² and round-off 1e-16 / h, relative to the whole.
                assert!(
                    error < 1e-8 * state.gradient.norm(),
                    "{kind:?} {rule:?} {unknown}: {error}"
                );
            }
        }
    }
}

#[test]
fn forces_and_moments_balance_at_any_deformation() {
    let rest = rest();
    let (x, turns) = pose(&rest, 0.3);
    for kind in ElementKind::ALL {
        let state = element(&rest, kind, FrameRule::Polar)
            .state(&x, &turns)
            .unwrap();
        let force: Vec3 = (0..3).map(|i| part(&state.gradient, 6 * i)).sum();
        let moment: Vec3 = (0..3)
            .map(|i| x[i].cross(&part(&state.gradient, 6 * i)) + part(&state.gradient, 6 * i + 3))
            .sum();
        // Round-off of a few products.
        assert!(force.norm() < 1e-13 * state.gradient.norm());
        assert!(moment.norm() < 1e-13 * state.gradient.norm());
    }
}

/// Largest difference between the tangent and the symmetric part of the forces' differences, relative.
fn tangent_error(size: f64, tangent: Tangent) -> f64 {
    let rest = rest();
    let at = pose(&rest, size);
    let element = element(&rest, ElementKind::Bezier, FrameRule::Polar);
    let (_, matrix) = element.derivatives(&at.0, &at.1, tangent).unwrap();
    let mut differences = Stiffness::zeros();
    for unknown in 0..18 {
        let h = 1e-6;
        let gradient = |by| {
            let (x, turns) = moved(&at, unknown, by);
            element.state(&x, &turns).unwrap().gradient
        };
        differences.set_column(unknown, &((gradient(h) - gradient(-h)) / (2.0 * h)));
    }
    let symmetric = 0.5 * (differences + differences.transpose());
    (matrix - symmetric).norm() / symmetric.norm()
}

#[test]
fn the_consistent_tangent_is_that_of_the_forces_up_to_the_strain() {
    let (fine, coarse) = (
        tangent_error(1e-4, Tangent::Consistent),
        tangent_error(1e-2, Tangent::Consistent),
    );
    // What is left out is of second order: a hundredth of the deformation, a ten-thousandth of the error.
    assert!(
        coarse < 1e-2 && fine < 1e-3 * coarse.max(1e-5),
        "{fine} {coarse}"
    );
    assert!(tangent_error(1e-4, Tangent::Corotated) < 1e-2);
}

/// Energy of an element whose corners are displaced by `field`: (u, v, w) and rotations (θ_x, θ_y, θ_z) at (x, y).
fn energy_of(rest: &RestElement, kind: ElementKind, field: impl Fn(f64, f64) -> [f64; 6]) -> f64 {
    let element = element(rest, kind, FrameRule::Polar);
    // The element's frame is along its first edge: fields are given in world axes and turned to it.
    let along = (rest.corners[1] - rest.corners[0]).normalize();
    let axes = Matrix3::from_columns(&[along, Vec3::z().cross(&along), Vec3::z()]);
    let mut d = ElementVector::zeros();
    for i in 0..3 {
        let [u, v, w, rx, ry, rz] = field(rest.corners[i].x, rest.corners[i].y);
        d.fixed_rows_mut::<3>(6 * i)
            .copy_from(&(axes.transpose() * Vector3::new(u, v, w)));
        d.fixed_rows_mut::<3>(6 * i + 3)
            .copy_from(&(axes.transpose() * Vector3::new(rx, ry, rz)));
    }
    0.5 * d.dot(&(element.stiffness() * d))
}

const SCALENE: [[f64; 2]; 3] = [[0.2, 0.1], [1.5, 0.3], [0.6, 1.2]];

#[test]
fn constant_strain_costs_what_it_should() {
    let rest = flat(SCALENE);
    let area = element(&rest, ElementKind::Bezier, FrameRule::Polar).area();
    let strain = Vector3::new(0.3, -0.2, 0.5);
    let exact = 0.5 * area * strain.dot(&(SECTION.membrane() * strain));
    // With a rotation on top, which the corners share.
    let field = |x: f64, y: f64| {
        [
            0.3 * x + 0.1 * y,
            0.4 * x - 0.2 * y,
            0.0,
            0.0,
            0.0,
            0.5 * (0.4 - 0.1),
        ]
    };
    let ratio = |kind| energy_of(&rest, kind, field) / exact;
    // Round-off of the quadrature.
    assert!((ratio(ElementKind::Bezier) - 1.0).abs() < 1e-12);
    assert!((ratio(ElementKind::DktAndes) - 1.0).abs() < 1e-12);
    // The printed element: 3s² − 2s³ along an edge where s belongs costs 6/5 along it.
    assert!(
        (1.05..1.25).contains(&ratio(ElementKind::BezierPaper)),
        "{}",
        ratio(ElementKind::BezierPaper)
    );
}

#[test]
fn constant_curvature_costs_what_it_should() {
    let rest = flat(SCALENE);
    let area = element(&rest, ElementKind::Bezier, FrameRule::Polar).area();
    let (a, b, c) = (0.7, -0.4, 0.3);
    let curvature = Vector3::new(2.0 * a, 2.0 * b, 2.0 * c);
    let exact = 0.5 * area * curvature.dot(&(SECTION.bending() * curvature));
    // w = a x² + b y² + c x y, with θ_x = w_y and θ_y = −w_x.
    let field = |x: f64, y: f64| {
        let w = a * x * x + b * y * y + c * x * y;
        [
            0.0,
            0.0,
            w,
            2.0 * b * y + c * x,
            -(2.0 * a * x + c * y),
            0.0,
        ]
    };
    let ratio = |kind| energy_of(&rest, kind, field) / exact;
    assert!((ratio(ElementKind::Bezier) - 1.0).abs() < 1e-12);
    assert!((ratio(ElementKind::DktAndes) - 1.0).abs() < 1e-12);
    // The printed rule for the central point does not reproduce quadratics.
    assert!(
        ratio(ElementKind::BezierPaper) > 1.1,
        "{}",
        ratio(ElementKind::BezierPaper)
    );
}

#[test]
fn a_rectangle_of_two_optimal_triangles_bends_exactly_in_its_plane() {
    for (a, b) in [(1.0, 1.0), (4.0, 1.0), (1.0, 5.0)] {
        let corners =
            [[-a, -b], [a, -b], [a, b], [-a, b]].map(|[x, y]: [f64; 2]| [0.5 * x, 0.5 * y]);
        let halves = [[0, 1, 2], [0, 2, 3]].map(|f| flat(f.map(|v| corners[v])));
        let nu = SECTION.poissons_ratio;
        let field = |x: f64, y: f64| [x * y, -0.5 * (x * x + nu * y * y), 0.0, 0.0, 0.0, -x];
        let energy: f64 = halves
            .iter()
            .map(|h| energy_of(h, ElementKind::DktAndes, field))
            .sum();
        // ½ E t κ² ∫ y²
        let exact = 0.5 * SECTION.youngs_modulus * SECTION.thickness * a * b.powi(3) / 12.0;
        assert!(
            (energy / exact - 1.0).abs() < 1e-12,
            "{a} × {b}: {}",
            energy / exact
        );
    }
}

#[test]
fn an_inverted_or_flat_element_is_refused() {
    let mut rest = rest();
    rest.normals[1] = -rest.normals[1];
    let made = Element::new(&rest, ElementKind::Bezier, FrameRule::Polar, 7);
    assert_eq!(
        made.err(),
        Some(BezierError::Inverted {
            element: 7,
            corner: 1
        })
    );
    rest.corners[2] = 0.5 * (rest.corners[0] + rest.corners[1]);
    let made = Element::new(&rest, ElementKind::Bezier, FrameRule::Polar, 7);
    assert_eq!(made.err(), Some(BezierError::NoArea { element: 7 }));
}

#[test]
fn the_response_does_not_depend_on_which_corner_comes_first() {
    let rest = rest();
    let (x, turns) = pose(&rest, 0.1);
    for kind in [ElementKind::Bezier, ElementKind::DktAndes] {
        let first = element(&rest, kind, FrameRule::Polar)
            .state(&x, &turns)
            .unwrap();
        for shift in 1..3 {
            let order = [0, 1, 2].map(|i| (i + shift) % 3);
            let other = RestElement {
                corners: order.map(|i| rest.corners[i]),
                normals: order.map(|i| rest.normals[i]),
                attached: rest.attached,
                section: rest.section,
            };
            let state = element(&other, kind, FrameRule::Polar)
                .state(&order.map(|i| x[i]), &order.map(|i| turns[i]))
                .unwrap();
            for i in 0..3 {
                for part_of in [0, 3] {
                    let difference = part(&state.gradient, 6 * i + part_of)
                        - part(&first.gradient, 6 * order[i] + part_of);
                    // Round-off of a stiffness of another frame.
                    assert!(
                        difference.norm() < 1e-11 * first.gradient.norm(),
                        "{kind:?}"
                    );
                }
            }
        }
    }
}
