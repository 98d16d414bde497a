//! The rest state of a shell as data: for every face an orthonormal frame, and a rest second fundamental form.
//!
//! With the rest edges `x_j − x_i` and `x_k − x_i` written in an orthonormal basis of the rest face as the columns of an
//! upper triangular D, the rest first fundamental form is `Ī = Dᵀ D`. Strains are expressed in that basis: for any
//! symmetric form X in the basis of the edges, `D⁻ᵀ X D⁻¹`. There an isotropic material has the same constants on every
//! face, and `tr(Ī⁻¹ X)` is the trace.

mod intrinsic;

pub use intrinsic::IntrinsicTriangulation;

use crate::Vec3;
use crate::mesh::Surface;

/// The rest metric of one face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestFrame {
    /// Rest area Ā [m²].
    pub area: f64,
    /// Entries `11, 12, 22` of D⁻¹ [1/m].
    pub inverse: [f64; 3],
}

impl RestFrame {
    /// From the entries `11, 12, 22` of a rest first fundamental form; `None` if it is not positive definite.
    pub fn from_first_form([e, f, g]: [f64; 3]) -> Option<Self> {
        let length = e.sqrt();
        let along = f / length;
        let height = (g - along * along).sqrt();
        let area = 0.5 * length * height;
        (area > 0.0 && area.is_finite()).then(|| Self {
            area,
            inverse: [1.0 / length, -along / (length * height), 1.0 / height],
        })
    }

    /// From the corners of a rest face; `None` if it has no area.
    pub fn from_corners(x: &[Vec3; 3]) -> Option<Self> {
        let (e1, e2) = (x[1] - x[0], x[2] - x[0]);
        Self::from_first_form([e1.norm_squared(), e1.dot(&e2), e2.norm_squared()])
    }

    /// The deformation gradient of a face with edges `e1`, `e2` out of the first corner, as its two columns.
    #[inline]
    pub fn deformation_gradient(&self, e1: &Vec3, e2: &Vec3) -> [Vec3; 2] {
        let [m11, m12, m22] = self.inverse;
        [e1 * m11, e1 * m12 + e2 * m22]
    }

    /// Weights of the three corners in the two columns of the deformation gradient [1/m].
    #[inline]
    pub fn corner_weights(&self) -> [[f64; 2]; 3] {
        let [m11, m12, m22] = self.inverse;
        [[-m11, -m12 - m22], [m11, m12], [0.0, m22]]
    }

    /// `D⁻ᵀ II D⁻¹` of `II = [[q₀ + q₁, q₀], [q₀, q₀ + q₂]]` as a matrix acting on q: row `s` is component `11, 22, 12`.
    pub fn second_form_matrix(&self) -> [[f64; 3]; 3] {
        let [m11, m12, m22] = self.inverse;
        let v = [[m11, m12 + m22], [m11, m12], [0.0, m22]];
        [
            [v[0][0] * v[0][0], v[1][0] * v[1][0], v[2][0] * v[2][0]],
            [v[0][1] * v[0][1], v[1][1] * v[1][1], v[2][1] * v[2][1]],
            [v[0][0] * v[0][1], v[1][0] * v[1][1], v[2][0] * v[2][1]],
        ]
    }
}

/// Rest frames of all faces of a shell.
///
/// # Errors
/// The first face whose rest shape has no area.
pub fn rest_frames(rest: &Surface) -> Result<Vec<RestFrame>, RestError> {
    (0..rest.mesh.num_faces())
        .map(|face| {
            RestFrame::from_corners(&rest.corners(face)).ok_or(RestError::DegenerateFace { face })
        })
        .collect()
}

/// Why a rest state cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RestError {
    /// A rest face without area.
    #[error("rest face {face} has no area: remove it or move its vertices apart")]
    DegenerateFace {
        /// Index of the face.
        face: usize,
    },
    /// The director solve of a curved rest shape failed.
    #[error("the rest directors did not converge: {reason}; check the rest mesh for folded faces")]
    Directors {
        /// What failed.
        reason: String,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_deformation_gradient_of_the_rest_shape_is_orthonormal() {
        let x = [
            Vec3::new(0.1, 0.2, 0.0),
            Vec3::new(1.0, 0.4, 0.3),
            Vec3::new(0.3, 1.1, -0.2),
        ];
        let frame = RestFrame::from_corners(&x).unwrap();
        let [f1, f2] = frame.deformation_gradient(&(x[1] - x[0]), &(x[2] - x[0]));
        assert!(
            (f1.norm() - 1.0).abs() < 1e-14
                && (f2.norm() - 1.0).abs() < 1e-14
                && f1.dot(&f2).abs() < 1e-14
        );
        assert!((frame.area - 0.5 * (x[1] - x[0]).cross(&(x[2] - x[0])).norm()).abs() < 1e-15);
    }

    #[test]
    fn a_face_without_area_has_no_frame() {
        assert!(RestFrame::from_corners(&[Vec3::zeros(), Vec3::x(), Vec3::x() * 2.0]).is_none());
        assert!(
            RestFrame::from_corners(&[Vec3::zeros(), Vec3::x(), Vec3::new(f64::NAN, 0.0, 0.0)])
                .is_none()
        );
    }
}
