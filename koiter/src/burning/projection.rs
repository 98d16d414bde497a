//! Successive fast projection: colour after colour onto its constraints, sweep after sweep (Eq. 18).
//!
//! All springs at once are more constraints than a double layer has unknowns (10 to 6 on large grids), so A of all of them
//! is singular; each colour alone is a network of quads with independent constraints on a sheet. After a sweep the colours
//! solved early are left with what the later ones undid: lengths agree in the end only if there is a shape that has them.

use super::network::{Errors, Mobility, Network, StepLimits};
use super::springs::Springs;
use crate::Vec3;

/// Which way springs are brought to their lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Deserialize, serde::Serialize, schemars::JsonSchema),
    serde(rename_all = "kebab-case")
)]
pub enum ProjectionMethod {
    /// Colour after colour, as the paper does.
    #[default]
    Successive,
    /// All at once, with compliance.
    Global,
    /// No projection: springs pull by Hooke's law, in explicit steps, as those with which the paper compares its own.
    MassSpring,
}

/// How springs are projected.
#[derive(Clone, Debug, PartialEq)]
pub struct ProjectionOptions {
    /// Which way.
    pub method: ProjectionMethod,
    /// Compliance of the springs in the global way [m/N].
    pub compliance: f64,
    /// Stiffness of the springs by Hooke's law [N/m].
    pub stiffness: f64,
    /// Most sweeps over all colours a step, or iterations of the global way.
    pub sweeps: usize,
    /// Sweeps stop when no spring is off its length by more than this share; conjugate gradients when their residual has
    /// fallen to this share.
    pub tolerance: f64,
    /// Most iterations of conjugate gradients for one colour.
    pub gradient_iterations: usize,
    /// No particle moves further in the projection of a colour than this share of the mean length of its springs; the paper
    /// has no such bound.
    pub longest_move: f64,
    /// Weights of the colours, above 0 and at most 1: a sweep removes this share of their errors.
    pub weights: [f64; 4],
    /// Whether particles that are held count in A as if they moved, as in Table 1 of the paper: steps are then shorter.
    pub held_ends_count: bool,
}

impl Default for ProjectionOptions {
    fn default() -> Self {
        Self {
            method: ProjectionMethod::default(),
            // A cell of paper, 2 cm wide, weighs 0.3 mN: it stretches a spring by a nanometre.
            compliance: 1e-5,
            // The same cell stretches such a spring by 3 µm.
            stiffness: 100.0,
            sweeps: 7,
            tolerance: 1e-7,
            gradient_iterations: 200,
            // With no bound a sheet that shrinks by half tangles; with a tenth and with a third it does not.
            longest_move: 0.25,
            weights: [1.0; 4],
            held_ends_count: false,
        }
    }
}

/// What a projection took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProjectionReport {
    /// Sweeps taken.
    pub sweeps: usize,
    /// Iterations of conjugate gradients in all.
    pub gradient_iterations: usize,
    /// Whether all lengths were met.
    pub converged: bool,
}

/// Lengths that are wanted, network by network.
#[derive(Clone, Copy, Debug)]
pub struct Lengths<'a> {
    /// Target lengths [m].
    pub targets: &'a [Vec<f64>],
    /// Which springs are there.
    pub is_there: &'a [Vec<bool>],
}

/// Networks that are projected one after the other.
#[derive(Clone, Debug)]
pub struct Projection {
    networks: Vec<Network>,
}

impl Projection {
    /// Of networks in the order in which they are projected.
    pub fn new<'a>(networks: impl IntoIterator<Item = &'a Springs>, num_particles: usize) -> Self {
        let networks = networks.into_iter();
        Self {
            networks: networks
                .map(|springs| Network::new(springs, num_particles))
                .collect(),
        }
    }

    /// Projects `positions`; `inverse_masses` [1/kg] are 0 where a particle is held, `held_masses` what they would be.
    /// After every network `correct` may move particles out of obstacles.
    pub fn project(
        &mut self,
        positions: &mut [Vec3],
        lengths: Lengths<'_>,
        mobility: Mobility<'_>,
        options: &ProjectionOptions,
        mut correct: impl FnMut(&mut [Vec3]),
    ) -> ProjectionReport {
        let mut report = ProjectionReport::default();
        let limits = StepLimits {
            tolerance: options.tolerance,
            iterations: options.gradient_iterations,
            longest_move: options.longest_move,
        };
        while report.sweeps < options.sweeps && !report.converged {
            let mut largest: f64 = 0.0;
            for (index, network) in self.networks.iter_mut().enumerate() {
                let (targets, is_there) = (&lengths.targets[index], &lengths.is_there[index]);
                let errors = network.measure(positions, targets, is_there);
                largest = largest.max(errors.largest);
                let weight = options.weights[index % options.weights.len()];
                report.gradient_iterations += network.project(positions, mobility, weight, limits);
                correct(positions);
            }
            report.sweeps += 1;
            report.converged = largest <= options.tolerance;
        }
        report
    }

    /// The errors of every network at `positions`.
    pub fn errors(&mut self, positions: &[Vec3], lengths: Lengths<'_>) -> Vec<Errors> {
        let networks = self
            .networks
            .iter_mut()
            .zip(lengths.targets)
            .zip(lengths.is_there);
        networks
            .map(|((network, targets), is_there)| network.measure(positions, targets, is_there))
            .collect()
    }
}

#[cfg(test)]
mod tests;
