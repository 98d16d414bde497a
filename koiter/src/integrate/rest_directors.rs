//! The extra unknowns of a given surface: those that minimise its bending energy.

use std::ops::Range;

use crate::assembly::{ConfigurationSpace, DofLayout, Energy};
use crate::rest::RestError;
use crate::solve::{
    HessianChoice, LinearWorkspace, NewtonOptions, NewtonReport, Problem, SolveError,
    TrustRegionOptions, TrustRegionReport, leave_saddle, leave_saddles_by_node, minimize,
    minimize_in_trust_region,
};

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

/// Moves the directors, the unknowns in `range`, to a minimum of `bending`; everything else in `q` stays, and the unknowns
/// in `held` take the values there.
///
/// # Errors
/// [`RestError::Directors`] if Newton's method does not converge.
pub fn relax_directors(
    bending: &mut dyn Energy,
    layout: &DofLayout,
    range: Range<usize>,
    held: &[(usize, f64)],
    q: &mut [f64],
) -> Result<(), RestError> {
    for &(dof, value) in held {
        q[dof] = value;
    }
    let mut is_fixed = all_but(layout, range);
    for &(dof, _) in held {
        is_fixed[dof] = true;
    }
    let positions = q.to_vec();
    if let Some(mut cheaper) = bending.at_held_positions(&positions, layout) {
        return relax(
            vec![cheaper.as_mut()],
            layout,
            &is_fixed,
            1.0,
            q,
            find_directors,
        );
    }
    relax(vec![bending], layout, &is_fixed, 1.0, q, find_directors)
}

fn all_but(layout: &DofLayout, range: Range<usize>) -> Vec<bool> {
    let mut is_fixed = vec![true; layout.num_solved_dofs()];
    is_fixed[range].fill(false);
    is_fixed
}

/// Moves the points of edges, the unknowns in `range`, until the sum of `energies` no longer falls by more than 5 % in
/// 50 iterations; everything else in `q` stays. `edge_length` [m] says how small a step is small.
///
/// # Errors
/// [`RestError::Directors`] if the energy still falls after 400 iterations.
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
    let is_fixed = all_but(layout, range);
    relax(energies, layout, &is_fixed, edge_length, q, find_points)
}

fn relax<'a>(
    energies: Vec<&'a mut (dyn Energy + 'a)>,
    layout: &DofLayout,
    is_fixed: &[bool],
    unit: f64,
    q: &mut [f64],
    find_minimum: fn(&mut Problem<'_>, &mut [f64]) -> Result<(), String>,
) -> Result<(), RestError> {
    let mut gradient = vec![0.0; q.len()];
    for energy in &energies {
        energy.add_gradient(q, &mut gradient);
    }
    let mut free = gradient.iter().zip(is_fixed).filter(|(_, fixed)| !**fixed);
    if free.all(|(moment, _)| *moment == 0.0) {
        // A flat sheet: nothing to solve for, and the factorisation would be the largest cost of reading a scene.
        return Ok(());
    }
    let target = q.to_vec();
    let mut problem = Problem {
        energies: energies.into_iter().map(|e| e as &mut dyn Energy).collect(),
        layout,
        space: &Scaled { unit },
        is_fixed,
        target: &target,
    };
    find_minimum(&mut problem, q).map_err(|reason| RestError::Directors { reason })
}

/// A fall of the energy in a step that counts as none, relative. Where directors are nearly free, as those of DCS on a
/// crease of a right angle, valleys are flat to fourth order and angles are not to be had; the energy is.
const DECREMENT: f64 = 1e-6;

/// Times that saddles are left: each costs energy, so they come to an end, but no bound is known.
const MAX_ROUNDS: usize = 20;

/// Factorisations of the first descent: smooth surfaces take less than ten. On creases directors topple one after the
/// other, like dominoes, until those on saddles are turned off all at once.
const FIRST_FACTORIZATIONS: usize = 30;

/// Factorisations of the others.
const MAX_FACTORIZATIONS: usize = 500;

/// The longest step of a descent [rad].
const LONGEST_STEP: f64 = std::f64::consts::FRAC_PI_4;

/// Iterations after which it is looked whether the energy of points of edges still falls, and how often.
const ROUND: usize = 50;
const MAX_ROUNDS_OF_POINTS: usize = 8;

/// A fall in a whole round that counts as none for points of edges, relative. They slide in degenerate patches for
/// thousands of iterations: the energy falls by orders of magnitude within 100, then by less than this in each 50, at the
/// latest from 250 on (irregular triangles).
const NO_FALL_OF_POINTS: f64 = 0.05;

/// How far directors are turned off the saddles they stand on [rad]: on sharp creases minima lie near right angles.
const OFF_SADDLE: f64 = std::f64::consts::FRAC_PI_2;

/// From the start directors downhill; where that ends at no minimum, once more with directors turned off their saddles, all
/// at once. The lower minimum counts.
fn find_directors(problem: &mut Problem<'_>, q: &mut [f64]) -> Result<(), String> {
    let mut workspace = LinearWorkspace::default();
    let first = descend(problem, &mut workspace, FIRST_FACTORIZATIONS, q)?;
    if first.converged && first.ends_definite {
        return Ok(());
    }
    let before = (energy(problem, q), q.to_vec());
    leave_saddles_by_node(problem, &mut workspace, OFF_SADDLE, q).map_err(in_words)?;
    find_minimum(problem, &mut workspace, q)?;
    if before.0 < energy(problem, q) {
        q.copy_from_slice(&before.1);
        find_minimum(problem, &mut workspace, q)?;
    }
    Ok(())
}

/// Downhill, leaving saddles.
fn find_minimum(
    problem: &mut Problem<'_>,
    workspace: &mut LinearWorkspace,
    q: &mut [f64],
) -> Result<(), String> {
    let mut before = f64::INFINITY;
    for _ in 0..MAX_ROUNDS {
        let report = descend(problem, workspace, MAX_FACTORIZATIONS, q)?;
        if !report.converged {
            return Err(still_falling(report.factorizations));
        }
        let after = energy(problem, q);
        let is_still = before - after <= DECREMENT * after.abs();
        before = after;
        let mut times = NewtonReport::default();
        if report.ends_definite
            || is_still
            || !leave_saddle(problem, workspace, TOLERANCE, q, &mut times).map_err(in_words)?
        {
            break;
        }
    }
    Ok(())
}

fn descend(
    problem: &mut Problem<'_>,
    workspace: &mut LinearWorkspace,
    max_factorizations: usize,
    q: &mut [f64],
) -> Result<TrustRegionReport, String> {
    let options = TrustRegionOptions {
        tolerance: TOLERANCE,
        decrement: DECREMENT,
        longest_step: LONGEST_STEP,
        max_factorizations,
    };
    minimize_in_trust_region(problem, &options, workspace, q).map_err(in_words)
}

fn in_words(error: SolveError) -> String {
    error.to_string()
}

/// To an energy that no longer falls: the points themselves do not come to rest.
fn find_points(problem: &mut Problem<'_>, q: &mut [f64]) -> Result<(), String> {
    // On the regular cylinder projected Hessians need half of the iterations of exact ones.
    let options = NewtonOptions {
        tolerance: TOLERANCE,
        max_iterations: ROUND,
        hessian: HessianChoice::Projected,
    };
    let mut workspace = LinearWorkspace::default();
    let mut before = f64::INFINITY;
    for _ in 0..MAX_ROUNDS_OF_POINTS {
        let report = minimize(problem, &options, &mut workspace, q)
            .map_err(|error: SolveError| error.to_string())?;
        let after = energy(problem, q);
        if report.converged || before - after <= NO_FALL_OF_POINTS * after {
            return Ok(());
        }
        before = after;
    }
    Err(still_falling(ROUND * MAX_ROUNDS_OF_POINTS))
}

fn energy(problem: &Problem<'_>, q: &[f64]) -> f64 {
    problem.energies.iter().map(|energy| energy.value(q)).sum()
}

fn still_falling(iterations: usize) -> String {
    format!("the energy still falls after {iterations} iterations")
}
