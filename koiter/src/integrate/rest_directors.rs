//! The directors of a given surface: those that minimise its bending energy.

use std::ops::Range;

use crate::assembly::{ConfigurationSpace, DofLayout, Energy};
use crate::rest::RestError;
use crate::solve::{HessianChoice, LinearWorkspace, NewtonOptions, Problem, minimize_stably};

/// Directors move by angles; the step is the largest of them [rad].
struct Angles;

impl ConfigurationSpace for Angles {
    fn displacement(&self, _q: &[f64], dq: &[f64]) -> f64 {
        dq.iter()
            .fold(0.0, |m, d| if d.abs() <= m { m } else { d.abs() })
    }
    fn describe(&self, dof: usize) -> String {
        format!("director {dof}")
    }
}

/// Angles are found to this accuracy [rad]: the energy's error is its square.
const TOLERANCE: f64 = 1e-10;

/// Moves the directors, the unknowns in `range`, to a minimum of `bending`; everything else in `q` stays.
///
/// # Errors
/// [`RestError::Directors`] if Newton's method does not converge.
pub fn relax_directors(
    bending: &mut dyn Energy,
    layout: &DofLayout,
    range: Range<usize>,
    q: &mut [f64],
) -> Result<(), RestError> {
    let mut gradient = vec![0.0; q.len()];
    bending.add_gradient(q, &mut gradient);
    if gradient[range.clone()].iter().all(|moment| *moment == 0.0) {
        // A flat sheet: nothing to solve for, and the factorisation would be the largest cost of reading a scene.
        return Ok(());
    }
    let mut is_fixed = vec![true; layout.num_solved_dofs()];
    is_fixed[range].fill(false);
    let target = q.to_vec();
    let mut problem = Problem {
        energies: vec![bending],
        layout,
        space: &Angles,
        is_fixed: &is_fixed,
        target: &target,
    };
    // Projected, the quadratic energy of DSO took 12 to 37 iterations on small patches: with positions held, elements
    // are projected for motions that do not happen. Exact, it takes two.
    let options = NewtonOptions {
        tolerance: TOLERANCE,
        max_iterations: 100,
        hessian: HessianChoice::ExactWhereConvex,
    };
    let report = minimize_stably(&mut problem, &options, &mut LinearWorkspace::default(), q)
        .map_err(|error| RestError::Directors {
            reason: error.to_string(),
        })?;
    if report.converged {
        Ok(())
    } else {
        let reason = format!(
            "the last step was {:.1e} rad after {} iterations",
            report.last_step, report.iterations
        );
        Err(RestError::Directors { reason })
    }
}
