//! Half a hinge: a triangle seen from one of its edges.
//!
//! For the triangle `(a, b, c)` with edge `a → b` and apex `c`, unit edge vector e, length ℓ, height h, unit altitude τ
//! (in the plane, from the edge towards the apex) and normal n = e × τ, let `w = δc − (1 − s) δa − s δb` be the motion
//! of the apex relative to the foot of its altitude, at parameter s on the edge. Five linear functionals of the motion
//! `δ` carry every first and second derivative of the altitude and of the hinge angle:
//!
//! ```text
//! N = n·w / h     T = τ·w / h     M = e·w / h     Ψ = n·(δb − δa) / ℓ     K = τ·(δb − δa) / ℓ
//! altitude:  h' = h T        h'' = h (N² + M² − (M + K)²)
//! angle:     φ' = N          φ'' = −2 N T − Ψ (2 M + K)
//! ```
//!
//! φ is the angle of the half-plane of `c` about the edge, against a direction that is carried along without twist; the
//! hinge angle is θ = const − φ₀ − φ₁ over the two wings of an edge, each with its own traversal of the edge. The primes
//! are derivatives along a straight motion `x + t δ`, so `h''` and `φ''` are the quadratic forms of the Hessians.

use crate::Vec3;

/// A triangle seen from one edge.
#[derive(Clone, Copy, Debug)]
pub struct Wing {
    /// Unit vector along the edge, from `a` to `b`.
    pub edge: Vec3,
    /// Unit altitude: in the plane, orthogonal to the edge, towards the apex.
    pub altitude: Vec3,
    /// Unit normal of `(a, b, c)`.
    pub normal: Vec3,
    /// Edge length ℓ [m].
    pub length: f64,
    /// Height h of the apex above the edge [m].
    pub height: f64,
    /// Parameter of the foot of the altitude on the edge: 0 at `a`, 1 at `b`.
    pub foot: f64,
}

/// A linear functional of the motions of `a`, `b`, `c`.
pub type WingFunctional = [Vec3; 3];

impl Wing {
    /// The wing of the triangle `(a, b, c)` at its edge `a → b`. Degenerate triangles give non-finite values.
    #[inline]
    pub fn new(a: &Vec3, b: &Vec3, c: &Vec3) -> Self {
        let along = b - a;
        let length = along.norm();
        let edge = along / length;
        let arm = c - a;
        let projection = arm.dot(&edge);
        let perpendicular = arm - edge * projection;
        let height = perpendicular.norm();
        let altitude = perpendicular / height;
        Self {
            edge,
            altitude,
            normal: edge.cross(&altitude),
            length,
            height,
            foot: projection / length,
        }
    }

    #[inline]
    fn relative_to_foot(&self, direction: &Vec3) -> WingFunctional {
        let scaled = direction / self.height;
        [scaled * (self.foot - 1.0), scaled * -self.foot, scaled]
    }

    #[inline]
    fn along_edge(&self, direction: &Vec3) -> WingFunctional {
        let scaled = direction / self.length;
        [-scaled, scaled, Vec3::zeros()]
    }

    /// N: turning of the half-plane about the edge, φ'.
    #[inline]
    pub fn turning(&self) -> WingFunctional {
        self.relative_to_foot(&self.normal)
    }

    /// T: relative change of the height, h'/h.
    #[inline]
    pub fn stretching(&self) -> WingFunctional {
        self.relative_to_foot(&self.altitude)
    }

    /// M: sliding of the apex along the edge.
    #[inline]
    pub fn sliding(&self) -> WingFunctional {
        self.relative_to_foot(&self.edge)
    }

    /// Ψ: tilting of the edge out of the plane.
    #[inline]
    pub fn tilting(&self) -> WingFunctional {
        self.along_edge(&self.normal)
    }

    /// K: turning of the edge in the plane.
    #[inline]
    pub fn swinging(&self) -> WingFunctional {
        self.along_edge(&self.altitude)
    }
}

/// Hinge angle of the edge shared by two wings, each with its own traversal of the edge: in (−π, π], 0 when flat.
#[inline]
pub fn hinge_angle(wing: &Wing, neighbor: &Wing) -> f64 {
    wing.normal
        .cross(&neighbor.normal)
        .dot(&wing.edge)
        .atan2(wing.normal.dot(&neighbor.normal))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::over_numbers::{angle_about, cross, norm, sub};
    use crate::geometry::{Jet, Real};

    const POINTS: [[f64; 3]; 4] = [
        [0.1, -0.2, 0.05],
        [1.3, 0.2, -0.3],
        [0.4, 0.9, 0.35],
        [0.7, -1.1, 0.4],
    ];

    fn functional(f: &WingFunctional, slots: [usize; 3]) -> [f64; 12] {
        let mut out = [0.0; 12];
        for (v, slot) in f.iter().zip(slots) {
            for axis in 0..3 {
                out[3 * slot + axis] += v[axis];
            }
        }
        out
    }

    /// Altitude of c over a → b and hinge angle of a, b, c, d from their definitions, over any number type.
    fn by_definition<R: Real>(x: &[[R; 3]; 4]) -> (R, R) {
        let e = sub(&x[1], &x[0]);
        let n0 = cross(&e, &sub(&x[2], &x[0]));
        let n1 = cross(&sub(&x[3], &x[0]), &e);
        (norm(&n0) / norm(&e), angle_about(&e, &n0, &n1))
    }

    #[test]
    fn first_and_second_derivatives_agree_with_jets() {
        let v: Vec<Vec3> = POINTS.iter().map(|p| Vec3::new(p[0], p[1], p[2])).collect();
        let wings = [
            Wing::new(&v[0], &v[1], &v[2]),
            Wing::new(&v[1], &v[0], &v[3]),
        ];
        let slots = [[0, 1, 2], [1, 0, 3]];
        let jets: [[Jet<12>; 3]; 4] = std::array::from_fn(|i| {
            std::array::from_fn(|k| Jet::variable(POINTS[i][k], 3 * i + k))
        });
        let (height, theta) = by_definition(&jets);
        assert!((height.value() - wings[0].height).abs() < 1e-14);
        assert!((theta.value() - hinge_angle(&wings[0], &wings[1])).abs() < 1e-14);
        let turning: Vec<_> = (0..2)
            .map(|i| functional(&wings[i].turning(), slots[i]))
            .collect();
        let stretching: Vec<_> = (0..2)
            .map(|i| functional(&wings[i].stretching(), slots[i]))
            .collect();
        let sliding: Vec<_> = (0..2)
            .map(|i| functional(&wings[i].sliding(), slots[i]))
            .collect();
        let tilting: Vec<_> = (0..2)
            .map(|i| functional(&wings[i].tilting(), slots[i]))
            .collect();
        let swinging: Vec<_> = (0..2)
            .map(|i| functional(&wings[i].swinging(), slots[i]))
            .collect();
        let pair =
            |u: &[f64; 12], v: &[f64; 12], i: usize, j: usize| 0.5 * (u[i] * v[j] + u[j] * v[i]);
        for i in 0..12 {
            assert!((height.gradient()[i] - wings[0].height * stretching[0][i]).abs() < 1e-13);
            assert!((theta.gradient()[i] + turning[0][i] + turning[1][i]).abs() < 1e-13);
            for j in 0..12 {
                let shear = |f: usize, k: usize| sliding[f][k] + swinging[f][k];
                let h2 = wings[0].height
                    * (turning[0][i] * turning[0][j] + sliding[0][i] * sliding[0][j]
                        - shear(0, i) * shear(0, j));
                assert!(
                    (height.hessian(i, j) - h2).abs() < 1e-12,
                    "altitude {i} {j}"
                );
                let mut t2 = 0.0;
                for f in 0..2 {
                    let twice: [f64; 12] =
                        std::array::from_fn(|k| 2.0 * sliding[f][k] + swinging[f][k]);
                    t2 += 2.0 * pair(&turning[f], &stretching[f], i, j)
                        + pair(&tilting[f], &twice, i, j);
                }
                assert!((theta.hessian(i, j) - t2).abs() < 1e-12, "angle {i} {j}");
            }
        }
    }

    #[test]
    fn a_fold_downwards_has_a_positive_hinge_angle() {
        let [a, b] = [Vec3::zeros(), Vec3::x()];
        let up = Wing::new(&a, &b, &Vec3::new(0.5, 1.0, -0.3));
        let down = Wing::new(&b, &a, &Vec3::new(0.5, -1.0, -0.3));
        let theta = hinge_angle(&up, &down);
        assert!((theta - 2.0 * 0.3f64.atan()).abs() < 1e-14);
    }
}
