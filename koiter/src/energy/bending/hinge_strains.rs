//! Strains of QB(CR): the curvature of a hinge along its mean normal, and the squares of their differences.
//!
//! ```text
//! Φ = Σ_edges (s − s̄)²,    s = √(C · 3 / (2 (A + A'))) v · (n + n') / |n + n'|
//! ```
//!
//! C, A, A' and v those of [`super::QuadraticHinge`], n, n' the unit normals of the two faces. Where lengths are kept v lies along
//! their mean, and with s̄ = 0 this is QB(CR) itself. As damping (s̄ from the start of a step, [`crate::integrate::Damping`]) it
//! follows the rate of a strain that turns with the shell and has a sign, so neither rigid motions nor the passage through the
//! flat shape disturb it.

use super::quadratic_hinge::QuadraticHinge;
use crate::assembly::{Dof, ElementFunction, LocalEnergy};
use crate::geometry::Real;
use crate::geometry::over_numbers::{cross, dot, norm, point, sub};

/// Squares of differences of the curvatures of hinges to rest values, all 0 at first.
pub struct HingeStrains {
    model: QuadraticHinge,
    rest: Vec<f64>,
}

impl HingeStrains {
    /// Of this model.
    pub fn new(model: QuadraticHinge) -> Self {
        Self {
            rest: vec![0.0; model.num_stencils()],
            model,
        }
    }

    /// s of one hinge.
    fn strain<R: Real>(&self, hinge: usize, q: &[R; 12]) -> R {
        let [along, own, other] = [1, 2, 3].map(|i| sub(&point(q, i), &point(q, 0)));
        let normals = [cross(&along, &own), cross(&other, &along)].map(|normal| {
            let length = norm(&normal);
            normal.map(|entry| entry / length)
        });
        let mean: [R; 3] = std::array::from_fn(|axis| normals[0][axis] + normals[1][axis]);
        let [_, b, c, d] = *self.model.factors(hinge);
        let bend = std::array::from_fn(|axis| along[axis] * b + own[axis] * c + other[axis] * d);
        dot(&bend, &mean) / norm(&mean)
    }
}

impl ElementFunction<12, 4> for HingeStrains {
    const MEASURES: usize = 1;

    fn name(&self) -> &str {
        self.model.name()
    }

    fn num_elements(&self) -> usize {
        self.model.num_stencils()
    }

    fn nodes(&self, element: usize) -> [Option<Dof>; 4] {
        self.model.nodes(element)
    }

    fn energy<R: Real>(&self, element: usize, q: &[R; 12]) -> R {
        let difference = self.strain(element, q) - self.rest[element];
        difference * difference
    }

    fn measure(&self, element: usize, q: &[f64; 12], measures: &mut [f64]) {
        measures[0] = self.strain(element, q);
    }

    fn rest(&self, element: usize, measures: &mut [f64]) {
        measures[0] = self.rest[element];
    }

    fn set_rest(&mut self, element: usize, measures: &[f64]) {
        self.rest[element] = measures[0];
    }

    fn describe(&self, element: usize) -> String {
        self.model.describe(element)
    }
}
