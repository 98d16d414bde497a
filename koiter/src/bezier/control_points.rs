//! The cubic triangle: its polynomials, and where its control points hang on the corners.
//!
//! With ξ_i, ξ_j, ξ_k the barycentric coordinates of corner i and of the next two, everything that belongs to corner i is
//!
//! ```text
//! N_i = ξ_i³ + 3 ξ_i² ξ_j + 3 ξ_i² ξ_k + 2 ξ_i ξ_j ξ_k        ℓ_i = 3 ξ_i² ξ_j s_ij + 3 ξ_i² ξ_k s_ik + 6 ξ_i ξ_j ξ_k s_ic
//! ```
//!
//! with the levers s_ij, s_ik [m] from the corner to the two control points beside it and s_ic to its share of the central
//! one. The tangent plane of a vertex holds the first two, which is what makes the surface smooth there.

use nalgebra::{Matrix3, Vector3};

use crate::Vec3;

/// A cubic in the barycentric coordinates with its derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cubic {
    /// Value.
    pub(super) value: f64,
    /// ∂/∂ξ_m.
    pub(super) gradient: Vector3<f64>,
    /// ∂²/∂ξ_m ∂ξ_n.
    pub(super) hessian: Matrix3<f64>,
}

impl std::ops::Add for Cubic {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            gradient: self.gradient + other.gradient,
            hessian: self.hessian + other.hessian,
        }
    }
}

/// `coefficient ξ_a ξ_b ξ_c`.
fn monomial(coefficient: f64, [a, b, c]: [usize; 3], xi: &Vector3<f64>) -> Cubic {
    let mut gradient = Vector3::zeros();
    let mut hessian = Matrix3::zeros();
    for (one, two, three) in [(a, b, c), (b, c, a), (c, a, b)] {
        gradient[one] += coefficient * xi[two] * xi[three];
        hessian[(one, two)] += coefficient * xi[three];
        hessian[(two, one)] += coefficient * xi[three];
    }
    Cubic {
        value: coefficient * xi[a] * xi[b] * xi[c],
        gradient,
        hessian,
    }
}

/// What belongs to a corner: N, and the factors of its three levers.
pub(super) fn corner_polynomials(corner: usize, xi: &Vector3<f64>) -> (Cubic, [Cubic; 3]) {
    let (i, j, k) = (corner, (corner + 1) % 3, (corner + 2) % 3);
    let next = monomial(3.0, [i, i, j], xi);
    let previous = monomial(3.0, [i, i, k], xi);
    let own = monomial(1.0, [i, i, i], xi) + next + previous + monomial(2.0, [0, 1, 2], xi);
    (own, [next, previous, monomial(6.0, [0, 1, 2], xi)])
}

/// How the central control point follows from the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CentralPoint {
    /// The mean of where the three corners carry it, `p = (Σ edge points − Σ corners) / 3` at rest: Eqs. (7) and (10) as
    /// printed. Quadratic surfaces are not reproduced.
    Carried,
    /// `p = ¼ Σ edge points − ⅙ Σ corners`: the rule by which a quadratic triangle is written as a cubic one.
    Elevated,
}

/// The levers of the three corners at rest: towards the next corner, towards the previous one, and the share of the
/// central control point.
pub(super) fn rest_levers(
    corners: &[Vec3; 3],
    normals: &[Vec3; 3],
    central: CentralPoint,
) -> [[Vec3; 3]; 3] {
    let beside = [0, 1, 2].map(|i| {
        [(i + 1) % 3, (i + 2) % 3]
            .map(|k| edge_lever(corners[k] - corners[i], normals[i], normals[k]))
    });
    let carried: Vec3 = (0..3)
        .map(|i| corners[i] + beside[i][0] + beside[i][1])
        .sum::<Vec3>()
        / 3.0;
    [0, 1, 2].map(|i| {
        let [next, previous] = beside[i];
        let share = match central {
            CentralPoint::Carried => (carried - corners[i]) / 3.0,
            CentralPoint::Elevated => (next + previous) / 4.0,
        };
        [next, previous, share]
    })
}

/// The lever along an edge `e` from a corner with the first normal towards one with the second: a third of the edge, in
/// the tangent plane of the corner and in the plane of the edge and the mean normal.
fn edge_lever(edge: Vec3, normal: Vec3, other_normal: Vec3) -> Vec3 {
    let direction = edge.normalize();
    let side = direction.cross(&(normal + other_normal));
    let rows = Matrix3::from_rows(&[
        normal.normalize().transpose(),
        side.transpose(),
        direction.transpose(),
    ]);
    let determinant = rows.determinant();
    // The determinant is that of three directions: below this a normal lies along the edge and there is no such point.
    const ALONG_EDGE: f64 = 1e-3;
    if determinant.abs() < ALONG_EDGE {
        return edge / 3.0;
    }
    rows.lu()
        .solve(&Vec3::new(0.0, 0.0, edge.norm() / 3.0))
        .unwrap_or(edge / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_sum_to_one_and_their_derivatives_are_those_of_differences() {
        let xi = Vector3::new(0.2, 0.5, 0.3);
        let sum: f64 = (0..3).map(|i| corner_polynomials(i, &xi).0.value).sum();
        assert!((sum - 1.0).abs() < 1e-15);
        let h = 1e-5;
        for corner in 0..3 {
            let at = |x: Vector3<f64>| {
                let (own, levers) = corner_polynomials(corner, &x);
                [own, levers[0], levers[1], levers[2]]
            };
            for m in 0..3 {
                let step = Vector3::ith(m, h);
                let (plus, minus, here) = (at(xi + step), at(xi - step), at(xi));
                for k in 0..4 {
                    let slope = (plus[k].value - minus[k].value) / (2.0 * h);
                    // Differences of cubics: truncation h², round-off 1e-16 / h.
                    assert!((here[k].gradient[m] - slope).abs() < 1e-9);
                    let bend = (plus[k].gradient - minus[k].gradient) / (2.0 * h);
                    assert!((here[k].hessian.column(m) - bend).norm() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn levers_of_an_asymmetric_triangle_point_where_they_should() {
        let corners = [
            Vec3::new(0.0, 0.0, 0.0),
            Vec3::new(3.0, 0.0, 0.0),
            Vec3::new(0.6, 1.5, 0.0),
        ];
        let flat = rest_levers(&corners, &[Vec3::z(); 3], CentralPoint::Elevated);
        for i in 0..3 {
            let (to_next, to_previous) = (
                corners[(i + 1) % 3] - corners[i],
                corners[(i + 2) % 3] - corners[i],
            );
            assert!((flat[i][0] - to_next / 3.0).norm() < 1e-15);
            assert!((flat[i][1] - to_previous / 3.0).norm() < 1e-15);
        }
        // On a paraboloid the points are in the tangent planes and above a third of the edge.
        let normals = corners.map(|x| Vec3::new(-0.2 * x.x, -0.2 * x.y, 1.0));
        for central in [CentralPoint::Carried, CentralPoint::Elevated] {
            let curved = rest_levers(&corners, &normals, central);
            for i in 0..3 {
                for (side, k) in [(0, (i + 1) % 3), (1, (i + 2) % 3)] {
                    let edge = corners[k] - corners[i];
                    assert!(curved[i][side].dot(&normals[i]).abs() < 1e-14);
                    assert!(
                        (curved[i][side].dot(&edge) / edge.norm_squared() - 1.0 / 3.0).abs()
                            < 1e-14
                    );
                }
            }
        }
    }

    #[test]
    fn a_normal_along_its_edge_gives_the_straight_lever() {
        let edge = Vec3::new(2.0, 0.0, 0.0);
        assert_eq!(edge_lever(edge, Vec3::x(), Vec3::z()), edge / 3.0);
    }
}
