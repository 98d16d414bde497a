//! How long an explicit step may be.
//!
//! ```text
//! dt² ω² + 2 dt c < 4,    ω² = xᵀ K x,  c = xᵀ C x   for the x with xᵀ M x = 1 that makes xᵀ (K + 2 C/dt) x largest
//! ```
//!
//! K the exact Hessian of all energies without contact, C that of damping by rates, which an explicit step knows half a step
//! late, M the masses. Without damping it is dt < 2 / ω. x is found by power iteration, from below; on meshes of shells the
//! iteration below is within a percent or two of ω².

use super::System;
use super::damping::RateRule;
use super::linear::Part;
use crate::assembly::{LowRank, SymmetricMatrix};

/// Each brings the estimate nearer to the largest eigenvalue.
const ITERATIONS: usize = 60;

impl System {
    /// An estimate of the longest stable step at `q` [s], at least the true one and rarely more than 2 % longer, if it is
    /// near `dt`.
    pub(super) fn stable_step(&mut self, q: &[f64], is_fixed: &[bool], dt: f64) -> f64 {
        // With half a step for τ the Hessian of damping is 2 C/dt.
        self.damping.begin(&RateRule::backward(q, 0.5 * dt));
        let (matrix, _) = self.second_derivatives(q, Part::Motion);
        let dense: Vec<LowRank> = (self.elastic.iter())
            .flat_map(|energy| energy.low_rank(q))
            .collect();
        let multiply = |matrix: &SymmetricMatrix, x: &[f64]| {
            let mut image = matrix.multiply(x);
            for LowRank { weight, vector } in &dense {
                let share = weight * dot(vector, x);
                for (image, entry) in image.iter_mut().zip(vector) {
                    *image += share * entry;
                }
            }
            image
        };
        let scale: Vec<f64> = (self.masses.iter().zip(is_fixed))
            .map(|(&mass, &fixed)| match fixed || mass == 0.0 {
                true => 0.0,
                false => 1.0 / mass.sqrt(),
            })
            .collect();
        let Some((shape, eigenvalue)) = largest(&|x| multiply(&matrix, x), &scale) else {
            return f64::INFINITY;
        };
        if self.damping.is_none() {
            return 2.0 / eigenvalue.sqrt();
        }
        let (undamped, _) = self.second_derivatives(q, Part::All);
        // The quotients lie below the eigenvalue as far as the iteration has not ended: both by the same share.
        let all = dot(&shape, &multiply(&matrix, &shape));
        let stiffness = eigenvalue / all * dot(&shape, &multiply(&undamped, &shape));
        let damping = 0.5 * dt * (eigenvalue - stiffness).max(0.0);
        4.0 / (damping + (damping * damping + 4.0 * stiffness.max(0.0)).sqrt())
    }
}

/// The largest eigenvalue of `S A S`, A a multiplication, S the diagonal matrix of `scale`, and S times its vector of unit length; `None` if
/// nothing moves.
fn largest(multiply: &dyn Fn(&[f64]) -> Vec<f64>, scale: &[f64]) -> Option<(Vec<f64>, f64)> {
    // No two entries alike, so that no symmetry hides the fastest vibration.
    let mut x: Vec<f64> = (0..scale.len())
        .map(|i| ((i * i + 3) as f64 * 0.7).sin())
        .collect();
    let mut shape = Vec::new();
    for _ in 0..ITERATIONS {
        let norm = dot(&x, &x).sqrt();
        if !(norm > 0.0) {
            return None;
        }
        shape = x.iter().zip(scale).map(|(x, s)| x * s / norm).collect();
        let image = multiply(&shape);
        x = image.iter().zip(scale).map(|(y, s)| y * s).collect();
    }
    Some((shape, dot(&x, &x).sqrt()))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
