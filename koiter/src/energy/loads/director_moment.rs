//! A moment about edges that turns the directors at their vertices.
//!
//! ```text
//! E = − λ Σ_e ½ m ℓ Σ_v (φ₀ + ψ_v),    ψ_v = atan2((r × d) · e, r · d − (r · e) (d · e))
//! ```
//!
//! As [`super::EdgeMoment`], for models whose directors d stand at vertices: each of the two vertices v of an edge takes half of
//! the moment m ℓ [N·m]. ψ_v [rad] is the angle about the edge, of unit direction e, from the reference r to d, whatever the
//! length of d.

use nalgebra::SVector;

use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian, variables};
use crate::geometry::Real;
use crate::geometry::over_numbers::{constant, cross, dot, point, sub};

/// An edge under a moment, with the directors of its ends.
#[derive(Clone, Copy, Debug)]
pub struct TurnedDirectors {
    /// Ends of the edge, in its face's traversal.
    pub ends: [Dof; 2],
    /// Their directors.
    pub directors: [Dof; 2],
    /// m ℓ [N·m].
    pub moment: f64,
    /// r of each end.
    pub references: [Vec3; 2],
    /// φ₀ [rad], the mean of both ends.
    pub turned: f64,
    /// The edge by its vertices, for reports.
    pub vertices: [u32; 2],
}

/// Moments about edges of one shell with directors at its vertices.
#[derive(Clone, Debug)]
pub struct DirectorMoment {
    /// The edges.
    pub edges: Vec<TurnedDirectors>,
    /// λ.
    pub factor: f64,
}

impl DirectorMoment {
    /// Takes the directors at `q` for references, and what they have turned since the last ones into account.
    pub fn rebase(&mut self, q: &[f64]) {
        let point = |Dof(first): Dof| Vec3::from_column_slice(&q[first as usize..][..3]);
        for stencil in 0..self.edges.len() {
            let TurnedDirectors {
                ends, directors, ..
            } = self.edges[stencil];
            let points = [ends[0], ends[1], directors[0], directors[1]].map(point);
            let angle = self.angle(stencil, &std::array::from_fn(|i| points[i / 3][i % 3]));
            let edge = &mut self.edges[stencil];
            edge.turned += angle;
            edge.references = [points[2].normalize(), points[3].normalize()];
        }
    }

    /// The mean of ψ over both ends.
    fn angle<R: Real>(&self, stencil: usize, q: &[R; 12]) -> R {
        let along = sub(&point(q, 1), &point(q, 0));
        let length_squared = dot(&along, &along);
        let length = length_squared.sqrt();
        let turning = |end: usize| {
            let reference = self.edges[stencil].references[end];
            let r: [R; 3] = constant(&reference);
            let d = point(q, 2 + end);
            let across = dot(&r, &d) - dot(&r, &along) * dot(&d, &along) / length_squared;
            (dot(&cross(&r, &d), &along) / length).atan2(across)
        };
        (turning(0) + turning(1)) * 0.5
    }

    /// E of one edge over any numbers.
    pub fn formula<R: Real>(&self, stencil: usize, q: &[R; 12]) -> R {
        let edge = &self.edges[stencil];
        (self.angle(stencil, q) + edge.turned) * (-self.factor * edge.moment)
    }

    fn derivatives(&self, stencil: usize, q: &SVector<f64, 12>, kept: f64) -> LocalHessian<12> {
        let mut local = LocalHessian::from(self.formula(stencil, &variables(q)));
        local.hessian *= kept;
        local
    }
}

impl LocalEnergy<12, 4> for DirectorMoment {
    const NODE_SIZES: [usize; 4] = [3; 4];

    fn name(&self) -> &'static str {
        "loads"
    }

    fn num_stencils(&self) -> usize {
        self.edges.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 4] {
        let TurnedDirectors {
            ends, directors, ..
        } = self.edges[stencil];
        [ends[0], ends[1], directors[0], directors[1]].map(Some)
    }

    fn value(&self, stencil: usize, q: &SVector<f64, 12>) -> f64 {
        self.formula(stencil, &std::array::from_fn(|i| q[i]))
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 12>) -> (f64, SVector<f64, 12>) {
        let local = self.derivatives(stencil, q, 1.0);
        (local.value, local.gradient)
    }

    fn hessian(&self, stencil: usize, q: &SVector<f64, 12>) -> LocalHessian<12> {
        self.derivatives(stencil, q, 1.0)
    }

    fn projected_hessian(
        &self,
        stencil: usize,
        q: &SVector<f64, 12>,
        kept: f64,
    ) -> LocalHessian<12> {
        self.derivatives(stencil, q, kept)
    }

    fn describe(&self, stencil: usize) -> String {
        let [u, v] = self.edges[stencil].vertices;
        format!("edge {u}–{v}")
    }
}
