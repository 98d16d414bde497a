//! Vertex–face and edge–edge pairs: their distance, their barrier, and its derivatives in closed form.
//!
//! The energy of a pair is `κ A m(c) b(D)` with the barrier b ([`LogBarrier`]), the area A that the pair stands for, and
//! for edges the mollifier
//!
//! ```text
//! m(c) = (2 − c/ε) c/ε for c < ε, else 1;     c = |e_a × e_b|²,  ε = 10⁻³ |ē_a|² |ē_b|²
//! ```
//!
//! which fades nearly parallel pairs, where the distance has no second derivative. With r the separation, w the weights
//! of the points, and the slides t_k, v_k of [`ClosestPoints`], the Hessian of b(D) is
//!
//! ```text
//! (4 b'' |r|² + 2 b') (w ⊗ r̂)² + 2 b' Σ_m (w ⊗ m̂)² − 2 b' Σ_k [ (w ⊗ t_k)(v_k ⊗ r)ᵀ + ᵀ + (v_k ⊗ r)² ]
//! ```
//!
//! with m̂ the directions orthogonal to r and to every t_k. Since b' < 0, the second term is negative; in the third,
//! `w ⊗ t_k` and `v_k ⊗ r` are orthogonal, so each summand has a 2 × 2 positive part in closed form.

use nalgebra::{SMatrix, SVector};

use super::barrier::LogBarrier;
use crate::Vec3;
use crate::assembly::{PsdProjection, project_to_psd};
use crate::geometry::{
    ClosestPoints, edge_edge, edge_edge_distance_squared, point_triangle,
    point_triangle_distance_squared,
};

/// What a pair is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PairKind {
    /// Vertex 0 and the face of vertices 1, 2, 3.
    VertexFace,
    /// The edges of vertices 0, 1 and of vertices 2, 3.
    EdgeEdge,
}

/// Two primitives that may touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Pair {
    /// Which primitives.
    pub kind: PairKind,
    /// Their vertices in the collision mesh.
    pub vertices: [u32; 4],
}

impl Pair {
    /// The vertices of the one primitive and of the other.
    #[inline]
    pub fn primitives(&self) -> [&[u32]; 2] {
        let (first, second) = self.vertices.split_at(match self.kind {
            PairKind::VertexFace => 1,
            PairKind::EdgeEdge => 2,
        });
        [first, second]
    }

    /// Closest points at the given positions of the four vertices.
    #[inline]
    pub fn closest(&self, x: &[Vec3; 4]) -> ClosestPoints {
        match self.kind {
            PairKind::VertexFace => point_triangle(&x[0], &x[1], &x[2], &x[3]),
            PairKind::EdgeEdge => edge_edge(&x[0], &x[1], &x[2], &x[3]),
        }
    }

    /// Squared distance at the given positions of the four vertices [m²].
    #[inline]
    pub fn distance_squared(&self, x: &[Vec3; 4]) -> f64 {
        match self.kind {
            PairKind::VertexFace => point_triangle_distance_squared(&x[0], &x[1], &x[2], &x[3]),
            PairKind::EdgeEdge => edge_edge_distance_squared(&x[0], &x[1], &x[2], &x[3]),
        }
    }
}

/// m and its derivative m', at `c` with threshold ε: value 1 beyond it.
fn mollifier(c: f64, threshold: f64) -> [f64; 3] {
    let ratio = c / threshold;
    if ratio >= 1.0 {
        [1.0, 0.0, 0.0]
    } else {
        [
            ratio * (2.0 - ratio),
            2.0 * (1.0 - ratio) / threshold,
            -2.0 / (threshold * threshold),
        ]
    }
}

fn squared_sine(x: &[Vec3; 4]) -> f64 {
    (x[1] - x[0]).cross(&(x[3] - x[2])).norm_squared()
}

/// m for a pair; `threshold` is ε, or 0 for pairs without mollifier.
pub(super) fn mollify(x: &[Vec3; 4], threshold: f64) -> f64 {
    mollifier_at(x, threshold)[0]
}

/// Gradient of `m(c) b(D)`.
pub(super) fn gradient(
    closest: &ClosestPoints,
    barrier: &LogBarrier,
    x: &[Vec3; 4],
    threshold: f64,
) -> SVector<f64, 12> {
    let [value, first, _] = barrier.derivatives(closest.distance_squared);
    let [m, m1, _] = mollifier_at(x, threshold);
    let along_distance = distance_gradient(closest) * (m * first);
    if m1 == 0.0 {
        return along_distance;
    }
    along_distance + squared_sine_derivatives(x).0 * (m1 * value)
}

/// m and its derivatives for a pair; `threshold` is ε, or 0 for pairs without mollifier.
fn mollifier_at(x: &[Vec3; 4], threshold: f64) -> [f64; 3] {
    if threshold > 0.0 {
        mollifier(squared_sine(x), threshold)
    } else {
        [1.0, 0.0, 0.0]
    }
}

fn distance_gradient(closest: &ClosestPoints) -> SVector<f64, 12> {
    SVector::from_fn(|i, _| 2.0 * closest.weights[i / 3] * closest.separation[i % 3])
}

/// Gradient and Hessian of `m(c) b(D)`.
pub(super) fn derivatives(
    closest: &ClosestPoints,
    barrier: &LogBarrier,
    x: &[Vec3; 4],
    threshold: f64,
    projection: PsdProjection,
) -> (SVector<f64, 12>, SMatrix<f64, 12, 12>) {
    let [value, first, second] = barrier.derivatives(closest.distance_squared);
    let distance_gradient = distance_gradient(closest);
    let kept = projection.kept();
    let [m, m1, m2] = mollifier_at(x, threshold);
    if m1 == 0.0 {
        return (
            distance_gradient * first,
            barrier_hessian(closest, first, second, kept),
        );
    }
    // Rare, nearly parallel edges: the products of derivatives of m and b have no simple sign structure.
    let (sine_gradient, sine_hessian) = squared_sine_derivatives(x);
    let gradient = distance_gradient * (m * first) + sine_gradient * (m1 * value);
    let cross = distance_gradient * sine_gradient.transpose() * (m1 * first);
    let mut hessian = barrier_hessian(closest, first, second, 1.0) * m
        + cross
        + cross.transpose()
        + sine_gradient * sine_gradient.transpose() * (m2 * value)
        + sine_hessian * (m1 * value);
    if kept < 1.0 {
        project_to_psd(&mut hessian, kept);
    }
    (gradient, hessian)
}

/// The formula in the head of this file, of whose negative part the share `kept` is left.
fn barrier_hessian(
    closest: &ClosestPoints,
    first: f64,
    second: f64,
    kept: f64,
) -> SMatrix<f64, 12, 12> {
    let distance = closest.distance_squared.sqrt();
    let direction = closest.separation / distance;
    let w = SVector::<f64, 4>::from(closest.weights);
    let mut normal = 4.0 * second * closest.distance_squared + 2.0 * first;
    let mut lateral = 2.0 * first;
    for factor in [&mut normal, &mut lateral] {
        *factor = factor.max(kept * *factor);
    }
    // Blocks on the weights: (w wᵀ) ⊗ B with one 3 × 3 matrix B.
    let mut block = direction * direction.transpose() * normal;
    if lateral != 0.0 {
        let mut rest = nalgebra::Matrix3::identity() - direction * direction.transpose();
        for (tangent, _) in closest.slides() {
            rest -= tangent * tangent.transpose();
        }
        block += rest * lateral;
    }
    let mut hessian = kronecker(&(w * w.transpose()), &block);
    for (tangent, change) in closest.slides() {
        let v = SVector::<f64, 4>::from(*change);
        let (a, b) = (w.norm(), v.norm() * distance);
        if a == 0.0 || b == 0.0 {
            continue;
        }
        // −2 b' [[0, 1], [1, 1]] on (w ⊗ t, v ⊗ r); on unit vectors [[0, ab], [ab, b²]].
        let k = -2.0 * first;
        let root = (b * b + 4.0 * a * a).sqrt();
        let largest = 0.5 * b * (b + root);
        // Unit eigenvector (ab, largest) / norm of the 2 × 2 matrix.
        let lead = k * largest / (a * a * b * b + largest * largest);
        let blend = |exact: f64, positive: f64| positive + kept * (exact - positive);
        let cross = blend(k, lead * largest);
        let square = blend(k, lead * largest * largest / (b * b));
        if kept < 1.0 {
            let lateral = blend(0.0, lead * b * b);
            hessian += kronecker(
                &(w * w.transpose() * lateral),
                &(tangent * tangent.transpose()),
            );
        }
        let mixed = kronecker(
            &(w * v.transpose() * (cross * distance)),
            &(tangent * direction.transpose()),
        );
        hessian += mixed + mixed.transpose();
        let radial = direction * direction.transpose();
        hessian += kronecker(
            &(v * v.transpose() * (square * distance * distance)),
            &radial,
        );
    }
    hessian
}

fn kronecker(a: &SMatrix<f64, 4, 4>, b: &SMatrix<f64, 3, 3>) -> SMatrix<f64, 12, 12> {
    SMatrix::from_fn(|i, j| a[(i / 3, j / 3)] * b[(i % 3, j % 3)])
}

/// Gradient and Hessian of `c = |e_a × e_b|² = |e_a|² |e_b|² − (e_a · e_b)²`.
fn squared_sine_derivatives(x: &[Vec3; 4]) -> (SVector<f64, 12>, SMatrix<f64, 12, 12>) {
    let (u, v) = (x[1] - x[0], x[3] - x[2]);
    let (uu, vv, uv) = (u.norm_squared(), v.norm_squared(), u.dot(&v));
    let by_edge = [(u * vv - v * uv) * 2.0, (v * uu - u * uv) * 2.0];
    let identity = nalgebra::Matrix3::identity();
    let same = [
        identity * (2.0 * vv) - v * v.transpose() * 2.0,
        identity * (2.0 * uu) - u * u.transpose() * 2.0,
    ];
    let cross = u * v.transpose() * 4.0 - v * u.transpose() * 2.0 - identity * (2.0 * uv);
    let sign = |i: usize| if (i / 3).is_multiple_of(2) { -1.0 } else { 1.0 };
    let gradient = SVector::<f64, 12>::from_fn(|i, _| sign(i) * by_edge[i / 6][i % 3]);
    let hessian = SMatrix::<f64, 12, 12>::from_fn(|i, j| {
        let entry = match (i / 6, j / 6) {
            (0, 1) => cross[(i % 3, j % 3)],
            (1, 0) => cross[(j % 3, i % 3)],
            (edge, _) => same[edge][(i % 3, j % 3)],
        };
        sign(i) * sign(j) * entry
    });
    (gradient, hessian)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::over_numbers::{cross, dot, sub};
    use crate::geometry::{Jet, Real};

    fn check(kind: PairKind, points: [[f64; 3]; 4], threshold: f64) {
        let x = points.map(|p| Vec3::new(p[0], p[1], p[2]));
        let pair = Pair {
            kind,
            vertices: [0, 1, 2, 3],
        };
        let barrier = LogBarrier::new(0.1, 0.9);
        let value =
            |x: &[Vec3; 4]| mollify(x, threshold) * barrier.value(pair.closest(x).distance_squared);
        let at = |x: &[Vec3; 4], p| derivatives(&pair.closest(x), &barrier, x, threshold, p);
        let (gradient, hessian) = at(&x, PsdProjection::Exact);
        assert!(gradient.norm() > 1e-3, "the pair is active");
        let h = 1e-6;
        for i in 0..12 {
            let moved = |step: f64| {
                let mut y = x;
                y[i / 3][i % 3] += step;
                y
            };
            let difference = (value(&moved(h)) - value(&moved(-h))) / (2.0 * h);
            assert!((gradient[i] - difference).abs() < 1e-7 * gradient.norm().max(1.0));
            let column = (at(&moved(h), PsdProjection::Exact).0
                - at(&moved(-h), PsdProjection::Exact).0)
                / (2.0 * h);
            assert!(
                (hessian.column(i) - column).norm() < 1e-6 * hessian.norm(),
                "column {i}"
            );
        }
        let (same, projected) = at(&x, PsdProjection::Clamp);
        assert_eq!(same, gradient);
        assert_eq!(
            super::gradient(&pair.closest(&x), &barrier, &x, threshold),
            gradient
        );
        let (_, partial) = at(&x, PsdProjection::Partial(0.3));
        let blend = projected + (hessian - projected) * 0.3;
        assert!((partial - blend).norm() < 1e-13 * hessian.norm());
        let eigenvalues = nalgebra::DMatrix::from_column_slice(12, 12, projected.as_slice())
            .symmetric_eigenvalues();
        assert!(eigenvalues.min() > -1e-12 * projected.norm());
        let scaled = projected * gradient;
        assert!(scaled.norm() > 0.0);
    }

    /// The barrier over jets, where both closest points are interior, from the textbook distances of a point and a plane
    /// and of two lines: `(separation · n)² / |n|²`.
    fn by_jets(kind: PairKind, points: [[f64; 3]; 4], barrier: &LogBarrier) -> Jet<12> {
        let x: [[Jet<12>; 3]; 4] = std::array::from_fn(|i| {
            std::array::from_fn(|k| Jet::variable(points[i][k], 3 * i + k))
        });
        let (u, v, separation) = match kind {
            PairKind::VertexFace => (sub(&x[2], &x[1]), sub(&x[3], &x[1]), sub(&x[0], &x[1])),
            PairKind::EdgeEdge => (sub(&x[1], &x[0]), sub(&x[3], &x[2]), sub(&x[0], &x[2])),
        };
        let n = cross(&u, &v);
        let along = dot(&separation, &n);
        let distance_squared = along * along / dot(&n, &n);
        let touching = barrier.touching_distance * barrier.touching_distance;
        let ratio = (distance_squared - touching) * (1.0 / barrier.range);
        -((ratio - 1.0) * (ratio - 1.0) * ratio.ln())
    }

    #[test]
    fn interior_pairs_agree_with_dual_numbers() {
        let barrier = LogBarrier::new(0.1, 0.9);
        let edges = [
            [0.0, 0.0, 0.0],
            [1.0, 0.1, 0.0],
            [0.4, -0.5, 0.3],
            [0.6, 0.8, 0.4],
        ];
        let face = [[0.4, 0.35, 0.5], FACE[0], FACE[1], FACE[2]];
        for (kind, points) in [(PairKind::VertexFace, face), (PairKind::EdgeEdge, edges)] {
            let x = points.map(|p| Vec3::new(p[0], p[1], p[2]));
            let closest = Pair {
                kind,
                vertices: [0, 1, 2, 3],
            }
            .closest(&x);
            assert_eq!(closest.slides().len(), 2);
            let (gradient, hessian) =
                derivatives(&closest, &barrier, &x, 0.0, PsdProjection::Exact);
            let oracle = by_jets(kind, points, &barrier);
            assert!((barrier.value(closest.distance_squared) - oracle.value()).abs() < 1e-13);
            for i in 0..12 {
                assert!((gradient[i] - oracle.gradient()[i]).abs() < 1e-12 * gradient.norm());
                for j in 0..12 {
                    assert!(
                        (hessian[(i, j)] - oracle.hessian(i, j)).abs() < 1e-11 * hessian.norm()
                    );
                }
            }
        }
    }

    const FACE: [[f64; 3]; 3] = [[0.0, 0.0, 0.1], [1.1, 0.2, 0.0], [0.3, 0.9, -0.2]];

    #[test]
    fn vertex_face_barriers_have_the_right_derivatives_in_every_region() {
        for p in [
            [0.4, 0.35, 0.5],
            [0.5, -0.3, 0.3],
            [-0.4, -0.3, 0.3],
            [1.5, 0.1, 0.3],
        ] {
            check(PairKind::VertexFace, [p, FACE[0], FACE[1], FACE[2]], 0.0);
        }
    }

    #[test]
    fn edge_edge_barriers_have_the_right_derivatives_in_every_region() {
        let a = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0]];
        for b in [
            [[0.4, -0.5, 0.3], [0.6, 0.8, 0.4]],
            [[0.4, 0.3, 0.3], [0.6, 1.8, 0.4]],
            [[1.3, 0.2, 0.3], [2.6, 0.8, 0.4]],
        ] {
            check(PairKind::EdgeEdge, [a[0], a[1], b[0], b[1]], 0.0);
        }
    }

    #[test]
    fn mollified_edges_have_the_right_derivatives() {
        let x = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.1, -0.02, 0.3],
            [0.9, 0.03, 0.35],
        ];
        check(PairKind::EdgeEdge, x, 0.05);
    }
}
