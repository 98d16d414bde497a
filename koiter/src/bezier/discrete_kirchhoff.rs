//! Discrete Kirchhoff bending (DKT): slopes that are quadratic in the triangle and fit a cubic deflection on its edges.
//!
//! The slopes g = ∇w are those of the corners, `g = (−θ_y, θ_x)`, and in the middle of an edge from i to j of length L and
//! direction t
//!
//! ```text
//! g = 3/(2L) (w_j − w_i) t + (½ I − ¾ t tᵀ)(g_i + g_j)
//! ```
//!
//! the tangential part being that of the cubic through the ends and the normal part linear. Curvatures are derivatives of g,
//! linear in the triangle. It passes the patch test on any mesh.
//! Reference: Batoz, Bathe, Ho, "A study of three-node triangular plate bending elements" (1980).

use nalgebra::{Matrix2, SMatrix, Vector3};

use super::Section;
use super::stiffness::{FlatTriangle, Stiffness, StrainMatrix, integrate};

type Slopes = SMatrix<f64, 2, 18>;

/// Slopes at a corner.
fn corner_slopes(corner: usize) -> Slopes {
    let mut g = Slopes::zeros();
    g[(0, 6 * corner + 4)] = -1.0;
    g[(1, 6 * corner + 3)] = 1.0;
    g
}

/// Slopes in the middle of the edge from corner `i` to corner `j`.
fn middle_slopes(triangle: &FlatTriangle, i: usize, j: usize) -> Slopes {
    let edge = triangle.corners[j] - triangle.corners[i];
    let (length, t) = (edge.norm(), edge.normalize());
    let share = 0.5 * Matrix2::identity() - 0.75 * t * t.transpose();
    let mut g: Slopes = share * (corner_slopes(i) + corner_slopes(j));
    for axis in 0..2 {
        g[(axis, 6 * j + 2)] += 1.5 / length * t[axis];
        g[(axis, 6 * i + 2)] -= 1.5 / length * t[axis];
    }
    g
}

/// Curvatures −(w_xx, w_yy, 2 w_xy) at ξ.
pub(super) fn strains(triangle: &FlatTriangle, xi: &Vector3<f64>) -> StrainMatrix {
    let mut b = StrainMatrix::zeros();
    let mut add = |slopes: &Slopes, x: f64, y: f64| {
        for k in 0..18 {
            let (gx, gy) = (slopes[(0, k)], slopes[(1, k)]);
            b[(0, k)] -= x * gx;
            b[(1, k)] -= y * gy;
            b[(2, k)] -= y * gx + x * gy;
        }
    };
    for i in 0..3 {
        let j = (i + 1) % 3;
        let (own, next) = (triangle.gradients.column(i), triangle.gradients.column(j));
        let corner = own * (4.0 * xi[i] - 1.0);
        add(&corner_slopes(i), corner.x, corner.y);
        let middle = (next * xi[i] + own * xi[j]) * 4.0;
        add(&middle_slopes(triangle, i, j), middle.x, middle.y);
    }
    b
}

/// The bending stiffness.
pub(super) fn bending_stiffness(triangle: &FlatTriangle, section: &Section) -> Stiffness {
    integrate(triangle, &section.bending(), |xi| strains(triangle, xi))
}
