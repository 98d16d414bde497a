//! The frame that goes with an element: what is left of its motion there is small.
//!
//! The third axis is the normal of the triangle of the corners. About it the frame is turned by the rotation of the
//! triangle's deformation gradient F from rest,
//!
//! ```text
//! angle = atan2(F₂₁ − F₁₂, F₁₁ + F₂₂)
//! ```
//!
//! which is exact, the same whichever edge one begins with, and needs no iteration ([`FrameRule::Polar`]).
//! The printed rule finds the rotation of the *interpolation* at the centroid, with rotations of corners entering by the
//! opposite sign (Eqs. 13 and 14): each turn by the angle found overshoots, the error changing by the factor −2/3, so the
//! angle is scaled by 0.61. It is kept as [`FrameRule::Iterated`].

use nalgebra::{Matrix2, Matrix3, Vector2};

use super::stiffness::FlatTriangle;
use crate::Vec3;

/// How the frame is turned about the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrameRule {
    /// By the rotation of the triangle of the corners.
    Polar,
    /// With its first axis along the first edge.
    Edge,
    /// By the printed iteration: turns by `scale` times the angle found until it is below `tolerance` [rad], at most
    /// `iterations` times. Forces are not the derivatives of an energy.
    Iterated {
        /// Fraction of the angle.
        scale: f64,
        /// Most turns.
        iterations: usize,
        /// Smallest angle that is turned by [rad].
        tolerance: f64,
    },
}

impl FrameRule {
    /// The printed iteration with the printed numbers.
    pub const PRINTED: Self = Self::Iterated {
        scale: 0.61,
        iterations: 5,
        tolerance: 1e-6,
    };
}

/// A frame, and the element in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Axes as columns: local to world.
    pub(super) axes: Matrix3<f64>,
    /// Corners about their centroid, in the frame [m].
    pub(super) corners: [Vector2<f64>; 3],
}

/// A triangle whose area falls below this fraction of its rest area has collapsed: no normal can be trusted there.
const LEAST_AREA: f64 = 1e-6;

impl Frame {
    /// The frame along the first edge; `None` if the triangle has collapsed.
    pub(super) fn along_edge(corners: &[Vec3; 3], rest_area: f64) -> Option<Self> {
        let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        let twice_area = normal.norm();
        // Written so that NaN is refused.
        if !(twice_area > 2.0 * LEAST_AREA * rest_area) {
            return None;
        }
        let third = normal / twice_area;
        let first = (corners[1] - corners[0]).normalize();
        let second = third.cross(&first);
        let centroid = (corners[0] + corners[1] + corners[2]) / 3.0;
        Some(Self {
            axes: Matrix3::from_columns(&[first, second, third]),
            corners: corners.map(|x| {
                let r = x - centroid;
                Vector2::new(first.dot(&r), second.dot(&r))
            }),
        })
    }

    /// Turned about the normal by `angle` [rad].
    pub(super) fn turned(&self, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        let (first, second) = (self.axes.column(0), self.axes.column(1));
        let axes = Matrix3::from_columns(&[
            first * cos + second * sin,
            second * cos - first * sin,
            self.axes.column(2).into_owned(),
        ]);
        let corners = self
            .corners
            .map(|y| Vector2::new(cos * y.x + sin * y.y, cos * y.y - sin * y.x));
        Self { axes, corners }
    }

    /// The deformation gradient in the plane.
    pub(super) fn gradient(&self, rest: &FlatTriangle) -> Matrix2<f64> {
        (0..3)
            .map(|i| self.corners[i] * rest.gradients.column(i).transpose())
            .sum()
    }

    /// Turned so that the deformation gradient is symmetric.
    pub(super) fn polar(&self, rest: &FlatTriangle) -> Self {
        self.turned(rotation_angle(&self.gradient(rest)))
    }

    /// How the frame turns when corners move: columns for (u, v, w) of each corner, everything in the frame. `None` for
    /// [`FrameRule::Iterated`].
    pub(super) fn spin(&self, rule: FrameRule, rest: &FlatTriangle) -> Option<[Matrix3<f64>; 3]> {
        let current = FlatTriangle::new(self.corners);
        let about_normal: [Vector2<f64>; 3] = match rule {
            FrameRule::Iterated { .. } => return None,
            FrameRule::Polar => {
                let trace = self.gradient(rest).trace();
                [0, 1, 2].map(|i| {
                    let slope = rest.gradients.column(i);
                    Vector2::new(-slope.y, slope.x) / trace
                })
            }
            FrameRule::Edge => {
                let length = (self.corners[1] - self.corners[0]).norm();
                [-1.0 / length, 1.0 / length, 0.0].map(|s| Vector2::new(0.0, s))
            }
        };
        Some([0, 1, 2].map(|i| {
            let (slope, turn) = (current.gradients.column(i), about_normal[i]);
            Matrix3::new(0.0, 0.0, slope.y, 0.0, 0.0, -slope.x, turn.x, turn.y, 0.0)
        }))
    }
}

/// The angle of the rotation in the polar decomposition of a matrix of positive determinant.
pub(super) fn rotation_angle(f: &Matrix2<f64>) -> f64 {
    (f[(1, 0)] - f[(0, 1)]).atan2(f[(0, 0)] + f[(1, 1)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rest() -> FlatTriangle {
        FlatTriangle::new([[0.0, 0.0], [2.0, 0.1], [0.5, 1.4]].map(|[x, y]| Vector2::new(x, y)))
    }

    #[test]
    fn the_polar_frame_is_the_same_whichever_edge_comes_first() {
        let x = [[0.1, 0.2, 0.4], [2.3, 0.9, 0.0], [0.2, 1.9, 0.5]].map(Vec3::from);
        let rest = rest();
        let first = Frame::along_edge(&x, rest.area).unwrap().polar(&rest);
        for shift in 1..3 {
            let moved = [0, 1, 2].map(|i| x[(i + shift) % 3]);
            let turned = FlatTriangle::new([0, 1, 2].map(|i| rest.corners[(i + shift) % 3]));
            let frame = Frame::along_edge(&moved, rest.area).unwrap().polar(&turned);
            // A dozen operations on numbers of size 1.
            assert!((frame.axes - first.axes).norm() < 1e-14);
        }
    }

    #[test]
    fn the_spin_of_a_frame_is_that_of_differences() {
        let x = [[0.1, 0.2, 0.4], [2.3, 0.9, 0.0], [0.2, 1.9, 0.5]].map(Vec3::from);
        let rest = rest();
        for rule in [FrameRule::Polar, FrameRule::Edge] {
            let at = |x: &[Vec3; 3]| {
                let frame = Frame::along_edge(x, rest.area).unwrap();
                if rule == FrameRule::Polar {
                    frame.polar(&rest)
                } else {
                    frame
                }
            };
            let frame = at(&x);
            let spin = frame.spin(rule, &rest).unwrap();
            for corner in 0..3 {
                for axis in 0..3 {
                    let h = 1e-6;
                    let mut moved = [x, x];
                    moved[0][corner] += frame.axes.column(axis) * h;
                    moved[1][corner] -= frame.axes.column(axis) * h;
                    let change = (at(&moved[0]).axes - at(&moved[1]).axes) / (2.0 * h);
                    let cross = frame.axes.transpose() * change;
                    let turn = Vec3::new(cross[(2, 1)], cross[(0, 2)], cross[(1, 0)]);
                    // Truncation h² and round-off 1e-16 / h.
                    assert!((spin[corner].column(axis) - turn).norm() < 1e-9, "{rule:?}");
                }
            }
        }
    }

    #[test]
    fn a_collapsed_triangle_has_no_frame() {
        let x = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]].map(Vec3::from);
        assert!(Frame::along_edge(&x, 1.0).is_none());
        assert!(Frame::along_edge(&[Vec3::repeat(f64::NAN); 3], 1.0).is_none());
    }
}
