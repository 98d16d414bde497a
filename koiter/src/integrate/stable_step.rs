//! How long an explicit step may be.
//!
//! ```text
//! dt² ω² + 2 dt c < 2/γ,    ω² = xᵀ K x,  c = xᵀ C x   for the x with xᵀ M x = 1 that makes xᵀ (K + 2 C/dt) x largest
//! ```
//!
//! K the exact Hessian of all energies without contact, C that of damping by rates, which an explicit step knows half a step
//! late, M the masses, γ that of Newmark's method: of x'' = −ω² x − c x' a step and the next multiply by −1 at the limit. With γ = 1/2 and
//! without damping it is dt < 2 / ω. x is found by power iteration, from below; on meshes of shells the
//! iteration below is within a percent or two of ω².
//!
//! An estimate costs as much as some twenty steps, so it is kept: for a hundred steps, unless what energies are told from outside
//! changes, or the shells become so fast that a dissipation, which may grow with speed, comes near the limit.

use super::damping::RateRule;
use super::linear::Part;
use super::{StableStep, State, System};
use crate::assembly::{LowRank, SymmetricMatrix};

/// Each brings the estimate nearer to the largest eigenvalue.
const ITERATIONS: usize = 60;

/// Steps for which an estimate is kept at most.
const KEPT_STEPS: u64 = 100;

/// The estimate is from below for ω, so from above for the step.
const SAFETY: f64 = 0.95;

/// The share by which a setting may change: of a stiffness it is half as much of the step, which [`SAFETY`] covers.
const SETTING_CHANGE: f64 = 0.05;

impl System {
    /// Whether an estimate still holds for a step from `state`. Forces up to the cube of the speed damp with its square: the
    /// limit of a step that damping alone limits falls with that.
    pub(super) fn is_still_stable(&self, stable: &StableStep, state: &State, dt: f64) -> bool {
        let settings = self.settings();
        let mut pairs = settings.iter().zip(&stable.settings);
        let is_alike = pairs.all(|(now, then): (&f64, &f64)| {
            (now - then).abs() <= SETTING_CHANGE * now.abs().max(then.abs())
        });
        let margin = (stable.dt / dt).sqrt();
        // The x of the estimate depends on the step where there is damping.
        let is_step =
            self.damping.is_none() || (dt / stable.found_for - 1.0).abs() < SETTING_CHANGE;
        let is_slow = self.damping.rates.is_empty() || speed(state) <= margin * stable.speed;
        stable.age < KEPT_STEPS && is_alike && is_step && is_slow
    }

    /// What energies are told from outside, of all in order.
    fn settings(&self) -> Vec<f64> {
        let energies = self.elastic.iter().flat_map(|energy| energy.settings());
        let rates = self.damping.rates.iter().flat_map(|rate| rate.settings());
        energies.chain(rates).copied().collect()
    }

    /// The longest stable step from `state` as it is estimated, if it is near `dt` [s].
    pub(super) fn stable_step(
        &mut self,
        state: &State,
        is_fixed: &[bool],
        [dt, gamma]: [f64; 2],
    ) -> StableStep {
        StableStep {
            dt: SAFETY * self.longest_step(state, is_fixed, [dt, gamma]),
            found_for: dt,
            age: 0,
            speed: speed(state),
            settings: self.settings(),
        }
    }

    /// An estimate of the longest stable step [s], at least the true one and rarely more than 2 % longer, if it is near `dt`.
    fn longest_step(&mut self, state: &State, is_fixed: &[bool], [dt, gamma]: [f64; 2]) -> f64 {
        let q = &state.q[..];
        // With half a step for τ the Hessian of damping is 2 C/dt, at the velocities of the state.
        let moving = state.q.iter().zip(&state.velocities);
        let before: Vec<f64> = moving.map(|(x, v)| x - 0.5 * dt * v).collect();
        self.damping.begin(&RateRule::backward(&before, 0.5 * dt));
        let (matrix, _) = self.second_derivatives(q, Part::Motion);
        let of_shape: Vec<LowRank> = (self.elastic.iter())
            .flat_map(|energy| energy.low_rank(q))
            .collect();
        let of_rates: Vec<LowRank> = (self.damping.energies())
            .flat_map(|energy| energy.low_rank(q))
            .collect();
        let multiply = |matrix: &SymmetricMatrix, dense: &[&[LowRank]], x: &[f64]| {
            let mut image = matrix.multiply(x);
            for LowRank { weight, vector } in dense.iter().copied().flatten() {
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
        let Some((shape, eigenvalue)) =
            largest(&|x| multiply(&matrix, &[&of_shape, &of_rates], x), &scale)
        else {
            return f64::INFINITY;
        };
        if self.damping.is_none() {
            return (2.0 / gamma / eigenvalue).sqrt();
        }
        let (undamped, _) = self.second_derivatives(q, Part::All);
        // The quotients lie below the eigenvalue as far as the iteration has not ended: both by the same share.
        let all = dot(&shape, &multiply(&matrix, &[&of_shape, &of_rates], &shape));
        let stiffness = eigenvalue / all * dot(&shape, &multiply(&undamped, &[&of_shape], &shape));
        let damping = 0.5 * dt * (eigenvalue - stiffness).max(0.0);
        let limit = 2.0 / gamma;
        limit / (damping + (damping * damping + limit * stiffness.max(0.0)).sqrt())
    }
}

/// The largest rate of an unknown.
fn speed(state: &State) -> f64 {
    (state.velocities.iter()).fold(0.0, |most: f64, v| most.max(v.abs()))
}

/// The largest eigenvalue of `S A S`, A a multiplication, S the diagonal matrix of `scale`, and S times its vector of unit
/// length; `None` if nothing moves.
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
