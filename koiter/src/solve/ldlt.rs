//! `P A Pᵀ = L D Lᵀ` with a diagonal D of any signs, for tangents that may be indefinite; by the crate `faer`.
//!
//! The order of elimination is fixed, pivots are not searched for: a pivot near zero costs digits of the solution, which an
//! iteration around it has to make good, and a pivot that is zero is an error. By Sylvester's law of inertia D has as many
//! negative entries as the matrix negative eigenvalues.

use faer::linalg::cholesky::ldlt::factor::{LdltError, LdltRegularization};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;
use faer::sparse::linalg::cholesky::{LdltRef, SymbolicCholeskyRaw};
use faer::{Conj, Par, Side};

use super::cholesky::{NotPositiveDefinite, SparseCholesky};
use super::ordering::NodeOrdering;
use super::supernodal::{Factor, structure};
use crate::assembly::{Pattern, SymmetricMatrix};

/// Supernodal `L D Lᵀ` on one thread.
#[derive(Default)]
pub struct SignedCholesky(Factor);

impl SignedCholesky {
    /// Negative eigenvalues of the matrix that was factorised last.
    ///
    /// # Panics
    /// If nothing was analysed.
    pub fn negative_pivots(&self) -> usize {
        let SymbolicCholeskyRaw::Supernodal(supernodal) = self.0.analysis().symbolic.raw() else {
            unreachable!("the analysis is forced to be supernodal");
        };
        let factor = SupernodalLdltRef::new(supernodal, self.0.values());
        let negative = |s: usize| {
            let block = factor.supernode(s).val();
            (0..block.ncols()).filter(|&j| block[(j, j)] < 0.0).count()
        };
        (0..supernodal.n_supernodes()).map(negative).sum()
    }
}

impl SparseCholesky for SignedCholesky {
    fn analyze(&mut self, pattern: &Pattern, ordering: &NodeOrdering) {
        (self.0).analyze(pattern, ordering, |symbolic| {
            symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default())
        });
    }

    fn factor_entries(&self) -> usize {
        self.0.values().len()
    }

    /// # Errors
    /// A pivot that is zero or not a number.
    fn factorize(&mut self, matrix: &SymmetricMatrix) -> Result<(), NotPositiveDefinite> {
        let (analysis, values, memory) = self.0.parts();
        let result = analysis.symbolic.factorize_numeric_ldlt(
            values,
            SparseColMatRef::new(structure(&matrix.pattern), &matrix.values),
            Side::Lower,
            LdltRegularization::default(),
            Par::Seq,
            memory,
            Default::default(),
        );
        match result {
            Ok(_) => Ok(()),
            Err(LdltError::ZeroPivot { index }) => Err(analysis.failure(index)),
        }
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        (self.0).solve(rhs, |symbolic, values, rhs, memory| {
            LdltRef::new(symbolic, values).solve_in_place_with_conj(
                Conj::No,
                rhs,
                Par::Seq,
                memory,
            );
        });
    }
}
