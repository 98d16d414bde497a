//! The inertial term of an implicit step.
//!
//! ```text
//! E = (1 / 2 dt²) Σ_i m_i (q_i − q̃_i)²
//! ```
//!
//! m_i lumped mass [kg] of a position or rotational inertia [kg·m²] of an edge angle, q̃ the inertial prediction. The
//! whole incremental potential is divided by dt², so that every other energy keeps its own scale in joules.

use crate::assembly::{Energy, HessianBuilder, PsdProjection, SymmetricMatrix, ordered_sum};

/// Lumped inertia over the first unknowns of `q`.
#[derive(Clone, Debug)]
pub struct Inertia {
    /// m_i; unknowns beyond its length have none.
    pub masses: Vec<f64>,
    /// q̃.
    pub prediction: Vec<f64>,
    /// Step size [s].
    pub dt: f64,
}

impl Energy for Inertia {
    fn name(&self) -> &'static str {
        "inertia"
    }

    fn value(&self, q: &[f64]) -> f64 {
        let sum = ordered_sum(self.masses.len(), |i| {
            let offset = q[i] - self.prediction[i];
            self.masses[i] * offset * offset
        });
        sum * 0.5 / (self.dt * self.dt)
    }

    fn add_gradient(&self, q: &[f64], gradient: &mut [f64]) {
        let scale = 1.0 / (self.dt * self.dt);
        for (i, mass) in self.masses.iter().enumerate() {
            gradient[i] += scale * mass * (q[i] - self.prediction[i]);
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
        let scale = 1.0 / (self.dt * self.dt);
        let SymmetricMatrix { pattern, values } = &mut *hessian.matrix;
        for (mass, &position) in self.masses.iter().zip(pattern.diagonal_positions()) {
            values[position as usize] += scale * mass;
        }
    }
}
