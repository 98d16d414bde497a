//! Newton steps with second derivatives that couple everything with everything, as far as those are few matrices of rank one.
//!
//! ```text
//! (H + G Λ Gᵀ) p = r      p = p₀ − Z (Λ⁻¹ + Gᵀ Z)⁻¹ Gᵀ p₀,    H p₀ = r,  H Z = G
//! ```
//!
//! Woodbury's identity: one more substitution a column, nothing stored but Z. With H positive definite and Λ > 0 the small
//! matrix is positive definite.

use nalgebra::{DMatrix, DVector};

use super::cholesky::SparseCholesky;
use crate::assembly::LowRank;

/// Solves in place for the free unknowns. `prescribed` is the motion of those that are held, 0 elsewhere; the rows of `rhs` that
/// are held have their solution already, as [`crate::assembly::SymmetricMatrix::fix`] leaves them.
pub(super) fn solve(
    factor: &mut dyn SparseCholesky,
    terms: Vec<LowRank>,
    is_fixed: &[bool],
    prescribed: &[f64],
    rhs: &mut [f64],
) {
    let mut columns = Vec::with_capacity(terms.len());
    for LowRank { weight, mut vector } in terms {
        let moved = dot(&vector, prescribed);
        vector.truncate(is_fixed.len());
        for (i, entry) in vector.iter_mut().enumerate() {
            if is_fixed[i] {
                *entry = 0.0;
            }
            rhs[i] -= weight * moved * *entry;
        }
        columns.push((weight, vector));
    }
    factor.solve(rhs);
    if columns.is_empty() {
        return;
    }
    let turned: Vec<Vec<f64>> = (columns.iter())
        .map(|(_, column)| {
            let mut turned = column.clone();
            factor.solve(&mut turned);
            turned
        })
        .collect();
    let count = columns.len();
    let small = DMatrix::from_fn(count, count, |i, j| {
        let own = if i == j { 1.0 / columns[i].0 } else { 0.0 };
        own + dot(&columns[i].1, &turned[j])
    });
    let along = DVector::from_fn(count, |i, _| dot(&columns[i].1, rhs));
    // Not definite only by round-off of weights that vanish: the sparse step stands then.
    let Some(shares) = small.cholesky().map(|factor| factor.solve(&along)) else {
        return;
    };
    for (share, turned) in shares.iter().zip(&turned) {
        for (p, z) in rhs.iter_mut().zip(turned) {
            *p -= share * z;
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
