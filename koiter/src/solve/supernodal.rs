//! Supernodal Cholesky factorisation by the crate `faer`: the reference for our own.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use super::cholesky::{NotPositiveDefinite, SparseCholesky};
use super::ordering::NodeOrdering;
use crate::assembly::{Pattern, SymmetricMatrix};

/// What is known of a factor before its numbers.
pub(super) struct Analysis {
    pub(super) symbolic: SymbolicCholesky<u32>,
    pub(super) new_to_old: Vec<u32>,
}

impl Analysis {
    /// Of matrices of `pattern`, eliminated in the given order, in supernodes whatever they are like.
    pub(super) fn new(pattern: &Pattern, ordering: &NodeOrdering) -> Self {
        let n = pattern.num_rows();
        let new_to_old = ordering.scalar_order(pattern);
        let mut old_to_new = vec![0u32; n];
        for (new, &old) in new_to_old.iter().enumerate() {
            old_to_new[old as usize] = new as u32;
        }
        let permutation = PermRef::new_checked(&new_to_old, &old_to_new, n);
        let symbolic = factorize_symbolic_cholesky(
            structure(pattern),
            Side::Lower,
            SymmetricOrdering::Custom(permutation),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .expect("the factor fits in memory and its indices in 32 bits");
        Self {
            symbolic,
            new_to_old,
        }
    }

    /// The unknown of a pivot that failed.
    pub(super) fn failure(&self, pivot: usize) -> NotPositiveDefinite {
        NotPositiveDefinite {
            dof: self.new_to_old.get(pivot).map_or(0, |&dof| dof as usize),
        }
    }
}

/// Supernodal Cholesky by faer, on one thread: its own parallelism inside small dense kernels costs more than it gains.
#[derive(Default)]
pub struct Supernodal {
    analysis: Option<Analysis>,
    values: Vec<f64>,
    memory: Option<MemBuffer>,
}

impl SparseCholesky for Supernodal {
    fn analyze(&mut self, pattern: &Pattern, ordering: &NodeOrdering) {
        let analysis = Analysis::new(pattern, ordering);
        let symbolic = &analysis.symbolic;
        let factor = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        self.memory = Some(MemBuffer::new(factor));
        self.values.clear();
        self.values.resize(symbolic.len_val(), 0.0);
        self.analysis = Some(analysis);
    }

    fn factor_entries(&self) -> usize {
        self.values.len()
    }

    fn factorize(&mut self, matrix: &SymmetricMatrix) -> Result<(), NotPositiveDefinite> {
        let analysis = self
            .analysis
            .as_ref()
            .expect("analyze comes before factorize");
        let memory = self
            .memory
            .as_mut()
            .expect("analyze comes before factorize");
        let view = SparseColMatRef::new(structure(&matrix.pattern), &matrix.values);
        let result = analysis.symbolic.factorize_numeric_llt(
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
            Err(LltError::NonPositivePivot { index }) => Err(analysis.failure(index)),
        }
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        let analysis = self.analysis.as_ref().expect("analyze comes before solve");
        let symbolic = &analysis.symbolic;
        let n = analysis.new_to_old.len();
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

pub(super) fn structure(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, u32> {
    let n = pattern.num_rows();
    SymbolicSparseColMatRef::new_checked(n, n, pattern.column_starts(), None, pattern.row_indices())
}
