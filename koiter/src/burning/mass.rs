//! Mass that burns away, and the lengths it takes with it.
//!
//! ```text
//! Δm / m_init = −µ h (T − T_ign)  where T > T_ign,  m ≥ m_min                (Eq. 4)
//! T ← T − η Δm / m_init                                                      (Eq. 1: burning heats)
//! υ = m / m_init,   l = l_init ((υ_0 + υ_1) / 2)^p                           (Eqs. 5, 6)
//! ```
//!
//! µ rate of mass loss [1/(K s)], η temperature that burning the whole mass adds [K], υ volume ratio at constant density,
//! p shrinkage exponent: 1 as in the paper, 1/3 the same in all directions, 1/2 area in proportion to mass, 0 none. Lengths
//! come from the initial ones: from the present ones they would shrink anew in every step.

use super::error::BurningError;
use super::numbers::{not_negative, share, within};

/// How a shell burns.
#[derive(Clone, Debug, PartialEq)]
pub struct BurningOptions {
    /// T_ign [K].
    pub ignition_temperature: f64,
    /// µ [1/(K s)].
    pub loss_rate: f64,
    /// η [K].
    pub heat_of_combustion: f64,
    /// The share of its initial mass at which a particle disappears; below `smallest_mass`: it never does.
    pub loss_level: f64,
    /// The share of its initial mass that does not burn.
    pub smallest_mass: f64,
    /// p.
    pub shrinkage_exponent: f64,
    /// Most that a mass ratio changes in one part of a step.
    pub largest_change: f64,
}

impl Default for BurningOptions {
    /// Paper as in the measurements that the scenes follow.
    fn default() -> Self {
        Self {
            ignition_temperature: 506.0,
            loss_rate: 0.01,
            heat_of_combustion: 150.0,
            loss_level: 0.55,
            smallest_mass: 0.5,
            shrinkage_exponent: 1.0,
            // Where it was 7 % in experiments, layers tangled.
            largest_change: 0.01,
        }
    }
}

impl BurningOptions {
    /// Checks the numbers.
    ///
    /// # Errors
    /// A number out of its range, by the name that scenes give it.
    pub fn check(&self) -> Result<(), BurningError> {
        not_negative("ignition_temperature", self.ignition_temperature)?;
        not_negative("loss_rate", self.loss_rate)?;
        not_negative("heat_of_combustion", self.heat_of_combustion)?;
        share("smallest_mass", self.smallest_mass)?;
        // Inverse masses and lengths have to be numbers that can be squared.
        within(
            "smallest_mass",
            self.smallest_mass,
            [1e-3, 1.0],
            "from 0.001 to 1",
        )?;
        within(
            "shrinkage_exponent",
            self.shrinkage_exponent,
            [0.0, 10.0],
            "from 0 to 10",
        )?;
        share("largest_change", self.largest_change)?;
        share("loss_level", self.loss_level)
    }

    /// Factor on lengths at a mean mass ratio.
    pub fn length_factor(&self, mass_ratio: f64) -> f64 {
        match self.shrinkage_exponent {
            1.0 => mass_ratio,
            exponent => mass_ratio.powf(exponent),
        }
    }

    /// How fast a particle burns [1/s]; `rate_factor` scales µ.
    fn burning_rate(&self, temperature: f64, rate_factor: f64, mass_ratio: f64) -> f64 {
        let is_burning = temperature > self.ignition_temperature && mass_ratio > self.smallest_mass;
        match is_burning {
            true => self.loss_rate * rate_factor * (temperature - self.ignition_temperature),
            false => 0.0,
        }
    }

    /// The fastest burning of all particles [1/s].
    pub fn fastest(&self, temperatures: &[f64], rate_factors: &[f64], mass_ratios: &[f64]) -> f64 {
        let particles = temperatures.iter().zip(rate_factors).zip(mass_ratios);
        particles
            .map(|((&t, &factor), &ratio)| self.burning_rate(t, factor, ratio))
            .fold(0.0, f64::max)
    }

    /// Burns for `dt` [s]. What would change a mass by more than [`Self::largest_change`] burns in the next step.
    pub fn burn(
        &self,
        dt: f64,
        rate_factors: &[f64],
        temperatures: &mut [f64],
        mass_ratios: &mut [f64],
    ) {
        let particles = temperatures.iter_mut().zip(rate_factors).zip(mass_ratios);
        for ((temperature, &factor), ratio) in particles {
            let loss = dt * self.burning_rate(*temperature, factor, *ratio);
            let loss = loss
                .min(self.largest_change)
                .min(*ratio - self.smallest_mass)
                .max(0.0);
            *ratio = (*ratio - loss).max(self.smallest_mass);
            *temperature += self.heat_of_combustion * loss;
        }
    }

    /// Writes the target lengths of springs [m].
    pub fn set_targets(
        &self,
        ends: &[[u32; 2]],
        initial_lengths: &[f64],
        mass_ratios: &[f64],
        targets: &mut [f64],
    ) {
        for ((target, &[a, b]), initial) in targets.iter_mut().zip(ends).zip(initial_lengths) {
            let mean = 0.5 * (mass_ratios[a as usize] + mass_ratios[b as usize]);
            *target = initial * self.length_factor(mean);
        }
    }

    /// Mass above the level at which a particle disappears, as a share of its initial mass; what is left at 0 is there.
    pub fn level(&self, mass_ratio: f64) -> f64 {
        mass_ratio - self.loss_level
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mass_falls_by_the_formula_to_its_minimum_and_heats() {
        let options = BurningOptions {
            largest_change: 1.0,
            ..BurningOptions::default()
        };
        let mut temperatures = [606.0, 500.0, 506.0];
        let mut ratios = [1.0; 3];
        options.burn(0.1, &[1.0; 3], &mut temperatures, &mut ratios);
        // 0.01 · 0.1 s · 100 K = 0.1.
        assert!((ratios[0] - 0.9).abs() < 1e-15 && (temperatures[0] - 621.0).abs() < 1e-12);
        assert_eq!((ratios[1], ratios[2], temperatures[1]), (1.0, 1.0, 500.0));
        for _ in 0..100 {
            options.burn(0.1, &[1.0; 3], &mut temperatures, &mut ratios);
        }
        assert_eq!(ratios[0], options.smallest_mass);
        assert_eq!(options.fastest(&temperatures, &[1.0; 3], &ratios), 0.0);
    }

    #[test]
    fn no_mass_changes_faster_than_allowed() {
        let options = BurningOptions::default();
        let (mut temperatures, mut ratios) = ([5000.0], [1.0]);
        options.burn(1.0, &[1.0], &mut temperatures, &mut ratios);
        assert_eq!(ratios[0], 1.0 - 0.01);
    }

    #[test]
    fn targets_follow_the_mean_of_the_ends_and_not_the_targets_before() {
        let mut options = BurningOptions::default();
        let ends = [[0, 1], [1, 2]];
        let ratios = [1.0, 0.75, 0.5];
        let mut targets = [0.0; 2];
        for _ in 0..2 {
            options.set_targets(&ends, &[1.0, 2.0], &ratios, &mut targets);
        }
        assert_eq!(targets, [0.875, 1.25]);
        for (exponent, expected) in [(0.0, 1.0), (0.5, 0.875_f64.sqrt())] {
            options.shrinkage_exponent = exponent;
            options.set_targets(&ends, &[1.0, 2.0], &ratios, &mut targets);
            assert_eq!(targets[0], expected);
        }
    }
}
