//! Quadratic bending with Crouzeix–Raviart elements: QB(CR).
//!
//! ```text
//! E = Σ_edges C · 3 / (2 (A + A')) · |v|²,     C = h³ (α + 2β) / 12
//! v = (c_b + c_b') x_a + (c_a + c_a') x_b − (c_a + c_b) x_c − (c_a' + c_b') x_d
//! ```
//!
//! Edge a b with apexes c, d; c_a cotangent of the rest angle at a in the face of c, c_a' in that of d; A, A' rest areas
//! [m²], h thickness [m], α, β plane-stress Lamé parameters [Pa]. Interior edges only. Reference: "Better Bending"
//! (2026), Eqs. (15)–(17), after Bergou et al., "A Quadratic Bending Model for Inextensible Surfaces" (2006).
//!
//! The Hessian is constant and positive semidefinite, and it has the fewest entries of all models. At a flat rest state it
//! is the Hessian of DS(θ), whose energy does not converge under refinement; nor does this one, it is three times too large
//! on regular meshes. The force against a fold weakens beyond a right angle (group II of the study), so folds collapse. It assumes a
//! flat rest shape and small stretch: curvature of a rest shape is ignored.

use nalgebra::{SMatrix, SVector};

use super::hinge::{Hinge, hinges};
use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian};
use crate::geometry::Real;
use crate::mesh::Surface;
use crate::rest::RestFrame;

/// QB(CR) bending energy of one shell.
pub struct QuadraticHinge {
    hinges: Vec<Hinge>,
    /// `√(C · 3 / (2 (A + A')))` times the factors of the four vertices in v.
    weights: Vec<[f64; 4]>,
}

impl QuadraticHinge {
    /// `frames` are the rest frames of the faces of `rest`, `flexural_rigidity` is `E h³ / (12 (1 − ν²))` of every face
    /// [N·m], which equals C.
    pub fn new(
        rest: &Surface,
        first_vertex: Dof,
        frames: &[RestFrame],
        flexural_rigidity: &[f64],
    ) -> Self {
        let hinges = hinges(rest, first_vertex, frames, flexural_rigidity);
        let weights = |hinge: &Hinge| {
            let scale = (hinge.rigidity * 1.5 / hinge.area()).sqrt();
            // Of each wing the cotangents at the start and the end of its own traversal of the edge.
            let [[a, b], [b1, a1]] = hinge.rest_wings().map(|w| {
                let cotangent = |share: f64| share * w.length / w.height;
                [cotangent(w.foot), cotangent(1.0 - w.foot)]
            });
            [b + b1, a + a1, -(a + b), -(a1 + b1)].map(|factor| scale * factor)
        };
        Self {
            weights: hinges.iter().map(weights).collect(),
            hinges,
        }
    }

    /// `√(C · 3 / (2 (A + A'))) v`. The factors of v sum to zero, so differences of positions do: round-off does not grow with
    /// the distance from the origin.
    fn bend(&self, stencil: usize, q: &SVector<f64, 12>) -> Vec3 {
        let x = |i: usize| Vec3::new(q[3 * i], q[3 * i + 1], q[3 * i + 2]);
        (1..4).fold(Vec3::zeros(), |sum, i| {
            sum + (x(i) - x(0)) * self.weights[stencil][i]
        })
    }

    /// Factors of the four vertices in `√(C · 3 / (2 (A + A'))) v`.
    pub(super) fn factors(&self, stencil: usize) -> &[f64; 4] {
        &self.weights[stencil]
    }

    /// E of one hinge over any numbers: the oracle of the tests.
    pub fn formula<R: Real>(&self, stencil: usize, q: &[R; 12]) -> R {
        (0..3).fold(R::from(0.0), |sum, axis| {
            let v = (0..4).fold(R::from(0.0), |v, i| {
                v + q[3 * i + axis] * self.weights[stencil][i]
            });
            sum + v * v
        })
    }
}

impl LocalEnergy<12, 4> for QuadraticHinge {
    const NODE_SIZES: [usize; 4] = [3; 4];

    fn name(&self) -> &'static str {
        "bending"
    }

    fn num_stencils(&self) -> usize {
        self.hinges.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 4] {
        self.hinges[stencil].vertices.map(Some)
    }

    fn value(&self, stencil: usize, q: &SVector<f64, 12>) -> f64 {
        self.bend(stencil, q).norm_squared()
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 12>) -> (f64, SVector<f64, 12>) {
        let bend = self.bend(stencil, q);
        let weights = &self.weights[stencil];
        let gradient = SVector::from_fn(|i, _| 2.0 * weights[i / 3] * bend[i % 3]);
        (bend.norm_squared(), gradient)
    }

    fn hessian(&self, stencil: usize, q: &SVector<f64, 12>) -> LocalHessian<12> {
        let (value, gradient) = self.gradient(stencil, q);
        let weights = &self.weights[stencil];
        let entry = |i: usize, j: usize| match i % 3 == j % 3 {
            true => 2.0 * weights[i / 3] * weights[j / 3],
            false => 0.0,
        };
        LocalHessian {
            value,
            gradient,
            hessian: SMatrix::from_fn(entry),
        }
    }

    /// The Hessian is a square, so nothing is negative.
    fn projected_hessian(
        &self,
        stencil: usize,
        q: &SVector<f64, 12>,
        _kept: f64,
    ) -> LocalHessian<12> {
        self.hessian(stencil, q)
    }

    fn describe(&self, stencil: usize) -> String {
        self.hinges[stencil].describe()
    }
}
