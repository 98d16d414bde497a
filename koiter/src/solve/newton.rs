//! Projected Newton's method with a filtered, backtracking line search.
//!
//! Every iteration solves `H p = −∇E` for the free unknowns, with prescribed ones stepping towards their targets, and
//! goes along p as far as (1) contact allows ([`Energy::max_step`]), (2) every energy is defined, (3) the sum of energies
//! decreases enough (Armijo). While prescribed motions are under way the sum may grow, and (3) is replaced by finiteness.
//! It stops when the step p, in metres, falls below the tolerance. No proof that this terminates; it is bounded.

use std::sync::Arc;
use std::time::Instant;

use super::cholesky::{Factorization, SparseCholesky};
use super::ordering::{NodeOrdering, nested_dissection};
use crate::assembly::{
    ConfigurationSpace, CoupledPairs, DofLayout, Energy, HessianBuilder, Pattern, PatternBuilder,
    PsdProjection, SymmetricMatrix,
};

/// What to minimise and what is held.
pub struct Problem<'a> {
    /// Energies; their sum is minimised.
    pub energies: Vec<&'a mut dyn Energy>,
    /// Grouping of the unknowns.
    pub layout: &'a DofLayout,
    /// How unknowns move.
    pub space: &'a dyn ConfigurationSpace,
    /// Which of the solved unknowns are prescribed.
    pub is_fixed: &'a [bool],
    /// Values of `q` to reach where it is prescribed (fixed unknowns, and all that are not solved for).
    pub target: &'a [f64],
}

/// When to stop.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonOptions {
    /// Largest step [m] at which the state counts as converged.
    pub tolerance: f64,
    /// Largest number of iterations.
    pub max_iterations: usize,
    /// Which second derivatives give the steps.
    pub hessian: HessianChoice,
}

/// Which second derivatives give the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HessianChoice {
    /// Projected, element by element: steps always go downhill, but convergence is only linear where elements have
    /// negative curvature that their sum has not.
    #[default]
    Projected,
    /// The true Hessian where it is positive definite, projected elsewhere: convergence is quadratic, at the price of a
    /// second assembly where it is not.
    ExactWhereConvex,
}

/// What happened.
#[derive(Clone, Debug, Default)]
pub struct NewtonReport {
    /// Iterations.
    pub iterations: usize,
    /// Evaluations in line searches.
    pub line_search_steps: usize,
    /// Whether the tolerance was met and all targets reached.
    pub converged: bool,
    /// Last step [m].
    pub last_step: f64,
    /// Largest distance of a prescribed unknown from its target.
    pub remaining: f64,
    /// What limited the last line search.
    pub limiter: Option<String>,
    /// The last fraction of the Newton step that was taken.
    pub last_fraction: f64,
    /// Seconds by part.
    pub seconds: Vec<(&'static str, f64)>,
    /// Factorisations that needed a diagonal shift.
    pub shifts: usize,
}

impl NewtonReport {
    fn spend(&mut self, part: &'static str, since: Instant) {
        let seconds = since.elapsed().as_secs_f64();
        match self.seconds.iter_mut().find(|(name, _)| *name == part) {
            Some((_, total)) => *total += seconds,
            None => self.seconds.push((part, seconds)),
        }
    }
}

/// Why no minimum was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// An energy is not finite at the start of an iteration.
    #[error("energy '{energy}' is not finite at {element}")]
    NotFinite {
        /// Name of the energy.
        energy: String,
        /// The element.
        element: String,
    },
    /// The matrix could not be factorised after the largest shift.
    #[error(
        "the Hessian is not positive definite at {unknown}; is a part of the scene free to move without resistance?"
    )]
    Indefinite {
        /// The unknown, in the user's terms.
        unknown: String,
    },
}

/// Pattern, matrix and factor, kept between steps.
#[derive(Default)]
pub struct LinearWorkspace {
    static_pairs: Option<CoupledPairs>,
    changing_pairs: CoupledPairs,
    ordering: Option<NodeOrdering>,
    entries_at_ordering: usize,
    matrix: Option<SymmetricMatrix>,
    factor: Factorization,
}

/// Shifts to try, relative to the diagonal, when a factorisation fails.
const SHIFTS: [f64; 6] = [1e-8, 1e-6, 1e-4, 1e-2, 1.0, 1e2];

/// Contacts make the factor fuller than the order was made for; beyond this ratio a new order pays.
const REORDER_GROWTH: f64 = 1.5;

impl LinearWorkspace {
    /// Stored entries of the lower triangle.
    pub fn entries(&self) -> usize {
        self.matrix.as_ref().map_or(0, |m| m.values.len())
    }

    /// The matrix of the last assembly.
    pub fn matrix(&self) -> Option<&SymmetricMatrix> {
        self.matrix.as_ref()
    }

    /// Makes the pattern hold all couplings of the energies at `q`; keeps it if it does already.
    pub fn update_pattern(
        &mut self,
        energies: &mut [&mut dyn Energy],
        layout: &DofLayout,
        q: &[f64],
    ) {
        let collect = |energies: &[&mut dyn Energy], changing: bool| {
            let mut builder = PatternBuilder::default();
            for energy in energies
                .iter()
                .filter(|e| e.has_changing_pattern() == changing)
            {
                energy.add_to_pattern(q, &mut builder);
            }
            builder.finish()
        };
        let new_topology = self.static_pairs.is_none();
        let static_pairs = self
            .static_pairs
            .get_or_insert_with(|| collect(energies, false));
        let needed = collect(energies, true);
        if !new_topology && self.changing_pairs.contains_all(&needed) {
            return;
        }
        // Couplings of earlier contacts are kept as explicit zeros while they are few: contacts flicker.
        let kept = if self.changing_pairs.len() <= 2 * needed.len() {
            &self.changing_pairs
        } else {
            &CoupledPairs::default()
        };
        self.changing_pairs = kept.union(&needed);
        let pattern = Arc::new(Pattern::new(
            layout,
            &static_pairs.union(&self.changing_pairs),
        ));
        for energy in energies.iter_mut() {
            energy.bind(&pattern);
        }
        let ordering = self
            .ordering
            .get_or_insert_with(|| nested_dissection(&pattern));
        self.factor.analyze(&pattern, ordering);
        if new_topology {
            self.entries_at_ordering = self.factor.factor_entries();
        } else if self.factor.factor_entries() as f64
            > REORDER_GROWTH * self.entries_at_ordering as f64
        {
            *ordering = nested_dissection(&pattern);
            self.factor.analyze(&pattern, ordering);
            self.entries_at_ordering = self.factor.factor_entries();
        }
        self.matrix = Some(SymmetricMatrix::zeros(pattern));
    }

    /// Factorises the assembled matrix, if it is positive definite.
    fn factorize_as_it_is(&mut self) -> Result<(), usize> {
        let matrix = self.matrix.as_ref().expect("the matrix was assembled");
        self.factor.factorize(matrix).map_err(|failure| failure.dof)
    }

    /// Factorises the assembled matrix, with a diagonal shift if it must be; returns the number of shifts tried.
    fn factorize(&mut self) -> Result<usize, usize> {
        let matrix = self.matrix.as_mut().expect("the matrix was assembled");
        let Err(mut failure) = self.factor.factorize(matrix) else {
            return Ok(0);
        };
        let pattern = Arc::clone(&matrix.pattern);
        let mut applied = 0.0;
        for (attempt, shift) in SHIFTS.iter().enumerate() {
            for &position in pattern.diagonal_positions() {
                let value = &mut matrix.values[position as usize];
                *value = *value / (1.0 + applied) * (1.0 + shift);
            }
            applied = *shift;
            match self.factor.factorize(matrix) {
                Ok(()) => return Ok(attempt + 1),
                Err(error) => failure = error,
            }
        }
        Err(failure.dof)
    }
}

/// Moves `q` to a local minimum of the sum of energies.
///
/// # Errors
/// See [`SolveError`]. Reaching the iteration limit is told in the report.
pub fn minimize(
    problem: &mut Problem<'_>,
    options: &NewtonOptions,
    workspace: &mut LinearWorkspace,
    q: &mut [f64],
) -> Result<NewtonReport, SolveError> {
    let mut report = NewtonReport {
        last_fraction: 1.0,
        ..Default::default()
    };
    let start = Instant::now();
    for energy in &mut problem.energies {
        energy.prepare(q);
    }
    report.spend("contact", start);
    let mut trial = vec![0.0; q.len()];
    while report.iterations < options.max_iterations {
        let step = newton_step(problem, options.hessian, workspace, q, &mut report)?;
        report.iterations += 1;
        report.last_step = problem.space.displacement(q, &step.direction);
        let moving = step.remaining > 0.0;
        let done = report.last_step < options.tolerance && step.remaining < options.tolerance;
        line_search(problem, q, &step, moving, &mut trial, &mut report);
        report.remaining = step.remaining * (1.0 - report.last_fraction);
        if done && report.last_fraction == 1.0 {
            report.converged = true;
            break;
        }
        if done && !moving {
            // The step is within the tolerance; that the line search shortened it is round-off or a contact's slack.
            report.converged = true;
            break;
        }
    }
    Ok(report)
}

struct NewtonStep {
    direction: Vec<f64>,
    /// ∇E · direction.
    slope: f64,
    /// Largest prescribed motion still to be made.
    remaining: f64,
}

fn newton_step(
    problem: &mut Problem<'_>,
    choice: HessianChoice,
    workspace: &mut LinearWorkspace,
    q: &[f64],
    report: &mut NewtonReport,
) -> Result<NewtonStep, SolveError> {
    let start = Instant::now();
    for energy in &mut problem.energies {
        energy.begin_iteration(q);
    }
    report.spend("contact", start);
    let start = Instant::now();
    workspace.update_pattern(&mut problem.energies, problem.layout, q);
    report.spend("analysis", start);
    let solved = problem.layout.num_solved_dofs();
    let mut direction: Vec<f64> = (0..q.len())
        .map(|i| {
            if i >= solved || problem.is_fixed[i] {
                problem.target[i] - q[i]
            } else {
                0.0
            }
        })
        .collect();
    let remaining = direction.iter().fold(0.0f64, |m, d| m.max(d.abs()));
    let mut system = None;
    if choice == HessianChoice::ExactWhereConvex {
        let (gradient, mut rhs) = assemble(problem, workspace, q, PsdProjection::Exact, &direction, report)?;
        let start = Instant::now();
        if workspace.factorize_as_it_is().is_ok() {
            workspace.factor.solve(&mut rhs);
            system = Some((gradient, rhs));
        }
        report.spend("linear solve", start);
    }
    let (gradient, solution) = match system {
        Some(solved) => solved,
        None => {
            let (gradient, mut rhs) = assemble(problem, workspace, q, PsdProjection::Clamp, &direction, report)?;
            let start = Instant::now();
            report.shifts += workspace.factorize().map_err(|dof| SolveError::Indefinite {
                unknown: problem.space.describe(dof),
            })?;
            workspace.factor.solve(&mut rhs);
            report.spend("linear solve", start);
            (gradient, rhs)
        }
    };
    direction[..solved].copy_from_slice(&solution);
    let slope = gradient.iter().zip(&direction).map(|(g, d)| g * d).sum();
    Ok(NewtonStep {
        direction,
        slope,
        remaining,
    })
}

/// Fills the matrix; returns the gradient and the right-hand side, with prescribed unknowns taken out of both.
fn assemble(
    problem: &mut Problem<'_>,
    workspace: &mut LinearWorkspace,
    q: &[f64],
    projection: PsdProjection,
    direction: &[f64],
    report: &mut NewtonReport,
) -> Result<(Vec<f64>, Vec<f64>), SolveError> {
    let solved = problem.layout.num_solved_dofs();
    let mut gradient = vec![0.0; q.len()];
    let mut coupling = vec![0.0; solved];
    let matrix = workspace.matrix.as_mut().expect("the pattern was updated");
    matrix.values.fill(0.0);
    for energy in &problem.energies {
        let start = Instant::now();
        let mut hessian = HessianBuilder {
            matrix: &mut *matrix,
            layout: problem.layout,
            prescribed_step: &direction[solved..],
            coupling: &mut coupling,
        };
        energy.add_derivatives(q, projection, &mut gradient, &mut hessian);
        let part = if energy.has_changing_pattern() { "contact" } else { "assembly" };
        report.spend(part, start);
    }
    let mut rhs: Vec<f64> = (0..solved).map(|i| -gradient[i] - coupling[i]).collect();
    if rhs.iter().any(|g| !g.is_finite()) {
        return Err(not_finite(&problem.energies, q));
    }
    matrix.fix(problem.is_fixed, &direction[..solved], &mut rhs);
    Ok((gradient, rhs))
}

fn not_finite(energies: &[&mut dyn Energy], q: &[f64]) -> SolveError {
    for energy in energies {
        if let Some(worst) = energy
            .worst_element(q)
            .filter(|w| !w.gradient_norm.is_finite())
        {
            return SolveError::NotFinite {
                energy: energy.name().into(),
                element: worst.description,
            };
        }
    }
    SolveError::NotFinite {
        energy: "sum".into(),
        element: "an unknown place".into(),
    }
}

/// Halvings before a line search gives up: 2⁻⁶⁰ of a step is below round-off of any position.
const MAX_HALVINGS: usize = 60;

/// Moves `q` along the step; leaves it where it is if no fraction will do.
fn line_search(
    problem: &mut Problem<'_>,
    q: &mut [f64],
    step: &NewtonStep,
    moving: bool,
    trial: &mut [f64],
    report: &mut NewtonReport,
) {
    let start = Instant::now();
    report.limiter = None;
    let mut fraction: f64 = 1.0;
    for energy in &mut problem.energies {
        let bound = energy.max_step(q, &step.direction);
        if bound < fraction {
            fraction = bound;
            report.limiter = energy.step_limiter();
        }
    }
    report.spend("collision detection", start);
    let start = Instant::now();
    let total = |energies: &[&mut dyn Energy], q: &[f64]| -> (f64, f64) {
        let values: Vec<f64> = energies.iter().map(|e| e.value(q)).collect();
        (values.iter().sum(), values.iter().map(|v| v.abs()).sum())
    };
    let (before, magnitude) = total(&problem.energies, q);
    // Round-off of a sum of that magnitude: differences below it say nothing.
    let noise = 1e-14 * magnitude;
    let mut moved = vec![0.0; q.len()];
    let mut accepted = false;
    for _ in 0..MAX_HALVINGS {
        report.line_search_steps += 1;
        for (m, d) in moved.iter_mut().zip(&step.direction) {
            *m = fraction * d;
        }
        problem.space.retract(q, &moved, trial);
        match problem.energies.iter().find(|e| !e.is_admissible(trial)) {
            Some(energy) => {
                report.limiter = Some(format!("{} is not defined further on", energy.name()))
            }
            None => {
                let after = total(&problem.energies, trial).0;
                if after.is_finite()
                    && (moving || after <= before + 1e-4 * fraction * step.slope.min(0.0) + noise)
                {
                    accepted = true;
                    break;
                }
                report.limiter = Some("the energy does not decrease further on".into());
            }
        }
        fraction *= 0.5;
    }
    if accepted {
        q.copy_from_slice(trial);
    } else {
        fraction = 0.0;
    }
    report.last_fraction = fraction;
    report.spend("line search", start);
}
