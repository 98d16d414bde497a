//! St. Venant–Kirchhoff: an isotropic density quadratic in the strain.
//!
//! ```text
//! w(ε) = α/2 tr(ε)² + β tr(ε²),     α = E ν / (1 − ν²),   β = E / (2 (1 + ν))
//! ```
//!
//! α, β are the plane-stress Lamé parameters [Pa]. Reference: "Better Bending" (2026), Eqs. (4), (5), (44). Right for
//! small strain at any rotation; under strong compression it softens and finally lets a face collapse.

use nalgebra::{Matrix3, Vector3};

use super::{Density, Material, Response};
use crate::geometry::Real;

/// The same isotropic material on every face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StVenantKirchhoff {
    /// α [Pa].
    pub lame_alpha: f64,
    /// β [Pa].
    pub lame_beta: f64,
}

impl StVenantKirchhoff {
    /// From Young's modulus [Pa] and Poisson's ratio.
    pub fn new(youngs_modulus: f64, poissons_ratio: f64) -> Self {
        Self {
            lame_alpha: youngs_modulus * poissons_ratio / (1.0 - poissons_ratio * poissons_ratio),
            lame_beta: youngs_modulus / (2.0 * (1.0 + poissons_ratio)),
        }
    }

    /// w and its derivatives.
    #[inline]
    pub(super) fn evaluate(&self, strain: &Vector3<f64>) -> Response {
        let (a, b) = (self.lame_alpha, self.lame_beta);
        let trace = strain.x + strain.y;
        let stress = Vector3::new(
            a * trace + 2.0 * b * strain.x,
            a * trace + 2.0 * b * strain.y,
            4.0 * b * strain.z,
        );
        let tangent = Matrix3::new(a + 2.0 * b, a, 0.0, a, a + 2.0 * b, 0.0, 0.0, 0.0, 4.0 * b);
        Response {
            density: 0.5 * stress.dot(strain),
            stress,
            tangent,
        }
    }
}

impl Material for StVenantKirchhoff {
    #[inline]
    fn response(&self, _face: usize, strain: &Vector3<f64>) -> Response {
        self.evaluate(strain)
    }

    #[inline]
    fn linearized(&self, _face: usize, strain: &Vector3<f64>) -> Response {
        self.evaluate(strain)
    }
}

impl Density for StVenantKirchhoff {
    fn formula<R: Real>(&self, _face: usize, [e11, e22, e12]: [R; 3]) -> R {
        let trace = e11 + e22;
        let square = e11 * e11 + e22 * e22 + e12 * e12 * 2.0;
        trace * trace * (0.5 * self.lame_alpha) + square * self.lame_beta
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniaxial_stress_has_the_modulus_of_young() {
        let (young, poisson) = (2.5, 0.3);
        let material = StVenantKirchhoff::new(young, poisson);
        let response = material.response(0, &Vector3::new(0.01, -0.3 * 0.01, 0.0));
        assert!((response.stress.x - young * 0.01).abs() < 1e-15);
        assert!(response.stress.y.abs() < 1e-15);
    }
}
