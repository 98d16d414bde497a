//! Functions of the two altitudes and the angle of a hinge: the shared chain rule of the models that average normals.
//!
//! ```text
//! f(h, h', θ):    f' = Σ f_i u_i,    f'' = Σ f_ij u_i u_j + Σ f_i u_i',    u = (T, T', −N − N')
//! ```
//!
//! Derivatives by altitudes are times the altitude, so that f_i and f_ij all have the unit of f and the functionals u
//! (those of [`crate::geometry::Wing`]) the same unit, 1/m: `f_0 = h ∂f/∂h`, `f_01 = h h' ∂²f/∂h∂h'`.

use nalgebra::Matrix3;

use super::hinge::{WING_PLACES, angle, wings};
use super::quadratic_form::{Functional, QuadraticForm, WingFunctionals};
use crate::Vec3;
use crate::geometry::Wing;

/// A deformed hinge.
pub struct DeformedHinge {
    wings: [Wing; 2],
    /// Heights of the two apexes over the edge [m].
    pub(super) heights: [f64; 2],
    /// Hinge angle.
    pub(super) theta: f64,
}

impl DeformedHinge {
    /// The hinge of edge `x₀ x₁` with apexes `x₂`, `x₃`.
    pub(super) fn new(x: &[Vec3; 4]) -> Self {
        let wings = wings(x);
        Self {
            heights: [wings[0].height, wings[1].height],
            theta: angle(&wings),
            wings,
        }
    }
}

/// Value and scaled derivatives of a function of a hinge by altitude, opposite altitude and angle.
pub struct HingeFunction {
    /// f.
    pub(super) value: f64,
    /// f_i.
    pub(super) slope: [f64; 3],
    /// f_ij.
    pub(super) curvature: Matrix3<f64>,
}

impl HingeFunction {
    /// The four derivatives of f by the vertices of the hinge.
    pub(super) fn gradient(&self, hinge: &DeformedHinge) -> [Vec3; 4] {
        let mut gradient = [Vec3::zeros(); 4];
        for (i, wing) in hinge.wings.iter().enumerate() {
            let (turning, stretching) = (wing.turning(), wing.stretching());
            for (k, place) in WING_PLACES[i].into_iter().enumerate() {
                gradient[place] += stretching[k] * self.slope[i] - turning[k] * self.slope[2];
            }
        }
        gradient
    }

    /// f', and `moment` f'' added to `form`.
    pub(super) fn add_to(
        &self,
        moment: f64,
        hinge: &DeformedHinge,
        form: &mut QuadraticForm,
    ) -> Functional {
        let [own, other] = [0, 1].map(|i| WingFunctionals::new(&hinge.wings[i], WING_PLACES[i]));
        let turning = std::array::from_fn(|i| -own.turning[i] - other.turning[i]);
        let changes = [&own.stretching, &other.stretching, &turning];
        for i in 0..3 {
            form.add_square(moment * self.curvature[(i, i)], changes[i]);
            for j in 0..i {
                form.add_product(
                    2.0 * moment * self.curvature[(i, j)],
                    changes[i],
                    changes[j],
                );
            }
        }
        for (wing, slope) in [&own, &other].into_iter().zip(self.slope) {
            wing.add_altitude(moment * slope, form);
            wing.add_angle(moment * self.slope[2], form);
        }
        std::array::from_fn(|k| (0..3).map(|i| self.slope[i] * changes[i][k]).sum())
    }
}
