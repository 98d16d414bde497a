//! What a load factor multiplies.

use super::system::System;
use crate::Vec3;
use crate::assembly::Energy;

/// Loads that grow in proportion to one factor λ, beside others that are constant.
#[derive(Clone, Debug, Default)]
pub struct LoadPattern {
    /// For every load its factor at λ = 1; `None`: it does not depend on λ.
    pub loads: Vec<Option<f64>>,
    /// Gravitational acceleration at λ = 1 [m/s²]; `None`: it does not depend on λ.
    pub gravity: Option<Vec3>,
}

impl LoadPattern {
    /// Sets the loads to a factor λ.
    pub fn apply(&self, load_factor: f64, system: &mut System) {
        for (share, load) in self.loads.iter().zip(&mut system.loads.loads) {
            load.set_factor(share.map_or(1.0, |share| share * load_factor));
        }
        if let Some(gravity) = self.gravity {
            system.gravity.acceleration = gravity * load_factor;
        }
    }

    /// f(q) over the solved unknowns: the forces at λ = 1 of all that depends on λ. The loads are at λ afterwards.
    pub(super) fn force(&self, q: &[f64], load_factor: f64, system: &mut System) -> Vec<f64> {
        let acceleration = system.gravity.acceleration;
        system.gravity.acceleration = self.gravity.unwrap_or_default();
        for (share, load) in self.loads.iter().zip(&mut system.loads.loads) {
            load.set_factor(share.unwrap_or(0.0));
        }
        let mut gradient = vec![0.0; q.len()];
        system.gravity.add_gradient(q, &mut gradient);
        system.loads.add_gradient(q, &mut gradient);
        system.gravity.acceleration = acceleration;
        self.apply(load_factor, system);
        let solved = system.layout.num_solved_dofs();
        gradient[..solved].iter().map(|g| -g).collect()
    }
}
