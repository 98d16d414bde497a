//! Potential energy of lumped masses in a uniform field.
//!
//! ```text
//! E = − Σ_v m_v g · x_v
//! ```
//!
//! m_v vertex mass [kg], g acceleration [m/s²], x_v position [m]; zero when every vertex is at the origin. Linear: no
//! Hessian.

use crate::Vec3;
use crate::assembly::{Dof, Energy, HessianBuilder, PsdProjection, ordered_sum};

/// Gravity on all vertices.
#[derive(Clone, Debug)]
pub struct Gravity {
    /// First unknown and mass [kg] of each vertex.
    pub masses: Vec<(Dof, f64)>,
    /// Acceleration g [m/s²].
    pub acceleration: Vec3,
}

impl Energy for Gravity {
    fn name(&self) -> &'static str {
        "gravity"
    }

    fn value(&self, q: &[f64]) -> f64 {
        ordered_sum(self.masses.len(), |i| {
            let (dof, mass) = self.masses[i];
            let x = &q[dof.0 as usize..dof.0 as usize + 3];
            -mass
                * (self.acceleration.x * x[0]
                    + self.acceleration.y * x[1]
                    + self.acceleration.z * x[2])
        })
    }

    fn add_gradient(&self, _q: &[f64], gradient: &mut [f64]) {
        for &(dof, mass) in &self.masses {
            for axis in 0..3 {
                gradient[dof.0 as usize + axis] -= mass * self.acceleration[axis];
            }
        }
    }

    fn add_derivatives(
        &self,
        q: &[f64],
        _: PsdProjection,
        gradient: &mut [f64],
        _: &mut HessianBuilder<'_>,
    ) {
        self.add_gradient(q, gradient);
    }
}
