//! What a shell resists with, per unit rest area: materials integrated over the thickness.

use std::fmt::Debug;
use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use super::{Density, Material, Response};
use crate::geometry::Real;

/// The law of a shell: energies per unit rest area of each face [J/m²], in an orthonormal basis of the rest face.
///
/// Energies know no thickness and no material; whatever lies between the two surfaces of a shell is said here.
pub trait Section: Send + Sync + Debug {
    /// The response of face `face` to the Green strain `(ε₁₁, ε₂₂, ε₁₂)` of its midsurface.
    fn stretch(&self, face: usize, strain: &Vector3<f64>) -> Response;
    /// The response of face `face` to the change of curvature `(κ₁₁, κ₂₂, κ₁₂)` [1/m].
    fn bend(&self, face: usize, curvature_change: &Vector3<f64>) -> Response;
    /// Stiffness of face `face` against bending about one axis without bending about the other, `E h³ / (12 (1 − ν²))` of a
    /// homogeneous isotropic shell [N·m]; the mean over all directions of an orthotropic one. For models that know one
    /// stiffness only.
    fn flexural_rigidity(&self, face: usize) -> f64 {
        let tangent = self.bend(face, &Vector3::zeros()).tangent;
        // Of fourth degree in cosine and sine of the direction: three directions, 60° apart, have its mean.
        let along = |direction: f64| {
            let (sin, cos) = direction.sin_cos();
            let curvature = Vector3::new(cos * cos, sin * sin, cos * sin);
            curvature.dot(&(tangent * curvature))
        };
        let third = std::f64::consts::FRAC_PI_3;
        (along(0.0) + along(third) + along(2.0 * third)) / 3.0
    }
    /// Whether the energy of stretching is finite at this strain.
    fn is_admissible(&self, _face: usize, _strain: &Vector3<f64>) -> bool {
        true
    }
}

impl<S: Section + ?Sized> Section for Arc<S> {
    #[inline]
    fn stretch(&self, face: usize, strain: &Vector3<f64>) -> Response {
        self.as_ref().stretch(face, strain)
    }
    #[inline]
    fn bend(&self, face: usize, curvature_change: &Vector3<f64>) -> Response {
        self.as_ref().bend(face, curvature_change)
    }
    fn is_admissible(&self, face: usize, strain: &Vector3<f64>) -> bool {
        self.as_ref().is_admissible(face, strain)
    }
    fn flexural_rigidity(&self, face: usize) -> f64 {
        self.as_ref().flexural_rigidity(face)
    }
}

/// One material through the thickness h: `h w(ε)` and `(h³/12) w₀(κ)` with the density w and its quadratic part w₀, the
/// leading terms in h ("Better Bending", Eqs. 3 to 5).
#[derive(Clone, Debug, PartialEq)]
pub struct Homogeneous<M> {
    /// The material.
    pub material: M,
    /// h of every face [m].
    pub thickness: Vec<f64>,
}

impl<M: Material> Homogeneous<M> {
    /// The same thickness [m] on all faces.
    pub fn uniform(material: M, thickness: f64, num_faces: usize) -> Self {
        Self {
            material,
            thickness: vec![thickness; num_faces],
        }
    }
}

impl<M: Material> Section for Homogeneous<M> {
    #[inline]
    fn stretch(&self, face: usize, strain: &Vector3<f64>) -> Response {
        (self.material.response(face, strain)).scaled(self.thickness[face])
    }
    #[inline]
    fn bend(&self, face: usize, curvature_change: &Vector3<f64>) -> Response {
        let weight = bending_weight(self.thickness[face]);
        self.material
            .linearized(face, curvature_change)
            .scaled(weight)
    }
    fn is_admissible(&self, face: usize, strain: &Vector3<f64>) -> bool {
        self.material.is_admissible(face, strain)
    }
}

/// h³/12 [m³].
fn bending_weight(thickness: f64) -> f64 {
    thickness.powi(3) / 12.0
}

/// The densities over any numbers: the oracle of the tests.
impl<M: Density> Homogeneous<M> {
    /// Energy of stretching per unit area [J/m²].
    pub fn stretch_formula<R: Real>(&self, face: usize, strain: [R; 3]) -> R {
        self.material.formula(face, strain) * self.thickness[face]
    }
    /// Energy of bending per unit area [J/m²].
    pub fn bend_formula<R: Real>(&self, face: usize, change: [R; 3]) -> R {
        let tangent = self.material.linearized(face, &Vector3::zeros()).tangent;
        quadratic(&tangent, change) * bending_weight(self.thickness[face])
    }
}

/// `½ xᵀ T x` over any numbers.
pub(super) fn quadratic<R: Real>(tangent: &Matrix3<f64>, x: [R; 3]) -> R {
    let mut sum = R::from(0.0);
    for i in 0..3 {
        for j in 0..3 {
            sum = sum + x[i] * x[j] * (0.5 * tangent[(i, j)]);
        }
    }
    sum
}
