//! Newton's method over poses: positions and rotations.
//!
//! A step solves `K p = −g` with K the consistent tangent, or a mean of it and of the corotated one, which never is
//! indefinite, where the first is not positive definite; moves the pose along it (`x + α δx`, `exp(α δθ) R`) and halves α until the sum of the potentials falls enough. Where the
//! forces are not the derivatives of an energy ([`Potential::has_energy`]) full steps are taken.

use std::sync::Arc;
use std::time::Instant;

use super::pose::NODE_UNKNOWNS;
use super::{BezierError, Pose, Supports, Tangent};
use crate::assembly::{
    CoupledPairs, DofLayout, HessianBuilder, NodeId, Pattern, PatternBuilder, SymmetricMatrix,
};
use crate::solve::{
    LinearSolver, NodeBlocks, NodeOrdering, SparseCholesky, conjugate_gradients, nested_dissection,
};

/// A term of what is minimised.
pub trait Potential: Send + Sync {
    /// Called before derivatives are asked for at `pose`.
    fn begin(&mut self, _pose: &Pose) {}
    /// Its value [J]; `None` where it is not defined.
    fn value(&self, pose: &Pose) -> Option<f64>;
    /// Whether gradients are derivatives of the value.
    fn has_energy(&self) -> bool {
        true
    }
    /// Adds gradient (six a node) and second derivatives.
    fn add_derivatives(
        &self,
        pose: &Pose,
        tangent: Tangent,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    );
    /// Couples nodes.
    fn add_to_pattern(&self, _pattern: &mut PatternBuilder) {}
    /// The fraction of the way between two poses that may be taken, 1 for all of it.
    fn allowed(&mut self, _from: &Pose, _to: &Pose) -> f64 {
        1.0
    }
}

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub struct NewtonLimits {
    /// Most iterations.
    pub iterations: usize,
    /// Done when a full step moves no node by more than this [m], a rotation counting by the arm [`Self::arm`].
    pub tolerance: f64,
    /// Length that makes a rotation a displacement [m].
    pub arm: f64,
    /// No iteration is begun that is not expected to end by then.
    pub deadline: Option<Instant>,
    /// Which tangent to begin with.
    pub tangent: Tangent,
    /// Solve by conjugate gradients to this relative residual, instead of directly.
    pub conjugate_gradients: Option<f64>,
}

impl NewtonLimits {
    /// Limits for a shell of edges of length `edge` [m]: steps below 10⁻⁸ of it.
    pub fn for_edges(edge: f64) -> Self {
        Self {
            iterations: 50,
            tolerance: 1e-8 * edge,
            arm: edge,
            deadline: None,
            tangent: Tangent::Consistent,
            conjugate_gradients: None,
        }
    }
}

/// What came of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NewtonOutcome {
    /// Iterations.
    pub iterations: usize,
    /// Whether the last step was below the tolerance.
    pub converged: bool,
    /// Whether it ended for want of time.
    pub late: bool,
    /// Length of the last full step [m].
    pub last_step: f64,
    /// Times that the tangent was indefinite and had less of the consistent one.
    pub indefinite: usize,
    /// Iterations of conjugate gradients.
    pub inner_iterations: usize,
}

/// A node turns no more than this in an iteration [rad]: beyond, the linearised rotation means little.
const LARGEST_TURN: f64 = 0.5;

/// Armijo's constant.
const DECREASE: f64 = 1e-4;

const MOST_HALVINGS: usize = 30;

/// The share of the consistent tangent grows by this factor after a step, and falls by it where it is indefinite …
const SHARE_FACTOR: f64 = 2.0;

/// … and below this share it is left out.
const LEAST_SHARE: f64 = 0.1;

/// Iterations of conjugate gradients, at most.
const MOST_INNER: usize = 2000;

/// Pattern, matrix and factor, kept from one minimisation to the next.
pub struct Solver {
    layout: DofLayout,
    pairs: CoupledPairs,
    matrix: Option<SymmetricMatrix>,
    ordering: Option<NodeOrdering>,
    factor: Box<dyn SparseCholesky>,
    analyzed: bool,
    seconds_per_iteration: f64,
}

/// Value and derivatives at a pose.
struct Linearised {
    gradient: Vec<f64>,
    value: f64,
}

impl Solver {
    /// For shells with these unknowns.
    pub fn new(layout: DofLayout) -> Self {
        Self {
            layout,
            pairs: CoupledPairs::default(),
            matrix: None,
            ordering: None,
            factor: LinearSolver::default().create(),
            analyzed: false,
            seconds_per_iteration: 0.0,
        }
    }

    /// The couplings that the matrix has, contacts of the past among them: they decide its order of elimination, and with it
    /// the last bits of every solution.
    pub fn couplings(&self) -> Vec<[u32; 2]> {
        self.pairs.iter().map(|(a, b)| [a.0, b.0]).collect()
    }

    /// Makes the coming solutions those of a solver with these couplings; none: those of a new one.
    pub fn restore_couplings(&mut self, couplings: &[[u32; 2]]) {
        if couplings.is_empty() {
            return;
        }
        let mut builder = PatternBuilder::default();
        for pair in couplings {
            builder.couple(pair.map(NodeId));
        }
        self.take_pattern(builder.finish());
    }

    /// The matrix of the last iteration.
    pub fn matrix(&self) -> Option<&SymmetricMatrix> {
        self.matrix.as_ref()
    }

    /// Moves `pose` to a minimum of the sum of the potentials.
    ///
    /// # Errors
    /// A potential that is not defined at `pose`; supports that leave a motion without stiffness. `pose` is then the last
    /// one at which all was well.
    pub fn minimize(
        &mut self,
        potentials: &mut [&mut dyn Potential],
        supports: &Supports,
        pose: &mut Pose,
        limits: &NewtonLimits,
    ) -> Result<NewtonOutcome, BezierError> {
        // Inside the pool, so that its many short loops start without waking other threads.
        #[cfg(feature = "parallel")]
        return rayon::scope(|_| self.minimize_in_pool(potentials, supports, pose, limits));
        #[cfg(not(feature = "parallel"))]
        self.minimize_in_pool(potentials, supports, pose, limits)
    }

    fn minimize_in_pool(
        &mut self,
        potentials: &mut [&mut dyn Potential],
        supports: &Supports,
        pose: &mut Pose,
        limits: &NewtonLimits,
    ) -> Result<NewtonOutcome, BezierError> {
        let mut outcome = NewtonOutcome::default();
        let has_energy = potentials.iter().all(|p| p.has_energy());
        let mut share = limits.tangent.share();
        while outcome.iterations < limits.iterations && !outcome.converged {
            let start = Instant::now();
            let expected = std::time::Duration::from_secs_f64(self.seconds_per_iteration);
            let is_late = limits.deadline.is_some_and(|end| start + expected > end);
            if is_late && outcome.iterations > 0 {
                outcome.late = true;
                break;
            }
            for potential in potentials.iter_mut() {
                potential.begin(pose);
            }
            self.update_pattern(potentials);
            let (here, step) =
                self.step(potentials, supports, pose, &mut share, limits, &mut outcome)?;
            outcome.iterations += 1;
            outcome.last_step = length(&step, limits.arm);
            outcome.converged = outcome.last_step <= limits.tolerance;
            let moved = if has_energy {
                advance(potentials, pose, &here, &step)
            } else {
                Some(pose.moved(&step, largest_factor(&step)))
            };
            match moved {
                Some(moved) if moved.is_finite() => *pose = moved,
                // No decrease along a descent direction: round-off, or a potential that is not smooth here.
                _ => break,
            }
            // A mean over iterations: a single one may have been interrupted.
            let seconds = start.elapsed().as_secs_f64();
            self.seconds_per_iteration = match self.seconds_per_iteration {
                0.0 => seconds,
                mean => 0.7 * mean + 0.3 * seconds,
            };
        }
        Ok(outcome)
    }

    /// The first step from `pose`, not taken: the answer of the linear problem.
    ///
    /// # Errors
    /// As [`Self::minimize`].
    pub fn linear_step(
        &mut self,
        potentials: &mut [&mut dyn Potential],
        supports: &Supports,
        pose: &Pose,
        limits: &NewtonLimits,
    ) -> Result<Vec<f64>, BezierError> {
        for potential in potentials.iter_mut() {
            potential.begin(pose);
        }
        self.update_pattern(potentials);
        let (mut share, mut outcome) = (limits.tangent.share(), NewtonOutcome::default());
        let (_, step) = self.step(potentials, supports, pose, &mut share, limits, &mut outcome)?;
        Ok(step)
    }

    /// Linearises and solves for a step, with as large a share of the consistent tangent as is definite.
    fn step(
        &mut self,
        potentials: &[&mut dyn Potential],
        supports: &Supports,
        pose: &Pose,
        share: &mut f64,
        limits: &NewtonLimits,
        outcome: &mut NewtonOutcome,
    ) -> Result<(Linearised, Vec<f64>), BezierError> {
        let value = total(potentials, pose).ok_or(BezierError::Undefined)?;
        loop {
            let gradient = self.linearise(potentials, pose, Tangent::of_share(*share));
            let mut step: Vec<f64> = gradient.iter().map(|g| -g).collect();
            let still = vec![0.0; step.len()];
            let matrix = self.matrix.as_mut().expect("the pattern was made");
            matrix.fix(supports.held(), &still, &mut step);
            match self.solve(&mut step, limits, outcome) {
                Ok(()) => {
                    let grown = (SHARE_FACTOR * *share).max(LEAST_SHARE);
                    *share = grown.min(limits.tangent.share());
                    return Ok((Linearised { gradient, value }, step));
                }
                Err(_) if *share > 0.0 => {
                    *share /= SHARE_FACTOR;
                    if *share < LEAST_SHARE {
                        *share = 0.0;
                    }
                    outcome.indefinite += 1;
                }
                Err(unknown) => {
                    let vertex = unknown / NODE_UNKNOWNS;
                    return Err(BezierError::Singular { vertex });
                }
            }
        }
    }

    /// Assembles the matrix and returns the gradient.
    fn linearise(
        &mut self,
        potentials: &[&mut dyn Potential],
        pose: &Pose,
        tangent: Tangent,
    ) -> Vec<f64> {
        let unknowns = NODE_UNKNOWNS * pose.len();
        let (mut gradient, mut coupling) = (vec![0.0; unknowns], vec![0.0; unknowns]);
        let matrix = self.matrix.as_mut().expect("the pattern was made");
        matrix.values.fill(0.0);
        let mut hessian = HessianBuilder {
            matrix,
            layout: &self.layout,
            prescribed_step: &[],
            coupling: &mut coupling,
        };
        for potential in potentials {
            potential.add_derivatives(pose, tangent, &mut gradient, &mut hessian);
        }
        gradient
    }

    /// Replaces the right-hand side by the solution.
    ///
    /// # Errors
    /// The unknown whose pivot is not positive.
    fn solve(
        &mut self,
        rhs: &mut [f64],
        limits: &NewtonLimits,
        outcome: &mut NewtonOutcome,
    ) -> Result<(), usize> {
        let matrix = self.matrix.as_ref().expect("the pattern was made");
        if let Some(tolerance) = limits.conjugate_gradients {
            let blocks = NodeBlocks::of(matrix)?;
            let solved = conjugate_gradients(matrix, &blocks, rhs, tolerance, MOST_INNER);
            outcome.inner_iterations += solved.iterations;
            return solved.negative_direction.map_or(Ok(()), Err);
        }
        if !self.analyzed {
            let pattern = &matrix.pattern;
            let ordering = self
                .ordering
                .get_or_insert_with(|| nested_dissection(pattern));
            self.factor.analyze(pattern, ordering);
            self.analyzed = true;
        }
        self.factor.factorize(matrix).map_err(|error| error.dof)?;
        self.factor.solve(rhs);
        match rhs.iter().position(|x| !x.is_finite()) {
            Some(unknown) => Err(unknown),
            None => Ok(()),
        }
    }

    /// Makes the pattern hold all couplings; couplings of earlier contacts stay until there are new ones.
    fn update_pattern(&mut self, potentials: &[&mut dyn Potential]) {
        let mut builder = PatternBuilder::default();
        for potential in potentials {
            potential.add_to_pattern(&mut builder);
        }
        let needed = builder.finish();
        if self.matrix.is_none() || !self.pairs.contains_all(&needed) {
            self.take_pattern(needed);
        }
    }

    fn take_pattern(&mut self, pairs: CoupledPairs) {
        self.matrix = Some(SymmetricMatrix::zeros(Arc::new(Pattern::new(
            &self.layout,
            &pairs,
        ))));
        self.pairs = pairs;
        self.ordering = None;
        self.analyzed = false;
    }
}

fn total(potentials: &[&mut dyn Potential], pose: &Pose) -> Option<f64> {
    let mut sum = 0.0;
    for potential in potentials {
        sum += potential.value(pose)?;
    }
    sum.is_finite().then_some(sum)
}

/// The longest motion of a node [m].
fn length(step: &[f64], arm: f64) -> f64 {
    let of_node = |node: &[f64]| {
        let norm = |part: &[f64]| part.iter().map(|c| c * c).sum::<f64>().sqrt();
        norm(&node[..3]).max(arm * norm(&node[3..]))
    };
    (step.chunks_exact(NODE_UNKNOWNS).map(of_node)).fold(0.0, f64::max)
}

/// The fraction of a step that turns no node too far.
fn largest_factor(step: &[f64]) -> f64 {
    let turn = step
        .chunks_exact(NODE_UNKNOWNS)
        .map(|node| node[3..].iter().map(|c| c * c).sum::<f64>().sqrt())
        .fold(0.0, f64::max);
    (LARGEST_TURN / turn.max(f64::MIN_POSITIVE)).min(1.0)
}

/// Goes along a step as far as the sum of the potentials falls; `None` if it does not.
fn advance(
    potentials: &mut [&mut dyn Potential],
    pose: &Pose,
    here: &Linearised,
    step: &[f64],
) -> Option<Pose> {
    let slope: f64 = here.gradient.iter().zip(step).map(|(g, p)| g * p).sum();
    // The decrease of a converged step drowns in the round-off of the sum.
    let round_off = 1e-14 * here.value.abs().max(slope.abs());
    let mut factor = largest_factor(step);
    for _ in 0..MOST_HALVINGS {
        let trial = pose.moved(step, factor);
        let allowed = (potentials.iter_mut())
            .map(|p| p.allowed(pose, &trial))
            .fold(1.0, f64::min);
        if allowed < 1.0 {
            factor *= allowed.min(0.9);
            continue;
        }
        if let Some(value) = total(potentials, &trial)
            && value <= here.value + DECREASE * factor * slope + round_off
        {
            return Some(trial);
        }
        factor *= 0.5;
    }
    None
}
