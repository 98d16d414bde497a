//! `P A Pᵀ = L D Lᵀ` with a diagonal D of any signs, for tangents that may be indefinite; by the crate `faer`.
//!
//! The order of elimination is fixed, pivots are not searched for: a pivot near zero costs digits of the solution, which an
//! iteration around it has to make good, and a pivot that is zero is an error. By Sylvester's law of inertia D has as many
//! negative entries as the matrix negative eigenvalues.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::{LdltError, LdltRegularization};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;
use faer::sparse::linalg::cholesky::{LdltRef, SymbolicCholeskyRaw};
use faer::{Conj, MatMut, Par, Side};

use super::cholesky::{NotPositiveDefinite, SparseCholesky};
use super::ordering::NodeOrdering;
use super::supernodal::{Analysis, structure};
use crate::assembly::{Pattern, SymmetricMatrix};

/// Supernodal `L D Lᵀ` on one thread.
#[derive(Default)]
pub struct SignedCholesky {
    analysis: Option<Analysis>,
    values: Vec<f64>,
    memory: Option<MemBuffer>,
}

impl SignedCholesky {
    /// Negative eigenvalues of the matrix that was factorised last.
    ///
    /// # Panics
    /// If nothing was analysed.
    pub fn negative_pivots(&self) -> usize {
        let symbolic = &self.analyzed().symbolic;
        let SymbolicCholeskyRaw::Supernodal(supernodal) = symbolic.raw() else {
            unreachable!("the analysis is forced to be supernodal");
        };
        let factor = SupernodalLdltRef::new(supernodal, &self.values);
        let negative = |s: usize| {
            let block = factor.supernode(s).val();
            (0..block.ncols()).filter(|&j| block[(j, j)] < 0.0).count()
        };
        (0..supernodal.n_supernodes()).map(negative).sum()
    }

    fn analyzed(&self) -> &Analysis {
        (self.analysis.as_ref()).expect("analyze comes before all else")
    }
}

impl SparseCholesky for SignedCholesky {
    fn analyze(&mut self, pattern: &Pattern, ordering: &NodeOrdering) {
        let analysis = Analysis::new(pattern, ordering);
        let symbolic = &analysis.symbolic;
        let factor = symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default());
        self.memory = Some(MemBuffer::new(factor));
        self.values.clear();
        self.values.resize(symbolic.len_val(), 0.0);
        self.analysis = Some(analysis);
    }

    fn factor_entries(&self) -> usize {
        self.values.len()
    }

    /// # Errors
    /// A pivot that is zero or not a number.
    fn factorize(&mut self, matrix: &SymmetricMatrix) -> Result<(), NotPositiveDefinite> {
        let analysis = self
            .analysis
            .as_ref()
            .expect("analyze comes before factorize");
        let memory = self.memory.as_mut();
        let result = analysis.symbolic.factorize_numeric_ldlt(
            &mut self.values,
            SparseColMatRef::new(structure(&matrix.pattern), &matrix.values),
            Side::Lower,
            LdltRegularization::default(),
            Par::Seq,
            MemStack::new(memory.expect("analyze comes before factorize")),
            Default::default(),
        );
        match result {
            Ok(_) => Ok(()),
            Err(LdltError::ZeroPivot { index }) => Err(analysis.failure(index)),
        }
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        let analysis = self.analyzed();
        let n = analysis.new_to_old.len();
        let width = rhs.len() / n.max(1);
        let scratch = (analysis.symbolic).solve_in_place_scratch::<f64>(width, Par::Seq);
        LdltRef::new(&analysis.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, n, width),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
    }
}
