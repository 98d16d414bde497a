//! A sequence of equilibria along the schedules: every step is a static solve from the last state.

use super::{Integrator, Prescribed, State, StepError, StepReport, System};

/// Static equilibria.
#[derive(Clone, Debug)]
pub struct QuasiStatic {
    /// Newton stops when no point moved further than this in the last step [m].
    pub displacement_tolerance: f64,
}

impl Integrator for QuasiStatic {
    fn step(
        &mut self,
        system: &mut System,
        state: &mut State,
        prescribed: &Prescribed,
        dt: f64,
    ) -> Result<StepReport, StepError> {
        let step = state.step + 1;
        let mut q = state.q.clone();
        let solved = system
            .solve(
                &mut q,
                None,
                (&state.q, dt),
                prescribed,
                self.displacement_tolerance,
            )
            .map_err(|error| (step, error))?;
        let report = StepReport {
            dt,
            residual: solved.newton.last_step,
            ..Default::default()
        };
        let next = State::at_rest(q, state.time + dt, step);
        system.finish(state, next, solved, report)
    }
}
