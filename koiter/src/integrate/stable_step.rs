//! How long an explicit step may be.
//!
//! ```text
//! dt < 2 / ω,    ω² the largest eigenvalue of M⁻¹ᐟ² K M⁻¹ᐟ²
//! ```
//!
//! K the exact Hessian of all energies without contact, M the masses. ω² is found by power iteration from below; on
//! meshes of shells the iteration below is within a percent or two of it.

use super::System;
use super::linear::Part;

/// Each brings the estimate nearer to the largest eigenvalue.
const ITERATIONS: usize = 60;

impl System {
    /// An estimate of the longest stable step at `q` [s], at least the true one and rarely more than 2 % longer.
    pub(super) fn stable_step(&mut self, q: &[f64], is_fixed: &[bool]) -> f64 {
        let (matrix, _) = self.second_derivatives(q, Part::All);
        let scale: Vec<f64> = (self.masses.iter().zip(is_fixed))
            .map(|(&mass, &fixed)| match fixed || mass == 0.0 {
                true => 0.0,
                false => 1.0 / mass.sqrt(),
            })
            .collect();
        // No two entries alike, so that no symmetry hides the fastest vibration.
        let mut x: Vec<f64> = (0..scale.len())
            .map(|i| ((i * i + 3) as f64 * 0.7).sin())
            .collect();
        let mut eigenvalue = 0.0;
        for _ in 0..ITERATIONS {
            let norm = x.iter().map(|x| x * x).sum::<f64>().sqrt();
            if !(norm > 0.0) {
                return f64::INFINITY;
            }
            let scaled: Vec<f64> = x.iter().zip(&scale).map(|(x, s)| x * s / norm).collect();
            let image = matrix.multiply(&scaled);
            x = image.iter().zip(&scale).map(|(y, s)| y * s).collect();
            eigenvalue = x.iter().map(|x| x * x).sum::<f64>().sqrt();
        }
        2.0 / eigenvalue.sqrt()
    }
}
