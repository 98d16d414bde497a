//! A moment about edges that turns their directors.
//!
//! ```text
//! E = − λ Σ_e m ℓ (φ₀ + ψ),    ψ = β + ζ,    ζ = θ/2 + ε α
//! ```
//!
//! m moment by rest length [N·m/m], ℓ rest length of the edge [m], λ the factor. ψ [rad] is the angle about the edge from
//! the reference r to the director, right-handed about the edge as its face traverses it (the surface on its left): β turns
//! r into the normal of the face, ζ the normal into the director, as in [`crate::energy::bending::DirectorClamp`]. A
//! positive moment at a boundary leans the directors outwards, so the surface bends away from its normals, like a ball
//! whose normals point outwards.
//!
//! r is the director at the start of the step and φ₀ what it has turned until then, so that E passes any number of turns.
//! While the edge keeps its direction ψ is the angle that the director turns, and m a moment about a fixed axis. If the
//! edge turns, ψ is measured in the plane across it: the moment stays about the edge, and the work depends on the way as
//! far as the edge's own turning within a step matters.
//!
//! The second derivatives are as often negative as positive; like those of [`super::Pressure`] they are left out where
//! curvature is clamped.

use nalgebra::SVector;

use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian, variables};
use crate::energy::bending::turning_angle;
use crate::geometry::over_numbers::{angle_about, constant, cross, point, sub};
use crate::geometry::{Real, Wing, hinge_angle};

/// An edge under a moment, seen from one of its faces.
#[derive(Clone, Copy, Debug)]
pub struct TurnedEdge {
    /// Ends of the edge in the face's traversal, apex of the face.
    pub corners: [Dof; 3],
    /// Apex of the other face.
    pub across: Option<Dof>,
    /// The edge angle.
    pub angle: Dof,
    /// ε of the edge in the face.
    pub sign: f64,
    /// m ℓ [N·m].
    pub moment: f64,
    /// r: a unit vector across the edge.
    pub reference: Vec3,
    /// φ₀ [rad].
    pub turned: f64,
    /// The edge by its vertices, for reports.
    pub vertices: [u32; 2],
}

/// Moments about edges of one shell with mid-edge directors.
#[derive(Clone, Debug)]
pub struct EdgeMoment {
    /// The edges.
    pub edges: Vec<TurnedEdge>,
    /// λ.
    pub factor: f64,
}

impl EdgeMoment {
    /// Takes the directors at `q` for references, and what they have turned since the last ones into account.
    pub fn rebase(&mut self, q: &[f64]) {
        for stencil in 0..self.edges.len() {
            let local = self.gather(stencil, q);
            let edge = &self.edges[stencil];
            let turned = edge.turned + self.angle(stencil, &local);
            let point = |i: usize| Vec3::new(local[3 * i], local[3 * i + 1], local[3 * i + 2]);
            let (a, b) = (point(0), point(1));
            let wing = Wing::new(&a, &b, &point(2));
            let theta =
                (edge.across).map_or(0.0, |_| hinge_angle(&wing, &Wing::new(&b, &a, &point(3))));
            let tilt = 0.5 * theta + edge.sign * local[12];
            let edge = &mut self.edges[stencil];
            edge.reference = wing.normal * tilt.cos() - wing.altitude * tilt.sin();
            edge.turned = turned;
        }
    }

    fn gather(&self, stencil: usize, q: &[f64]) -> SVector<f64, 13> {
        let edge = &self.edges[stencil];
        let mut local = SVector::<f64, 13>::zeros();
        let points = edge
            .corners
            .iter()
            .map(|dof| Some(*dof))
            .chain([edge.across]);
        for (i, dof) in points.enumerate() {
            if let Some(Dof(first)) = dof {
                local.as_mut_slice()[3 * i..3 * i + 3]
                    .copy_from_slice(&q[first as usize..first as usize + 3]);
            }
        }
        local[12] = q[edge.angle.0 as usize];
        local
    }

    fn angle(&self, stencil: usize, q: &SVector<f64, 13>) -> f64 {
        self.angle_formula(stencil, &std::array::from_fn(|i| q[i]))
    }

    /// ψ.
    fn angle_formula<R: Real>(&self, stencil: usize, q: &[R; 13]) -> R {
        let edge = &self.edges[stencil];
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| point(q, i));
        let along = sub(&b, &a);
        let normal = cross(&along, &sub(&c, &a));
        let beta = angle_about(&along, &constant(&edge.reference), &normal);
        let tilt = q[12] * edge.sign;
        match edge.across {
            Some(_) => beta + tilt + turning_angle(&[a, b, c, d]) * 0.5,
            None => beta + tilt,
        }
    }

    /// E of one edge over any numbers.
    pub fn formula<R: Real>(&self, stencil: usize, q: &[R; 13]) -> R {
        let edge = &self.edges[stencil];
        (self.angle_formula(stencil, q) + edge.turned) * (-self.factor * edge.moment)
    }

    fn derivatives(&self, stencil: usize, q: &SVector<f64, 13>, kept: f64) -> LocalHessian<13> {
        let mut local = LocalHessian::from(self.formula(stencil, &variables(q)));
        local.hessian *= kept;
        local
    }
}

impl LocalEnergy<13, 5> for EdgeMoment {
    const NODE_SIZES: [usize; 5] = [3, 3, 3, 3, 1];

    fn name(&self) -> &'static str {
        "loads"
    }

    fn num_stencils(&self) -> usize {
        self.edges.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 5] {
        let edge = &self.edges[stencil];
        let [a, b, c] = edge.corners.map(Some);
        [a, b, c, edge.across, Some(edge.angle)]
    }

    fn value(&self, stencil: usize, q: &SVector<f64, 13>) -> f64 {
        self.formula(stencil, &std::array::from_fn(|i| q[i]))
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 13>) -> (f64, SVector<f64, 13>) {
        let local = self.derivatives(stencil, q, 1.0);
        (local.value, local.gradient)
    }

    fn hessian(&self, stencil: usize, q: &SVector<f64, 13>) -> LocalHessian<13> {
        self.derivatives(stencil, q, 1.0)
    }

    fn projected_hessian(
        &self,
        stencil: usize,
        q: &SVector<f64, 13>,
        kept: f64,
    ) -> LocalHessian<13> {
        self.derivatives(stencil, q, kept)
    }

    fn describe(&self, stencil: usize) -> String {
        let [u, v] = self.edges[stencil].vertices;
        format!("edge {u}–{v}")
    }
}
