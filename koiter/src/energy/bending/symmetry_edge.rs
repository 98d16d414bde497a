//! Holds the directors of edges on a plane of symmetry in that plane.
//!
//! ```text
//! E = Σ ½ K ψ²,    ψ = β + ε α,    r = m × e
//! ```
//!
//! The surface goes on behind the plane as its mirror image, so the director of an edge in the plane, which belongs to both
//! halves, is in the plane too: across the edge e that is the direction r, with m the unit normal of the plane on the side
//! where r is nearer to the director at the start. β [rad] turns r into the normal of the face about the edge, the edge
//! angle α the normal into the director; ψ is the angle from r to the director. Unlike in [`super::DirectorClamp`] the ends
//! of the edge move, within the plane.
//!
//! K [J/rad²] is a penalty; ψ is wrong by the bending moment over K.

use nalgebra::SVector;

use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian, variables};
use crate::geometry::Real;
use crate::geometry::over_numbers::{angle_about, constant, cross, point, sub};

/// A boundary edge on a plane of symmetry.
#[derive(Clone, Copy, Debug)]
pub struct SymmetryEdge {
    /// Ends of the edge in its face's traversal, apex of the face.
    pub corners: [Dof; 3],
    /// The edge angle.
    pub angle: Dof,
    /// ε of the edge in the face.
    pub sign: f64,
    /// m.
    pub normal: Vec3,
    /// K [J/rad²].
    pub stiffness: f64,
    /// The edge by its vertices, for reports.
    pub vertices: [u32; 2],
}

/// The edges on planes of symmetry.
#[derive(Clone, Debug, Default)]
pub struct SymmetryEdges {
    /// The edges.
    pub edges: Vec<SymmetryEdge>,
}

impl SymmetryEdges {
    /// E of one edge over any numbers.
    pub fn formula<R: Real>(&self, stencil: usize, q: &[R; 10]) -> R {
        let edge = &self.edges[stencil];
        let corners: &[R; 9] = q.first_chunk().expect("the corners come first");
        let psi = edge.turn_from_plane(corners) + q[9] * edge.sign;
        psi * psi * (0.5 * edge.stiffness)
    }
}

impl SymmetryEdge {
    /// The edge angle α [rad] of the director in the plane, for the positions of the corners.
    pub fn angle_in_plane(&self, corners: &[f64; 9]) -> f64 {
        -self.sign * self.turn_from_plane(corners)
    }

    /// β.
    fn turn_from_plane<R: Real>(&self, q: &[R; 9]) -> R {
        let [a, b, c] = [0, 1, 2].map(|i| point(q, i));
        let along = sub(&b, &a);
        let normal = cross(&along, &sub(&c, &a));
        angle_about(&along, &cross(&constant(&self.normal), &along), &normal)
    }
}

impl LocalEnergy<10, 4> for SymmetryEdges {
    const NODE_SIZES: [usize; 4] = [3, 3, 3, 1];

    fn name(&self) -> &'static str {
        "clamps"
    }

    fn num_stencils(&self) -> usize {
        self.edges.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 4] {
        let edge = &self.edges[stencil];
        let [a, b, c] = edge.corners.map(Some);
        [a, b, c, Some(edge.angle)]
    }

    fn value(&self, stencil: usize, q: &SVector<f64, 10>) -> f64 {
        self.formula(stencil, &std::array::from_fn(|i| q[i]))
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 10>) -> (f64, SVector<f64, 10>) {
        let local = self.hessian(stencil, q);
        (local.value, local.gradient)
    }

    fn hessian(&self, stencil: usize, q: &SVector<f64, 10>) -> LocalHessian<10> {
        self.formula(stencil, &variables(q)).into()
    }

    fn describe(&self, stencil: usize) -> String {
        let [u, v] = self.edges[stencil].vertices;
        format!("edge {u}–{v}")
    }
}
