//! Rotations: their vectors and how those change.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// The matrix of `v ×`.
pub(super) fn cross_matrix(v: &Vector3<f64>) -> Matrix3<f64> {
    v.cross_matrix()
}

/// The rotation vector of a matrix, of length at most π [rad].
pub(super) fn rotation_vector(matrix: &Matrix3<f64>) -> Vector3<f64> {
    let axial = 0.5
        * Vector3::new(
            matrix[(2, 1)] - matrix[(1, 2)],
            matrix[(0, 2)] - matrix[(2, 0)],
            matrix[(1, 0)] - matrix[(0, 1)],
        );
    let (sin, cos) = (axial.norm(), 0.5 * (matrix.trace() - 1.0));
    // Near a half turn the axis drowns in round-off; the quaternion keeps it.
    if cos < -0.9 {
        let rotation = Rotation3::from_matrix_unchecked(*matrix);
        return UnitQuaternion::from_rotation_matrix(&rotation).scaled_axis();
    }
    if sin < 1e-12 {
        return axial;
    }
    axial * (sin.atan2(cos) / sin)
}

/// How a rotation vector changes: `log(exp(δ) exp(θ)) = θ + H(θ) δ` to first order, with
/// `H = I − ½ θ× + η (θ×)²`, `η = (1 − (θ/2) cot(θ/2)) / θ²`.
pub(super) fn log_derivative(theta: &Vector3<f64>) -> Matrix3<f64> {
    let angle = theta.norm();
    let eta = if angle < 1e-2 {
        // The next term is θ⁴ / 30240.
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        (1.0 - 0.5 * angle / (0.5 * angle).tan()) / (angle * angle)
    };
    let cross = cross_matrix(theta);
    Matrix3::identity() - 0.5 * cross + eta * cross * cross
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vector_of_a_rotation_is_the_one_it_was_made_of() {
        for v in [
            Vector3::new(0.3, -0.2, 0.9),
            Vector3::new(1e-9, 2e-9, -1e-9),
            Vector3::new(2.0, 1.5, -1.8),
        ] {
            let matrix = UnitQuaternion::from_scaled_axis(v).to_rotation_matrix();
            // A dozen operations on entries of size 1.
            assert!((rotation_vector(matrix.matrix()) - v).norm() < 1e-14 * (1.0 + v.norm()));
        }
    }

    #[test]
    fn the_derivative_of_the_vector_is_that_of_differences() {
        for theta in [
            Vector3::new(0.7, -1.1, 0.4),
            Vector3::new(0.002, 0.003, 0.0),
        ] {
            let turn = UnitQuaternion::from_scaled_axis(theta);
            for axis in 0..3 {
                let h = 1e-5;
                let delta = Vector3::ith(axis, h);
                let at = |d| (UnitQuaternion::from_scaled_axis(d) * turn).scaled_axis();
                let difference = (at(delta) - at(-delta)) / (2.0 * h);
                // Truncation h² and round-off 1e-16 / h.
                assert!((log_derivative(&theta).column(axis) - difference).norm() < 1e-9);
            }
        }
    }
}
