//! Newmark's method: implicit steps as minimisations, explicit ones by the forces at their start.
//!
//! ```text
//! x_{n+1} = x̃ + β dt² a_{n+1}                     x̃ = x_n + dt v_n + (1/2 − β) dt² a_n
//! v_{n+1} = v_n + dt ((1 − γ) a_n + γ a_{n+1})     M a = −∇Φ
//! implicit:  x_{n+1} = argmin  |x − x̃|²_M / (2 β dt²) + Φ(x)
//! explicit:  β = 0, x_{n+1} = x̃
//! ```
//!
//! M masses, Φ all energies [J]. With γ = 1/2 the method is of second order and damps nothing: linear momentum is
//! conserved, and so is Σ m (x − β dt² a) × v; energy is kept up to dt² but not bounded by it, so stiff membranes and
//! contacts gain energy in steps that are long for them: cloth of 2450 triangles that falls on a ball in steps of 20 ms has
//! six times its energy after 0.6 s. Shorter steps help, or γ > 1/2, which damps in first order, or damping; gains can be
//! watched, and the steps that have them be cut ([`Newmark::energy_growth`]). β = 1/4 is stable for any step in linear problems;
//! β = 0 only below √(2/γ)/ω of the fastest vibration, see [`super::stable_step`].
//!
//! Damping takes rates of strain ṡ_{n+1} = 2 (s_{n+1} − s_n)/dt − ṡ_n in implicit steps, whatever β: of second order, as the
//! method, and a function of s alone, so that both momenta stay what they are. Explicit steps take the mean rate of the step,
//! half a step late: of first order in the damping. Their longest stable step is (√(1 + ξ²) − ξ) 2/ω, ξ the share of critical
//! damping.
//!
//! What is prescribed has the velocity and acceleration of backward differences, and so has what has no mass: the rule
//! above would let them ring for ever. Reference: N. M. Newmark, "A method of computation for structural dynamics" (1959).

use std::time::Instant;

use super::damping::RateRule;
use super::energy_monitor::EnergyMonitor;
use super::system::Solved;
use super::{Integrator, Memory, Prescribed, State, StepError, StepReport, System};
use crate::energy::Inertia;

/// Newmark dynamics.
#[derive(Clone, Debug)]
pub struct Newmark {
    /// β: 0 for explicit steps, 1/4 for the average of accelerations.
    pub beta: f64,
    /// γ: 1/2; more damps.
    pub gamma: f64,
    /// A step that gains more energy than this share of the largest kinetic energy so far is refused; `None`: not watched.
    pub energy_growth: Option<f64>,
    /// Newton stops when no point moved faster than this in the last step [m/s].
    pub velocity_tolerance: f64,
}

impl Newmark {
    /// x̃.
    fn prediction(&self, state: &State, dt: f64) -> Vec<f64> {
        let rest = (0.5 - self.beta) * dt * dt;
        let moving = state.q.iter().zip(&state.velocities);
        let all = moving.zip(&state.accelerations);
        all.map(|((x, v), a)| x + dt * v + rest * a).collect()
    }

    /// The state after a step to `q` with the accelerations of the equation of motion where they are known.
    fn next(
        &self,
        (state, q, dt): (&State, Vec<f64>, f64),
        (masses, is_fixed): (&[f64], &[bool]),
        accelerations: impl Fn(usize, &[f64]) -> f64,
        memory: Memory,
    ) -> State {
        let mut next = State::at_rest(q, state.time + dt, state.step + 1);
        for i in 0..next.q.len() {
            let obeys = i < masses.len() && !is_fixed[i] && masses[i] > 0.0;
            let (v, a) = (state.velocities[i], state.accelerations[i]);
            if obeys {
                let after = accelerations(i, &next.q);
                next.accelerations[i] = after;
                next.velocities[i] = v + dt * ((1.0 - self.gamma) * a + self.gamma * after);
            } else {
                next.velocities[i] = (next.q[i] - state.q[i]) / dt;
                next.accelerations[i] = (next.velocities[i] - v) / dt;
            }
        }
        next.memory = memory;
        next
    }

    /// Refuses a step that has gained energy, where that is watched.
    fn watch(
        &self,
        system: &mut System,
        state: &State,
        next: &mut State,
        prescribed: &Prescribed,
    ) -> Result<(), StepError> {
        let Some(largest_share) = self.energy_growth else {
            return Ok(());
        };
        let kinetic_so_far = |memory: &Memory| match memory {
            Memory::Accelerated {
                largest_kinetic, ..
            } => *largest_kinetic,
            _ => 0.0,
        };
        let monitor = EnergyMonitor {
            largest_share,
            largest_kinetic: kinetic_so_far(&state.memory),
            velocity_tolerance: self.velocity_tolerance,
        };
        let kinetic = monitor.check(system, [state, next], prescribed)?;
        if let Memory::Accelerated {
            largest_kinetic, ..
        } = &mut next.memory
        {
            *largest_kinetic = kinetic;
        }
        Ok(())
    }

    fn implicit_step(
        &self,
        system: &mut System,
        state: &mut State,
        prescribed: &Prescribed,
        dt: f64,
    ) -> Result<StepReport, StepError> {
        let rates = RateRule::trapezoidal(&state.q, &state.velocities, dt);
        system.damping.begin(&rates);
        let reach = self.beta.sqrt() * dt;
        let prediction = self.prediction(state, dt);
        let mut inertia = Inertia {
            masses: system.masses.clone(),
            prediction: prediction.clone(),
            dt: reach,
        };
        let mut q = state.q.clone();
        let tolerance = self.velocity_tolerance * dt;
        let start = (&state.q[..], dt);
        let solved = system
            .solve(&mut q, Some(&mut inertia), start, prescribed, tolerance)
            .map_err(|error| (state.step + 1, error))?;
        let mut next = self.next(
            (&*state, q, dt),
            (&system.masses, &prescribed.is_fixed),
            |i, q| (q[i] - prediction[i]) / (reach * reach),
            Memory::Accelerated {
                stable: None,
                largest_kinetic: 0.0,
            },
        );
        self.watch(system, state, &mut next, prescribed)?;
        let report = StepReport {
            dt,
            residual: solved.newton.last_step / dt,
            ..Default::default()
        };
        system.finish(state, next, solved, report)
    }

    fn explicit_step(
        &self,
        system: &mut System,
        state: &mut State,
        prescribed: &Prescribed,
        dt: f64,
    ) -> Result<StepReport, StepError> {
        let step = state.step + 1;
        let clock = Instant::now();
        let mut stable = match &state.memory {
            Memory::Accelerated {
                stable: Some(stable),
                ..
            } if system.is_still_stable(stable, state, dt) => stable.clone(),
            _ => system.stable_step(state, &prescribed.is_fixed, [dt, self.gamma]),
        };
        if dt > stable.dt {
            return Err(StepError::Unstable {
                step,
                dt,
                stable_dt: stable.dt,
            });
        }
        stable.age += 1;
        let mut seconds = vec![("stable_step", clock.elapsed().as_secs_f64())];
        let mut q = self.prediction(state, dt);
        let solved_dofs = system.masses.len();
        for (i, x) in q.iter_mut().enumerate() {
            if i >= solved_dofs || prescribed.is_fixed[i] {
                *x = prescribed.target[i];
            }
        }
        system.damping.begin(&RateRule::backward(&state.q, dt));
        let clock = Instant::now();
        let (gradient, elastic) =
            (system.total_gradient_and_elastic(&q)).map_err(|error| (step, error))?;
        seconds.push(("forces", clock.elapsed().as_secs_f64()));
        let masses = &system.masses;
        let mut next = self.next(
            (&*state, q, dt),
            (masses, &prescribed.is_fixed),
            |i, _| -gradient[i] / masses[i],
            Memory::Accelerated {
                stable: Some(stable),
                largest_kinetic: 0.0,
            },
        );
        self.watch(system, state, &mut next, prescribed)?;
        let report = StepReport {
            dt,
            ..Default::default()
        };
        system.finish(state, next, Solved::explicit(elastic, seconds), report)
    }
}

impl Integrator for Newmark {
    /// The accelerations of the equation of motion; prescribed unknowns have none.
    fn begin(
        &mut self,
        system: &mut System,
        state: &mut State,
        is_fixed: &[bool],
        dt: f64,
    ) -> Result<(), StepError> {
        if matches!(state.memory, Memory::Accelerated { .. }) {
            return Ok(());
        }
        let rates = RateRule::at_start(&state.q, &state.velocities, dt);
        system.damping.begin(&rates);
        let gradient =
            (system.total_gradient(&state.q)).map_err(|error| (state.step + 1, error))?;
        state.accelerations.fill(0.0);
        for (i, &mass) in system.masses.iter().enumerate() {
            if mass > 0.0 && !is_fixed[i] {
                state.accelerations[i] = -gradient[i] / mass;
            }
        }
        Ok(())
    }

    fn step(
        &mut self,
        system: &mut System,
        state: &mut State,
        prescribed: &Prescribed,
        dt: f64,
    ) -> Result<StepReport, StepError> {
        match self.beta > 0.0 {
            true => self.implicit_step(system, state, prescribed, dt),
            false => self.explicit_step(system, state, prescribed, dt),
        }
    }
}
