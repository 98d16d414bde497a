//! What a step of Bézier shells tells, and why one did not converge.

use super::body::BezierBody;
use super::step::Effort;
use crate::Vec3;
use crate::bezier::{COLLAPSE_BEGINS, MappedContact};
use crate::integrate::{Diagnostics, StepReport};
use crate::scene::model::Model;

impl BezierBody {
    pub(super) fn report(&self, model: &Model, effort: &Effort) -> StepReport {
        let statistics = self.contact.as_ref().map(MappedContact::statistics);
        let pushed = (self.contact.as_ref()).map(|contact| contact.forces(&self.moving.pose).len());
        let mut measures = vec![
            ("elements", self.moving.shell.elements().len() as f64),
            ("procedures", self.done.len() as f64),
        ];
        measures.extend(pushed.map(|count| ("pushed_vertices", count as f64)));
        let asleep = self.contact.as_ref().map(MappedContact::num_asleep);
        measures.extend(asleep.map(|count| ("sleeping_pairs", count as f64)));
        let converged = effort.outcome.converged && effort.left == 0.0;
        StepReport {
            newton_iterations: effort.iterations,
            converged,
            contacts: statistics.as_ref().map_or(0, |s| s.contacts),
            min_gap: statistics.as_ref().map_or(f64::INFINITY, |s| s.min_gap),
            kappa: statistics.as_ref().map_or(0.0, |s| s.kappa),
            parts: effort.parts,
            measures,
            diagnosis: (!converged).then(|| diagnosis(model, effort) + &self.pressed()),
            diagnostics: Diagnostics {
                indefinite: effort.outcome.indefinite,
                closest: statistics.and_then(|s| s.closest),
                ..Diagnostics::default()
            },
            ..StepReport::default()
        }
    }

    /// Says where an element is pressed together, if one is.
    fn pressed(&self) -> String {
        let (shell, pose) = (&self.moving.shell, &self.moving.pose);
        let (element, share) = shell.most_pressed(pose);
        if share > COLLAPSE_BEGINS {
            return String::new();
        }
        let x = shell.corners(element, pose).0.iter().sum::<Vec3>() / 3.0;
        format!(
            "; at ({:.4}, {:.4}, {:.4}) m an element is pressed to {:.1} % of its area: pull more gently, sew with a wider patch or \
             where the lips are nearer, or take finer elements",
            x[0],
            x[1],
            x[2],
            100.0 * share
        )
    }
}

/// Why a step did not converge, and what to try.
fn diagnosis(model: &Model, effort: &Effort) -> String {
    if effort.left > 0.0 {
        return format!(
            "obstacles and constraints came only {:.0} % of their way in {} parts before they touched the shell: move them more slowly",
            100.0 * (1.0 - effort.left),
            effort.parts
        );
    }
    let outcome = &effort.outcome;
    format!(
        "the last of {} iterations still moved a node by {:.1e} m{}: take smaller steps, more damping or a larger tolerance",
        outcome.iterations,
        outcome.last_step,
        match (outcome.indefinite, model.integrator.is_dynamic()) {
            (0, _) => "",
            (_, true) => ", and the tangent was indefinite: something buckles",
            (_, false) =>
                ", and the tangent was indefinite: something buckles, which inertia would hold (implicit-euler)",
        }
    )
}
