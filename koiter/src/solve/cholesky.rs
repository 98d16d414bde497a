//! Sparse Cholesky factorisation. All that is known of the crate `faer` stands here.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use super::ordering::NodeOrdering;
use crate::assembly::{Pattern, SymmetricMatrix};

/// A factorisation met a pivot that is not positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the matrix is not positive definite at unknown {dof}")]
pub struct NotPositiveDefinite {
    /// The unknown whose pivot failed.
    pub dof: usize,
}

/// Analyses a pattern once, then factorises matrices of that pattern.
pub trait SparseCholesky {
    /// Prepares for matrices of `pattern`, eliminated in the given order.
    fn analyze(&mut self, pattern: &Pattern, ordering: &NodeOrdering);
    /// Entries of the factor after [`Self::analyze`].
    fn factor_entries(&self) -> usize;
    /// Factorises.
    ///
    /// # Errors
    /// The first unknown whose pivot is not positive.
    fn factorize(&mut self, matrix: &SymmetricMatrix) -> Result<(), NotPositiveDefinite>;
    /// Replaces `rhs` by the solution.
    fn solve(&mut self, rhs: &mut [f64]);
}

/// Supernodal Cholesky by faer, on one thread: its own parallelism inside small dense kernels costs more than it gains.
#[derive(Default)]
pub struct Factorization {
    symbolic: Option<SymbolicCholesky<u32>>,
    new_to_old: Vec<u32>,
    values: Vec<f64>,
    memory: Option<MemBuffer>,
}

impl SparseCholesky for Factorization {
    fn analyze(&mut self, pattern: &Pattern, ordering: &NodeOrdering) {
        let n = pattern.num_rows();
        self.new_to_old = ordering.scalar_order(pattern);
        let mut old_to_new = vec![0u32; n];
        for (new, &old) in self.new_to_old.iter().enumerate() {
            old_to_new[old as usize] = new as u32;
        }
        let permutation = PermRef::new_checked(&self.new_to_old, &old_to_new, n);
        let symbolic = factorize_symbolic_cholesky(
            structure(pattern),
            Side::Lower,
            SymmetricOrdering::Custom(permutation),
            CholeskySymbolicParams::default(),
        )
        .expect("the factor fits in memory and its indices in 32 bits");
        let factor = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let solve = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        self.memory = Some(MemBuffer::new(factor.or(solve)));
        self.values.clear();
        self.values.resize(symbolic.len_val(), 0.0);
        self.symbolic = Some(symbolic);
    }

    fn factor_entries(&self) -> usize {
        self.values.len()
    }

    fn factorize(&mut self, matrix: &SymmetricMatrix) -> Result<(), NotPositiveDefinite> {
        let symbolic = self
            .symbolic
            .as_ref()
            .expect("analyze comes before factorize");
        let memory = self
            .memory
            .as_mut()
            .expect("analyze comes before factorize");
        let view = SparseColMatRef::new(structure(&matrix.pattern), &matrix.values);
        let result = symbolic.factorize_numeric_llt(
            &mut self.values,
            view,
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(memory),
            Default::default(),
        );
        match result {
            Ok(_) => Ok(()),
            Err(LltError::NonPositivePivot { index }) => Err(NotPositiveDefinite {
                dof: self.new_to_old.get(index).map_or(0, |&dof| dof as usize),
            }),
        }
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        let symbolic = self.symbolic.as_ref().expect("analyze comes before solve");
        let memory = self.memory.as_mut().expect("analyze comes before solve");
        let n = rhs.len();
        let columns = MatMut::from_column_major_slice_mut(rhs, n, 1);
        let stack = MemStack::new(memory);
        LltRef::new(symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            columns,
            Par::Seq,
            stack,
        );
    }
}

fn structure(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, u32> {
    let n = pattern.num_rows();
    SymbolicSparseColMatRef::new_checked(n, n, pattern.column_starts(), None, pattern.row_indices())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::assembly::{DofLayout, NodeId, PatternBuilder};
    use crate::solve::nested_dissection;

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

    #[test]
    fn the_solution_solves() {
        let matrix = chain(0.0);
        let mut factor = Factorization::default();
        factor.analyze(&matrix.pattern, &nested_dissection(&matrix.pattern));
        factor.factorize(&matrix).unwrap();
        let expected: Vec<f64> = (0..180).map(|i| (i as f64 * 0.3).cos()).collect();
        let mut x = matrix.multiply(&expected);
        factor.solve(&mut x);
        for (a, b) in x.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-13);
        }
    }

    #[test]
    fn an_indefinite_matrix_is_reported() {
        let matrix = chain(-4.0);
        let mut factor = Factorization::default();
        factor.analyze(&matrix.pattern, &nested_dissection(&matrix.pattern));
        assert!(factor.factorize(&matrix).is_err());
    }
}
