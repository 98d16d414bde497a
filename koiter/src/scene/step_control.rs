//! Steps in parts: a step that fails is cut in half, one that converges quickly grows again.
//!
//! A step of the schedules stays one step in all that is written; only the way to its end has more states on it. The
//! share of a step that is tried first is that at which the last step ended. A failure is an iteration that does not
//! converge, or an energy or a linear system that breaks down; surfaces that intersect are an error of the program, and an
//! explicit step that is not stable is one of the scene: neither is tried again.

use super::holds::Holds;
use super::simulation::Simulation;
use crate::burning::HeatedState;
use crate::integrate::{State, StepError, StepReport};
use crate::process::RestState;

/// A part that took at most this share of the iterations that are allowed is followed by one twice as long …
const QUICK: f64 = 0.125;

/// … and so is one that took no more than these: Newton's method is hardly ever quicker.
const FEWEST: usize = 4;

/// What a step changes, before it.
struct Before {
    state: State,
    turned: Vec<f64>,
    holds: Holds,
    rests: Vec<RestState>,
    heated: Vec<HeatedState>,
    kappa: Option<f64>,
}

impl Simulation {
    /// Advances by `dt` [s], in as many parts as are needed to converge.
    pub(super) fn step_in_parts(&mut self, dt: f64) -> Result<StepReport, StepError> {
        let start = self.before();
        let smallest = self.model().solver.smallest_step;
        let allowed = self.model().solver.max_iterations as f64;
        let quick = ((QUICK * allowed) as usize).max(FEWEST);
        let mut whole = StepReport {
            converged: true,
            ..StepReport::default()
        };
        let mut done = 0.0;
        let mut can_cut = true;
        while done < 1.0 {
            let share = self.share.min(1.0 - done);
            let is_last = done + share >= 1.0;
            let since_start = if is_last { dt } else { dt * (done + share) };
            let before = self.before();
            let part_dt = if share == 1.0 { dt } else { dt * share };
            let may_cut = can_cut && share > smallest;
            match self.step_to(start.state.time + since_start, part_dt) {
                Ok(part) if !part.converged && may_cut => {
                    whole.add_effort(&part);
                    whole.cut = whole.cut.take().or(part.diagnosis);
                    self.go_back(&before);
                    self.share = 0.5 * share;
                }
                Ok(part) => {
                    let (converged, iterations) = (part.converged, part.newton_iterations);
                    whole.add_part(part);
                    done += share;
                    if !converged {
                        // Smaller parts would not help: the rest of the step is tried as it is.
                        (self.share, can_cut) = (1.0, false);
                    } else if iterations <= quick {
                        self.share = (2.0 * self.share).min(1.0);
                    }
                }
                Err(error) if may_cut && can_be_cured(&error) => {
                    whole.cut = whole.cut.take().or_else(|| Some(error.to_string()));
                    self.go_back(&before);
                    self.share = 0.5 * share;
                }
                Err(error) => {
                    self.go_back(&start);
                    return Err(error);
                }
            }
        }
        if !whole.converged {
            self.share = smallest;
        }
        self.state.step = start.state.step + 1;
        self.state.time = start.state.time + dt;
        (whole.step, whole.time, whole.dt) = (self.state.step, self.state.time, dt);
        Ok(whole)
    }

    fn before(&self) -> Before {
        Before {
            state: self.state.clone(),
            turned: self.system.loads.turned(),
            holds: self.holds.clone(),
            rests: self.processes.rests(),
            heated: self.heated.states(),
            kappa: self.system.contact.as_ref().map(|contact| contact.kappa()),
        }
    }

    fn go_back(&mut self, before: &Before) {
        self.state = before.state.clone();
        (self.system.loads).restore_turned(&before.turned, &self.state.q);
        self.holds = before.holds.clone();
        (self.heated).put_back(&mut self.system, &before.heated);
        self.processes.restore(&mut self.system, &before.rests);
        self.system.follow(&self.state.q);
        self.apply_schedules(self.state.time);
        if let (Some(contact), Some(kappa)) = (&mut self.system.contact, before.kappa) {
            contact.set_kappa(kappa);
        }
    }
}

/// Whether a shorter step may do what this one could not.
fn can_be_cured(error: &StepError) -> bool {
    !matches!(
        error,
        StepError::Intersection { .. } | StepError::Unstable { .. }
    )
}
