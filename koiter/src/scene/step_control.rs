//! Static steps in parts: a step that does not converge is cut in half, one that converges quickly grows again.
//!
//! A step of the schedules stays one step in all that is written; only the way to its end has more equilibria on it. The
//! share of a step that is tried first is that at which the last step ended.

use super::simulation::Simulation;
use crate::integrate::{StepError, StepReport};

/// A part that took at most this share of the iterations that are allowed is followed by one twice as long.
const QUICK: f64 = 0.125;

impl Simulation {
    /// Advances by `dt` [s], in as many parts as are needed to converge.
    pub(super) fn step_in_parts(&mut self, dt: f64) -> Result<StepReport, StepError> {
        let start = self.state.clone();
        let turned = self.system.loads.turned();
        let smallest = self.model().solver.smallest_step;
        let quick = (QUICK * self.model().solver.max_iterations as f64) as usize;
        let mut whole = StepReport {
            converged: true,
            ..StepReport::default()
        };
        let mut done = 0.0;
        let mut can_cut = true;
        while done < 1.0 {
            let share = self.share.min(1.0 - done);
            let is_last = done + share >= 1.0;
            let end = start.time + if is_last { dt } else { dt * (done + share) };
            let (before, turned_before) = (self.state.clone(), self.system.loads.turned());
            let part_dt = if share == 1.0 { dt } else { dt * share };
            match self.step_to(end, part_dt) {
                Ok(part) => {
                    let converged = part.converged;
                    let iterations = part.newton_iterations;
                    if !converged && can_cut && share > smallest {
                        whole.add_effort(&part);
                        self.state = before;
                        (self.system.loads).restore_turned(&turned_before, &self.state.q);
                        self.share = 0.5 * share;
                        continue;
                    }
                    whole.add_part(part);
                    done += share;
                    if !converged {
                        // Smaller parts would not help: the rest of the step is tried as it is.
                        (self.share, can_cut) = (1.0, false);
                    } else if iterations <= quick {
                        self.share = (2.0 * self.share).min(1.0);
                    }
                }
                Err(error)
                    if !can_cut
                        || share <= smallest
                        || matches!(error, StepError::Intersection { .. }) =>
                {
                    self.state = start;
                    (self.system.loads).restore_turned(&turned, &self.state.q);
                    self.apply_schedules(self.state.time);
                    return Err(error);
                }
                Err(_) => self.share = 0.5 * share,
            }
        }
        if !whole.converged {
            self.share = smallest;
        }
        self.state.step = start.step + 1;
        self.state.time = start.time + dt;
        (whole.step, whole.time, whole.dt) = (self.state.step, self.state.time, dt);
        Ok(whole)
    }
}
