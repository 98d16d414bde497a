//! Supernodal Cholesky factorisation by the crate `faer`: the reference for our own.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use super::cholesky::{NotPositiveDefinite, SparseCholesky};
use super::ordering::NodeOrdering;
use crate::assembly::{Pattern, SymmetricMatrix};

/// Supernodal Cholesky by faer, on one thread: its own parallelism inside small dense kernels costs more than it gains.
#[derive(Default)]
pub struct Supernodal {
    symbolic: Option<SymbolicCholesky<u32>>,
    new_to_old: Vec<u32>,
    values: Vec<f64>,
    memory: Option<MemBuffer>,
}

impl SparseCholesky for Supernodal {
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
        self.memory = Some(MemBuffer::new(factor));
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
        let n = self.new_to_old.len();
        let width = rhs.len() / n.max(1);
        let mut memory = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(width, Par::Seq));
        LltRef::new(symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, n, width),
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }
}

fn structure(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, u32> {
    let n = pattern.num_rows();
    SymbolicSparseColMatRef::new_checked(n, n, pattern.column_starts(), None, pattern.row_indices())
}
