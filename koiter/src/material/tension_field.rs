//! Tension field: a membrane that wrinkles before it takes compression.
//!
//! ```text
//! taut      e₂ ≥ −ν e₁             w = α/2 (e₁ + e₂)² + β (e₁² + e₂²)
//! wrinkled  e₁ > 0, e₂ < −ν e₁     w = E/2 e₁²
//! slack     e₁ ≤ 0                 w = 0
//! ```
//!
//! e₁ ≥ e₂ principal Green strains, α, β plane-stress Lamé parameters, E Young's modulus [Pa], ν Poisson's ratio. This is
//! the least energy of [`StVenantKirchhoff`] over all finer wrinkles, which lengthen the strain by any positive
//! semidefinite form; it is convex and has continuous stress. The tangent jumps between states; at a switch it is that of
//! the state with more tension (at zero strain: taut), so at rest it is that of St. Venant–Kirchhoff. Bending is that
//! of the material: wrinkles are softer, but how much depends on their length, which the mesh does not resolve. A slack
//! face has no stiffness in its plane; the solver then shifts its matrix. It may then shrink for nothing, and curvatures,
//! which are those of the deformed face over rest lengths, shrink with it: models with a second fundamental form lose
//! their bending stiffness where a sheet is not kept taut, and hang straight down. References: Pipkin (1986); Steigmann (1990).

use nalgebra::{Matrix3, Vector3};

use super::{Density, Material, Response, StVenantKirchhoff};
use crate::geometry::Real;

/// An isotropic membrane without compressive stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TensionField {
    taut: StVenantKirchhoff,
    youngs_modulus: f64,
    poissons_ratio: f64,
}

/// Strains of an unstrained face are rounded by a few 10⁻¹⁶; within this they count as taut, or a flat sheet at rest would
/// lose its stiffness by chance. The stress is then continuous up to this times the modulus.
const ROUND_OFF: f64 = 1e-14;

/// What a face of it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TensionState {
    /// Tension in all directions.
    Taut,
    /// Tension along one direction, wrinkles across.
    Wrinkled,
    /// No stress.
    Slack,
}

impl TensionField {
    /// From Young's modulus [Pa] and Poisson's ratio.
    pub fn new(youngs_modulus: f64, poissons_ratio: f64) -> Self {
        Self {
            taut: StVenantKirchhoff::new(youngs_modulus, poissons_ratio),
            youngs_modulus,
            poissons_ratio,
        }
    }

    /// The state at a strain.
    pub fn state(&self, strain: &Vector3<f64>) -> TensionState {
        let (mean, half_difference) = principal(strain);
        let [first, second] = [mean + half_difference, mean - half_difference];
        if second >= -self.poissons_ratio * first - ROUND_OFF {
            TensionState::Taut
        } else if first > 0.0 {
            TensionState::Wrinkled
        } else {
            TensionState::Slack
        }
    }
}

/// Mean and half the difference of the principal strains.
fn principal(strain: &Vector3<f64>) -> (f64, f64) {
    let (p, q) = (0.5 * (strain.x - strain.y), strain.z);
    (0.5 * (strain.x + strain.y), p.hypot(q))
}

impl Material for TensionField {
    fn response(&self, face: usize, strain: &Vector3<f64>) -> Response {
        match self.state(strain) {
            TensionState::Taut => self.taut.response(face, strain),
            TensionState::Slack => Response::quadratic(Matrix3::zeros(), strain),
            TensionState::Wrinkled => {
                let (mean, r) = principal(strain);
                let first = mean + r;
                let (p, q) = (0.5 * (strain.x - strain.y), strain.z);
                // e₁ = mean + r, r² = p² + q²; r > 0 in this state.
                let slope = Vector3::new(0.5 + 0.5 * p / r, 0.5 - 0.5 * p / r, q / r);
                let turning = Vector3::new(0.5 * q, -0.5 * q, -p);
                let bending = turning * turning.transpose() / (r * r * r);
                let young = self.youngs_modulus;
                Response {
                    density: 0.5 * young * first * first,
                    stress: slope * (young * first),
                    tangent: (slope * slope.transpose() + bending * first) * young,
                }
            }
        }
    }

    fn linearized(&self, face: usize, strain: &Vector3<f64>) -> Response {
        self.taut.response(face, strain)
    }
}

impl Density for TensionField {
    fn formula<R: Real>(&self, face: usize, [e11, e22, e12]: [R; 3]) -> R {
        let values = Vector3::new(e11.value(), e22.value(), e12.value());
        match self.state(&values) {
            TensionState::Taut => self.taut.formula(face, [e11, e22, e12]),
            TensionState::Slack => R::from(0.0),
            TensionState::Wrinkled => {
                let p = (e11 - e22) * 0.5;
                let first = (e11 + e22) * 0.5 + (p * p + e12 * e12).sqrt();
                first * first * (0.5 * self.youngs_modulus)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The strain with principal values e₁, e₂ whose first direction is turned by `angle`.
    fn turned(first: f64, second: f64, angle: f64) -> Vector3<f64> {
        let (c, s) = (angle.cos(), angle.sin());
        Vector3::new(
            first * c * c + second * s * s,
            first * s * s + second * c * c,
            (first - second) * c * s,
        )
    }

    #[test]
    fn stress_and_density_are_continuous_across_the_states() {
        for poisson in [-0.3, 0.0, 0.4] {
            let material = TensionField::new(2.0, poisson);
            let gap = 1e-9;
            // Both sides of each switch: taut to wrinkled, wrinkled to slack.
            for (first, second, before, after) in [
                (
                    0.1,
                    -poisson * 0.1,
                    TensionState::Taut,
                    TensionState::Wrinkled,
                ),
                (0.0, -0.1, TensionState::Wrinkled, TensionState::Slack),
            ] {
                let sides = match after {
                    TensionState::Slack => [(first + gap, second), (first - gap, second)],
                    _ => [(first, second + gap), (first, second - gap)],
                };
                let [one, other] = sides.map(|(e1, e2)| turned(e1, e2, 0.7));
                assert_eq!(
                    (material.state(&one), material.state(&other)),
                    (before, after)
                );
                let [one, other] = [one, other].map(|strain| material.response(0, &strain));
                // The stress changes by at most the stiffness times the gap.
                assert!((one.stress - other.stress).norm() < 20.0 * gap);
                assert!((one.density - other.density).abs() < gap);
            }
        }
    }

    #[test]
    fn compression_meets_no_stress_and_tension_the_modulus_of_young() {
        let material = TensionField::new(2.0, 0.3);
        let compressed = material.response(0, &turned(0.03, -0.1, 0.0));
        // Pressed together across, it still carries E e₁ along, and nothing across.
        assert!((compressed.stress - Vector3::new(0.06, 0.0, 0.0)).norm() < 1e-16);
        let slack = material.response(0, &turned(0.0, -0.1, 0.4));
        assert_eq!((slack.density, slack.stress.norm()), (0.0, 0.0));
    }

    /// No shorter way over positive semidefinite lengthenings, sampled: the relaxed density is the least.
    #[test]
    fn the_density_is_the_least_over_all_wrinkles() {
        let material = TensionField::new(2.0, 0.3);
        for strain in [
            turned(0.1, -0.2, 0.3),
            turned(-0.05, -0.2, 1.0),
            turned(0.1, 0.05, 2.0),
        ] {
            let relaxed = material.response(0, &strain).density;
            let mut least = f64::INFINITY;
            for i in 0..60 {
                for j in 0..60 {
                    for k in 0..24 {
                        let (a, b) = (f64::from(i) * 0.005, f64::from(j) * 0.005);
                        let wrinkled = strain + turned(a, b, f64::from(k) * 0.131);
                        least = least.min(material.taut.response(0, &wrinkled).density);
                    }
                }
            }
            assert!(relaxed <= least + 1e-15, "{relaxed} {least}");
            // The samples are 0.005 apart in strain and 0.131 rad in direction.
            assert!(least - relaxed < 2e-4, "{relaxed} {least}");
        }
    }
}
