//! Orthotropic: two moduli along the axes of a material frame, as of woven cloth, paper and wood.
//!
//! ```text
//! w = ½ (Q₁₁ ε₁₁² + 2 Q₁₂ ε₁₁ ε₂₂ + Q₂₂ ε₂₂²) + 2 G ε₁₂²
//! Q₁₁ = E₁ / (1 − ν₁₂ ν₂₁),   Q₂₂ = E₂ / (1 − ν₁₂ ν₂₁),   Q₁₂ = ν₁₂ Q₂₂,   ν₂₁ = ν₁₂ E₂ / E₁
//! ```
//!
//! Axes 1 (warp) and 2 (weft) of the material; E₁, E₂ Young's moduli along them, G shear modulus [Pa], ν₁₂ the major
//! Poisson's ratio: the contraction along 2 by tension along 1. Positive definite where `ν₁₂² < E₁ / E₂`. Quadratic in the
//! Green strain, with the limits of [`StVenantKirchhoff`](super::StVenantKirchhoff), which it is for E₁ = E₂ and
//! G = E / (2 (1 + ν)). Reference: Jones (1999), plane stress.

use nalgebra::{Matrix3, Vector3};

use super::section::quadratic;
use super::{Density, Material, ModuliError, Response, positive};
use crate::geometry::Real;

/// Constants of an orthotropic sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrthotropicModuli {
    /// E₁ [Pa].
    pub along: f64,
    /// E₂ [Pa].
    pub across: f64,
    /// ν₁₂.
    pub poissons_ratio: f64,
    /// G [Pa].
    pub shear: f64,
}

/// An orthotropic material turned into the frame of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orthotropic {
    tangent: Matrix3<f64>,
}

impl Orthotropic {
    /// The material whose first axis is the unit vector `axis` in the frame of the face.
    ///
    /// # Errors
    /// Moduli that are not positive definite.
    pub fn new(moduli: &OrthotropicModuli, axis: [f64; 2]) -> Result<Self, ModuliError> {
        let &OrthotropicModuli {
            along,
            across,
            poissons_ratio,
            shear,
        } = moduli;
        positive("Young's modulus", along)?;
        positive("Young's modulus across", across)?;
        positive("the shear modulus", shear)?;
        let largest = (along / across).sqrt();
        if !(poissons_ratio.abs() < largest) {
            return Err(ModuliError::PoissonsRatio {
                value: poissons_ratio,
                low: -largest,
                high: largest,
            });
        }
        let scale = 1.0 / (1.0 - poissons_ratio * poissons_ratio * across / along);
        let coupling = poissons_ratio * across * scale;
        let own = Matrix3::new(
            along * scale,
            coupling,
            0.0,
            coupling,
            across * scale,
            0.0,
            0.0,
            0.0,
            4.0 * shear,
        );
        let [c, s] = axis;
        // Strain in the material's axes from that in the face's.
        let turn = Matrix3::new(
            c * c,
            s * s,
            2.0 * c * s,
            s * s,
            c * c,
            -2.0 * c * s,
            -c * s,
            c * s,
            c * c - s * s,
        );
        Ok(Self {
            tangent: turn.transpose() * own * turn,
        })
    }
}

impl Material for Orthotropic {
    fn response(&self, _face: usize, strain: &Vector3<f64>) -> Response {
        Response::quadratic(self.tangent, strain)
    }
}

impl Density for Orthotropic {
    fn formula<R: Real>(&self, _face: usize, strain: [R; 3]) -> R {
        quadratic(&self.tangent, strain)
    }
}

#[cfg(test)]
mod tests {
    use super::super::StVenantKirchhoff;
    use super::*;

    const WOVEN: OrthotropicModuli = OrthotropicModuli {
        along: 3.0,
        across: 1.2,
        poissons_ratio: 0.4,
        shear: 0.1,
    };

    #[test]
    fn tension_along_an_axis_meets_its_modulus() {
        let strain = |axial: f64, lateral: f64| Vector3::new(axial, lateral, 0.0);
        let warp = Orthotropic::new(&WOVEN, [1.0, 0.0]).unwrap();
        let stress = warp.response(0, &strain(0.01, -0.4 * 0.01)).stress;
        assert!((stress - Vector3::new(0.03, 0.0, 0.0)).norm() < 1e-16);
        let weft = Orthotropic::new(&WOVEN, [0.0, 1.0]).unwrap();
        let stress = weft
            .response(0, &strain(0.01, -0.4 * 1.2 / 3.0 * 0.01))
            .stress;
        assert!((stress - Vector3::new(0.012, 0.0, 0.0)).norm() < 1e-16);
    }

    /// Turning the material and the strain together changes no density.
    #[test]
    fn the_material_turns_with_its_axis() {
        let straight = Orthotropic::new(&WOVEN, [1.0, 0.0]).unwrap();
        let strain = nalgebra::Matrix2::new(0.02, 0.007, 0.007, -0.03);
        let components = |m: &nalgebra::Matrix2<f64>| Vector3::new(m[(0, 0)], m[(1, 1)], m[(0, 1)]);
        let expected = straight.response(0, &components(&strain)).density;
        for angle in [0.3f64, 1.2, -2.0] {
            let turn = nalgebra::Rotation2::new(angle);
            let turned = Orthotropic::new(&WOVEN, [angle.cos(), angle.sin()]).unwrap();
            let strain = turn.matrix() * strain * turn.matrix().transpose();
            let found = turned.response(0, &components(&strain)).density;
            assert!((found / expected - 1.0).abs() < 1e-14, "{angle}");
        }
        let across = Orthotropic::new(&WOVEN, [0.0, 1.0]).unwrap();
        assert!((across.tangent - straight.tangent).norm() > 1.0);
    }

    #[test]
    fn equal_moduli_are_isotropic() {
        let (young, poisson) = (2.0, 0.3);
        let moduli = OrthotropicModuli {
            along: young,
            across: young,
            poissons_ratio: poisson,
            shear: young / (2.0 * (1.0 + poisson)),
        };
        let material = Orthotropic::new(&moduli, [0.6, 0.8]).unwrap();
        let strain = Vector3::new(0.3, -0.2, 0.1);
        let isotropic = StVenantKirchhoff::new(young, poisson).response(0, &strain);
        let found = material.response(0, &strain);
        assert!((found.tangent - isotropic.tangent).norm() < 1e-15 * isotropic.tangent.norm());
    }

    #[test]
    fn indefinite_moduli_are_refused_with_the_reason() {
        let with = |poissons_ratio, shear| {
            let moduli = OrthotropicModuli {
                poissons_ratio,
                shear,
                ..WOVEN
            };
            Orthotropic::new(&moduli, [1.0, 0.0])
        };
        let error = with(1.6, 0.1).unwrap_err().to_string();
        assert!(error.contains("between -1.5811"), "{error}");
        let error = with(0.4, 0.0).unwrap_err().to_string();
        assert_eq!(
            error,
            "the shear modulus must be larger than 0, but it is 0"
        );
        assert!(with(1.5, 0.1).is_ok());
    }
}
