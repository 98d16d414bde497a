//! Bending of a face by one curvature an edge: the element of CH(FS) and M-e. Av.
//!
//! ```text
//! E = W(q₀, q₁, q₂),     q_c = f(a_c, a_c', θ_c)
//! ```
//!
//! a_c, a_c' altitudes over edge c in the face and in its neighbour [m], θ_c hinge angle; q_c = 0 on boundary edges. The
//! unknowns are the corners and the opposite vertices of the three neighbours. A [`FaceLaw`] gives f and W; the Hessian
//! is `Jᵀ (∂²W) J + Σ (∂W/∂q_c) ∇²q_c` with J = ∂q.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::bending_stencil::BendingStencil;
use super::hinge_function::{DeformedHinge, HingeFunction};
use super::quadratic_form::QuadraticForm;
use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian};

/// W with its derivatives by the q_c.
pub struct FaceResponse {
    pub(super) value: f64,
    pub(super) moments: Vector3<f64>,
    /// Positive semidefinite.
    pub(super) tangent: Matrix3<f64>,
}

/// What a model of this kind adds: which curvature, which energy.
pub trait FaceLaw: Send + Sync {
    /// q_c with its derivatives.
    fn curvature(&self, face: usize, corner: usize, hinge: &DeformedHinge) -> HingeFunction;
    /// W.
    fn response(&self, face: usize, curvatures: &Vector3<f64>) -> FaceResponse;
    /// What of the q_c is compared with rest values.
    fn measure(&self, face: usize, curvatures: &Vector3<f64>) -> Vector3<f64>;
    /// These rest values.
    fn rest(&self, face: usize) -> Vector3<f64>;
    /// Replaces them.
    fn set_rest(&mut self, face: usize, rest: Vector3<f64>);
}

/// Bending energy of one shell with the law `L`.
pub struct FaceBending<L> {
    stencils: Vec<BendingStencil>,
    /// Edges across which the neighbour has gone; empty: none.
    cuts: Vec<[bool; 3]>,
    pub(super) law: L,
}

/// The hinge at an edge of a face and its curvature; none on the boundary.
type Corner = Option<(DeformedHinge, HingeFunction)>;

impl<L: FaceLaw> FaceBending<L> {
    pub(super) fn with_law(stencils: Vec<BendingStencil>, law: L) -> Self {
        let cuts = Vec::new();
        Self {
            stencils,
            cuts,
            law,
        }
    }

    fn corners(&self, face: usize, q: &SVector<f64, 18>) -> [Corner; 3] {
        std::array::from_fn(|c| {
            if !self.has_neighbor(face, c) {
                return None;
            }
            let point = |i: usize| Vec3::new(q[3 * i], q[3 * i + 1], q[3 * i + 2]);
            let hinge = DeformedHinge::new(&nodes(c).map(point));
            let curvature = self.law.curvature(face, c, &hinge);
            Some((hinge, curvature))
        })
    }

    /// Whether edge `c` of the face has a neighbour that is there.
    pub(super) fn has_neighbor(&self, face: usize, c: usize) -> bool {
        let is_cut = self.cuts.get(face).is_some_and(|edges| edges[c]);
        self.stencils[face].across[c].is_some() && !is_cut
    }

    /// The q_c.
    pub(super) fn curvatures(&self, face: usize, q: &SVector<f64, 18>) -> Vector3<f64> {
        values(&self.corners(face, q))
    }

    fn derivatives(&self, face: usize, q: &SVector<f64, 18>, kept: f64) -> LocalHessian<18> {
        let corners = self.corners(face, q);
        let response = self.law.response(face, &values(&corners));
        let mut hessian = SMatrix::<f64, 18, 18>::zeros();
        let mut jacobian = SMatrix::<f64, 3, 18>::zeros();
        for (c, corner) in corners.iter().enumerate() {
            let Some((hinge, curvature)) = corner else {
                continue;
            };
            let mut form = QuadraticForm::zero(kept);
            let slope = curvature.add_to(response.moments[c], hinge, &mut form);
            let place = |i: usize| 3 * nodes(c)[i / 3] + i % 3;
            for j in 0..12 {
                jacobian[(c, place(j))] = slope[j];
                for i in 0..12 {
                    hessian[(place(i), place(j))] += form.rows[j][i];
                }
            }
        }
        LocalHessian {
            value: response.value,
            gradient: jacobian.transpose() * response.moments,
            hessian: hessian + jacobian.transpose() * response.tangent * jacobian,
        }
    }
}

/// The vertices of the hinge at edge `c` among the six of a face.
pub(super) fn nodes(c: usize) -> [usize; 4] {
    [(c + 1) % 3, (c + 2) % 3, c, 3 + c]
}

fn values(corners: &[Corner; 3]) -> Vector3<f64> {
    Vector3::from_fn(|c, _| corners[c].as_ref().map_or(0.0, |(_, q)| q.value))
}

impl<L: FaceLaw> LocalEnergy<18, 6> for FaceBending<L> {
    const NODE_SIZES: [usize; 6] = [3; 6];
    const MEASURES: usize = 3;

    fn name(&self) -> &'static str {
        "bending"
    }

    fn num_stencils(&self) -> usize {
        self.stencils.len()
    }

    fn nodes(&self, face: usize) -> [Option<Dof>; 6] {
        let stencil = &self.stencils[face];
        let ([a, b, c], [d, e, f]) = (stencil.corners.map(Some), stencil.across);
        [a, b, c, d, e, f]
    }

    fn value(&self, face: usize, q: &SVector<f64, 18>) -> f64 {
        self.law.response(face, &self.curvatures(face, q)).value
    }

    fn gradient(&self, face: usize, q: &SVector<f64, 18>) -> (f64, SVector<f64, 18>) {
        let corners = self.corners(face, q);
        let response = self.law.response(face, &values(&corners));
        let mut gradient = SVector::<f64, 18>::zeros();
        for (c, corner) in corners.iter().enumerate() {
            if let Some((hinge, curvature)) = corner {
                for (v, node) in curvature.gradient(hinge).iter().zip(nodes(c)) {
                    let mut part = gradient.fixed_rows_mut::<3>(3 * node);
                    part += v * response.moments[c];
                }
            }
        }
        (response.value, gradient)
    }

    fn hessian(&self, face: usize, q: &SVector<f64, 18>) -> LocalHessian<18> {
        self.derivatives(face, q, 1.0)
    }

    fn projected_hessian(&self, face: usize, q: &SVector<f64, 18>, kept: f64) -> LocalHessian<18> {
        self.derivatives(face, q, kept)
    }

    fn measure(&self, face: usize, q: &SVector<f64, 18>, measures: &mut [f64]) {
        let measured = self.law.measure(face, &self.curvatures(face, q));
        measures.copy_from_slice(measured.as_slice());
    }

    fn rest(&self, face: usize, measures: &mut [f64]) {
        measures.copy_from_slice(self.law.rest(face).as_slice());
    }

    fn set_rest(&mut self, face: usize, measures: &[f64]) {
        self.law
            .set_rest(face, Vector3::from_column_slice(measures));
    }

    fn set_cut(&mut self, face: usize, edges: [bool; 3]) {
        self.cuts.resize(self.stencils.len(), [false; 3]);
        self.cuts[face] = edges;
    }

    fn describe(&self, face: usize) -> String {
        format!("face {face}")
    }
}
