//! All springs at once: Gauss–Newton steps on their errors, with compliance.
//!
//! ```text
//! minimise  ½ Σ m_p |x_p − x̃_p|² / h² + ½ Σ C_j² / α                 (M / h² + Jᵀ J / α) dx = −(M (x − x̃) / h² + Jᵀ C / α)
//! ```
//!
//! x̃ positions without springs [m], h step [s], α compliance [m/N], C and J of [`super::Network`]. The matrix is positive
//! definite whatever the rank of J: the paper's reason for taking colours one after the other, that all constraints together
//! are singular, is a property of A = J W Jᵀ and not of the constraints. Stiffness does not depend on the number of
//! iterations, and a shell bends as far as its layers ask: successive projections of a strip with a shrunk layer stop
//! before that.
//!
//! A step is halved until the sum falls.

use std::sync::Arc;

use super::double_layer::DoubleLayer;
use super::projection::{Lengths, ProjectionReport};
use super::springs::vector;
use crate::Vec3;
use crate::assembly::{DofLayout, NodeId, Pattern, PatternBuilder, SymmetricMatrix};
use crate::solve::{LinearSolver, NotPositiveDefinite, SparseCholesky, nested_dissection};

/// Most halvings of a step.
const HALVINGS: usize = 12;

/// A solver for all springs of a double layer.
pub struct GlobalSolve {
    ends: [Vec<[u32; 2]>; 4],
    /// Places of the blocks of each spring in the matrix: of its first end, of its second, between them.
    slots: [Vec<[u32; 3]>; 4],
    mean_length: f64,
    matrix: SymmetricMatrix,
    factor: Box<dyn SparseCholesky>,
    is_fixed: Vec<bool>,
    no_step: Vec<f64>,
    step: Vec<f64>,
    trial: Vec<Vec3>,
    /// x̃.
    goal: Vec<Vec3>,
}

/// How far a global solve goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlobalLimits {
    /// α [m/N].
    pub compliance: f64,
    /// h [s].
    pub dt: f64,
    /// Most iterations.
    pub iterations: usize,
    /// Iterations end when nothing moves further than this share of the mean length.
    pub tolerance: f64,
}

impl GlobalSolve {
    /// Analyses the matrix of a double layer.
    pub fn new(shell: &DoubleLayer) -> Self {
        let n = shell.particles.len();
        let mut layout = DofLayout::new();
        layout.push_nodes(n, 3, true);
        let ends = shell.springs.each_ref().map(|springs| springs.ends.clone());
        let mut builder = PatternBuilder::default();
        for pair in ends.iter().flatten() {
            builder.couple(pair.map(NodeId));
        }
        let pattern = Arc::new(Pattern::new(&layout, &builder.finish()));
        let slot = |row: u32, column: u32| {
            let slot = pattern.slot(NodeId(row), NodeId(column));
            slot.expect("the ends of springs are coupled")
        };
        let slots = ends.each_ref().map(|ends| {
            let of_spring = |&[a, b]: &[u32; 2]| [slot(a, a), slot(b, b), slot(a.max(b), a.min(b))];
            ends.iter().map(of_spring).collect()
        });
        let mut factor = LinearSolver::default().create();
        factor.analyze(&pattern, &nested_dissection(&pattern));
        let lengths = shell.springs.iter().flat_map(|s| &s.initial_lengths);
        Self {
            mean_length: lengths.sum::<f64>() / shell.num_springs() as f64,
            matrix: SymmetricMatrix::zeros(pattern),
            is_fixed: vec![false; 3 * n],
            no_step: vec![0.0; 3 * n],
            step: vec![0.0; 3 * n],
            trial: vec![Vec3::zeros(); n],
            goal: vec![Vec3::zeros(); n],
            ends,
            slots,
            factor,
        }
    }

    /// Moves `positions`, which are x̃ at first, by their `inverse_masses` [1/kg] (0: held). After every iteration `correct`
    /// may move particles out of obstacles.
    ///
    /// # Errors
    /// A matrix that cannot be factorised, which takes positions that are not finite.
    pub fn project(
        &mut self,
        positions: &mut [Vec3],
        lengths: Lengths<'_>,
        inverse_masses: &[f64],
        limits: GlobalLimits,
        mut correct: impl FnMut(&mut [Vec3]),
    ) -> Result<ProjectionReport, NotPositiveDefinite> {
        let mut report = ProjectionReport::default();
        self.goal.copy_from_slice(positions);
        for (fixed, mass) in self.is_fixed.chunks_exact_mut(3).zip(inverse_masses) {
            fixed.fill(!(*mass > 0.0));
        }
        while report.sweeps < limits.iterations && !report.converged {
            self.assemble(positions, lengths, inverse_masses, limits);
            self.matrix
                .fix(&self.is_fixed, &self.no_step, &mut self.step);
            self.factor.factorize(&self.matrix)?;
            self.factor.solve(&mut self.step);
            let longest = self.move_down(positions, lengths, inverse_masses, limits);
            correct(positions);
            report.sweeps += 1;
            report.converged = longest <= limits.tolerance * self.mean_length;
        }
        Ok(report)
    }

    /// Writes the matrix, and minus the gradient in place of the step.
    fn assemble(
        &mut self,
        x: &[Vec3],
        lengths: Lengths<'_>,
        inverse_masses: &[f64],
        limits: GlobalLimits,
    ) {
        self.matrix.values.fill(0.0);
        let inertia = |mass: f64| {
            if mass > 0.0 {
                1.0 / (mass * limits.dt * limits.dt)
            } else {
                0.0
            }
        };
        let pattern = Arc::clone(&self.matrix.pattern);
        for (particle, &mass) in inverse_masses.iter().enumerate() {
            let pull = -inertia(mass) * (x[particle] - self.goal[particle]);
            for axis in 0..3 {
                let dof = 3 * particle + axis;
                self.step[dof] = pull[axis];
                self.matrix.values[pattern.diagonal_positions()[dof] as usize] = inertia(mass);
            }
        }
        let stiffness = 1.0 / limits.compliance;
        for color in 0..4 {
            let springs = self.ends[color].iter().zip(&self.slots[color]);
            let wanted = lengths.targets[color].iter().zip(&lengths.is_there[color]);
            for ((&[a, b], &[at_a, at_b, between]), (&target, _)) in
                springs.zip(wanted).filter(|(_, (_, is_there))| **is_there)
            {
                let along = vector([a, b], x);
                let error = along.norm_squared() / target - target;
                let g = along * (2.0 / target);
                for axis in 0..3 {
                    let pull = stiffness * error * g[axis];
                    self.step[3 * a as usize + axis] -= pull;
                    self.step[3 * b as usize + axis] += pull;
                }
                let own = |r: usize, c: usize| stiffness * g[r] * g[c];
                let shared = |r: usize, c: usize| -stiffness * g[r] * g[c];
                self.matrix.add_block(at_a, NodeId(a), [3, 3], true, own);
                self.matrix.add_block(at_b, NodeId(b), [3, 3], true, own);
                self.matrix
                    .add_block(between, NodeId(a.min(b)), [3, 3], false, shared);
            }
        }
    }

    /// What is minimised [J].
    fn value(
        &self,
        x: &[Vec3],
        lengths: Lengths<'_>,
        inverse_masses: &[f64],
        limits: GlobalLimits,
    ) -> f64 {
        let particles = x.iter().zip(&self.goal).zip(inverse_masses);
        let moving = particles.filter(|(_, mass)| **mass > 0.0);
        let inertia: f64 = moving
            .map(|((x, goal), mass)| (x - goal).norm_squared() / mass)
            .sum();
        let mut errors = 0.0;
        for color in 0..4 {
            let wanted = lengths.targets[color].iter().zip(&lengths.is_there[color]);
            let springs = self.ends[color].iter().zip(wanted);
            for (&ends, (target, _)) in springs.filter(|(_, (_, is_there))| **is_there) {
                let error = vector(ends, x).norm_squared() / target - target;
                errors += error * error;
            }
        }
        0.5 * (inertia / (limits.dt * limits.dt) + errors / limits.compliance)
    }

    /// Takes the step, or the part of it that lowers the value; returns how far a particle moved at most [m].
    fn move_down(
        &mut self,
        positions: &mut [Vec3],
        lengths: Lengths<'_>,
        inverse_masses: &[f64],
        limits: GlobalLimits,
    ) -> f64 {
        let before = self.value(positions, lengths, inverse_masses, limits);
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            let steps = self.step.chunks_exact(3);
            for ((trial, x), step) in self.trial.iter_mut().zip(&*positions).zip(steps) {
                *trial = x + share * Vec3::from_column_slice(step);
            }
            if self.value(&self.trial, lengths, inverse_masses, limits) < before {
                let moved = self.trial.iter().zip(&*positions);
                let longest = moved
                    .map(|(trial, x)| (trial - x).norm())
                    .fold(0.0, f64::max);
                positions.copy_from_slice(&self.trial);
                return longest;
            }
            share *= 0.5;
        }
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::burning::quad_mesh::QuadMesh;

    fn relax(shell: &DoubleLayer, factors: [f64; 4], iterations: usize) -> (Vec<Vec3>, f64) {
        let scaled = shell.springs.iter().zip(factors);
        let targets: Vec<Vec<f64>> = scaled
            .map(|(springs, factor)| springs.initial_lengths.iter().map(|l| factor * l).collect())
            .collect();
        let is_there: Vec<Vec<bool>> = shell.springs.iter().map(|s| vec![true; s.len()]).collect();
        let lengths = Lengths {
            targets: &targets,
            is_there: &is_there,
        };
        let mut solve = GlobalSolve::new(shell);
        let mut x = shell.particles.clone();
        let masses = vec![1.0; x.len()];
        // Long steps of little inertia: statics.
        let limits = GlobalLimits {
            compliance: 1e-3,
            dt: 100.0,
            iterations: 10,
            tolerance: 1e-12,
        };
        for _ in 0..iterations {
            solve
                .project(&mut x, lengths, &masses, limits, |_| ())
                .unwrap();
        }
        let mut largest: f64 = 0.0;
        for color in 0..4 {
            for (&ends, target) in shell.springs[color].ends.iter().zip(&targets[color]) {
                largest = largest.max((vector(ends, &x).norm() / target - 1.0).abs());
            }
        }
        (x, largest)
    }

    #[test]
    fn a_strip_with_a_shrunk_layer_curls_to_the_radius_of_its_lengths() {
        let (cells, thickness) = (20, 0.25);
        let mesh = QuadMesh::grid([f64::from(cells), 1.0], [cells as usize, 1]).unwrap();
        let shell = DoubleLayer::new(mesh, thickness);
        for ratio in [0.98, 0.95] {
            let (x, strain) = relax(&shell, [0.5 * (1.0 + ratio), 1.0, ratio, ratio], 40);
            assert!(strain < 1e-3, "{strain}");
            // The turn from cell to cell, in the middle of the strip.
            let row = |i: usize| x[i];
            let direction = |i: usize| (row(i + 1) - row(i)).normalize();
            let middle = cells as usize / 2;
            let turn = direction(middle).dot(&direction(middle - 1)).acos();
            let radius = ratio / turn;
            let expected = ratio * thickness / (1.0 - ratio);
            let error = radius / expected - 1.0;
            // Chords of cells for arcs, and red springs that are not quite those of the bent strip.
            assert!(error.abs() < 0.08, "{radius} for {expected}");
        }
    }

    #[test]
    fn lengths_that_fit_are_met_and_momentum_is_kept() {
        let shell = DoubleLayer::new(QuadMesh::grid([4.0; 2], [4, 4]).unwrap(), 0.25);
        let center = |x: &[Vec3]| x.iter().sum::<Vec3>() / x.len() as f64;
        let (x, strain) = relax(&shell, [0.98; 4], 3);
        assert!(strain < 1e-6, "{strain}");
        assert!((center(&x) - center(&shell.particles)).norm() < 1e-12);
    }
}
