//! Stiffness of the cubic triangle: `K = ∫ B_mᵀ M B_m + B_bᵀ M_b B_b` over the flat rest triangle.
//!
//! In the frame of the element a corner has the unknowns (u, v, w, θ_x, θ_y, θ_z). With ℓ its lever polynomial projected to
//! the plane, turning the corner moves the surface by θ × ℓ:
//!
//! ```text
//! u = Σ N_i u_i − θ_z,i ℓ_y,i      v = Σ N_i v_i + θ_z,i ℓ_x,i      w = Σ N_i w_i + θ_x,i ℓ_y,i − θ_y,i ℓ_x,i
//! ```
//!
//! A control point that hangs rigidly on its corner does not follow the stretch of the element, so the printed membrane
//! pays too much energy for constant strain, however fine the mesh. [`Attachment::Stretched`] interpolates u and v linearly
//! and adds the rotations of the corners relative to the element, `θ_z − ω` with `ω = ½ (v_x − u_y)`.
//! Reference: Golembiovsky and Duriez (2012), Eqs. (15)–(29), with the signs of Eq. (33).

use nalgebra::{Matrix2, Matrix2x3, Matrix3, SMatrix, SVector, Vector2, Vector3};

use super::Section;
use super::control_points::{Cubic, corner_polynomials};
use crate::Vec3;

/// A stiffness over the 18 unknowns of an element.
pub(super) type Stiffness = SMatrix<f64, 18, 18>;

/// Strains over the 18 unknowns: rows xx, yy, and twice xy.
pub(super) type StrainMatrix = SMatrix<f64, 3, 18>;

/// Whether the in-plane interpolation of control points follows the stretch of the element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Attachment {
    /// Control points hang rigidly on their corners, as printed.
    Rigid,
    /// Control points follow the constant strain of the element.
    Stretched,
}

/// A flat rest triangle in its plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlatTriangle {
    /// Corners about their centroid [m].
    pub(super) corners: [Vector2<f64>; 3],
    /// ∇ξ_i [1/m], as columns.
    pub(super) gradients: Matrix2x3<f64>,
    /// Area [m²].
    pub(super) area: f64,
}

impl FlatTriangle {
    /// The triangle of three points in counter-clockwise order.
    pub(super) fn new(points: [Vector2<f64>; 3]) -> Self {
        let centroid = (points[0] + points[1] + points[2]) / 3.0;
        let corners = points.map(|x| x - centroid);
        let twice_area = (corners[1] - corners[0]).perp(&(corners[2] - corners[0]));
        let gradients = [0, 1, 2].map(|i| {
            let opposite = corners[(i + 2) % 3] - corners[(i + 1) % 3];
            Vector2::new(-opposite.y, opposite.x) / twice_area
        });
        Self {
            corners,
            gradients: Matrix2x3::from_columns(&gradients),
            area: 0.5 * twice_area,
        }
    }
}

/// Barycentric points and weights of the six-point rule, exact to degree 4: Dunavant (1985).
pub(super) fn quadrature() -> [(Vector3<f64>, f64); 6] {
    let orbits = [
        (0.445_948_490_915_965, 0.223_381_589_678_011),
        (0.091_576_213_509_771, 0.109_951_743_655_322),
    ];
    std::array::from_fn(|k| {
        let (a, weight) = orbits[k / 3];
        let mut xi = Vector3::repeat(a);
        xi[k % 3] = 1.0 - 2.0 * a;
        (xi, weight)
    })
}

/// Bending of one kind plus membrane of one kind, integrated by the six-point rule.
pub(super) fn integrate(
    triangle: &FlatTriangle,
    matrix: &Matrix3<f64>,
    strains: impl Fn(&Vector3<f64>) -> StrainMatrix,
) -> Stiffness {
    let mut stiffness = Stiffness::zeros();
    for (xi, weight) in quadrature() {
        let b = strains(&xi);
        stiffness += b.transpose() * (matrix * (weight * triangle.area)) * b;
    }
    // Round-off of the products is not symmetric.
    0.5 * (stiffness + stiffness.transpose())
}

/// A polynomial over the plane: gradient and second derivatives in x and y.
struct OverPlane {
    gradient: Vector2<f64>,
    hessian: Matrix2<f64>,
}

fn over_plane(cubic: &Cubic, triangle: &FlatTriangle) -> OverPlane {
    let gradients = &triangle.gradients;
    OverPlane {
        gradient: gradients * cubic.gradient,
        hessian: gradients * cubic.hessian * gradients.transpose(),
    }
}

/// What corner i contributes: N_i, and ℓ_i in the plane.
struct CornerField {
    own: OverPlane,
    /// ∂ℓ/∂x, row = component of ℓ, column = direction.
    lever_gradient: Matrix2<f64>,
    lever_hessians: [Matrix2<f64>; 2],
}

fn corner_field(
    corner: usize,
    levers: &[Vec3; 3],
    triangle: &FlatTriangle,
    xi: &Vector3<f64>,
) -> CornerField {
    let (own, factors) = corner_polynomials(corner, xi);
    let mut lever_gradient = Matrix2::zeros();
    let mut lever_hessians = [Matrix2::zeros(); 2];
    for (factor, lever) in factors.iter().zip(levers) {
        let factor = over_plane(factor, triangle);
        let lever = lever.xy();
        lever_gradient += lever * factor.gradient.transpose();
        for axis in 0..2 {
            lever_hessians[axis] += lever[axis] * factor.hessian;
        }
    }
    CornerField {
        own: over_plane(&own, triangle),
        lever_gradient,
        lever_hessians,
    }
}

/// Membrane strains at ξ; `levers` in the frame of the element.
pub(super) fn membrane_strains(
    triangle: &FlatTriangle,
    levers: &[[Vec3; 3]; 3],
    attachment: Attachment,
    xi: &Vector3<f64>,
) -> StrainMatrix {
    let mut b = StrainMatrix::zeros();
    let mut turned = SVector::<f64, 3>::zeros();
    for i in 0..3 {
        let field = corner_field(i, &levers[i], triangle, xi);
        let slope = match attachment {
            Attachment::Rigid => field.own.gradient,
            Attachment::Stretched => triangle.gradients.column(i).into_owned(),
        };
        b.set_column(6 * i, &Vector3::new(slope.x, 0.0, slope.y));
        b.set_column(6 * i + 1, &Vector3::new(0.0, slope.y, slope.x));
        let l = &field.lever_gradient;
        let turn = Vector3::new(-l[(1, 0)], l[(0, 1)], l[(0, 0)] - l[(1, 1)]);
        b.set_column(6 * i + 5, &turn);
        turned += turn;
    }
    if attachment == Attachment::Stretched {
        for i in 0..3 {
            let slope = triangle.gradients.column(i);
            let mut u = b.column_mut(6 * i);
            u += turned * (0.5 * slope.y);
            let mut v = b.column_mut(6 * i + 1);
            v -= turned * (0.5 * slope.x);
        }
    }
    b
}

/// Curvatures −(w_xx, w_yy, 2 w_xy) at ξ.
pub(super) fn bending_strains(
    triangle: &FlatTriangle,
    levers: &[[Vec3; 3]; 3],
    xi: &Vector3<f64>,
) -> StrainMatrix {
    let mut b = StrainMatrix::zeros();
    let voigt = |h: &Matrix2<f64>| -Vector3::new(h[(0, 0)], h[(1, 1)], h[(0, 1)] + h[(1, 0)]);
    for i in 0..3 {
        let field = corner_field(i, &levers[i], triangle, xi);
        b.set_column(6 * i + 2, &voigt(&field.own.hessian));
        b.set_column(6 * i + 3, &voigt(&field.lever_hessians[1]));
        b.set_column(6 * i + 4, &-voigt(&field.lever_hessians[0]));
    }
    b
}

/// The centroid's in-plane displacement gradient by the printed interpolation, as a function of (u, v, θ_z) of the corners:
/// a pair (∇N_i, ∂ℓ_i) a corner. The printed frame is found from it.
pub(super) fn centre_gradients(
    triangle: &FlatTriangle,
    levers: &[[Vec3; 3]; 3],
) -> [(Vector2<f64>, Matrix2<f64>); 3] {
    let centre = Vector3::repeat(1.0 / 3.0);
    [0, 1, 2].map(|i| {
        let field = corner_field(i, &levers[i], triangle, &centre);
        (field.own.gradient, field.lever_gradient)
    })
}

/// The stiffness of a cubic triangle.
pub(super) fn cubic_stiffness(
    triangle: &FlatTriangle,
    levers: &[[Vec3; 3]; 3],
    attachment: Attachment,
    section: &Section,
) -> Stiffness {
    let membrane = integrate(triangle, &section.membrane(), |xi| {
        membrane_strains(triangle, levers, attachment, xi)
    });
    membrane
        + integrate(triangle, &section.bending(), |xi| {
            bending_strains(triangle, levers, xi)
        })
}
