//! Linear statics: what the loads would do to a structure that is as stiff as at the start of the step.
//!
//! One step from the rest shape is the textbook problem K u = f of small displacements; every step is linearised anew at
//! the state it starts from. For published linear benchmarks and for estimates, not for large displacements.

use super::{Integrator, Prescribed, State, StepError, StepReport, System};
use crate::assembly::ConfigurationSpace;

/// Linear static response.
#[derive(Clone, Debug)]
pub struct LinearStatic;

impl Integrator for LinearStatic {
    fn step(
        &mut self,
        system: &mut System,
        state: &mut State,
        prescribed: &Prescribed,
        dt: f64,
    ) -> Result<StepReport, StepError> {
        let step = state.step + 1;
        system.damping.rest();
        let response = system.linear_response(&state.q, prescribed);
        let u = response.map_err(|error| StepError::LinearSolve {
            step,
            reason: error.to_string(),
        })?;
        let mut q = state.q.clone();
        system.space.retract(&state.q, &u, &mut q);
        system.loads.rebase(&q);
        *state = State::at_rest(q, state.time + dt, step);
        Ok(StepReport {
            step,
            time: state.time,
            dt,
            newton_iterations: 1,
            converged: true,
            min_gap: f64::INFINITY,
            energies: system.energies(state),
            ..Default::default()
        })
    }
}
