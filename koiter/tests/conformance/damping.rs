//! Energies that are there for damping: squares of strains, and the tangents of texts.

use koiter::assembly::{
    Assembled, Differentiated, Dof, DofLayout, Energy, LocalEnergy, RestMeasures,
};
use koiter::energy::bending::{
    HingeStrains, LaplacianMesh, SecondOrderEdges, SecondOrderFaces, VertexStrains,
};
use koiter::energy::expression::{Elements, PotentialDamping, WholeDamping};
use koiter::testing::{Claims, check, check_claims, check_global};

use super::expressions::{edges, faces, hinges, potential, vertices, whole};
use super::setup::*;
use super::{check_rest_measures, second_order};

/// Strains are 0 in a flat shape, do not change with rigid motions, and pull at nothing where they are what is measured.
#[test]
fn strains_of_hinges_conform() {
    let s = patch(0.0);
    let mut energy = Assembled::new(
        Differentiated(HingeStrains::new(quadratic_hinge(&s))),
        &s.layout,
    );
    check_claims(&energy, &s.layout, &s.q, &claims_of(&s)).unwrap();
    check_global(&mut energy, &s.layout, &s.q).unwrap();
    let flat = RestMeasures::measure(&energy, &s.at_rest);
    assert!(flat.iter().all(|strain| strain.abs() < 1e-14), "{flat:?}");
    let squares = Differentiated(HingeStrains::new(quadratic_hinge(&s)));
    check_rest_measures(&s, &s.layout, &s.q, squares);
}

/// Where strains are those of rest nothing pulls.
fn check_rest_of<const N: usize, const K: usize>(
    layout: &DofLayout,
    q: &[f64],
    local: impl LocalEnergy<N, K>,
) {
    let mut energy = Assembled::new(local, layout);
    assert!(energy.value(q) > 1e-3);
    let now = RestMeasures::measure(&energy, q);
    energy.set_rest(&now);
    let mut gradient = vec![0.0; q.len()];
    energy.add_gradient(q, &mut gradient);
    let largest = gradient.iter().fold(0.0f64, |m, g| m.max(g.abs()));
    assert!(largest < 1e-14 && energy.value(q) < 1e-28, "{largest}");
}

/// With rest values derivatives are those of the formula with rest values.
#[test]
fn second_order_shells_take_rest_values() {
    let s = patch(0.0);
    let (layout, points, q, _) = second_order(&s);
    let rigidities = vec![0.7; s.frames.len()];
    let (frames, r) = (s.frames.clone(), rigidities.clone());
    let claims = Claims {
        rigid_motion_invariant: true,
        ..Claims::default()
    };
    let faces = || SecondOrderFaces::new(&s.rest.mesh, Dof(0), points, frames.clone(), r.clone());
    check_rest_of(&layout, &q, faces());
    let mut faces = faces();
    (0..faces.num_stencils()).for_each(|face| faces.set_rest(face, &[0.3, -0.2, 0.05]));
    check(faces, &layout, &q, |e, f, q| e.formula(f, q), &claims).unwrap();
    let edges = || SecondOrderEdges::new(&s.rest, Dof(0), points, &s.frames, &rigidities);
    // What keeps patches from degenerating is no damping.
    check_rest_of(&layout, &q, edges().with_area_stiffness(0.0));
    let mut edges = edges();
    (0..edges.num_stencils()).for_each(|edge| edges.set_rest(edge, &[0.2, -0.1]));
    check(edges, &layout, &q, |e, i, q| e.formula(i, q), &claims).unwrap();
}

#[test]
fn the_strain_of_a_fold_is_all_of_quadratic_bending() {
    let s = patch(0.0);
    let model = quadratic_hinge(&s);
    let squares = Differentiated(HingeStrains::new(quadratic_hinge(&s)));
    let gathered = Assembled::new(quadratic_hinge(&s), &s.layout);
    for hinge in 0..model.num_stencils() {
        let mut q = gathered.gather(hinge, &s.at_rest);
        let x = |i: usize| koiter::Vec3::new(q[3 * i], q[3 * i + 1], q[3 * i + 2]);
        let axis = (x(1) - x(0)).normalize();
        let turned = nalgebra::Rotation3::new(axis * 1.1) * (x(3) - x(0)) + x(0);
        q.fixed_rows_mut::<3>(9).copy_from(&turned);
        let (of_model, of_strain) = (model.value(hinge, &q), squares.value(hinge, &q));
        assert!(
            of_model > 1e-3 && (of_strain / of_model - 1.0).abs() < 1e-12,
            "{of_model} {of_strain}"
        );
    }
}

#[test]
fn mean_curvatures_at_vertices_conform() {
    for laplacian in [LaplacianMesh::Extrinsic, LaplacianMesh::IntrinsicDelaunay] {
        let s = patch(0.0);
        let mut energy = VertexStrains::new(quadratic_vertex(&s, laplacian), &s.rest.mesh);
        let claims = claims_of(&s);
        check_claims(&energy, &s.layout, &s.q, &claims).unwrap();
        // Central differences of values, of an error that falls with h².
        let direction: Vec<f64> = (0..s.q.len()).map(|i| ((i * 5 + 2) as f64).cos()).collect();
        let mut gradient = vec![0.0; s.q.len()];
        energy.add_gradient(&s.q, &mut gradient);
        let slope: f64 = gradient.iter().zip(&direction).map(|(g, d)| g * d).sum();
        let at = |h: f64| {
            let moved = s.q.iter().zip(&direction).map(|(x, d)| x + h * d);
            energy.value(&moved.collect::<Vec<_>>())
        };
        let errors = [4e-4, 2e-4].map(|h| ((at(h) - at(-h)) / (2.0 * h) - slope).abs());
        assert!((3.5..4.5).contains(&(errors[0] / errors[1])), "{errors:?}");
        // Where strains are those of rest, second derivatives are exact.
        let now = RestMeasures::measure(&energy, &s.q);
        energy.set_rest(&now);
        check_global(&mut energy, &s.layout, &s.q).unwrap();
    }
}

fn claims_of(s: &Setup) -> Claims {
    Claims {
        rigid_motion_invariant: true,
        rest: Some(s.at_rest.clone()),
        ..Claims::default()
    }
}

/// The damping of a text that is quadratic in strains is the text itself with other rest values.
#[test]
fn the_damping_of_a_quadratic_text_is_its_energy_about_the_shape_before() {
    fn check_text<const N: usize, const K: usize, E: Elements<N, K>>(
        s: &Setup,
        elements: E,
        text: &str,
    ) {
        let written = potential(elements, text);
        let mut damping = Assembled::new(
            Differentiated(PotentialDamping::new(written.0.clone())),
            &s.layout,
        );
        let rest = RestMeasures::measure(&damping, &s.at_rest);
        damping.set_rest(&rest);
        let energy = Assembled::new(written, &s.layout);
        let (a, b) = (damping.value(&s.q), energy.value(&s.q));
        assert!(b > 0.0 && (a / b - 1.0).abs() < 1e-10, "{text}: {a} {b}");
        check_global(&mut damping, &s.layout, &s.q).unwrap();
        check_claims(&damping, &s.layout, &s.q, &claims_of(s)).unwrap();
    }
    let s = patch(1.0);
    check_text(&s, edges(&s), "k * (length / rest_length - 1)^2");
    check_text(&s, hinges(&s), "k * (angle - rest_angle)^2 / rest_height");
    check_text(
        &s,
        faces(&s),
        "k * (c * strain_trace^2 + strain_11^2 + 2 * strain_12^2 + strain_22^2)",
    );
}

#[test]
fn what_is_linear_or_concave_is_not_damped() {
    let s = patch(1.0);
    let linear = potential(edges(&s), "k * length");
    let mut damping = Assembled::new(Differentiated(PotentialDamping::new(linear.0)), &s.layout);
    let rest = RestMeasures::measure(&damping, &s.at_rest);
    damping.set_rest(&rest);
    assert_eq!(damping.value(&s.q), 0.0);
    // What is linear in the shape may well be more than linear together with what no motion changes.
    let weight = potential(vertices(&s), "mass * 9.81 * z");
    let mut damping = Assembled::new(Differentiated(PotentialDamping::new(weight.0)), &s.layout);
    let rest = RestMeasures::measure(&damping, &s.at_rest);
    damping.set_rest(&rest);
    assert_eq!(damping.value(&s.q), 0.0);
    for (text, is_damped) in [
        ("volume - area^2", false),
        ("k * (volume - 2 * rest_volume)^2", true),
    ] {
        let mut damping = WholeDamping::new(whole(&s, text));
        damping.set_rest(&RestMeasures::measure(&damping, &s.at_rest));
        assert_eq!(damping.value(&s.q) > 0.0, is_damped, "{text}");
    }
}
