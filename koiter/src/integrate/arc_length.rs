//! Equilibria along a path of loads, through limit points: snap-through, snap-back, softening.
//!
//! ```text
//! ∇E(q) − λ f(q) = 0        ⟨q − q₀, q − q₀⟩ = Δs²        ⟨a, b⟩ = (1/n) Σ_v a_v · b_v
//! ```
//!
//! E elastic energy and constant loads [J], f the forces at a load factor λ of 1 [N], q₀ the last equilibrium; a_v are the
//! displacements [m] of the n vertices, so the arc length Δs is a root mean square displacement and does not depend on the
//! mesh. Newton's method on both equations takes two solves with one factor an iteration,
//!
//! ```text
//! δq = K⁻¹ (λ f − ∇E) + δλ K⁻¹ f        K = ∇²E − λ ∂f/∂q
//! δλ = (Δs² − ⟨u, u⟩ − 2 ⟨u, K⁻¹ (λ f − ∇E)⟩) / 2 ⟨u, K⁻¹ f⟩        u = q − q₀
//! ```
//!
//! from the tangent of the path, which goes on in the direction of the last increment. K is the exact Hessian and indefinite
//! beyond a limit point; its negative eigenvalues are counted. There is no line search, for there is nothing to
//! minimise: an arc on which Newton's method fails is halved.
//! Reference: M. A. Crisfield, "Non-linear Finite Element Analysis of Solids and Structures", vol. 1 (1991), sections 9.3
//! (cylindrical arc length) and 9.4.3 (linearised constraint).

use std::time::Instant;

use super::linear::Part;
use super::load_pattern::LoadPattern;
use super::{Integrator, Prescribed, State, StepError, StepReport, System};
use crate::assembly::ConfigurationSpace;
use crate::solve::{SignedCholesky, SparseCholesky, nested_dissection};

/// Where on its path a state stands.
#[derive(Clone, Debug, PartialEq)]
pub struct PathPoint {
    /// λ.
    pub load_factor: f64,
    /// Δs to try next [m].
    pub arc_length: f64,
    /// The last change of all unknowns; its direction is that of the path.
    pub increment: Vec<f64>,
}

/// How a path is followed.
#[derive(Clone, Debug, PartialEq)]
pub struct ArcLengthOptions {
    /// Root mean square displacement of the first step [m].
    pub first: f64,
    /// Largest root mean square displacement of a step [m].
    pub largest: f64,
    /// An arc is halved until it is this share of that which was tried first.
    pub smallest_share: f64,
    /// The path ends where λ rises to this: the last point has it exactly.
    pub last_load_factor: f64,
    /// Newton stops when no point moved further than this [m].
    pub displacement_tolerance: f64,
    /// Largest number of Newton iterations an arc, if it is less than 12.
    pub max_iterations: usize,
}

/// Follows a path by arc length: one step is one equilibrium.
pub struct ArcLength {
    options: ArcLengthOptions,
    pattern: LoadPattern,
    factor: Option<SignedCholesky>,
}

/// Newton's method either converges within these iterations or is better off with half the arc.
const MAX_ITERATIONS: usize = 12;

/// Iterations that neither lengthen nor shorten the next arc.
const USUAL_ITERATIONS: f64 = 5.0;

/// A point whose increment turned from the tangent by more than this cosine lies on another part of the path.
const SMALLEST_COSINE: f64 = 0.5;

/// Why there is no point at the end of an arc.
#[derive(Clone, Debug, thiserror::Error)]
enum Failure {
    #[error("the tangent is singular at {0}")]
    Singular(String),
    #[error("an energy is not defined")]
    NotDefined,
    #[error("Newton's method stopped after {0} iterations with a last step of {1:.1e} m")]
    Slow(usize, f64),
    #[error("the path turns too sharply")]
    Turned,
}

/// An equilibrium.
struct Equilibrium {
    q: Vec<f64>,
    load_factor: f64,
    iterations: usize,
    last_step: f64,
    negative_eigenvalues: usize,
}

/// The two solutions of an iteration, zero where `q` is prescribed.
struct Directions {
    /// K⁻¹ (λ f − ∇E).
    correction: Vec<f64>,
    /// K⁻¹ f.
    by_load: Vec<f64>,
}

/// The equation beside those of equilibrium.
enum Constraint<'a> {
    /// As far from a state as this [m].
    Arc(&'a [f64], f64),
    /// At this load factor.
    Load(f64),
}

impl Constraint<'_> {
    /// The change of λ that fulfils the linearised equation.
    fn load_change(&self, system: &System, q: &[f64], load_factor: f64, by: &Directions) -> f64 {
        match self {
            Self::Load(target) => target - load_factor,
            Self::Arc(start, length) => {
                let u = difference(q, start);
                let missing = length * length
                    - inner(system, &u, &u)
                    - 2.0 * inner(system, &u, &by.correction);
                missing / (2.0 * inner(system, &u, &by.by_load))
            }
        }
    }
}

impl ArcLength {
    /// Follows the path of these loads.
    pub fn new(options: ArcLengthOptions, pattern: LoadPattern) -> Self {
        Self {
            options,
            pattern,
            factor: None,
        }
    }

    /// The equilibrium without the scheduled loads, where the path begins.
    fn beginning(
        &self,
        system: &mut System,
        state: &State,
        prescribed: &Prescribed,
    ) -> Result<(Vec<f64>, PathPoint), StepError> {
        let mut q = state.q.clone();
        self.pattern.apply(0.0, system);
        let tolerance = self.options.displacement_tolerance;
        let solved = system
            .solve(&mut q, None, (&state.q, 1.0), prescribed, tolerance)
            .map_err(|error| (state.step + 1, error))?;
        if !solved.newton.converged {
            return Err(StepError::PathLost {
                step: state.step + 1,
                load_factor: 0.0,
                reason: "there is no equilibrium without the scheduled loads".into(),
            });
        }
        let point = PathPoint {
            load_factor: 0.0,
            arc_length: self.options.first,
            increment: Vec::new(),
        };
        Ok((q, point))
    }

    /// The equilibrium at the end of an arc from `start`.
    fn at_end_of_arc(
        &mut self,
        system: &mut System,
        (start, point): (&[f64], &PathPoint),
        arc_length: f64,
        is_fixed: &[bool],
        work: &mut StepReport,
    ) -> Result<Equilibrium, Failure> {
        let tangent = self
            .directions(system, start, point.load_factor, is_fixed, work)?
            .by_load;
        let forward = match point.increment.is_empty() {
            true => 1.0,
            false => inner(system, &tangent, &point.increment).signum(),
        };
        let load_change = forward * arc_length / inner(system, &tangent, &tangent).sqrt();
        let first: Vec<f64> = tangent.iter().map(|t| load_change * t).collect();
        let mut q = vec![0.0; start.len()];
        system.space.retract(start, &first, &mut q);
        let load_factor = point.load_factor + load_change;
        let constraint = Constraint::Arc(start, arc_length);
        let end = self.correct(system, (q, load_factor), &constraint, is_fixed, work)?;
        let along = inner(system, &difference(&end.q, start), &first);
        match along > SMALLEST_COSINE * arc_length * arc_length {
            true => Ok(end),
            false => Err(Failure::Turned),
        }
    }

    /// Newton's method for equilibrium and one more equation.
    fn correct(
        &mut self,
        system: &mut System,
        (mut q, mut load_factor): (Vec<f64>, f64),
        constraint: &Constraint<'_>,
        is_fixed: &[bool],
        work: &mut StepReport,
    ) -> Result<Equilibrium, Failure> {
        let most = MAX_ITERATIONS.min(self.options.max_iterations);
        let mut last_step = f64::INFINITY;
        for iteration in 1..=most {
            let by = self.directions(system, &q, load_factor, is_fixed, work)?;
            work.newton_iterations += 1;
            let load_change = constraint.load_change(system, &q, load_factor, &by);
            let both = by.correction.iter().zip(&by.by_load);
            let step: Vec<f64> = both.map(|(c, f)| c + load_change * f).collect();
            last_step = system.space.displacement(&q, &step);
            let before = std::mem::take(&mut q);
            q = vec![0.0; before.len()];
            system.space.retract(&before, &step, &mut q);
            load_factor = match constraint {
                Constraint::Arc(..) => load_factor + load_change,
                Constraint::Load(target) => *target,
            };
            if !(last_step.is_finite() && load_factor.is_finite()) {
                return Err(Failure::NotDefined);
            }
            if last_step < self.options.displacement_tolerance {
                let factor = self.factor.as_ref().expect("it was made for the solve");
                return Ok(Equilibrium {
                    q,
                    load_factor,
                    iterations: iteration,
                    last_step,
                    negative_eigenvalues: factor.negative_pivots(),
                });
            }
        }
        Err(Failure::Slow(most, last_step))
    }

    /// Both solutions with the exact tangent at `q`, over all unknowns.
    fn directions(
        &mut self,
        system: &mut System,
        q: &[f64],
        load_factor: f64,
        is_fixed: &[bool],
        work: &mut StepReport,
    ) -> Result<Directions, Failure> {
        if !system.is_admissible(q) {
            return Err(Failure::NotDefined);
        }
        let start = Instant::now();
        let force = self.pattern.force(q, load_factor, system);
        self.pattern.apply(load_factor, system);
        let (mut matrix, gradient) = system.second_derivatives(q, Part::All);
        let solved = system.layout.num_solved_dofs();
        let mut sides: Vec<f64> = gradient[..solved].iter().map(|g| -g).collect();
        matrix.fix(is_fixed, &vec![0.0; solved], &mut sides);
        let held = force.iter().zip(is_fixed);
        sides.extend(held.map(|(f, &fixed)| if fixed { 0.0 } else { *f }));
        spend(work, "assembly", start);
        if sides.iter().any(|value| !value.is_finite()) {
            return Err(Failure::NotDefined);
        }
        let start = Instant::now();
        let factor = self.factor.get_or_insert_with(|| {
            let mut factor = SignedCholesky::default();
            factor.analyze(&matrix.pattern, &nested_dissection(&matrix.pattern));
            factor
        });
        (factor.factorize(&matrix))
            .map_err(|failure| Failure::Singular(system.space.describe(failure.dof)))?;
        factor.solve(&mut sides);
        spend(work, "linear_solve", start);
        let mut by_load = sides.split_off(solved);
        sides.resize(q.len(), 0.0);
        by_load.resize(q.len(), 0.0);
        Ok(Directions {
            correction: sides,
            by_load,
        })
    }

    /// The end of the first arc that is short enough, and its length [m].
    fn next(
        &mut self,
        system: &mut System,
        from: (&[f64], &PathPoint),
        prescribed: &Prescribed,
        work: &mut StepReport,
    ) -> Result<(Equilibrium, f64), StepError> {
        let point = from.1;
        let smallest = self.options.smallest_share * point.arc_length;
        let mut arc_length = point.arc_length;
        loop {
            match self.at_end_of_arc(system, from, arc_length, &prescribed.is_fixed, work) {
                Ok(end) => return Ok((end, arc_length)),
                Err(_) if 0.5 * arc_length >= smallest => arc_length *= 0.5,
                Err(failure) => {
                    return Err(StepError::PathLost {
                        step: work.step,
                        load_factor: point.load_factor,
                        reason: format!(
                            "{failure} over an arc of {arc_length:.1e} m; try a smaller solver.first_arc_length, \
                             solver.largest_arc_length or solver.smallest_step"
                        ),
                    });
                }
            }
        }
    }
}

impl Integrator for ArcLength {
    fn step(
        &mut self,
        system: &mut System,
        state: &mut State,
        prescribed: &Prescribed,
        dt: f64,
    ) -> Result<StepReport, StepError> {
        let mut report = StepReport {
            step: state.step + 1,
            time: state.time + dt,
            dt,
            converged: true,
            min_gap: f64::INFINITY,
            ..Default::default()
        };
        let (start, point) = match &state.path {
            Some(point) => (state.q.clone(), point.clone()),
            None => self.beginning(system, state, prescribed)?,
        };
        let (mut end, arc_length) = self.next(system, (&start, &point), prescribed, &mut report)?;
        let growth = (USUAL_ITERATIONS / end.iterations as f64)
            .sqrt()
            .clamp(0.5, 2.0);
        let last = self.options.last_load_factor;
        if end.load_factor > last {
            // Where the path reaches its end, the last point is put there.
            let near = (end.q.clone(), end.load_factor);
            let load = Constraint::Load(last);
            let exact = self.correct(system, near, &load, &prescribed.is_fixed, &mut report);
            end = exact.unwrap_or(end);
        }
        self.pattern.apply(end.load_factor, system);
        system.loads.rebase(&end.q);
        let point = PathPoint {
            load_factor: end.load_factor,
            arc_length: (growth * arc_length).min(self.options.largest),
            increment: difference(&end.q, &start),
        };
        *state = State {
            path: Some(point),
            ..State::at_rest(end.q, report.time, report.step)
        };
        report.residual = end.last_step;
        report.energies = system.energies(state);
        report.load_factor = Some(end.load_factor);
        report.negative_eigenvalues = Some(end.negative_eigenvalues);
        Ok(report)
    }
}

impl System {
    fn is_admissible(&self, q: &[f64]) -> bool {
        self.elastic.iter().all(|energy| energy.is_admissible(q))
    }
}

/// ⟨a, b⟩ over the positions of all vertices.
fn inner(system: &System, a: &[f64], b: &[f64]) -> f64 {
    let shells = &system.space.shells;
    let vertices: usize = shells.iter().map(|shell| shell.mesh.num_vertices()).sum();
    let dofs = shells.iter().flat_map(|shell| shell.vertex_dofs());
    dofs.map(|dof| a[dof] * b[dof]).sum::<f64>() / vertices as f64
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn spend(work: &mut StepReport, part: &'static str, since: Instant) {
    work.add_effort(&StepReport {
        seconds: vec![(part, since.elapsed().as_secs_f64())],
        ..Default::default()
    });
}
