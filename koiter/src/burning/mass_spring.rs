//! Springs that pull by Hooke's law, in explicit steps: what the paper holds its projections against (Fig. 7).
//!
//! ```text
//! x̂ = x̃ + h² M⁻¹ F(x) / (1 + h k_d)      F_j = k (d_j − l_j) along the spring      h ≤ min √(m / (2 k n))
//! ```
//!
//! x positions at the start of the step, x̃ after free motion [m], k stiffness [N/m], d and l length and target length [m], m
//! mass [kg] and n number of springs of a particle, k_d damping [1/s]. This is the symplectic Euler method. No eigenvalue of M⁻¹ K is above 2 k n / m,
//! so h is half of the longest stable step.

use super::double_layer::DoubleLayer;
use super::projection::{Lengths, ProjectionMethod};
use super::setup::BurningSetup;
use super::springs::vector;
use crate::Vec3;

/// The step that is used at most [s]; infinite where springs do not pull.
pub(super) fn longest_step(setup: &BurningSetup) -> f64 {
    if setup.projection.method != ProjectionMethod::MassSpring {
        return f64::INFINITY;
    }
    let mut springs = vec![0.0; setup.shell.particles.len()];
    for &particle in setup
        .shell
        .springs
        .iter()
        .flat_map(|s| s.ends.as_flattened())
    {
        springs[particle as usize] += 1.0;
    }
    let masses = setup.shell.masses(setup.area_density);
    let least = setup.burning.smallest_mass;
    let steps = masses.iter().zip(springs).map(|(mass, springs)| {
        (least * mass / (2.0 * setup.projection.stiffness * springs)).sqrt()
    });
    steps.fold(f64::INFINITY, f64::min)
}

/// Moves `positions`, which are x̃, by the springs at `start`; `inverse_masses` [1/kg], `stiffness` h² k / (1 + h k_d) [kg].
pub(super) fn pull(
    shell: &DoubleLayer,
    start: &[Vec3],
    positions: &mut [Vec3],
    lengths: Lengths<'_>,
    inverse_masses: &[f64],
    stiffness: f64,
) {
    for (color, springs) in shell.springs.iter().enumerate() {
        let wanted = lengths.targets[color].iter().zip(&lengths.is_there[color]);
        let pairs = springs.ends.iter().zip(wanted);
        for (&[a, b], (target, _)) in pairs.filter(|(_, (_, is_there))| **is_there) {
            let along = vector([a, b], start);
            let length = along.norm();
            if !(length > 0.0) {
                continue;
            }
            let push = stiffness * (1.0 - target / length) * along;
            positions[a as usize] -= inverse_masses[a as usize] * push;
            positions[b as usize] += inverse_masses[b as usize] * push;
        }
    }
}

#[cfg(test)]
mod tests;
