//! Nearest positive semidefinite matrix.

use nalgebra::{DMatrix, SMatrix};

/// Multiplies the negative eigenvalues of a symmetric matrix by `kept` (0 clamps them), after a Cholesky attempt that
/// spares matrices which are positive definite already.
///
/// The reference for energies that know a smaller space to project in; an eigen-decomposition of 21 × 21 takes far
/// longer than the rest of an element.
pub fn project_to_psd<const N: usize>(matrix: &mut SMatrix<f64, N, N>, kept: f64) {
    if is_positive_definite(matrix) {
        return;
    }
    let eigen = DMatrix::from_column_slice(N, N, matrix.as_slice()).symmetric_eigen();
    let scaled = (eigen.eigenvalues).map(|value| if value < 0.0 { kept * value } else { value });
    let rebuilt =
        &eigen.eigenvectors * DMatrix::from_diagonal(&scaled) * eigen.eigenvectors.transpose();
    matrix.copy_from_slice(rebuilt.as_slice());
}

/// Cholesky without storing the factor for others: succeeds if and only if every pivot is positive.
fn is_positive_definite<const N: usize>(matrix: &SMatrix<f64, N, N>) -> bool {
    let mut factor = *matrix;
    for k in 0..N {
        let pivot = factor[(k, k)];
        if !(pivot > 0.0) {
            return false;
        }
        let inverse = 1.0 / pivot;
        for j in k + 1..N {
            let scale = factor[(j, k)] * inverse;
            for i in j..N {
                factor[(i, j)] -= scale * factor[(i, k)];
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projection_keeps_the_positive_part() {
        // Eigenvalues 3 and −1.
        let original = SMatrix::<f64, 2, 2>::new(1.0, 2.0, 2.0, 1.0);
        let clamped = SMatrix::<f64, 2, 2>::new(1.5, 1.5, 1.5, 1.5);
        for kept in [0.0, 0.3, 1.0] {
            let mut m = original;
            project_to_psd(&mut m, kept);
            assert!((m - (clamped + (original - clamped) * kept)).norm() < 1e-14);
        }
    }

    #[test]
    fn a_positive_definite_matrix_is_left_alone() {
        let original = SMatrix::<f64, 2, 2>::new(2.0, 0.3, 0.3, 1.0);
        let mut m = original;
        project_to_psd(&mut m, 0.0);
        assert_eq!(m, original);
    }
}
