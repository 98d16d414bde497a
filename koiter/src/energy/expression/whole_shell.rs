//! The volume and the area of a whole shell, and functions of both.
//!
//! ```text
//! V = Σ_f x₀·(x₁ × x₂)/6,    A = Σ_f |(x₁ − x₀) × (x₂ − x₀)|/2
//! ∇²f = f_V ∇²V + f_A ∇²A + Σ_i λ_i g_i g_iᵀ,    g_i = u_i · (∇V, ∇A)
//! ```
//!
//! λ_i, u_i eigenvalues and eigenvectors of the second derivatives of f. The first two terms couple what shares a face. The
//! last couples everything with everything: it is handed on as what it is, matrices of rank one.
//!
//! ∇²V depends, face by face, on the origin, which is the mean of the start positions here; only the sum does not. As with
//! [`crate::energy::loads::Pressure`], of a projected Hessian only the share of it that is kept is formed.

use nalgebra::{Matrix2, SMatrix, SVector};

use crate::Vec3;
use crate::assembly::{
    Dof, DofLayout, HessianBuilder, LowRank, NodeId, PatternBuilder, PsdProjection, ordered_sum,
    parallel_map, project_to_psd, variables,
};
use crate::geometry::over_numbers::{cross, dot, norm, point, sub};
use crate::geometry::{Dual, Jet, Real};

/// The faces of a shell as a whole.
#[derive(Clone, Debug)]
pub(super) struct WholeShell {
    faces: Vec<[(Dof, NodeId); 3]>,
    /// From where volumes are measured [m].
    origin: Vec3,
}

impl WholeShell {
    /// `faces` by the first unknowns of their corners, `rest` by their positions at rest. Second, volume and area at rest.
    pub(super) fn new(
        faces: &[[Dof; 3]],
        layout: &DofLayout,
        rest: &[[Vec3; 3]],
    ) -> (Self, [f64; 2]) {
        let corners = rest.iter().flatten();
        let origin = corners.sum::<Vec3>() / (3 * rest.len()).max(1) as f64;
        let measures = rest.iter().map(|corners| {
            let q = std::array::from_fn(|i| corners[i / 3][i % 3]);
            measures::<f64>(&q, &origin)
        });
        let at_rest = measures.fold([0.0; 2], |[v, a], [dv, da]| [v + dv, a + da]);
        let nodes = |face: &[Dof; 3]| face.map(|dof| (dof, layout.node(dof)));
        let faces = faces.iter().map(nodes).collect();
        (Self { faces, origin }, at_rest)
    }

    fn corners(&self, face: usize, q: &[f64]) -> SVector<f64, 9> {
        let starts = self.faces[face].map(|(dof, _)| dof.0 as usize);
        SVector::from_fn(|i, _| q[starts[i / 3] + i % 3])
    }

    /// V and A.
    pub(super) fn measures(&self, q: &[f64]) -> [f64; 2] {
        [0, 1].map(|which| {
            ordered_sum(self.faces.len(), |face| {
                let q = self.corners(face, q);
                measures::<f64>(&std::array::from_fn(|i| q[i]), &self.origin)[which]
            })
        })
    }

    /// Adds `by[0]` ∇V + `by[1]` ∇A.
    pub(super) fn add_slopes(&self, q: &[f64], by: [f64; 2], gradient: &mut [f64]) {
        let slopes = parallel_map(self.faces.len(), |face| {
            let q = self.corners(face, q);
            let q: [Dual<9>; 9] = std::array::from_fn(|i| Dual::variable(q[i], i));
            let [volume, area] = measures(&q, &self.origin);
            *(volume * by[0] + area * by[1]).gradient()
        });
        for (face, slope) in self.faces.iter().zip(slopes) {
            for (k, (dof, _)) in face.iter().enumerate() {
                for axis in 0..3 {
                    gradient[dof.0 as usize + axis] += slope[3 * k + axis];
                }
            }
        }
    }

    /// f_V ∇²V + f_A ∇²A of one face.
    fn sparse_part(&self, face: usize, q: &[f64], by: &Jet<2>, kept: f64) -> SMatrix<f64, 9, 9> {
        let [volume, area] = measures(&variables(&self.corners(face, q)), &self.origin);
        let [by_volume, by_area] = *by.gradient();
        let mut hessian = SMatrix::from_fn(|i, j| by_area * area.hessian(i, j));
        if kept < 1.0 {
            project_to_psd(&mut hessian, kept);
        }
        hessian + SMatrix::from_fn(|i, j| kept * by_volume * volume.hessian(i, j))
    }

    /// Adds ∇f and what of ∇²f couples faces only, by the derivatives of f by V and A.
    pub(super) fn add_derivatives(
        &self,
        q: &[f64],
        by: &Jet<2>,
        projection: PsdProjection,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        self.add_slopes(q, *by.gradient(), gradient);
        let locals = parallel_map(self.faces.len(), |face| {
            self.sparse_part(face, q, by, projection.kept())
        });
        for (face, local) in self.faces.iter().zip(&locals) {
            for (i, (_, a)) in face.iter().enumerate() {
                for (j, (_, b)) in face[..=i].iter().enumerate() {
                    let entry = |r, c| local[(3 * i + r, 3 * j + c)];
                    hessian.add(*a, *b, i == j, entry);
                }
            }
        }
    }

    /// Σ λ_i g_i g_iᵀ.
    pub(super) fn low_rank(&self, q: &[f64], by: &Jet<2>) -> Vec<LowRank> {
        let second = Matrix2::from_fn(|i, j| by.hessian(i, j));
        if !second.iter().all(|entry| entry.is_finite()) {
            return Vec::new();
        }
        let eigen = second.symmetric_eigen();
        let curved = (0..2).filter(|&i| eigen.eigenvalues[i] != 0.0);
        curved
            .map(|i| {
                let mut vector = vec![0.0; q.len()];
                let u = eigen.eigenvectors.column(i);
                self.add_slopes(q, [u[0], u[1]], &mut vector);
                LowRank {
                    weight: eigen.eigenvalues[i],
                    vector,
                }
            })
            .collect()
    }

    pub(super) fn add_to_pattern(&self, pattern: &mut PatternBuilder) {
        for face in &self.faces {
            pattern.couple(face.map(|(_, node)| node));
        }
    }

    /// An unknown of the shell.
    pub(super) fn first_unknown(&self) -> Option<Dof> {
        self.faces.first().map(|face| face[0].0)
    }
}

/// Volume and area of a face.
fn measures<R: Real>(q: &[R; 9], origin: &Vec3) -> [R; 2] {
    let corners: [[R; 3]; 3] = [0, 1, 2].map(|c| {
        let x = point(q, c);
        std::array::from_fn(|axis| x[axis] - origin[axis])
    });
    let [e1, e2] = [1, 2].map(|c| sub(&corners[c], &corners[0]));
    let volume = dot(&corners[0], &cross(&corners[1], &corners[2]));
    [volume * (1.0 / 6.0), norm(&cross(&e1, &e2)) * 0.5]
}
