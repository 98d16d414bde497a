//! Implicit Euler and BDF2 as minimisations.
//!
//! ```text
//! q_{n+1} = argmin  |q − q̃|²_M / (2 τ²) + Φ(q),    q̃ = q̂ + τ v̂,    v_{n+1} = (q_{n+1} − q̂) / τ
//! implicit Euler:  τ = dt,            q̂ = q_n,                           v̂ = v_n
//! BDF2:            τ = dt (1+ω)/(1+2ω),  q̂ = q_n + c (q_n − q_{n−1}),  v̂ = v_n + c (v_n − v_{n−1}),  c = ω²/(1+2ω)
//! ```
//!
//! M masses, Φ all energies [J], ω the ratio of this step to the last one; steps of one length have τ = 2/3 dt and
//! c = 1/3. A first step of BDF2, and one that is more than twice as long as the last (the formula is unstable from
//! 1 + √2 on), is one of implicit Euler. Both are unconditionally stable; Euler is of first order and damps what moves
//! fast, BDF2 of second order and damps only what moves in a few steps.
//!
//! Rates of strain, for damping, follow from strains as velocities from positions: (s − ŝ)/τ with ŝ = s_n or
//! s_n + c (s_n − s_{n−1}).
//!
//! Linear momentum is conserved; of Euler the sum of `x_{n+1} × M (v_{n+1} − v_n)` vanishes too, but angular momentum
//! `x × M v` is conserved only up to the order of the step. Reference: E. Hairer, S. P. Nørsett, G. Wanner, "Solving
//! Ordinary Differential Equations I" (1993), section III.5 (variable steps).

use super::damping::RateRule;
use super::{Integrator, Memory, Prescribed, State, StepError, StepReport, System};
use crate::energy::Inertia;

/// Implicit Euler dynamics.
#[derive(Clone, Debug)]
pub struct ImplicitEuler {
    /// Newton stops when no point moved faster than this in the last step [m/s].
    pub velocity_tolerance: f64,
}

/// Dynamics by backward differences of second order.
#[derive(Clone, Debug)]
pub struct Bdf2 {
    /// Newton stops when no point moved faster than this in the last step [m/s].
    pub velocity_tolerance: f64,
}

/// Largest ratio of a step to the one before; round-off of a ratio of 2 may pass it.
const LARGEST_RATIO: f64 = 2.0 + 1e-9;

/// q̂, v̂ and τ.
struct Base {
    q: Vec<f64>,
    velocities: Vec<f64>,
    reach: f64,
    /// q̂ is the sum of configurations with these weights.
    combination: Vec<(f64, Vec<f64>)>,
}

impl Base {
    fn of_euler(state: &State, dt: f64) -> Self {
        Self {
            q: state.q.clone(),
            velocities: state.velocities.clone(),
            reach: dt,
            combination: vec![(1.0, state.q.clone())],
        }
    }

    fn of_bdf2(state: &State, dt: f64) -> Self {
        let Memory::Before {
            dt: dt_before,
            q,
            velocities,
        } = &state.memory
        else {
            return Self::of_euler(state, dt);
        };
        let ratio = dt / dt_before;
        if ratio > LARGEST_RATIO {
            return Self::of_euler(state, dt);
        }
        let share = ratio * ratio / (1.0 + 2.0 * ratio);
        let beyond = |now: &[f64], before: &[f64]| -> Vec<f64> {
            let pairs = now.iter().zip(before);
            pairs.map(|(now, old)| now + share * (now - old)).collect()
        };
        Self {
            q: beyond(&state.q, q),
            velocities: beyond(&state.velocities, velocities),
            reach: dt * (1.0 + ratio) / (1.0 + 2.0 * ratio),
            combination: vec![(1.0 + share, state.q.clone()), (-share, q.clone())],
        }
    }

    /// The step from this base.
    fn step(
        self,
        system: &mut System,
        state: &mut State,
        prescribed: &Prescribed,
        dt: f64,
        (velocity_tolerance, memory): (f64, Memory),
    ) -> Result<StepReport, StepError> {
        let step = state.step + 1;
        let Self {
            q: base,
            velocities: base_velocities,
            reach,
            combination,
        } = self;
        (system.damping).begin(&RateRule {
            reach,
            base: combination,
            dt,
        });
        let moving = base.iter().zip(&base_velocities);
        let mut inertia = Inertia {
            masses: system.masses.clone(),
            prediction: moving.map(|(x, v)| x + reach * v).collect(),
            dt: reach,
        };
        let mut q = state.q.clone();
        let tolerance = velocity_tolerance * dt;
        let start = (&state.q[..], dt);
        let solved = system
            .solve(&mut q, Some(&mut inertia), start, prescribed, tolerance)
            .map_err(|error| (step, error))?;
        let rates = |new: &[f64], base: &[f64]| -> Vec<f64> {
            let pairs = new.iter().zip(base);
            pairs.map(|(new, base)| (new - base) / reach).collect()
        };
        let velocities = rates(&q, &base);
        let report = StepReport {
            dt,
            residual: solved.newton.last_step / dt,
            ..Default::default()
        };
        let next = State {
            accelerations: rates(&velocities, &base_velocities),
            velocities,
            q,
            time: state.time + dt,
            step,
            path: None,
            memory,
        };
        system.finish(state, next, solved, report)
    }
}

impl Integrator for ImplicitEuler {
    fn step(
        &mut self,
        system: &mut System,
        state: &mut State,
        prescribed: &Prescribed,
        dt: f64,
    ) -> Result<StepReport, StepError> {
        let how = (self.velocity_tolerance, Memory::None);
        Base::of_euler(state, dt).step(system, state, prescribed, dt, how)
    }
}

impl Integrator for Bdf2 {
    fn step(
        &mut self,
        system: &mut System,
        state: &mut State,
        prescribed: &Prescribed,
        dt: f64,
    ) -> Result<StepReport, StepError> {
        let memory = Memory::Before {
            dt,
            q: state.q.clone(),
            velocities: state.velocities.clone(),
        };
        let how = (self.velocity_tolerance, memory);
        Base::of_bdf2(state, dt).step(system, state, prescribed, dt, how)
    }
}
