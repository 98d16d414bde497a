//! What a burning shell is made of, and what acts on it.

use super::collisions::Collider;
use super::double_layer::DoubleLayer;
use super::error::BurningError;
use super::heat::HeatSource;
use super::mass::BurningOptions;
use super::numbers::{not_negative, positive, share, within};
use super::projection::ProjectionOptions;
use super::self_collision::{SelfCollision, SelfCollisionOptions};
use super::stepper::BurningShell;
use crate::Vec3;

/// What a burning shell is made of.
#[derive(Clone, Debug)]
pub struct BurningSetup {
    /// Particles and springs.
    pub shell: DoubleLayer,
    /// Mass of a unit of area [kg/m²].
    pub area_density: f64,
    /// Temperature at the start [K].
    pub temperature: f64,
    /// Temperature around [K].
    pub ambient_temperature: f64,
    /// Rate of cooling towards it [1/s].
    pub cooling_rate: f64,
    /// Thermal diffusivity [m²/s].
    pub diffusivity: f64,
    /// Factors on the diffusivity by particle; empty: 1.
    pub diffusivity_factors: Vec<f64>,
    /// How it burns.
    pub burning: BurningOptions,
    /// Factors on the rate of mass loss by particle; empty: 1.
    pub loss_factors: Vec<f64>,
    /// How springs are projected.
    pub projection: ProjectionOptions,
    /// How it keeps out of itself; `None`: it may pass through itself.
    pub self_collision: Option<SelfCollisionOptions>,
    /// Rate at which motion is damped [1/s].
    pub damping: f64,
}

/// What acts on a shell at a time.
#[derive(Clone, Debug, Default)]
pub struct Surroundings {
    /// Gravitational acceleration [m/s²].
    pub gravity: Vec3,
    /// Sources of heat.
    pub sources: Vec<HeatSource>,
    /// Bodies.
    pub colliders: Vec<Collider>,
    /// Corner particles that are held, and where [m].
    pub held: Vec<(u32, Vec3)>,
}

impl BurningShell {
    /// Checks the numbers of a setup.
    ///
    /// # Errors
    /// A number out of its range, by the name that scenes give it; a start shape that crosses itself and is to keep out of
    /// itself.
    pub fn check(setup: &BurningSetup) -> Result<(), BurningError> {
        positive("thickness", setup.shell.thickness)?;
        positive("area_density", setup.area_density)?;
        not_negative("temperature", setup.temperature)?;
        not_negative("ambient_temperature", setup.ambient_temperature)?;
        not_negative("cooling_rate", setup.cooling_rate)?;
        not_negative("diffusivity", setup.diffusivity)?;
        not_negative("damping", setup.damping)?;
        positive("compliance", setup.projection.compliance)?;
        positive("stiffness", setup.projection.stiffness)?;
        not_negative("tolerance", setup.projection.tolerance)?;
        setup.burning.check()?;
        // Inverse masses, lengths and stiffnesses have to be numbers that can be squared.
        within(
            "area_density",
            setup.area_density,
            [1e-9, 1e9],
            "from 1e-9 to 1e9",
        )?;
        within(
            "compliance",
            setup.projection.compliance,
            [1e-30, 1e30],
            "from 1e-30 to 1e30",
        )?;
        within(
            "stiffness",
            setup.projection.stiffness,
            [1e-9, 1e12],
            "from 1e-9 to 1e12",
        )?;
        for springs in &setup.shell.springs {
            let lengths = &springs.initial_lengths;
            let mean = lengths.iter().sum::<f64>() / lengths.len().max(1) as f64;
            // Written so that what is not a number is refused.
            if !lengths
                .iter()
                .all(|&length| length.is_finite() && length > 1e-6 * mean)
            {
                return Err(BurningError::Value {
                    what: "thickness",
                    value: setup.shell.thickness,
                    expected: "such that no two particles of the layers stand at one place",
                });
            }
        }
        if let Some(options) = &setup.self_collision {
            options.check()?;
            SelfCollision::check_start(&setup.shell)?;
        }
        setup
            .projection
            .weights
            .iter()
            .try_for_each(|&weight| share("weights", weight))
    }
}
