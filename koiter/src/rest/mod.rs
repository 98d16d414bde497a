//! The rest state of a shell as data: for every face an orthonormal frame, and a rest second fundamental form.
//!
//! With the rest edges `x_j − x_i` and `x_k − x_i` written in an orthonormal basis of the rest face as the columns of an
//! upper triangular D, the rest first fundamental form is `Ī = Dᵀ D`. Strains are expressed in that basis: for any
//! symmetric form X in the basis of the edges, `D⁻ᵀ X D⁻¹`. There an isotropic material has the same constants on every
//! face, and `tr(Ī⁻¹ X)` is the trace.

mod intrinsic;

pub use intrinsic::IntrinsicTriangulation;
use nalgebra::Vector3;

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

    /// `D⁻ᵀ X D⁻¹` of a form X with entries `11, 12, 22` in the basis of the edges, as components `11, 22, 12`.
    pub fn components(&self, [x11, x12, x22]: [f64; 3]) -> Vector3<f64> {
        let [m11, m12, m22] = self.inverse;
        Vector3::new(
            m11 * m11 * x11,
            m12 * m12 * x11 + 2.0 * m12 * m22 * x12 + m22 * m22 * x22,
            m11 * (m12 * x11 + m22 * x12),
        )
    }

    /// The form in the basis of the edges whose [`Self::components`] these are.
    pub fn edge_form(&self, components: Vector3<f64>) -> [f64; 3] {
        let [d11, d12, d22] = self.edges();
        let (s11, s22, s12) = (components.x, components.y, components.z);
        [
            d11 * d11 * s11,
            d11 * (d12 * s11 + d22 * s12),
            d12 * d12 * s11 + 2.0 * d12 * d22 * s12 + d22 * d22 * s22,
        ]
    }

    /// The unit vector along `c₁ (x_j − x_i) + c₂ (x_k − x_i)` in the frame.
    pub fn direction(&self, [c1, c2]: [f64; 2]) -> [f64; 2] {
        let [d11, d12, d22] = self.edges();
        let (x, y) = (d11 * c1 + d12 * c2, d22 * c2);
        let length = x.hypot(y);
        [x / length, y / length]
    }

    /// Lengths of the edges opposite to the corners [m].
    pub fn edge_lengths(&self) -> [f64; 3] {
        let [d11, d12, d22] = self.edges();
        [(d12 - d11).hypot(d22), d12.hypot(d22), d11]
    }

    /// Entries `11, 12, 22` of D [m].
    fn edges(&self) -> [f64; 3] {
        let [m11, m12, m22] = self.inverse;
        [1.0 / m11, -m12 / (m11 * m22), 1.0 / m22]
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
    /// The director solve of the shape itself failed, the deformed or the start one.
    #[error(
        "the directors of the shape itself did not converge: {reason}; check it for folded faces"
    )]
    ShapeDirectors {
        /// What failed.
        reason: String,
    },
}

impl RestError {
    /// The same of the shape itself, where its directors were solved for.
    #[must_use]
    pub(crate) fn of_shape_itself(self) -> Self {
        match self {
            Self::Directors { reason } => Self::ShapeDirectors { reason },
            other => other,
        }
    }
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
        for (corner, length) in frame.edge_lengths().into_iter().enumerate() {
            let edge = x[(corner + 2) % 3] - x[(corner + 1) % 3];
            assert!((length - edge.norm()).abs() < 1e-15);
        }
    }

    #[test]
    fn forms_change_their_basis_and_come_back() {
        let first_form = [1.3, 0.4, 0.9];
        let frame = RestFrame::from_first_form(first_form).unwrap();
        let unit = frame.components(first_form);
        assert!((unit - Vector3::new(1.0, 1.0, 0.0)).norm() < 1e-15);
        let form = [0.7, -0.2, 1.1];
        let back = frame.edge_form(frame.components(form));
        assert!((0..3).all(|i| (back[i] - form[i]).abs() < 1e-14));
        // Along the second edge the form is measured by that edge alone.
        let [c, s] = frame.direction([0.0, 2.0]);
        let k = frame.components(form);
        let along = c * c * k.x + s * s * k.y + 2.0 * c * s * k.z;
        assert!((along - form[2] / first_form[2]).abs() < 1e-14);
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
