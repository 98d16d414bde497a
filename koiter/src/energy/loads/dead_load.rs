//! Forces that keep their direction: point, line and area loads, lumped to vertices.
//!
//! ```text
//! E = − λ Σ_v F_v · (x_v − X_v)
//! ```
//!
//! F_v force on a vertex [N], x_v and X_v its position now and at the start [m], λ the factor: minus the work done. Linear:
//! no Hessian. A line load of q [N/m] gives each end of an edge q ℓ/2, an area load of p [N/m²] each corner of a face
//! p A/3, with rest lengths ℓ and rest areas A: the consistent forces of linear interpolation.

use crate::Vec3;
use crate::assembly::{Dof, Energy, HessianBuilder, PsdProjection, ordered_sum};

/// A force on one vertex.
#[derive(Clone, Copy, Debug)]
pub struct VertexForce {
    /// First unknown of the vertex.
    pub vertex: Dof,
    /// F [N].
    pub force: Vec3,
    /// X [m].
    pub start: Vec3,
}

/// Dead forces on vertices.
#[derive(Clone, Debug)]
pub struct DeadLoad {
    /// The forces.
    pub forces: Vec<VertexForce>,
    /// λ.
    pub factor: f64,
}

impl Energy for DeadLoad {
    fn name(&self) -> &'static str {
        "loads"
    }

    fn value(&self, q: &[f64]) -> f64 {
        let work = ordered_sum(self.forces.len(), |i| {
            let VertexForce {
                vertex,
                force,
                start,
            } = self.forces[i];
            let first = vertex.0 as usize;
            force.dot(&(Vec3::new(q[first], q[first + 1], q[first + 2]) - start))
        });
        -self.factor * work
    }

    fn add_gradient(&self, _q: &[f64], gradient: &mut [f64]) {
        for VertexForce { vertex, force, .. } in &self.forces {
            for axis in 0..3 {
                gradient[vertex.0 as usize + axis] -= self.factor * force[axis];
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
