//! Quadratic bending at vertices, QB(PL) and QB(int): what the operator of a flat sheet must do.

use koiter::Vec3;
use koiter::assembly::{
    DofLayout, Energy, HessianBuilder, Pattern, PatternBuilder, PsdProjection, SymmetricMatrix,
};
use koiter::energy::bending::{LaplacianMesh, QuadraticVertex};
use koiter::mesh::{Surface, TriMesh};
use koiter::rest::rest_frames;
use nalgebra::{DMatrix, DVector};

const BOTH: [LaplacianMesh; 2] = [LaplacianMesh::Extrinsic, LaplacianMesh::IntrinsicDelaunay];

/// A flat sheet of `n × n` cells, whose inner vertices are moved and whose cells are sheared; in a tilted plane.
fn sheet(n: u32, shear: f64) -> Surface {
    let (u, v) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(-0.48, 0.36, 0.8));
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let inner = i > 0 && j > 0 && i < n && j < n;
            let moved = |k: u32| {
                if inner {
                    0.1 * f64::from(7 * i + k * j).sin()
                } else {
                    0.0
                }
            };
            let (x, y) = (f64::from(i) + moved(3), f64::from(j) + moved(5));
            positions.push(u * (x + shear * y) + v * y);
            if i < n && j < n {
                let k = j * (n + 1) + i;
                faces.push([k, k + 1, k + n + 2]);
                faces.push([k, k + n + 2, k + n + 1]);
            }
        }
    }
    let mesh = TriMesh::new(positions.len(), faces).unwrap();
    Surface { mesh, positions }
}

fn bending(rest: &Surface, laplacian: LaplacianMesh) -> (QuadraticVertex, DofLayout) {
    let mut layout = DofLayout::new();
    let first = layout.push_nodes(rest.mesh.num_vertices(), 3, true);
    let rigidity = vec![0.7; rest.mesh.num_faces()];
    let frames = rest_frames(rest).unwrap();
    let energy = QuadraticVertex::new(rest, first, &layout, &frames, &rigidity, laplacian);
    (energy, layout)
}

fn unknowns(positions: impl Iterator<Item = Vec3>) -> Vec<f64> {
    positions.flat_map(|x| [x.x, x.y, x.z]).collect()
}

/// The assembled Hessian, dense.
fn hessian(mut energy: QuadraticVertex, layout: &DofLayout) -> DMatrix<f64> {
    let q = vec![0.0; layout.num_dofs()];
    let mut builder = PatternBuilder::default();
    energy.add_to_pattern(&q, &mut builder);
    let pattern = std::sync::Arc::new(Pattern::new(layout, &builder.finish()));
    energy.bind(&pattern);
    let mut matrix = SymmetricMatrix::zeros(pattern);
    let mut builder = HessianBuilder {
        matrix: &mut matrix,
        layout,
        prescribed_step: &[],
        coupling: &mut vec![0.0; q.len()],
    };
    let mut gradient = vec![0.0; q.len()];
    energy.add_derivatives(&q, PsdProjection::Exact, &mut gradient, &mut builder);
    let column = |j: usize| {
        let mut unit = vec![0.0; q.len()];
        unit[j] = 1.0;
        DVector::from_vec(matrix.multiply(&unit))
    };
    DMatrix::from_columns(&(0..q.len()).map(column).collect::<Vec<_>>())
}

#[test]
fn linear_functions_are_annihilated_at_the_boundary_too() {
    for (laplacian, shear) in [
        (BOTH[0], 0.0),
        (BOTH[0], 1.7),
        (BOTH[1], 0.0),
        (BOTH[1], 1.7),
    ] {
        let rest = sheet(6, shear);
        let (energy, _) = bending(&rest, laplacian);
        let affine = |x: &Vec3| {
            Vec3::new(x.x - 2.0 * x.z, 0.3 * x.y + x.x, 1.5 * x.z - x.y) + Vec3::new(4.0, -1.0, 2.0)
        };
        let q = unknowns(rest.positions.iter().map(affine));
        for vertex in 0..rest.mesh.num_vertices() {
            // Positions of the size 10, weights of the size 1.
            let found = energy.laplacian(vertex, &q).norm();
            assert!(found < 1e-13, "{laplacian:?} {shear} {vertex}: {found:.1e}");
        }
        // Not because everything is: a bent sheet has energy.
        let bent = unknowns(
            rest.positions
                .iter()
                .map(|x| Vec3::new(x.x, x.y, x.x * x.x)),
        );
        assert!(energy.value(&bent) > 1.0);
    }
}

#[test]
fn the_hessian_is_positive_semidefinite_with_the_linear_functions_as_kernel() {
    for laplacian in BOTH {
        let rest = sheet(3, 0.8);
        let (energy, layout) = bending(&rest, laplacian);
        let matrix = hessian(energy, &layout);
        let mut eigenvalues: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
        eigenvalues.sort_by(f64::total_cmp);
        // 1 and the two coordinates of the plane, for each of x, y, z; 1e-13 is round-off of 48 rows.
        let largest = eigenvalues[eigenvalues.len() - 1];
        assert!(eigenvalues[..9].iter().all(|e| e.abs() < 1e-13 * largest));
        assert!(eigenvalues[9] > 1e-6 * largest, "{:?}", &eigenvalues[..12]);
    }
}

#[test]
fn on_a_delaunay_mesh_both_are_the_same() {
    // Nearly equilateral triangles.
    let rest = sheet(6, -0.5);
    let bent = unknowns((rest.positions.iter()).map(|x| Vec3::new(x.x, x.y.sin(), x.x * x.z)));
    let [extrinsic, intrinsic] = BOTH.map(|l| bending(&rest, l).0.value(&bent));
    assert_eq!(extrinsic, intrinsic);
    let sheared = sheet(6, 1.7);
    let [extrinsic, intrinsic] = BOTH.map(|l| bending(&sheared, l).0.value(&bent));
    assert!(extrinsic > 1.05 * intrinsic, "{extrinsic} {intrinsic}");
}
