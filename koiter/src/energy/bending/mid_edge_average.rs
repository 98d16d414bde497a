//! Koiter bending with averaged mid-edge normals: M-e. Av.
//!
//! ```text
//! E = Ā W(κ),    κ = D⁻ᵀ II D⁻¹ − b̄,    II = [[q₀ + q₁, q₀], [q₀, q₀ + q₂]]
//! q_c = (x_a + x_b − 2 x_c)·d = 2 a a' sin θ / √(a² + a'² + 2 a a' cos θ),     d ∥ N + N'
//! ```
//!
//! Ā rest area [m²], W energy of bending per unit area of the [`Section`] [J/m²], D rest edges ([`RestFrame`]), b̄ rest
//! second fundamental form in the same frame [1/m]; edge a b opposite corner c, N, N' the normals of its two faces, as
//! long as twice their areas, so d is their mean weighted by area. The second form of q_c has the altitudes a, a' [m] and
//! the hinge angle θ: it is what is computed, and it is the same from both faces. q_c = 0 on boundary edges. Reference:
//! "Better Bending" (2026), Eqs. (35), (36), after Chen et al. (2018).
//!
//! The director models without directors: positions only, any material. Exact in the limit on regular meshes that are
//! aligned with the bending; elsewhere its energy does not converge, on anisotropic meshes it is many times too large. The
//! force against a fold weakens beyond a right angle (group II of the study), so folds collapse.

use nalgebra::{Matrix3, SVector, Vector3};

use super::bending_stencil::BendingStencil;
use super::face_bending::{FaceBending, FaceLaw, FaceResponse, nodes};
use super::hinge_function::{DeformedHinge, HingeFunction};
use crate::geometry::Real;
use crate::geometry::over_numbers::{cross, dot, sub};
use crate::material::Section;
use crate::rest::RestFrame;

/// The law of M-e. Av. with the section `S`.
pub struct MidEdgeAverage<S> {
    frames: Vec<RestFrame>,
    rest_forms: Vec<Vector3<f64>>,
    section: S,
}

impl<S: Section> FaceBending<MidEdgeAverage<S>> {
    /// `rest_forms` are b̄ in the frames of the faces, components `11, 22, 12` [1/m].
    pub fn new(
        stencils: Vec<BendingStencil>,
        frames: Vec<RestFrame>,
        rest_forms: Vec<Vector3<f64>>,
        section: S,
    ) -> Self {
        let law = MidEdgeAverage {
            frames,
            rest_forms,
            section,
        };
        Self::with_law(stencils, law)
    }

    /// Replaces b̄ of every face.
    pub fn set_rest_forms(&mut self, rest_forms: Vec<Vector3<f64>>) {
        self.law.rest_forms = rest_forms;
    }

    /// The second fundamental form in the rest frame, components `11, 22, 12` [1/m].
    pub fn second_form(&self, face: usize, q: &SVector<f64, 18>) -> Vector3<f64> {
        self.law.form_matrix(face) * self.curvatures(face, q)
    }

    /// E of one face over any numbers, with the averaged normals, whose section has the density `density(κ)` [J/m²]: the
    /// oracle of the tests.
    pub fn formula<R: Real>(&self, face: usize, q: &[R; 18], density: impl Fn([R; 3]) -> R) -> R {
        let curvature: [R; 3] = std::array::from_fn(|c| {
            if !self.has_neighbor(face, c) {
                return R::from(0.0);
            }
            let [a, b, apex, across] = nodes(c).map(|i| [q[3 * i], q[3 * i + 1], q[3 * i + 2]]);
            let edge = sub(&b, &a);
            let own = cross(&edge, &sub(&apex, &a));
            let other = cross(&sub(&across, &a), &edge);
            let sum: [R; 3] = std::array::from_fn(|axis| own[axis] + other[axis]);
            let arm: [R; 3] = std::array::from_fn(|i| a[i] + b[i] - apex[i] * 2.0);
            dot(&arm, &sum) / dot(&sum, &sum).sqrt()
        });
        let rows = self.law.frames[face].second_form_matrix();
        let change = std::array::from_fn(|s| {
            curvature[0] * rows[s][0] + curvature[1] * rows[s][1] + curvature[2] * rows[s][2]
                - self.law.rest_forms[face][s]
        });
        density(change) * self.law.frames[face].area
    }
}

impl<S> MidEdgeAverage<S> {
    fn form_matrix(&self, face: usize) -> Matrix3<f64> {
        let rows = self.frames[face].second_form_matrix();
        Matrix3::from_fn(|i, j| rows[i][j])
    }
}

impl<S: Section> FaceLaw for MidEdgeAverage<S> {
    /// As the quotient `P / R` with `P = 2 a a' sin θ`, `R² = a² + a'² + 2 a a' cos θ`.
    fn curvature(&self, _face: usize, _corner: usize, hinge: &DeformedHinge) -> HingeFunction {
        let [a, b] = hinge.heights;
        let (sin, cos) = hinge.theta.sin_cos();
        let (s, c) = (2.0 * a * b * sin, 2.0 * a * b * cos);
        // Without the cancellation of a² + b² + c in a sharp fold.
        let root = ((a - b).powi(2) + 4.0 * a * b * (0.5 * hinge.theta).cos().powi(2)).sqrt();
        let value = s / root;
        let (p1, p2) = (
            Vector3::new(s, s, c),
            Matrix3::new(0.0, s, c, s, 0.0, c, c, c, -s),
        );
        // Half the derivatives of R².
        let h1 = Vector3::new(a * a + 0.5 * c, b * b + 0.5 * c, -0.5 * s);
        let h2 = Matrix3::new(
            a * a,
            0.5 * c,
            -0.5 * s, //
            0.5 * c,
            b * b,
            -0.5 * s, //
            -0.5 * s,
            -0.5 * s,
            -0.5 * c,
        );
        let r1 = h1 / root;
        let r2 = (h2 - r1 * r1.transpose()) / root;
        let f1 = (p1 - r1 * value) / root;
        let mixed = f1 * r1.transpose();
        HingeFunction {
            value,
            slope: f1.into(),
            curvature: (p2 - mixed - mixed.transpose() - r2 * value) / root,
        }
    }

    fn response(&self, face: usize, curvatures: &Vector3<f64>) -> FaceResponse {
        let form = self.form_matrix(face);
        let change = form * curvatures - self.rest_forms[face];
        let response = (self.section.bend(face, &change)).scaled(self.frames[face].area);
        FaceResponse {
            value: response.density,
            moments: form.transpose() * response.stress,
            tangent: form.transpose() * response.tangent * form,
        }
    }

    fn measure(&self, face: usize, curvatures: &Vector3<f64>) -> Vector3<f64> {
        self.form_matrix(face) * curvatures
    }

    fn rest(&self, face: usize) -> Vector3<f64> {
        self.rest_forms[face]
    }

    fn set_rest(&mut self, face: usize, rest: Vector3<f64>) {
        self.rest_forms[face] = rest;
    }
}
