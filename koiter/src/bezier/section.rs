//! The material and thickness of a Bézier shell: linear, isotropic, plane stress.

use nalgebra::Matrix3;

use super::BezierError;

/// A homogeneous section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Thickness [m].
    pub thickness: f64,
    /// Mass density [kg/m³].
    pub density: f64,
}

impl Section {
    /// # Errors
    /// A number out of its range.
    pub fn check(&self) -> Result<(), BezierError> {
        for (what, value) in [
            ("Young's modulus", self.youngs_modulus),
            ("the thickness", self.thickness),
            ("the density", self.density),
        ] {
            if !(value.is_finite() && value > 0.0) {
                let range = "positive";
                return Err(BezierError::Section { what, value, range });
            }
        }
        let value = self.poissons_ratio;
        if !(value > -1.0 && value < 0.5) {
            return Err(BezierError::Section {
                what: "Poisson's ratio",
                value,
                range: "between -1 and 0.5",
            });
        }
        Ok(())
    }

    /// `E t / (1 − ν²) [1 ν 0; ν 1 0; 0 0 (1 − ν)/2]` [N/m]: strain (ε_xx, ε_yy, 2 ε_xy) to force a length.
    pub fn membrane(&self) -> Matrix3<f64> {
        let nu = self.poissons_ratio;
        let scale = self.youngs_modulus * self.thickness / (1.0 - nu * nu);
        let shear = 0.5 * (1.0 - nu);
        Matrix3::new(1.0, nu, 0.0, nu, 1.0, 0.0, 0.0, 0.0, shear) * scale
    }

    /// `t² / 12` times [`Self::membrane`] [N m]: curvature to moment a length.
    pub fn bending(&self) -> Matrix3<f64> {
        self.membrane() * (self.thickness * self.thickness / 12.0)
    }

    /// Mass a unit of area [kg/m²].
    pub fn area_density(&self) -> f64 {
        self.density * self.thickness
    }
}
