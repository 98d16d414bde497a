//! Multifrontal Cholesky factorisation: parallel over subtrees of the elimination tree and inside large fronts.
//!
//! The driver is ours, the dense kernels are faer's (`docs/decisions/0005`). Results do not depend on the number of threads.

mod dense;
mod fronts;
mod numeric;
mod substitute;
mod upward;

use self::fronts::FrontTree;
use self::numeric::Elimination;
use self::substitute::Substitution;
use self::upward::{Buffers, upward};
use super::cholesky::{NotPositiveDefinite, SparseCholesky};
use super::ordering::NodeOrdering;
use crate::assembly::{Pattern, SymmetricMatrix};

/// The factor of a matrix, front by front.
#[derive(Default)]
pub struct Multifrontal {
    tree: FrontTree,
    factor: Vec<f64>,
    buffers: Buffers,
}

impl SparseCholesky for Multifrontal {
    fn analyze(&mut self, pattern: &Pattern, ordering: &NodeOrdering) {
        self.tree = FrontTree::new(pattern, &ordering.elimination_order(pattern));
        self.factor.resize(self.tree.num_values, 0.0);
    }

    fn factor_entries(&self) -> usize {
        self.factor.len()
    }

    fn factorize(&mut self, matrix: &SymmetricMatrix) -> Result<(), NotPositiveDefinite> {
        let elimination = Elimination {
            tree: &self.tree,
            entries: &matrix.values,
        };
        upward(&self.tree, &elimination, &self.buffers, &mut self.factor).map_err(|position| {
            NotPositiveDefinite {
                dof: self.tree.unknowns[position] as usize,
            }
        })
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        let n = self.tree.unknowns.len();
        let width = rhs.len() / n.max(1);
        let mut x = Vec::with_capacity(rhs.len());
        for &unknown in &self.tree.unknowns {
            x.extend((0..width).map(|k| rhs[k * n + unknown as usize]));
        }
        let substitution = Substitution {
            tree: &self.tree,
            factor: &self.factor,
            width,
        };
        upward(&self.tree, &substitution, &self.buffers, &mut x)
            .expect("substitution has no pivots to refuse");
        substitution.backward(&mut x);
        for (at, &unknown) in self.tree.unknowns.iter().enumerate() {
            for k in 0..width {
                rhs[k * n + unknown as usize] = x[at * width + k];
            }
        }
    }
}

#[cfg(all(test, feature = "parallel"))]
mod tests;
