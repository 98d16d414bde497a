//! Newton's method with exact Hessians inside a trust region, for problems of many small saddles.
//!
//! A step solves `(H + λ D) p = −g`, where D is the diagonal of |H|, at least its mean: unknowns that are nearly free, and
//! those on a saddle of their own, would need a multiple of their own small entries that stops all others. λ follows the
//! ratio of the energy's fall to what the step promised (Moré 1978), and is zero near a minimum. Projected Hessians are
//! too stiff there: what two elements share may have no curvature at all, although each of them has.

use std::collections::VecDeque;

use super::newton::{Problem, SolveError};
use super::saddle::assemble_exact;
use super::workspace::{LinearWorkspace, mean_size};

/// When to stop.
#[derive(Clone, Debug, PartialEq)]
pub struct TrustRegionOptions {
    /// Largest step at which the state counts as converged, as the problem's space measures it.
    pub tolerance: f64,
    /// Fall of the energy a step, relative to it, that counts as none if ten steps in a row have no more: in valleys that are
    /// flat to fourth order unknowns are not to be had, but the energy is.
    pub decrement: f64,
    /// Longest step, as the problem's space measures it: periodic energies let any length pass.
    pub longest_step: f64,
    /// Largest number of factorisations.
    pub max_factorizations: usize,
}

/// What happened.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrustRegionReport {
    /// Factorisations.
    pub factorizations: usize,
    /// Whether a tolerance was met.
    pub converged: bool,
    /// Whether it converged where the Hessian is positive definite.
    pub ends_definite: bool,
}

/// λ where none was needed before, the least, and the largest: entries of H are far below 10⁶ times their diagonal's mean.
const FIRST_SHIFT: f64 = 1e-2;
const LEAST_SHIFT: f64 = 1e-7;
const LARGEST_SHIFT: f64 = 1e6;

/// Growth and decay of λ.
const FACTOR: f64 = 4.0;

/// Ratios of the energy's fall to the promised one: below the first a step is refused, above the second λ decays.
const RATIOS: [f64; 2] = [0.1, 0.7];

/// Steps over which the energy must fall.
const LAST_STEPS: usize = 10;

/// Relative round-off of an energy: falls below it cannot be told from none.
const ROUND_OFF: f64 = 1e-13;

/// Moves `q` to where the sum of energies is stationary, downhill. Prescribed unknowns stay; there must be no contact.
///
/// # Errors
/// [`SolveError`]. Reaching the limit is told in the report.
pub fn minimize_in_trust_region(
    problem: &mut Problem<'_>,
    options: &TrustRegionOptions,
    workspace: &mut LinearWorkspace,
    q: &mut [f64],
) -> Result<TrustRegionReport, SolveError> {
    let mut report = TrustRegionReport::default();
    let mut shift = Shift::default();
    let mut energy = value(problem, q);
    let mut trial = vec![0.0; q.len()];
    let mut energies = VecDeque::from([energy]);
    loop {
        for energy in &mut problem.energies {
            energy.begin_iteration(q);
        }
        workspace.update_pattern(&mut problem.energies, problem.layout, q);
        let gradient = assemble_exact(problem, workspace, q)?;
        let diagonal = workspace.diagonal();
        let scale = at_least_mean(&diagonal, problem.is_fixed);
        loop {
            if report.factorizations == options.max_factorizations {
                return Ok(report);
            }
            report.factorizations += 1;
            if let Err(dof) =
                workspace.factorize_with(&diagonal, &scale, shift.now, problem.is_fixed)
            {
                if !shift.grow() {
                    let unknown = problem.space.describe(dof);
                    return Err(SolveError::Indefinite { unknown });
                }
                continue;
            }
            let (direction, promised) = step(problem, workspace, &gradient, &scale, shift.now);
            let length = problem.space.displacement(q, &direction);
            if length > options.longest_step && shift.grow() {
                continue;
            }
            problem.space.retract(q, &direction, &mut trial);
            let fall = energy - value(problem, &trial);
            let ratio = (fall + ROUND_OFF * energy.abs()) / (promised + ROUND_OFF * energy.abs());
            // NaN is refused too.
            let accepted = ratio >= RATIOS[0];
            if !accepted {
                // Beyond the largest shift there is only round-off left.
                if shift.grow() {
                    continue;
                }
                return Ok(report);
            }
            q.copy_from_slice(&trial);
            energy -= fall;
            energies.push_back(energy);
            let is_still = energies.len() > LAST_STEPS
                && energies.pop_front().is_some_and(|before| {
                    before - energy <= LAST_STEPS as f64 * options.decrement * energy.abs()
                });
            if length < options.tolerance || is_still {
                report.converged = true;
                report.ends_definite = shift.now == 0.0
                    || (workspace.factorize_with(&diagonal, &scale, 0.0, problem.is_fixed)).is_ok();
                return Ok(report);
            }
            if ratio > RATIOS[1] {
                shift.decay();
            }
            break;
        }
    }
}

/// λ.
struct Shift {
    now: f64,
    /// The last that was not zero.
    last: f64,
}

impl Default for Shift {
    fn default() -> Self {
        let last = FIRST_SHIFT;
        Self { now: 0.0, last }
    }
}

impl Shift {
    /// To the next larger one; whether there is one.
    fn grow(&mut self) -> bool {
        let next = if self.now > 0.0 {
            FACTOR * self.now
        } else {
            self.last
        };
        if next > LARGEST_SHIFT {
            return false;
        }
        (self.now, self.last) = (next, next);
        true
    }

    fn decay(&mut self) {
        if self.now > 0.0 {
            self.last = self.now;
        }
        let next = self.now / FACTOR;
        self.now = if next < LEAST_SHIFT { 0.0 } else { next };
    }
}

/// The step and the fall of the energy it promises, `−(g·p + ½ p·H p)`.
fn step(
    problem: &Problem<'_>,
    workspace: &mut LinearWorkspace,
    gradient: &[f64],
    scale: &[f64],
    shift: f64,
) -> (Vec<f64>, f64) {
    let mut solved: Vec<f64> = (0..scale.len())
        .map(|i| {
            if problem.is_fixed[i] {
                0.0
            } else {
                -gradient[i]
            }
        })
        .collect();
    workspace.factor.solve(&mut solved);
    let along: f64 = solved.iter().zip(gradient).map(|(p, g)| p * g).sum();
    let damping: f64 = (solved.iter().zip(scale))
        .map(|(p, d)| shift * d * p * p)
        .sum();
    let mut direction = vec![0.0; gradient.len()];
    direction[..solved.len()].copy_from_slice(&solved);
    (direction, 0.5 * (damping - along))
}

/// The sizes of the entries, at least the mean of those that are free.
fn at_least_mean(diagonal: &[f64], is_fixed: &[bool]) -> Vec<f64> {
    let mean = mean_size(diagonal, is_fixed);
    diagonal.iter().map(|d| d.abs().max(mean)).collect()
}

fn value(problem: &Problem<'_>, q: &[f64]) -> f64 {
    if problem.energies.iter().all(|e| e.is_admissible(q)) {
        problem.energies.iter().map(|e| e.value(q)).sum()
    } else {
        f64::INFINITY
    }
}
