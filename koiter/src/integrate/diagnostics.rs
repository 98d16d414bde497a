//! Why a step took the work it took, in terms a person can act on.

use std::fmt::Write;

use crate::solve::{DECREASE, Limit, NewtonReport};

/// What a step met on its way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// What cut line searches short, by cause.
    pub limits: Vec<Limit>,
    /// Hessians that were not positive definite and were assembled again with less negative curvature.
    pub indefinite: usize,
    /// Factorisations that needed a diagonal shift.
    pub shifts: usize,
    /// Saddles that were left.
    pub saddles: usize,
    /// Where the last Newton step was largest.
    pub residual_at: String,
    /// The pair with the smallest gap at the end of the step.
    pub closest: Option<String>,
    /// Active contact pairs by bodies, most first.
    pub contacts_by_bodies: Vec<(String, usize)>,
    /// For each energy the element with the largest force at the end of the step.
    pub largest_forces: Vec<LargestForce>,
}

/// The element of an energy that pulls most.
#[derive(Clone, Debug, PartialEq)]
pub struct LargestForce {
    /// Name of the energy.
    pub energy: String,
    /// Norm of the element's gradient [N; with rotations also N·m].
    pub force: f64,
    /// The element, in the user's terms.
    pub place: String,
}

impl Diagnostics {
    /// The part that a minimisation tells.
    pub fn of_newton(newton: &NewtonReport) -> Self {
        Self {
            limits: newton.limits.clone(),
            indefinite: newton.indefinite,
            shifts: newton.shifts,
            saddles: newton.saddles,
            residual_at: newton.last_step_at.clone(),
            ..Self::default()
        }
    }

    /// Adds the work of another attempt at the same step.
    pub fn add_effort(&mut self, other: &Self) {
        Limit::join(&mut self.limits, other.limits.iter().cloned());
        self.indefinite += other.indefinite;
        self.shifts += other.shifts;
        self.saddles += other.saddles;
    }

    /// This, with the state at the end of the next part of the step.
    pub(super) fn at_end_of(self, part: Self) -> Self {
        Self {
            limits: self.limits,
            indefinite: self.indefinite,
            shifts: self.shifts,
            saddles: self.saddles,
            ..part
        }
    }

    /// The smallest fraction of a Newton step that a line search left; 1 if all were taken whole.
    pub fn smallest_fraction(&self) -> f64 {
        let fractions = self.limits.iter().map(|limit| limit.smallest_fraction);
        fractions.fold(1.0, f64::min)
    }

    /// What cut most line searches short.
    pub fn main_limit(&self) -> Option<&Limit> {
        // The first of equal ones.
        self.limits.iter().rev().max_by_key(|limit| limit.count)
    }

    /// Why there were so many iterations, in a sentence without its full stop.
    pub fn reason(&self, iterations: usize) -> String {
        let mut reasons: Vec<String> = Vec::new();
        let mut limits: Vec<&Limit> = self.limits.iter().collect();
        limits.sort_by_key(|limit| std::cmp::Reverse(limit.count));
        for limit in limits {
            reasons.push(describe(limit, iterations));
        }
        for (count, what) in [
            (
                self.indefinite,
                "Hessians were indefinite and had to be assembled again",
            ),
            (self.shifts, "factorisations needed a diagonal shift"),
            (self.saddles, "saddles had to be left"),
        ] {
            if count > 0 {
                reasons.push(format!("{count} {what}"));
            }
        }
        if reasons.is_empty() {
            return "every Newton step was taken whole".into();
        }
        reasons.join("; ")
    }

    /// What to try when a step did not converge.
    pub fn advice(&self) -> &'static str {
        match self.main_limit().map(|limit| limit.by.as_str()) {
            Some("contact") => {
                "Try a smaller time.dt, a larger contact.d_hat, or slower obstacles; look at that place for layers that \
                 are squeezed between things that cannot give way"
            }
            Some("bending" | "clamps") => {
                "The fold there is sharper than the mesh can follow: try a finer mesh, a smaller time.dt, or a bending \
                 model without a bound, such as dcs"
            }
            Some("strain_limit") => {
                "Try a smaller time.dt, a slower motion of what pulls there, or a wider strain limit"
            }
            Some("membrane") => "Try a smaller time.dt, or a slower motion of what pulls there",
            Some(DECREASE) => {
                "The energy hardly falls along the steps: try a smaller time.dt, or a larger tolerance (solver.*_tolerance) \
                 if the last step is already small"
            }
            Some(_) => "Try a smaller time.dt, or slower motions",
            None => "Every step was whole, there were only too few: try a smaller time.dt",
        }
    }
}

fn describe(limit: &Limit, iterations: usize) -> String {
    let mut text = match limit.by.as_str() {
        DECREASE => "the energy did not fall over the whole of".to_owned(),
        by => format!("{} cut short", by.replace('_', " ")),
    };
    let (count, fraction) = (limit.count, limit.smallest_fraction);
    let _ = write!(
        text,
        " {count} of {iterations} Newton steps, the shortest to {fraction:.1e}"
    );
    if !limit.place.is_empty() {
        let _ = write!(text, " ({})", limit.place);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limit(by: &'static str, count: usize, smallest_fraction: f64, place: &str) -> Limit {
        Limit {
            by: by.into(),
            count,
            smallest_fraction,
            place: place.into(),
        }
    }

    #[test]
    fn causes_add_up_and_the_worst_place_is_kept() {
        let mut first = Diagnostics {
            limits: vec![limit("contact", 2, 0.1, "a")],
            shifts: 1,
            ..Diagnostics::default()
        };
        first.add_effort(&Diagnostics {
            limits: vec![limit(DECREASE, 9, 0.5, ""), limit("contact", 1, 1e-3, "b")],
            ..Diagnostics::default()
        });
        assert_eq!(
            first.limits,
            [limit("contact", 3, 1e-3, "b"), limit(DECREASE, 9, 0.5, "")]
        );
        assert_eq!(first.smallest_fraction(), 1e-3);
        assert_eq!(first.main_limit().unwrap().by, DECREASE);
        let reason = first.reason(20);
        assert!(
            reason.starts_with("the energy did not fall over the whole of 9 of 20"),
            "{reason}"
        );
        assert!(
            reason.contains("contact cut short 3 of 20 Newton steps, the shortest to 1.0e-3 (b)")
        );
        assert!(reason.ends_with("1 factorisations needed a diagonal shift"));
        assert_eq!(Diagnostics::default().smallest_fraction(), 1.0);
    }
}
