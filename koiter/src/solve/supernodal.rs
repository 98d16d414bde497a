//! Supernodal Cholesky factorisation by the crate `faer`: the reference for our own.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
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

/// The numbers of a factor with the analysis they belong to and the memory they take to compute, for faer's
/// decompositions of one structure.
#[derive(Default)]
pub(super) struct Factor {
    analysis: Option<Analysis>,
    values: Vec<f64>,
    memory: Option<MemBuffer>,
}

impl Factor {
    /// Prepares for matrices of `pattern`; `scratch` is what a factorisation needs.
    pub(super) fn analyze(
        &mut self,
        pattern: &Pattern,
        ordering: &NodeOrdering,
        scratch: impl FnOnce(&SymbolicCholesky<u32>) -> StackReq,
    ) {
        let analysis = Analysis::new(pattern, ordering);
        self.memory = Some(MemBuffer::new(scratch(&analysis.symbolic)));
        self.values.clear();
        self.values.resize(analysis.symbolic.len_val(), 0.0);
        self.analysis = Some(analysis);
    }

    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// # Panics
    /// If nothing was analysed.
    pub(super) fn analysis(&self) -> &Analysis {
        (self.analysis.as_ref()).expect("analyze comes before all else")
    }

    /// What a factorisation reads and writes.
    ///
    /// # Panics
    /// If nothing was analysed.
    pub(super) fn parts(&mut self) -> (&Analysis, &mut [f64], &mut MemStack) {
        let both = self.analysis.as_ref().zip(self.memory.as_mut());
        let (analysis, memory) = both.expect("analyze comes before factorize");
        (analysis, &mut self.values, MemStack::new(memory))
    }

    /// Solves for the columns of `rhs` by `solve`.
    pub(super) fn solve(
        &self,
        rhs: &mut [f64],
        solve: impl FnOnce(&SymbolicCholesky<u32>, &[f64], MatMut<'_, f64>, &mut MemStack),
    ) {
        let analysis = self.analysis();
        let n = analysis.new_to_old.len();
        let width = rhs.len() / n.max(1);
        let scratch = (analysis.symbolic).solve_in_place_scratch::<f64>(width, Par::Seq);
        solve(
            &analysis.symbolic,
            &self.values,
            MatMut::from_column_major_slice_mut(rhs, n, width),
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
    }
}

/// Supernodal Cholesky by faer, on one thread: its own parallelism inside small dense kernels costs more than it gains.
#[derive(Default)]
pub struct Supernodal(Factor);

impl SparseCholesky for Supernodal {
    fn analyze(&mut self, pattern: &Pattern, ordering: &NodeOrdering) {
        (self.0).analyze(pattern, ordering, |symbolic| {
            symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default())
        });
    }

    fn factor_entries(&self) -> usize {
        self.0.values().len()
    }

    fn factorize(&mut self, matrix: &SymmetricMatrix) -> Result<(), NotPositiveDefinite> {
        let (analysis, values, memory) = self.0.parts();
        let result = analysis.symbolic.factorize_numeric_llt(
            values,
            SparseColMatRef::new(structure(&matrix.pattern), &matrix.values),
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            memory,
            Default::default(),
        );
        match result {
            Ok(_) => Ok(()),
            Err(LltError::NonPositivePivot { index }) => Err(analysis.failure(index)),
        }
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        (self.0).solve(rhs, |symbolic, values, rhs, memory| {
            LltRef::new(symbolic, values).solve_in_place_with_conj(Conj::No, rhs, Par::Seq, memory);
        });
    }
}

pub(super) fn structure(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, u32> {
    let n = pattern.num_rows();
    SymbolicSparseColMatRef::new_checked(n, n, pattern.column_starts(), None, pattern.row_indices())
}
