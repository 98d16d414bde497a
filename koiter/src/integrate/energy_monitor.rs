//! Whether a step has gained energy that nothing gave it.
//!
//! ```text
//! gained = E_{n+1} − E_n − W − G,    W = Σ ½ (r_n + r_{n+1})·Δx,    r = ∇Φ + M a
//! ```
//!
//! E all energies with the kinetic one, those at the start of the step under the loads of its end; W the work at what is
//! prescribed, r its reactions without damping, which takes what it is given; G what dissipation functions gave, if they drive, by
//! their forces at the end of the step. An undamped method of second order gains or loses a third power of the step; one that has
//! lost its stability gains a share in every step. Gains below the kinetic energy of the speeds at which Newton's method stops
//! mean nothing.

use super::{Prescribed, State, StepError, System};

/// What is watched.
pub(super) struct EnergyMonitor {
    /// Largest gain of a step, as a share of the largest kinetic energy so far.
    pub(super) largest_share: f64,
    /// The largest kinetic energy so far [J].
    pub(super) largest_kinetic: f64,
    /// Speed at which Newton's method stops [m/s].
    pub(super) velocity_tolerance: f64,
}

impl EnergyMonitor {
    /// The largest kinetic energy so far, that of `next` included.
    ///
    /// # Errors
    /// A step from `state` to `next` that has gained too much.
    pub(super) fn check(
        &self,
        system: &mut System,
        [state, next]: [&State; 2],
        prescribed: &Prescribed,
    ) -> Result<f64, StepError> {
        let (before, after) = (system.kinetic(state), system.kinetic(next));
        let scale = self.largest_kinetic.max(before).max(after);
        let [start, end] = [state, next].map(|at| system.potential_and_reactions(at));
        let (start, end) = (
            start.map_err(|e| (next.step, e))?,
            end.map_err(|e| (next.step, e))?,
        );
        let solved = system.masses.len();
        let work: f64 = (0..state.q.len())
            .filter(|&i| i >= solved || prescribed.is_fixed[i])
            .map(|i| 0.5 * (start.1[i] + end.1[i]) * (next.q[i] - state.q[i]))
            .sum();
        let driven: f64 = (system
            .damping
            .taken_by_rates(&system.layout, &state.q, &next.q))
        .map(|(_, taken)| (-taken).max(0.0))
        .sum();
        let gained = end.0 + after - start.0 - before - work - driven;
        let mass = system.masses.iter().sum::<f64>() / 3.0;
        let noise = 0.5 * mass * self.velocity_tolerance * self.velocity_tolerance;
        if gained > (self.largest_share * scale).max(noise) {
            return Err(StepError::EnergyGrew {
                step: next.step,
                gained,
                kinetic: scale,
            });
        }
        Ok(scale)
    }
}
