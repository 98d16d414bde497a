//! Energies that are there for damping: squares of strains, and the tangents of texts.

use koiter::assembly::{
    Assembled, Differentiated, Dof, DofLayout, Energy, LocalEnergy, RestMeasures,
};
use koiter::energy::bending::{
    BendingStrains, LaplacianMesh, SecondOrderEdges, SecondOrderFaces, StrainSquares, VertexStrains,
};
use koiter::energy::expression::{Elements, PotentialDamping, WholeDamping};
use koiter::testing::{Claims, check_claims, check_global};

use super::expressions::{edges, faces, hinges, potential, whole};
use super::setup::*;
use super::{check_rest_measures, second_order};

/// Strains are 0 in a flat shape, do not change with rigid motions, and pull at nothing where they are what is measured.
fn check_strains<const N: usize, const K: usize, L: BendingStrains<N, K>>(
    layout: &DofLayout,
    [q, at_rest]: [&[f64]; 2],
    model: L,
) {
    let mut energy = Assembled::new(Differentiated(StrainSquares::new(model)), layout);
    let claims = Claims {
        rigid_motion_invariant: true,
        rest: Some(at_rest.to_vec()),
        ..Claims::default()
    };
    check_claims(&energy, layout, q, &claims).unwrap();
    check_global(&mut energy, layout, q).unwrap();
    let flat = energy.rest_measures().unwrap().measure(at_rest);
    assert!(flat.iter().all(|strain| strain.abs() < 1e-14), "{flat:?}");
}

#[test]
fn strains_of_quadratic_bending_and_second_order_shells_conform() {
    let s = patch(0.0);
    check_strains(&s.layout, [&s.q, &s.at_rest], quadratic_hinge(&s));
    let squares = Differentiated(StrainSquares::new(quadratic_hinge(&s)));
    check_rest_measures(&s, &s.layout, &s.q, squares);
    let (layout, points, q, at_rest) = second_order(&s);
    let rigidities = vec![0.7; s.frames.len()];
    let (frames, r) = (s.frames.clone(), rigidities.clone());
    let faces = SecondOrderFaces::new(&s.rest.mesh, Dof(0), points, frames, r);
    check_strains(&layout, [&q, &at_rest], faces);
    let edges = SecondOrderEdges::new(&s.rest, Dof(0), points, &s.frames, &rigidities);
    check_strains(&layout, [&q, &at_rest], edges);
}

/// A fold keeps lengths: then the strain is all of the vector that QB(CR) squares.
#[test]
fn the_strain_of_a_fold_is_all_of_quadratic_bending() {
    let s = patch(0.0);
    let model = quadratic_hinge(&s);
    let squares = Differentiated(StrainSquares::new(quadratic_hinge(&s)));
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
    for (text, is_damped) in [
        ("volume - area^2", false),
        ("k * (volume - 2 * rest_volume)^2", true),
    ] {
        let mut damping = WholeDamping::new(whole(&s, text));
        damping.set_rest(&RestMeasures::measure(&damping, &s.at_rest));
        assert_eq!(damping.value(&s.q) > 0.0, is_damped, "{text}");
    }
}
