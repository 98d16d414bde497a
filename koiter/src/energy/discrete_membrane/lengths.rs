//! Springs on the lengths of edges.
//!
//! ```text
//! E = k ((ℓ − ℓ̄)/ℓ̄ − ε̄)²,    k = k_L ℓ̄
//! ∂E = 2 k (ε − ε̄)/ℓ̄ e,    ∂²E = 2 k / ℓ̄² (e eᵀ + (ε − ε̄) ℓ̄/ℓ (1 − e eᵀ))
//! ```
//!
//! e unit vector along the edge, ∂ by the motion of its second end relative to the first. ε̄, zero but in dampers, is a
//! strain that costs nothing. The second term is negative where an edge is short.

use nalgebra::{Matrix3, SMatrix, SVector};

use super::{DiscreteStiffness, Stiffnesses, rest_lengths};
use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian};
use crate::geometry::Real;
use crate::geometry::over_numbers::{norm, point, sub};
use crate::material::Section;
use crate::mesh::TriMesh;
use crate::rest::RestFrame;

/// The springs of all edges of one shell, boundary edges too.
pub struct EdgeLengths {
    edges: Vec<[u32; 2]>,
    first_vertex: Dof,
    /// ℓ̄.
    lengths: Vec<f64>,
    /// k [J].
    stiffness: Vec<f64>,
    /// ε̄.
    rest: Vec<f64>,
}

impl EdgeLengths {
    /// Vertices have three unknowns each from `first_vertex` on; what is not `given` is that of the section.
    pub fn new(
        mesh: &TriMesh,
        first_vertex: Dof,
        frames: &[RestFrame],
        section: &dyn Section,
        given: DiscreteStiffness,
    ) -> Self {
        let lengths = rest_lengths(mesh, frames);
        let stiffnesses = Stiffnesses::new(mesh, frames, &lengths, section, given).edges;
        Self {
            edges: mesh.edges().to_vec(),
            first_vertex,
            stiffness: (stiffnesses.iter().zip(&lengths))
                .map(|(k, length)| k * length)
                .collect(),
            rest: vec![0.0; lengths.len()],
            lengths,
        }
    }

    /// Unit vector along the edge, its length, and ε.
    fn at(&self, edge: usize, q: &SVector<f64, 6>) -> (Vec3, f64, f64) {
        let along = Vec3::new(q[3] - q[0], q[4] - q[1], q[5] - q[2]);
        let (length, rest) = (along.norm(), self.lengths[edge]);
        (along / length, length, (length - rest) / rest)
    }

    fn derivatives(&self, edge: usize, q: &SVector<f64, 6>, kept: f64) -> LocalHessian<6> {
        let (along, length, strain) = self.at(edge, q);
        let (k, rest) = (self.stiffness[edge], self.lengths[edge]);
        let offset = strain - self.rest[edge];
        let across = offset * rest / length;
        let across = if across < 0.0 { kept * across } else { across };
        let squared = along * along.transpose();
        let block =
            (squared + (Matrix3::identity() - squared) * across) * (2.0 * k / (rest * rest));
        LocalHessian {
            value: k * offset * offset,
            gradient: ends(&(along * (2.0 * k * offset / rest))),
            hessian: between_ends(&block),
        }
    }

    /// E of one edge over any numbers: the oracle of the tests.
    pub fn formula<R: Real>(&self, edge: usize, q: &[R; 6]) -> R {
        let length = norm(&sub(&point(q, 1), &point(q, 0)));
        let strain = length * (1.0 / self.lengths[edge]) - 1.0 - self.rest[edge];
        strain * strain * self.stiffness[edge]
    }
}

/// Opposite forces on both ends.
fn ends(on_second: &Vec3) -> SVector<f64, 6> {
    SVector::from_fn(|i, _| {
        if i < 3 {
            -on_second[i]
        } else {
            on_second[i - 3]
        }
    })
}

/// Second derivatives by both ends from those by the edge.
fn between_ends(block: &Matrix3<f64>) -> SMatrix<f64, 6, 6> {
    let mut hessian = SMatrix::<f64, 6, 6>::zeros();
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let signed = if i == j { *block } else { -block };
        (hessian.fixed_view_mut::<3, 3>(3 * i, 3 * j)).copy_from(&signed);
    }
    hessian
}

impl LocalEnergy<6, 2> for EdgeLengths {
    const NODE_SIZES: [usize; 2] = [3; 2];
    const MEASURES: usize = 1;

    fn name(&self) -> &'static str {
        "membrane"
    }

    fn num_stencils(&self) -> usize {
        self.edges.len()
    }

    fn nodes(&self, edge: usize) -> [Option<Dof>; 2] {
        self.edges[edge].map(|v| Some(Dof(self.first_vertex.0 + 3 * v)))
    }

    fn value(&self, edge: usize, q: &SVector<f64, 6>) -> f64 {
        self.stiffness[edge] * (self.at(edge, q).2 - self.rest[edge]).powi(2)
    }

    fn gradient(&self, edge: usize, q: &SVector<f64, 6>) -> (f64, SVector<f64, 6>) {
        let (along, _, strain) = self.at(edge, q);
        let (k, offset) = (self.stiffness[edge], strain - self.rest[edge]);
        let force = along * (2.0 * k * offset / self.lengths[edge]);
        (k * offset * offset, ends(&force))
    }

    fn hessian(&self, edge: usize, q: &SVector<f64, 6>) -> LocalHessian<6> {
        self.derivatives(edge, q, 1.0)
    }

    fn projected_hessian(&self, edge: usize, q: &SVector<f64, 6>, kept: f64) -> LocalHessian<6> {
        self.derivatives(edge, q, kept)
    }

    fn measure(&self, edge: usize, q: &SVector<f64, 6>, measures: &mut [f64]) {
        measures[0] = self.at(edge, q).2;
    }

    fn rest(&self, edge: usize, measures: &mut [f64]) {
        measures[0] = self.rest[edge];
    }

    fn set_rest(&mut self, edge: usize, measures: &[f64]) {
        self.rest[edge] = measures[0];
    }

    fn stress_stiffness(
        &self,
        edge: usize,
        q: &SVector<f64, 6>,
        motion: &SVector<f64, 6>,
    ) -> Option<SMatrix<f64, 6, 6>> {
        let (along, length, _) = self.at(edge, q);
        let longer = along.dot(&(motion.fixed_rows::<3>(3) - motion.fixed_rows::<3>(0)));
        let tension = 2.0 * self.stiffness[edge] * longer / self.lengths[edge].powi(2);
        let across = Matrix3::identity() - along * along.transpose();
        Some(between_ends(&(across * (tension / length))))
    }

    fn describe(&self, edge: usize) -> String {
        let [u, v] = self.edges[edge];
        format!("edge {u}–{v}")
    }
}
