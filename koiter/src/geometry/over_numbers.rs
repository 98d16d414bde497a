//! Vector algebra in space over any numbers: plain ones, and jets, which carry derivatives along.

use super::jet::Real;

/// `p − q`.
pub fn sub<R: Real>(p: &[R; 3], q: &[R; 3]) -> [R; 3] {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

/// `p · q`.
pub fn dot<R: Real>(p: &[R; 3], q: &[R; 3]) -> R {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

/// `p × q`.
pub fn cross<R: Real>(p: &[R; 3], q: &[R; 3]) -> [R; 3] {
    [
        p[1] * q[2] - p[2] * q[1],
        p[2] * q[0] - p[0] * q[2],
        p[0] * q[1] - p[1] * q[0],
    ]
}

/// `|p|`.
pub fn norm<R: Real>(p: &[R; 3]) -> R {
    dot(p, p).sqrt()
}

/// The constants `p`.
pub fn constant<R: Real>(p: &crate::Vec3) -> [R; 3] {
    [R::from(p.x), R::from(p.y), R::from(p.z)]
}

/// Point `i` of unknowns that hold three numbers a point.
pub fn point<R: Real, const N: usize>(q: &[R; N], i: usize) -> [R; 3] {
    [q[3 * i], q[3 * i + 1], q[3 * i + 2]]
}

/// The angle in (−π, π] by which `from` turns about `axis`, in the right-handed sense, to `to`; both stand at right angles
/// to the axis, and none needs to be a unit vector.
pub fn angle_about<R: Real>(axis: &[R; 3], from: &[R; 3], to: &[R; 3]) -> R {
    (dot(&cross(from, to), axis) / norm(axis)).atan2(dot(from, to))
}
