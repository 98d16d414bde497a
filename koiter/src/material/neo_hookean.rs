//! Neo-Hookean: compressible rubber in plane stress, stiff against collapse.
//!
//! ```text
//! W₃ = μ/2 (tr C₃ − 3 − 2 ln J) + λ/2 (ln J)²,     C₃ = diag(C, c),  C = 1 + 2 ε,  J² = c det C
//! σ₃₃ = 0:   μ (c − 1) + λ ln J = 0,     S = ∂w/∂ε = μ (1 − c C⁻¹)
//! ```
//!
//! μ = E / (2 (1 + ν)), λ = E ν / ((1 + ν)(1 − 2ν)) [Pa], c the squared stretch of the thickness. c depends on det C
//! alone; its equation is convex in ln c, and Newton's method from the safe side gives it to round-off. ν = ½ is the
//! incompressible limit c = 1/det C; ν < 0 is refused, for there c may not be unique. At small strain this is
//! [`StVenantKirchhoff`](super::StVenantKirchhoff) of the same E and ν. As the area of a face goes to 0 the density
//! grows without bound, so faces do not collapse under compression. Reference: Bonet and Wood (2008) for W₃.

use nalgebra::{Matrix2, Matrix3, Vector3};

use super::{Density, Material, ModuliError, Response, positive};
use crate::geometry::Real;

/// A neo-Hookean material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean {
    shear_modulus: f64,
    poissons_ratio: f64,
}

impl NeoHookean {
    /// From Young's modulus [Pa] and Poisson's ratio of small strain.
    ///
    /// # Errors
    /// A modulus that is not positive; a ratio outside [0, ½].
    pub fn new(youngs_modulus: f64, poissons_ratio: f64) -> Result<Self, ModuliError> {
        positive("Young's modulus", youngs_modulus)?;
        if !(0.0..=0.5).contains(&poissons_ratio) {
            return Err(ModuliError::PoissonsRatio {
                value: poissons_ratio,
                low: 0.0,
                high: 0.5,
            });
        }
        Ok(Self {
            shear_modulus: youngs_modulus / (2.0 * (1.0 + poissons_ratio)),
            poissons_ratio,
        })
    }

    /// ln c where ln det C = `log_det`: the zero of `(1 − 2ν)(eˢ − 1) + ν (s + ln det C)`.
    fn log_thickness(&self, log_det: f64) -> f64 {
        let nu = self.poissons_ratio;
        let weight = 1.0 - 2.0 * nu;
        // Both bounds lie where the function is positive; from there Newton's method on a convex function descends.
        let mut s = -nu * log_det / (1.0 - nu);
        if s > 0.0 && weight > 0.0 {
            s = s.min((-nu * log_det / weight).ln_1p());
        }
        // Quadratic from a bound that is tight for small and for large strain: at most 8 steps were seen.
        for _ in 0..50 {
            let growth = s.exp_m1();
            let step = (weight * growth + nu * (s + log_det)) / (weight * (1.0 + growth) + nu);
            s -= step;
            if step.abs() <= 1e-16 * s.abs() {
                break;
            }
        }
        s
    }
}

/// Determinant and trace of C − 1, as twice those of ε suggest: `(det C − 1, det ε)`.
fn area_change(strain: &Vector3<f64>) -> (f64, f64) {
    let det = strain.x * strain.y - strain.z * strain.z;
    (2.0 * (strain.x + strain.y) + 4.0 * det, det)
}

impl Material for NeoHookean {
    fn response(&self, _face: usize, strain: &Vector3<f64>) -> Response {
        let (change, det) = area_change(strain);
        let (mu, nu) = (self.shear_modulus, self.poissons_ratio);
        let log_det = change.ln_1p();
        let s = self.log_thickness(log_det);
        let thinning = s.exp_m1();
        // w/μ = tr ε + (c − 1)/2 − (c + 1) ln J / 2, sorted so that what is small is not a difference of what is large.
        let log_volume = 0.5 * (log_det + s);
        let of_area = excess(change, change - log_det, |n| {
            (-1.0f64).powi(n) / f64::from(n)
        });
        let of_thickness = excess(s, thinning - s, |n| 1.0 / factorial(n));
        let density = 0.5 * (of_area + of_thickness - thinning * log_volume) - 2.0 * det;
        let c = 1.0 + thinning;
        let inverse = Matrix2::new(
            1.0 + 2.0 * strain.y,
            -2.0 * strain.z,
            -2.0 * strain.z,
            1.0 + 2.0 * strain.x,
        ) / (1.0 + change);
        // 1 − c C⁻¹ = C⁻¹ (2 ε − (c − 1))
        let small = Matrix2::new(
            2.0 * strain.x - thinning,
            2.0 * strain.z,
            2.0 * strain.z,
            2.0 * strain.y - thinning,
        );
        let stress = inverse * small * mu;
        let (b11, b22, b12) = (inverse[(0, 0)], inverse[(1, 1)], inverse[(0, 1)]);
        let by_area = Vector3::new(b11, b22, 2.0 * b12);
        let by_shape = Matrix3::new(
            b11 * b11,
            b12 * b12,
            2.0 * b11 * b12,
            b12 * b12,
            b22 * b22,
            2.0 * b12 * b22,
            2.0 * b11 * b12,
            2.0 * b12 * b22,
            2.0 * (b11 * b22 + b12 * b12),
        );
        let bulk = nu * c / ((1.0 - 2.0 * nu) * c + nu);
        Response {
            density: mu * density,
            stress: Vector3::new(stress[(0, 0)], stress[(1, 1)], 2.0 * stress[(0, 1)]),
            tangent: (by_area * by_area.transpose() * bulk + by_shape * c) * (2.0 * mu),
        }
    }

    fn is_admissible(&self, _face: usize, strain: &Vector3<f64>) -> bool {
        area_change(strain).0 > -1.0
    }
}

/// `Σ_{n ≥ 2} coefficient(n) xⁿ` where x is small, else the same number as a difference.
fn excess(x: f64, difference: f64, coefficient: impl Fn(i32) -> f64) -> f64 {
    // At 0.05 the terms beyond the 14th are below 1e-17 of the first; above, the difference loses less than two digits.
    if x.abs() > 0.05 {
        return difference;
    }
    (2..=14).rev().map(|n| coefficient(n) * x.powi(n)).sum()
}

fn factorial(n: i32) -> f64 {
    (2..=n).map(f64::from).product()
}

impl Density for NeoHookean {
    fn formula<R: Real>(&self, _face: usize, [e11, e22, e12]: [R; 3]) -> R {
        let (mu, nu) = (self.shear_modulus, self.poissons_ratio);
        let trace = e11 + e22;
        let log_det = (trace * 2.0 + (e11 * e22 - e12 * e12) * 4.0 + 1.0).ln();
        // Every step of Newton's method doubles the order to which derivatives are right.
        let mut c = R::from(self.log_thickness(log_det.value()).exp());
        for _ in 0..3 {
            let value = (c - R::from(1.0)) * (1.0 - 2.0 * nu) + (c.ln() + log_det) * nu;
            c = c - value / (R::from(nu) / c + (1.0 - 2.0 * nu));
        }
        let log_volume = (log_det + c.ln()) * 0.5;
        (trace + (c - R::from(1.0)) * 0.5 - (c + 1.0) * log_volume * 0.5) * mu
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniaxial tension: both lateral stretches are √c, so `μ (c − 1) + λ ln(a c) = 0` gives the stretch a for any c.
    #[test]
    fn uniaxial_stress_is_that_of_the_closed_form() {
        let (young, poisson) = (2.0, 0.3);
        let material = NeoHookean::new(young, poisson).unwrap();
        let mu = young / (2.0 * (1.0 + poisson));
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        for c in [0.5, 0.9, 1.2, 2.5] {
            let stretch = (-mu / lambda * (c - 1.0f64)).exp() / c;
            let strain = Vector3::new(0.5 * (stretch * stretch - 1.0), 0.5 * (c - 1.0), 0.0);
            let stress = material.response(0, &strain).stress;
            let expected = mu * (1.0 - c / (stretch * stretch));
            assert!((stress.x - expected).abs() < 1e-13 * expected.abs(), "{c}");
            assert!(stress.y.abs() < 1e-13, "{c}: {}", stress.y);
        }
    }

    /// The classical `S = μ (1 − a⁻³)` of incompressible rubber.
    #[test]
    fn incompressible_rubber_is_the_limit() {
        let material = NeoHookean::new(3.0, 0.5).unwrap();
        for stretch in [0.6f64, 1.5, 4.0] {
            let strain = Vector3::new(
                0.5 * (stretch * stretch - 1.0),
                0.5 * (1.0 / stretch - 1.0),
                0.0,
            );
            let stress = material.response(0, &strain).stress;
            let expected = 1.0 - stretch.powi(-3);
            assert!((stress.x - expected).abs() < 1e-13 * expected.abs() && stress.y.abs() < 1e-14);
        }
    }

    #[test]
    fn the_density_grows_without_bound_as_the_area_vanishes() {
        for poisson in [0.0, 0.3, 0.5] {
            let material = NeoHookean::new(1.0, poisson).unwrap();
            let at = |area: f64| {
                let strain = Vector3::new(0.5 * (area * area - 1.0), 0.0, 0.0);
                assert!(material.is_admissible(0, &strain));
                material.response(0, &strain).density
            };
            let densities = [1e-1, 1e-2, 1e-3, 1e-4].map(at);
            // By a logarithm at least: equal factors of the area add equal amounts.
            for step in densities.windows(2) {
                assert!(step[1] - step[0] > 0.5, "{poisson}: {densities:?}");
            }
        }
        let material = NeoHookean::new(1.0, 0.3).unwrap();
        assert!(!material.is_admissible(0, &Vector3::new(-0.5, 0.0, 0.0)));
    }

    #[test]
    fn tiny_strains_keep_their_digits() {
        let material = NeoHookean::new(1.0, 0.3).unwrap();
        let linear = |strain: &Vector3<f64>| material.linearized(0, strain);
        for size in [1e-3, 1e-5, 1e-7] {
            let strain = Vector3::new(1.0, -0.4, 0.3) * size;
            let (found, expected) = (material.response(0, &strain), linear(&strain));
            // The next order is the strain itself, times a few.
            assert!((found.density / expected.density - 1.0).abs() < 4.0 * size);
            assert!((found.stress - expected.stress).norm() < 6.0 * size * expected.stress.norm());
        }
    }

    #[test]
    fn ratios_out_of_range_are_refused() {
        let error = NeoHookean::new(1.0, -0.2).unwrap_err();
        assert_eq!(
            error.to_string(),
            "Poisson's ratio must lie between 0 and 0.5, but it is -0.2"
        );
        assert!(NeoHookean::new(0.0, 0.3).is_err());
    }
}
