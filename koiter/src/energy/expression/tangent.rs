//! The part of a second derivative that can be damped.

use nalgebra::DMatrix;

/// A positive semidefinite part of a symmetric matrix that does not depend on the units of its unknowns: those without positive
/// curvature of their own are left out, the others are measured by it, `D A D` with `D = 1/√A_ii`, and of that negative eigenvalues are
/// left out. Zero where the matrix is not finite.
pub(super) fn damped_part(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let size = matrix.nrows();
    if !matrix.iter().all(|entry| entry.is_finite()) {
        return DMatrix::zeros(size, size);
    }
    let scale = |i: usize| match matrix[(i, i)] {
        own if own > 0.0 => 1.0 / own.sqrt(),
        _ => 0.0,
    };
    let scaled = DMatrix::from_fn(size, size, |i, j| scale(i) * matrix[(i, j)] * scale(j));
    let mut eigen = scaled.symmetric_eigen();
    eigen.eigenvalues.apply(|value| *value = value.max(0.0));
    let kept = eigen.recompose();
    DMatrix::from_fn(size, size, |i, j| match scale(i) * scale(j) {
        0.0 => 0.0,
        both => kept[(i, j)] / both,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_positive_matrix_stays_and_what_is_left_does_not_depend_on_units() {
        let positive = DMatrix::from_row_slice(2, 2, &[2.0, -1.0, -1.0, 3.0]);
        assert!((damped_part(&positive) - &positive).amax() < 1e-14);
        let mixed = DMatrix::from_row_slice(3, 3, &[1.0, 2.0, 5.0, 2.0, 1.0, 0.0, 5.0, 0.0, 0.0]);
        let kept = damped_part(&mixed);
        assert!(kept.row(2).amax() == 0.0 && kept[(0, 0)] > 0.0);
        let units = DMatrix::from_diagonal(&nalgebra::dvector![1e-3, 7.0, 1.0]);
        let other = damped_part(&(&units * mixed * &units));
        assert!((other - &units * kept * &units).amax() < 1e-13);
        assert_eq!(damped_part(&DMatrix::from_element(1, 1, -1.0))[(0, 0)], 0.0);
        assert_eq!(
            damped_part(&DMatrix::from_element(1, 1, f64::NAN))[(0, 0)],
            0.0
        );
    }
}
