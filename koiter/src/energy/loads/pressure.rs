//! Pressure that follows the surface.
//!
//! ```text
//! E = − λ p V,    V = Σ_f (x₀ − o) · ((x₁ − o) × (x₂ − o)) / 6
//! ```
//!
//! p pressure [Pa], positive along the normals (it inflates a ball whose normals point outwards), x₀ x₁ x₂ the corners of a
//! face in their order, o the origin of volumes [m], λ the factor. V is the volume between the surface and o.
//!
//! Where the surface is closed, or its boundary is held, V changes as the volume behind the surface does, whatever o: the
//! force on a vertex is p times a third of the area vectors of its faces. At a free edge the cone from the edge to o
//! moves too, and pressure acts on it: the edge bears two thirds of p times the area vector of the triangle it forms with
//! o, more than a pressure on the surface alone would give, which has no potential there. Nothing is added to an edge that
//! stays in a plane through o and is free in this plane only, as at a plane of symmetry: so choose o on all of these.
//!
//! The Hessian of one face depends on o, only the sum does not. Projected face by face it would stiffen what is far from o,
//! so of a projected Hessian only the share of negative curvature that is kept is formed: none of it where all is clamped.

use nalgebra::{Matrix3, SMatrix, SVector};

use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian};
use crate::geometry::Real;

/// Pressure on the faces of one shell.
#[derive(Clone, Debug)]
pub struct Pressure {
    /// First unknowns of the corners of the faces.
    pub faces: Vec<[Dof; 3]>,
    /// p [Pa].
    pub pressure: f64,
    /// o [m].
    pub origin: Vec3,
    /// λ.
    pub factor: f64,
}

impl Pressure {
    fn arms(&self, q: &SVector<f64, 9>) -> [Vec3; 3] {
        std::array::from_fn(|i| Vec3::new(q[3 * i], q[3 * i + 1], q[3 * i + 2]) - self.origin)
    }

    /// −λ p / 6.
    fn scale(&self) -> f64 {
        -self.factor * self.pressure / 6.0
    }

    fn scaled(&self, q: &SVector<f64, 9>, kept: f64) -> LocalHessian<9> {
        let (value, gradient) = self.gradient(0, q);
        let y = self.arms(q);
        let scale = kept * self.scale();
        let mut hessian = SMatrix::<f64, 9, 9>::zeros();
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            // ∂²V/∂x_i∂x_j, with V the triple product of the arms.
            let block: Matrix3<f64> = -y[k].cross_matrix() * scale;
            hessian
                .fixed_view_mut::<3, 3>(3 * i, 3 * j)
                .copy_from(&block);
            (hessian.fixed_view_mut::<3, 3>(3 * j, 3 * i)).copy_from(&block.transpose());
        }
        LocalHessian {
            value,
            gradient,
            hessian,
        }
    }

    /// E of one face over any numbers: the oracle of the tests.
    pub fn formula<R: Real>(&self, q: &[R; 9]) -> R {
        let y = |i: usize| -> [R; 3] { std::array::from_fn(|d| q[3 * i + d] - self.origin[d]) };
        let (a, b, c) = (y(0), y(1), y(2));
        let triple = a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        triple * self.scale()
    }
}

impl LocalEnergy<9, 3> for Pressure {
    const NODE_SIZES: [usize; 3] = [3; 3];

    fn name(&self) -> &'static str {
        "loads"
    }

    fn num_stencils(&self) -> usize {
        self.faces.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 3] {
        self.faces[stencil].map(Some)
    }

    fn value(&self, _stencil: usize, q: &SVector<f64, 9>) -> f64 {
        let [a, b, c] = self.arms(q);
        self.scale() * a.dot(&b.cross(&c))
    }

    fn gradient(&self, _stencil: usize, q: &SVector<f64, 9>) -> (f64, SVector<f64, 9>) {
        let y = self.arms(q);
        let mut gradient = SVector::<f64, 9>::zeros();
        for i in 0..3 {
            let force = y[(i + 1) % 3].cross(&y[(i + 2) % 3]) * self.scale();
            gradient.fixed_rows_mut::<3>(3 * i).copy_from(&force);
        }
        (self.scale() * y[0].dot(&y[1].cross(&y[2])), gradient)
    }

    fn hessian(&self, _stencil: usize, q: &SVector<f64, 9>) -> LocalHessian<9> {
        self.scaled(q, 1.0)
    }

    fn projected_hessian(
        &self,
        _stencil: usize,
        q: &SVector<f64, 9>,
        kept: f64,
    ) -> LocalHessian<9> {
        self.scaled(q, kept)
    }

    fn describe(&self, stencil: usize) -> String {
        format!("face {stencil}")
    }
}
