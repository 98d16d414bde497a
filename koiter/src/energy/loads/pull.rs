//! A spring that pulls a vertex to a place, as a hand does.
//!
//! ```text
//! E = ½ k |x − t|²
//! ```
//!
//! k stiffness [N/m], x the vertex, t the place [m].

use crate::Vec3;
use crate::assembly::{Dof, Energy, HessianBuilder, NodeId, PsdProjection};

/// A vertex pulled to a place.
#[derive(Clone, Copy, Debug)]
pub struct Pull {
    /// First unknown of the vertex.
    pub vertex: Dof,
    /// Its node.
    pub node: NodeId,
    /// t [m].
    pub target: Vec3,
    /// k [N/m].
    pub stiffness: f64,
}

impl Pull {
    fn stretch(&self, q: &[f64]) -> Vec3 {
        let first = self.vertex.0 as usize;
        Vec3::from_column_slice(&q[first..first + 3]) - self.target
    }
}

impl Energy for Pull {
    fn name(&self) -> &'static str {
        "loads"
    }

    fn value(&self, q: &[f64]) -> f64 {
        0.5 * self.stiffness * self.stretch(q).norm_squared()
    }

    fn add_gradient(&self, q: &[f64], gradient: &mut [f64]) {
        let force = self.stretch(q) * self.stiffness;
        let first = self.vertex.0 as usize;
        for axis in 0..3 {
            gradient[first + axis] += force[axis];
        }
    }

    fn add_derivatives(
        &self,
        q: &[f64],
        _: PsdProjection,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        self.add_gradient(q, gradient);
        let on_diagonal = |row, column| if row == column { self.stiffness } else { 0.0 };
        hessian.add(self.node, self.node, true, on_diagonal);
    }
}
