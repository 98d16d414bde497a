//! The extra unknowns of a given surface: those that minimise its bending energy.

use std::ops::Range;

use crate::assembly::{ConfigurationSpace, DofLayout, Energy};
use crate::rest::RestError;
use crate::solve::{HessianChoice, LinearWorkspace, NewtonOptions, Problem, minimize_stably};

/// Directors move by angles; the step is the largest of them [rad]. Points of edges move by lengths, in units of the
/// length of an edge.
struct Scaled {
    unit: f64,
}

impl ConfigurationSpace for Scaled {
    fn displacement(&self, _q: &[f64], dq: &[f64]) -> f64 {
        let largest = dq
            .iter()
            .fold(0.0, |m, d| if d.abs() <= m { m } else { d.abs() });
        largest / self.unit
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
    relax(vec![bending], layout, range, 1.0, q)
}

/// Moves the points of edges, the unknowns in `range`, to a minimum of the sum of `energies`; everything else in `q`
/// stays. `edge_length` [m] says how small a step is small.
///
/// # Errors
/// [`RestError::Directors`] if Newton's method does not converge.
pub fn relax_edge_points(
    energies: &mut [Box<dyn Energy>],
    layout: &DofLayout,
    range: Range<usize>,
    edge_length: f64,
    q: &mut [f64],
) -> Result<(), RestError> {
    let energies = energies
        .iter_mut()
        .map(|e| &mut **e as &mut dyn Energy)
        .collect();
    relax(energies, layout, range, edge_length, q)
}

fn relax<'a>(
    energies: Vec<&'a mut (dyn Energy + 'a)>,
    layout: &DofLayout,
    range: Range<usize>,
    unit: f64,
    q: &mut [f64],
) -> Result<(), RestError> {
    let mut gradient = vec![0.0; q.len()];
    for energy in &energies {
        energy.add_gradient(q, &mut gradient);
    }
    if gradient[range.clone()].iter().all(|moment| *moment == 0.0) {
        // A flat sheet: nothing to solve for, and the factorisation would be the largest cost of reading a scene.
        return Ok(());
    }
    let mut is_fixed = vec![true; layout.num_solved_dofs()];
    is_fixed[range].fill(false);
    let target = q.to_vec();
    let mut problem = Problem {
        energies: energies.into_iter().map(|e| e as &mut dyn Energy).collect(),
        layout,
        space: &Scaled { unit },
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
            "the last step was {:.1e} after {} iterations",
            report.last_step, report.iterations
        );
        Err(RestError::Directors { reason })
    }
}
