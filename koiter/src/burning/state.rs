//! What changes of a burning shell.

use super::stepper::BurningShell;
use crate::Vec3;

/// What a shell owes to its past: all that a step changes and the next one needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BurningState {
    /// Positions of the particles [m].
    pub positions: Vec<Vec3>,
    /// Velocities of the particles [m/s].
    pub velocities: Vec<Vec3>,
    /// Temperatures of the particles [K].
    pub temperatures: Vec<f64>,
    /// Masses of the particles over their initial masses.
    pub mass_ratios: Vec<f64>,
}

impl BurningState {
    /// The first particle with a value that is not finite.
    pub(super) fn first_not_finite(&self) -> Option<usize> {
        let is_finite = |v: &Vec3| v.iter().all(|value| value.is_finite());
        (0..self.positions.len()).find(|&p| {
            !(is_finite(&self.positions[p])
                && is_finite(&self.velocities[p])
                && self.temperatures[p].is_finite())
        })
    }
}

impl BurningShell {
    /// Takes up a state that a shell of the same setup had.
    ///
    /// # Errors
    /// Lists of other lengths, or values that no shell has; the shell is then as it was.
    pub fn restore(&mut self, state: &BurningState) -> Result<(), String> {
        let n = self.masses.len();
        let lengths = [
            state.positions.len(),
            state.velocities.len(),
            state.temperatures.len(),
            state.mass_ratios.len(),
        ];
        if lengths.iter().any(|&length| length != n) {
            return Err(format!(
                "a double layer of {n} particles has values of {lengths:?}"
            ));
        }
        let vectors = state.positions.iter().chain(&state.velocities);
        let mut numbers = vectors.flat_map(|v| v.iter()).chain(&state.temperatures);
        if numbers.any(|value| !value.is_finite()) {
            return Err("a value of a double layer is not finite".to_owned());
        }
        if state
            .mass_ratios
            .iter()
            .any(|ratio| !(*ratio > 0.0 && *ratio <= 1.0))
        {
            return Err(
                "a mass of a double layer is not between 0 and its initial mass".to_owned(),
            );
        }
        self.put_back(state);
        Ok(())
    }

    /// Takes up a state that this shell had.
    pub(crate) fn put_back(&mut self, state: &BurningState) {
        self.state.clone_from(state);
        self.shrink_and_cut();
    }
}
