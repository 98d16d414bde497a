//! How much negative curvature the steps of Newton's method keep.
//!
//! Clamping it keeps every matrix positive definite, but where it matters (a sheet that buckles) it makes the model too
//! stiff: steps shrink by a constant factor only. Exact Hessians converge quadratically but are indefinite half of the
//! time. So the share of negative curvature that is kept is raised where progress is slow, and lowered where the matrix
//! is indefinite or the energy does not decrease along the step; a failure costs a factorisation, so the wait after it
//! doubles. Meanwhile the line search looks further than the Newton step. `docs/decisions/0006` has the figures.

use super::newton::HessianChoice;
use crate::assembly::PsdProjection;

/// The shares that are tried.
const KEPT: [f64; 4] = [0.0, 0.5, 0.75, 1.0];

/// Steps that shrink less than this between two iterations count as slow.
const SLOW_RATIO: f64 = 0.3;

/// A line search that takes less than this of a step, because the energy grows beyond, calls for more convexity.
const CURVED: f64 = 0.6;

/// A step of which this little is taken, whatever the reason, is wild: its matrix was barely definite.
const WILD: f64 = 0.05;

/// The line search looks at most this many Newton steps ahead: further reaches cost collision detection more than they
/// save (4 and 16 take the same iterations on the scene `drape-n`).
const LONGEST_REACH: f64 = 4.0;

/// After failures more negative curvature is tried again after at most this many iterations.
const LONGEST_WAIT: usize = 16;

/// What the last steps tell about the next.
#[derive(Debug)]
pub(super) struct Pace {
    choice: HessianChoice,
    level: usize,
    slow: bool,
    wait: usize,
    next_wait: usize,
    last_step: f64,
    /// Newton steps that the last line search took.
    taken: f64,
}

impl Pace {
    pub(super) fn new(choice: HessianChoice) -> Self {
        let level = match choice {
            HessianChoice::Projected => 0,
            HessianChoice::ExactWhereConvex => KEPT.len() - 1,
        };
        Self {
            choice,
            level,
            slow: false,
            wait: 0,
            next_wait: 0,
            last_step: f64::INFINITY,
            taken: 1.0,
        }
    }

    /// Which second derivatives give the next step.
    pub(super) fn projection(&self) -> PsdProjection {
        match KEPT[self.level] {
            0.0 => PsdProjection::Clamp,
            1.0 => PsdProjection::Exact,
            kept => PsdProjection::Partial(kept),
        }
    }

    /// The matrix was not positive definite.
    pub(super) fn indefinite(&mut self) {
        self.level = match self.choice {
            HessianChoice::Projected => self.level - 1,
            HessianChoice::ExactWhereConvex => 0,
        };
        self.next_wait = (2 * self.next_wait).clamp(1, LONGEST_WAIT);
        self.wait = self.next_wait;
    }

    /// A Newton step of this length [m] was taken in this many multiples; `by_energy`: no more because of the energy.
    pub(super) fn observe(&mut self, step: f64, taken: f64, by_energy: bool) {
        let ratio = step / self.last_step;
        (self.last_step, self.taken) = (step, taken);
        if self.choice != HessianChoice::Projected {
            // Failures are for one iteration.
            self.level = KEPT.len() - 1;
            return;
        }
        self.slow = ratio > SLOW_RATIO && (taken >= 0.5 || by_energy);
        self.wait = self.wait.saturating_sub(1);
        if (by_energy && taken < CURVED) || taken < WILD {
            self.level = self.level.saturating_sub(1);
        } else if self.slow && self.wait == 0 {
            self.level = (self.level + 1).min(KEPT.len() - 1);
        }
    }

    /// How many Newton steps ahead the line search may look.
    pub(super) fn reach(&self) -> f64 {
        if self.slow && self.level + 1 < KEPT.len() {
            (2.0 * self.taken).clamp(2.0, LONGEST_REACH)
        } else {
            1.0
        }
    }
}
