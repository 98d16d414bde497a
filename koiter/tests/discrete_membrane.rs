//! The membrane of Discrete Shells has the stiffness of its material, as far as springs can.

use koiter::Vec3;
use koiter::assembly::{Assembled, Dof, DofLayout, Energy, LocalEnergy};
use koiter::energy::{DiscreteStiffness, EdgeLengths, FaceAreas, Membrane};
use koiter::material::{Homogeneous, StVenantKirchhoff};
use koiter::mesh::generate::irregular;
use koiter::mesh::{Surface, TriMesh};
use koiter::rest::rest_frames;
use nalgebra::SVector;

const YOUNG: f64 = 2e5;
const THICKNESS: f64 = 0.01;

/// Energies of Koiter's membrane and of the springs when a square is strained by `(ε₁₁, ε₂₂, ε₁₂)`.
fn energies(poisson: f64, area: f64, strain: [f64; 3]) -> [f64; 2] {
    let rest: Surface = irregular(1.0, 1.0, area, 3).unwrap();
    let frames = rest_frames(&rest).unwrap();
    let material = StVenantKirchhoff::new(YOUNG, poisson);
    let section = Homogeneous::uniform(material, THICKNESS, frames.len());
    let mut layout = DofLayout::new();
    layout.push_nodes(rest.positions.len(), 3, true);
    let strained = rest.positions.iter().flat_map(|x| {
        let [a, b, c] = strain;
        [x.x + a * x.x + c * x.y, x.y + c * x.x + b * x.y, x.z]
    });
    let q: Vec<f64> = strained.collect();
    let (mesh, given) = (&rest.mesh, DiscreteStiffness::default());
    let lengths = EdgeLengths::new(mesh, Dof(0), &frames, &section, given);
    let areas = FaceAreas::new(mesh, Dof(0), &frames, &section, given);
    let springs =
        Assembled::new(lengths, &layout).value(&q) + Assembled::new(areas, &layout).value(&q);
    let koiter = Membrane::new(mesh, Dof(0), frames, section);
    [Assembled::new(koiter, &layout).value(&q), springs]
}

#[test]
fn small_strains_cost_what_they_cost_in_the_material() {
    // Edges of an irregular mesh have all directions, up to chance.
    for strain in [
        [1e-4, 0.0, 0.0],
        [0.0, 1e-4, 0.0],
        [1e-4, 1e-4, 0.0],
        [0.0, 0.0, 1e-4],
    ] {
        for poisson in [1.0 / 3.0, 0.45] {
            let [koiter, springs] = energies(poisson, 2.5e-3, strain);
            assert!(
                (springs / koiter - 1.0).abs() < 0.05,
                "{strain:?} {poisson}: {koiter} {springs}"
            );
        }
    }
}

#[test]
fn the_stiffness_of_the_material_does_not_depend_on_the_size_of_triangles() {
    let [coarse, fine] = [1e-2, 1.2e-3].map(|area| energies(0.4, area, [1e-4, 2e-5, 0.0]));
    for [koiter, springs] in [coarse, fine] {
        assert!((springs / koiter - 1.0).abs() < 0.05, "{koiter} {springs}");
    }
}

#[test]
fn a_ratio_below_a_third_acts_as_a_third() {
    // The shear modulus is that of the material, so in shear nothing is lost.
    let [koiter, springs] = energies(0.0, 2.5e-3, [0.0, 0.0, 1e-4]);
    assert!((springs / koiter - 1.0).abs() < 0.05, "{koiter} {springs}");
    // All around: E/(1 − ν) with ν = 1/3 and the same shear modulus is twice that with ν = 0.
    let [koiter, springs] = energies(0.0, 2.5e-3, [1e-4, 1e-4, 0.0]);
    assert!((springs / koiter - 2.0).abs() < 0.1, "{koiter} {springs}");
}

/// The largest difference, over the largest entry, between the stress stiffness of a motion in the plane of a flat face and
/// the change of the Hessian along it, out of the plane, where the change of shape has no part.
fn stress_stiffness_error<const N: usize, const K: usize>(energy: &impl LocalEnergy<N, K>) -> f64 {
    let at_rest = |i: usize| [0.0, 0.0, 0.0, 1.0, 0.2, 0.0, 0.3, 0.9, 0.0][i];
    let q = SVector::<f64, N>::from_fn(|i, _| at_rest(i));
    let motion = SVector::from_fn(|i, _| {
        if i % 3 == 2 {
            0.0
        } else {
            (i as f64 + 0.4).sin()
        }
    });
    let found = energy.stress_stiffness(0, &q, &motion).unwrap();
    // Third derivatives are of the order of one: the error of the difference is about the square of the step.
    let step = 1e-5;
    let hessian = |s: f64| energy.hessian(0, &(q + motion * s)).hessian;
    let change = (hessian(step) - hessian(-step)) / (2.0 * step);
    let upright = (0..N * N)
        .map(|k| (k / N, k % N))
        .filter(|(i, j)| i % 3 == 2 && j % 3 == 2);
    let (mut error, mut size) = (0.0f64, 0.0f64);
    for (i, j) in upright {
        error = error.max((found[(i, j)] - change[(i, j)]).abs());
        size = size.max(change[(i, j)].abs());
    }
    error / size
}

#[test]
fn stresses_of_a_motion_stiffen_as_the_hessian_changes() {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.2, 0.0], [0.3, 0.9, 0.0]].map(Vec3::from);
    let mesh = TriMesh::new(3, vec![[0, 1, 2]]).unwrap();
    let rest = Surface::from_mesh(mesh, positions.to_vec()).unwrap();
    let frames = rest_frames(&rest).unwrap();
    let section = Homogeneous::uniform(StVenantKirchhoff::new(YOUNG, 0.4), THICKNESS, 1);
    let given = DiscreteStiffness::default();
    let errors = [
        stress_stiffness_error(&EdgeLengths::new(
            &rest.mesh,
            Dof(0),
            &frames,
            &section,
            given,
        )),
        stress_stiffness_error(&FaceAreas::new(
            &rest.mesh,
            Dof(0),
            &frames,
            &section,
            given,
        )),
        stress_stiffness_error(&Membrane::new(&rest.mesh, Dof(0), frames.clone(), section)),
    ];
    for error in errors {
        assert!(error < 1e-8, "{errors:?}");
    }
}
