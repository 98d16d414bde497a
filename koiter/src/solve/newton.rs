//! Projected Newton's method with a filtered, backtracking line search.
//!
//! Every iteration solves `H p = −∇E` for the free unknowns, with prescribed ones stepping towards their targets, and
//! goes along p as far as the line search allows. While prescribed motions are under way the sum of energies may grow. It
//! stops when the step p, in metres, falls below the tolerance; that last step is still taken. No proof that this
//! terminates; it is bounded.

use std::time::Instant;

use super::limits::{Limit, Limiter};
use super::line_search::{SearchLine, line_search};
use super::low_rank;
use super::pace::Pace;
use super::saddle::leave_saddle;
use super::workspace::LinearWorkspace;
use crate::assembly::{ConfigurationSpace, DofLayout, Energy, HessianBuilder, PsdProjection};

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
    /// Projected, element by element, and exact where progress is slow: for problems that are far from convex.
    #[default]
    Projected,
    /// Exact from the first iteration on, projected where the exact Hessian is not positive definite.
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
    pub limiter: Option<Limiter>,
    /// The last fraction of the Newton step that was taken.
    pub last_fraction: f64,
    /// What cut line searches short, by cause.
    pub limits: Vec<Limit>,
    /// Where the last step was largest, in the user's terms.
    pub last_step_at: String,
    /// Seconds by part.
    pub seconds: Vec<(&'static str, f64)>,
    /// Factorisations that needed a diagonal shift.
    pub shifts: usize,
    /// Exact Hessians that were not positive definite.
    pub indefinite: usize,
    /// Saddles that were left.
    pub saddles: usize,
    /// Whether the last step was one with the exact Hessian: then that is positive definite.
    pub ends_definite: bool,
}

impl NewtonReport {
    /// Continues the report of one minimisation with that of the next: efforts add up.
    pub fn go_on(&mut self, next: Self) {
        let before = std::mem::replace(self, next);
        self.iterations += before.iterations;
        self.line_search_steps += before.line_search_steps;
        self.shifts += before.shifts;
        self.indefinite += before.indefinite;
        self.saddles += before.saddles;
        let later = std::mem::replace(&mut self.limits, before.limits);
        Limit::join(&mut self.limits, later);
        for (part, seconds) in before.seconds {
            self.add_seconds(part, seconds);
        }
    }

    /// Counts what cut the last line search short, if anything did.
    fn count_limit(&mut self) {
        let limiter = self.limiter.iter().filter(|_| self.last_fraction < 1.0);
        let limits = limiter.map(|limiter| Limit {
            by: limiter.by.clone(),
            count: 1,
            smallest_fraction: self.last_fraction,
            place: limiter.place.clone(),
        });
        Limit::join(&mut self.limits, limits);
    }

    pub(super) fn spend(&mut self, part: &'static str, since: Instant) {
        self.add_seconds(part, since.elapsed().as_secs_f64());
    }

    fn add_seconds(&mut self, part: &'static str, seconds: f64) {
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

/// Saddles that are left before [`minimize_stably`] gives up: every one costs energy, so they come to an end, but no
/// bound is known.
const MAX_SADDLES: usize = 20;

/// Moves `q` to a stable minimum: where [`minimize`] ends at a saddle, on along the direction of negative curvature.
///
/// # Errors
/// As for [`minimize`].
pub fn minimize_stably(
    problem: &mut Problem<'_>,
    options: &NewtonOptions,
    workspace: &mut LinearWorkspace,
    q: &mut [f64],
) -> Result<NewtonReport, SolveError> {
    let mut report = minimize(problem, options, workspace, q)?;
    for _ in 0..MAX_SADDLES {
        // A last step within the tolerance ends where its Hessian was taken.
        if !report.converged
            || report.ends_definite
            || !leave_saddle(problem, workspace, options.tolerance, q, &mut report)?
        {
            break;
        }
        report.saddles += 1;
        let remaining = NewtonOptions {
            max_iterations: options.max_iterations.saturating_sub(report.iterations),
            ..options.clone()
        };
        report.go_on(minimize(problem, &remaining, workspace, q)?);
    }
    Ok(report)
}

/// Moves `q` to a stationary point of the sum of energies, downhill.
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
    let mut pace = Pace::new(options.hessian);
    while report.iterations < options.max_iterations {
        let step = newton_step(problem, workspace, q, &mut pace, &mut report)?;
        report.iterations += 1;
        report.last_step = problem.space.displacement(q, &step.direction);
        let moving = step.remaining > 0.0;
        let reach = if moving { 1.0 } else { pace.reach() };
        let line = SearchLine {
            direction: &step.direction,
            slope: step.slope,
            reach,
            moving,
        };
        let taken = line_search(problem, q, &line, &mut report);
        pace.observe(report.last_step, taken.steps, taken.stopped_by.is_some());
        report.last_fraction = taken.steps.min(1.0);
        report.count_limit();
        if moving && taken.steps >= 1.0 {
            reach_targets(problem, q);
        }
        report.remaining = step.remaining * (1.0 - report.last_fraction);
        // A step within the tolerance that the line search shortened was shortened by round-off or a contact's slack.
        let small = report.last_step < options.tolerance && step.remaining < options.tolerance;
        report.converged = small && (!moving || taken.steps >= 1.0);
        if report.converged || report.iterations == options.max_iterations {
            report.last_step_at = problem.space.describe_largest(&step.direction);
            break;
        }
    }
    Ok(report)
}

/// Sets prescribed unknowns to their targets, which a whole step reaches up to round-off.
fn reach_targets(problem: &Problem<'_>, q: &mut [f64]) {
    let solved = problem.layout.num_solved_dofs();
    for (i, value) in q.iter_mut().enumerate() {
        if i >= solved || problem.is_fixed[i] {
            *value = problem.target[i];
        }
    }
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
    workspace: &mut LinearWorkspace,
    q: &[f64],
    pace: &mut Pace,
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
    let (gradient, mut rhs) = factorized_system(problem, workspace, q, &direction, pace, report)?;
    let start = Instant::now();
    let factor = workspace.factor.as_mut();
    let dense = (problem.energies.iter()).flat_map(|energy| energy.low_rank(q));
    let dense = dense.filter(|term| term.weight > 0.0).collect();
    low_rank::solve(factor, dense, problem.is_fixed, &direction, &mut rhs);
    direction[..solved].copy_from_slice(&rhs);
    report.spend("linear_solve", start);
    let slope = gradient.iter().zip(&direction).map(|(g, d)| g * d).sum();
    Ok(NewtonStep {
        direction,
        slope,
        remaining,
    })
}

/// Assembles and factorises, with as much negative curvature as leaves the matrix positive definite; returns the gradient
/// and the right-hand side.
fn factorized_system(
    problem: &Problem<'_>,
    workspace: &mut LinearWorkspace,
    q: &[f64],
    prescribed: &[f64],
    pace: &mut Pace,
    report: &mut NewtonReport,
) -> Result<(Vec<f64>, Vec<f64>), SolveError> {
    let mut gradient = vec![0.0; q.len()];
    loop {
        gradient.fill(0.0);
        let projection = pace.projection();
        let rhs = assemble(
            problem,
            workspace,
            q,
            prescribed,
            projection,
            &mut gradient,
            report,
        )?;
        let start = Instant::now();
        let may_shift = projection == PsdProjection::Clamp;
        let factorized = if may_shift {
            workspace.factorize_shifted(problem.is_fixed)
        } else {
            workspace.factorize().map(|()| 0)
        };
        report.spend("linear_solve", start);
        match factorized {
            Ok(shifts) => {
                report.shifts += shifts;
                report.ends_definite = projection == PsdProjection::Exact && shifts == 0;
                return Ok((gradient, rhs));
            }
            Err(dof) if may_shift => {
                return Err(SolveError::Indefinite {
                    unknown: problem.space.describe(dof),
                });
            }
            Err(_) => {
                report.indefinite += 1;
                pace.indefinite();
            }
        }
    }
}

/// Fills the matrix and returns the right-hand side, with prescribed unknowns eliminated.
fn assemble(
    problem: &Problem<'_>,
    workspace: &mut LinearWorkspace,
    q: &[f64],
    prescribed: &[f64],
    projection: PsdProjection,
    gradient: &mut [f64],
    report: &mut NewtonReport,
) -> Result<Vec<f64>, SolveError> {
    let solved = problem.layout.num_solved_dofs();
    let mut coupling = vec![0.0; solved];
    let matrix = workspace.matrix.as_mut().expect("the pattern was updated");
    matrix.values.fill(0.0);
    for energy in &problem.energies {
        let start = Instant::now();
        let mut hessian = HessianBuilder {
            matrix: &mut *matrix,
            layout: problem.layout,
            prescribed_step: &prescribed[solved..],
            coupling: &mut coupling,
        };
        energy.add_derivatives(q, projection, gradient, &mut hessian);
        report.spend(
            if energy.has_changing_pattern() {
                "contact"
            } else {
                "assembly"
            },
            start,
        );
    }
    let mut rhs: Vec<f64> = (0..solved).map(|i| -gradient[i] - coupling[i]).collect();
    if rhs.iter().any(|g| !g.is_finite()) {
        return Err(not_finite(&problem.energies, q));
    }
    matrix.fix(problem.is_fixed, &prescribed[..solved], &mut rhs);
    Ok(rhs)
}

pub(super) fn not_finite(energies: &[&mut dyn Energy], q: &[f64]) -> SolveError {
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
