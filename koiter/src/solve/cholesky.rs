//! Sparse Cholesky factorisation: what the solver asks of it, and the choice between two.

use super::multifrontal::Multifrontal;
use super::ordering::NodeOrdering;
use super::supernodal::Supernodal;
use crate::assembly::{Pattern, SymmetricMatrix};

/// A factorisation met a pivot that is not positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the matrix is not positive definite at unknown {dof}")]
pub struct NotPositiveDefinite {
    /// The unknown whose pivot failed.
    pub dof: usize,
}

/// Analyses a pattern once, then factorises matrices of that pattern.
pub trait SparseCholesky: Send + Sync {
    /// Prepares for matrices of `pattern`, eliminated in the given order.
    fn analyze(&mut self, pattern: &Pattern, ordering: &NodeOrdering);
    /// Entries of the factor after [`Self::analyze`].
    fn factor_entries(&self) -> usize;
    /// Factorises.
    ///
    /// # Errors
    /// An unknown whose pivot is not positive; exact for [`LinearSolver::Multifrontal`], nearby for the other.
    fn factorize(&mut self, matrix: &SymmetricMatrix) -> Result<(), NotPositiveDefinite>;
    /// Replaces `rhs`, one column after another for several right-hand sides, by the solution.
    fn solve(&mut self, rhs: &mut [f64]);
}

/// Which factorisation solves the linear systems.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinearSolver {
    /// Our own driver: subtrees of the elimination tree in parallel.
    #[default]
    Multifrontal,
    /// That of the crate `faer`, on one thread: the reference.
    Supernodal,
}

impl LinearSolver {
    /// A factorisation that has analysed nothing yet.
    pub fn create(self) -> Box<dyn SparseCholesky> {
        match self {
            Self::Multifrontal => Box::new(Multifrontal::default()),
            Self::Supernodal => Box::new(Supernodal::default()),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::assembly::{DofLayout, NodeId, PatternBuilder};
    use crate::solve::{SignedCholesky, nested_dissection};

    /// Nodes of three unknowns on the vertices of an n × n grid and of one unknown on its cells.
    fn grid(n: u32) -> SymmetricMatrix {
        let mut layout = DofLayout::new();
        layout.push_nodes((n * n) as usize, 3, true);
        layout.push_nodes(((n - 1) * (n - 1)) as usize, 1, true);
        let mut builder = PatternBuilder::default();
        for (i, j) in (0..n - 1).flat_map(|i| (0..n - 1).map(move |j| (i, j))) {
            let corner = i * n + j;
            let cell = n * n + i * (n - 1) + j;
            builder.couple([corner, corner + 1, corner + n, corner + n + 1, cell].map(NodeId));
        }
        let pattern = Arc::new(Pattern::new(&layout, &builder.finish()));
        let mut matrix = SymmetricMatrix::zeros(pattern.clone());
        for (i, value) in matrix.values.iter_mut().enumerate() {
            *value = 0.1 * (i as f64).sin();
        }
        for &position in pattern.diagonal_positions() {
            matrix.values[position as usize] = 4.0;
        }
        matrix
    }

    fn chain(shift: f64) -> SymmetricMatrix {
        let mut layout = DofLayout::new();
        layout.push_nodes(60, 3, true);
        let mut builder = PatternBuilder::default();
        for i in 0..59 {
            builder.couple([NodeId(i), NodeId(i + 1)]);
        }
        let pattern = Arc::new(Pattern::new(&layout, &builder.finish()));
        let mut matrix = SymmetricMatrix::zeros(pattern.clone());
        for (i, value) in matrix.values.iter_mut().enumerate() {
            *value = 0.1 * (i as f64).sin();
        }
        for &position in pattern.diagonal_positions() {
            matrix.values[position as usize] = 2.0 + shift;
        }
        matrix
    }

    const SOLVERS: [LinearSolver; 2] = [LinearSolver::Multifrontal, LinearSolver::Supernodal];

    fn analyzed(solver: LinearSolver, matrix: &SymmetricMatrix) -> Box<dyn SparseCholesky> {
        let mut factor = solver.create();
        factor.analyze(&matrix.pattern, &nested_dissection(&matrix.pattern));
        factor
    }

    #[test]
    fn the_solution_solves() {
        for (solver, matrix) in SOLVERS
            .into_iter()
            .flat_map(|s| [(s, chain(0.0)), (s, grid(40))])
        {
            let n = matrix.pattern.num_rows();
            let mut factor = analyzed(solver, &matrix);
            factor.factorize(&matrix).unwrap();
            let expected: Vec<f64> = (0..2 * n).map(|i| (i as f64 * 0.3).cos()).collect();
            let mut x: Vec<f64> = (expected.chunks(n))
                .flat_map(|column| matrix.multiply(column))
                .collect();
            factor.solve(&mut x);
            for (a, b) in x.iter().zip(&expected) {
                // The condition of both matrices is below 100.
                assert!((a - b).abs() < 1e-13, "{solver:?}: {a} for {b}");
            }
        }
    }

    #[test]
    fn an_indefinite_matrix_is_solved_and_its_signs_are_counted() {
        let mut matrix = grid(20);
        let pattern = Arc::clone(&matrix.pattern);
        let n = pattern.num_rows();
        // Entries off the diagonal of a row sum to less than 7: as many negative eigenvalues as negative diagonal entries.
        for (i, &position) in pattern.diagonal_positions().iter().enumerate() {
            matrix.values[position as usize] = if i % 7 == 3 { -7.0 } else { 7.0 };
        }
        let mut factor = SignedCholesky::default();
        factor.analyze(&pattern, &nested_dissection(&pattern));
        factor.factorize(&matrix).unwrap();
        let expected = (0..n).filter(|i| i % 7 == 3).count();
        assert_eq!(factor.negative_pivots(), expected);
        let expected: Vec<f64> = (0..2 * n).map(|i| (i as f64 * 0.3).cos()).collect();
        let mut x: Vec<f64> = (expected.chunks(n))
            .flat_map(|column| matrix.multiply(column))
            .collect();
        factor.solve(&mut x);
        for (a, b) in x.iter().zip(&expected) {
            // Rows are dominated by their diagonal: pivots do not grow.
            assert!((a - b).abs() < 1e-13, "{a} for {b}");
        }
    }

    #[test]
    fn an_indefinite_matrix_is_reported() {
        for solver in SOLVERS {
            let matrix = chain(-4.0);
            assert!(analyzed(solver, &matrix).factorize(&matrix).is_err());
        }
    }

    #[test]
    fn the_unknown_whose_pivot_fails_is_named() {
        let mut matrix = grid(20);
        for value in [-1.0, f64::NAN] {
            let position = matrix.pattern.diagonal_positions()[77] as usize;
            matrix.values[position] = value;
            let solver = LinearSolver::Multifrontal;
            let failure = analyzed(solver, &matrix).factorize(&matrix).unwrap_err();
            // NaN spreads within a block of columns before it is seen.
            assert!(value.is_nan() || failure.dof == 77, "{failure}");
        }
    }
}
