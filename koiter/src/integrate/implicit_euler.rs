//! Implicit Euler as a minimisation.
//!
//! ```text
//! q_{n+1} = argmin  |q − q̃|²_M / (2 dt²) + Φ(q),    q̃ = q_n + dt v_n,    v_{n+1} = (q_{n+1} − q_n) / dt
//! ```
//!
//! First order, unconditionally stable; it damps what moves fast. Linear momentum is conserved; angular momentum only
//! up to the order of the step (the sum of `x_{n+1} × M (v_{n+1} − v_n)` vanishes exactly, that of `x × M v` does not).

use super::{Integrator, Prescribed, State, StepError, StepReport, System};
use crate::energy::Inertia;

/// Implicit Euler dynamics.
#[derive(Clone, Debug)]
pub struct ImplicitEuler {
    /// Newton stops when no point moved faster than this in the last step [m/s].
    pub velocity_tolerance: f64,
}

impl Integrator for ImplicitEuler {
    fn step(
        &mut self,
        system: &mut System,
        state: &mut State,
        prescribed: &Prescribed,
        dt: f64,
    ) -> Result<StepReport, StepError> {
        let step = state.step + 1;
        let prediction = state
            .q
            .iter()
            .zip(&state.velocities)
            .map(|(x, v)| x + dt * v)
            .collect();
        let mut inertia = Inertia {
            masses: system.masses.clone(),
            prediction,
            dt,
        };
        let mut q = state.q.clone();
        let tolerance = self.velocity_tolerance * dt;
        let solved = system
            .solve(
                &mut q,
                Some(&mut inertia),
                (&state.q, dt),
                prescribed,
                tolerance,
            )
            .map_err(|error| (step, error))?;
        let velocities = q
            .iter()
            .zip(&state.q)
            .map(|(new, old)| (new - old) / dt)
            .collect();
        let report = StepReport {
            dt,
            residual: solved.newton.last_step / dt,
            ..Default::default()
        };
        let next = State {
            q,
            velocities,
            time: state.time + dt,
            step,
            path: None,
        };
        system.finish(state, next, solved, report)
    }
}
