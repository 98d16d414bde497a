//! A burning shell, step by step: heat, mass loss, what has burnt away, motion (Sect. 4 of the paper).
//!
//! ```text
//! ṽ = v + h g      x̃ = x + h ṽ / (1 + h k_d)      x̂ = projections of x̃      v̂ = (x̂ − x) / h       (Eqs. 8, 9, 12, 13)
//! ```
//!
//! g gravity [m/s²], k_d damping [1/s]. Planes and balls push particles out after every colour, and take from velocities at
//! the end. A step is taken in equal parts where masses would otherwise change by more than
//! [`BurningOptions::largest_change`].

use std::time::Instant;

use super::ablation::Remaining;
use super::collisions::Collider;
use super::double_layer::DoubleLayer;
use super::error::BurningError;
use super::global_solve::{GlobalLimits, GlobalSolve};
use super::heat::{Conduction, HeatSource, cool, heat};
use super::mass::BurningOptions;
use super::network::Mobility;
use super::numbers::{not_negative, positive, share, within};
use super::projection::{
    Lengths, Projection, ProjectionMethod, ProjectionOptions, ProjectionReport,
};
use super::surface::RenderSurface;
use crate::Vec3;
use crate::solve::NotPositiveDefinite;

/// Most parts of a step; what would burn faster burns later.
const MAX_PARTS: usize = 50;
/// A particle this close to a body, as a share of the thickness, touches it.
const TOUCHING: f64 = 0.01;

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

/// What a step took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BurningReport {
    /// Parts in which it was taken.
    pub parts: usize,
    /// Sweeps of projections.
    pub sweeps: usize,
    /// Iterations of conjugate gradients of projections.
    pub gradient_iterations: usize,
    /// Parts in which not all springs had their lengths at the end.
    pub unmet: usize,
    /// Wall time [s] of heat, mass loss and cutting, and motion.
    pub seconds: [f64; 3],
}

impl BurningReport {
    /// Adds what another shell took.
    pub fn add(&mut self, other: &Self) {
        self.parts = self.parts.max(other.parts);
        self.sweeps += other.sweeps;
        self.gradient_iterations += other.gradient_iterations;
        self.unmet += other.unmet;
        for (seconds, more) in self.seconds.iter_mut().zip(other.seconds) {
            *seconds += more;
        }
    }
}

/// A shell that burns.
pub struct BurningShell {
    pub(super) setup: BurningSetup,
    pub(super) state: BurningState,
    masses: Vec<f64>,
    diffusivity: Vec<f64>,
    mobility: Vec<f64>,
    mobility_in_matrix: Vec<f64>,
    pub(super) targets: [Vec<f64>; 4],
    pub(super) remaining: Remaining,
    pub(super) surface: RenderSurface,
    is_triangle_there: Vec<bool>,
    conduction: Conduction,
    projection: Projection,
    /// In place of the projection, where that is asked for.
    global: Option<GlobalSolve>,
    trial: Vec<Vec3>,
    clearance: f64,
    /// Of the whole render mesh at rest [m²].
    pub(super) initial_area: f64,
}

impl BurningShell {
    /// A shell at rest.
    ///
    /// # Errors
    /// A number out of its range.
    pub fn new(mut setup: BurningSetup) -> Result<Self, BurningError> {
        Self::check(&setup)?;
        let shell = &setup.shell;
        let n = shell.particles.len();
        if setup.loss_factors.is_empty() {
            setup.loss_factors = vec![1.0; n];
        }
        let factor = |p: usize| setup.diffusivity_factors.get(p).copied().unwrap_or(1.0);
        let mut made = Self {
            state: BurningState {
                positions: shell.particles.clone(),
                velocities: vec![Vec3::zeros(); n],
                temperatures: vec![setup.temperature; n],
                mass_ratios: vec![1.0; n],
            },
            masses: shell.masses(setup.area_density),
            diffusivity: (0..n).map(|p| setup.diffusivity * factor(p)).collect(),
            mobility: vec![0.0; n],
            mobility_in_matrix: vec![0.0; n],
            targets: shell
                .springs
                .each_ref()
                .map(|springs| springs.initial_lengths.clone()),
            remaining: Remaining::all(shell),
            surface: RenderSurface::new(&shell.mesh),
            is_triangle_there: vec![true; 4 * shell.mesh.quads().len()],
            conduction: Conduction::new(shell),
            projection: Projection::new(&shell.springs, n),
            global: (setup.projection.method == ProjectionMethod::Global)
                .then(|| GlobalSolve::new(shell)),
            trial: vec![Vec3::zeros(); n],
            clearance: shell.half_diagonal(),
            initial_area: RenderSurface::new(&shell.mesh).area(shell, &shell.particles),
            setup,
        };
        made.shrink_and_cut();
        Ok(made)
    }

    /// Advances by `dt` [s] from `time` [s]; `surround` writes what acts at a time.
    ///
    /// # Errors
    /// A position that is not finite; the state is then not to be used.
    pub fn step(
        &mut self,
        time: f64,
        dt: f64,
        surround: &mut dyn FnMut(f64, &mut Surroundings),
        surroundings: &mut Surroundings,
    ) -> Result<BurningReport, BurningError> {
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(BurningError::Value {
                what: "dt",
                value: dt,
                expected: "larger than 0",
            });
        }
        let burning = &self.setup.burning;
        let fastest = burning.fastest(
            &self.state.temperatures,
            &self.setup.loss_factors,
            &self.state.mass_ratios,
        );
        let parts = (fastest * dt / burning.largest_change).ceil();
        let parts = (parts as usize).clamp(1, MAX_PARTS);
        let mut report = BurningReport {
            parts,
            ..BurningReport::default()
        };
        for part in 1..=parts {
            let end = time + dt * part as f64 / parts as f64;
            surround(end, surroundings);
            self.advance(dt / parts as f64, surroundings, &mut report)
                .map_err(|_| BurningError::NotPositiveDefinite { time: time + dt })?;
        }
        match self.state.first_not_finite() {
            None => Ok(report),
            Some(particle) => Err(BurningError::NotFinite {
                particle,
                time: time + dt,
            }),
        }
    }

    fn advance(
        &mut self,
        dt: f64,
        surroundings: &Surroundings,
        report: &mut BurningReport,
    ) -> Result<(), NotPositiveDefinite> {
        let mut clock = Instant::now();
        let mut lap = |part: usize| {
            let now = Instant::now();
            report.seconds[part] += (now - clock).as_secs_f64();
            clock = now;
        };
        self.warm(dt, surroundings);
        lap(0);
        let (setup, state) = (&self.setup, &mut self.state);
        (setup.burning).burn(
            dt,
            &setup.loss_factors,
            &mut state.temperatures,
            &mut state.mass_ratios,
        );
        self.shrink_and_cut();
        lap(1);
        let taken = self.move_particles(dt, 1.0 / report.parts as f64, surroundings)?;
        report.sweeps += taken.sweeps;
        report.gradient_iterations += taken.gradient_iterations;
        report.unmet += usize::from(!taken.converged);
        lap(2);
        Ok(())
    }

    fn warm(&mut self, dt: f64, surroundings: &Surroundings) {
        let (setup, state) = (&self.setup, &mut self.state);
        let (positions, temperatures) = (&state.positions, &mut state.temperatures);
        heat(&surroundings.sources, positions, dt, temperatures);
        cool(
            setup.ambient_temperature,
            setup.cooling_rate,
            dt,
            temperatures,
        );
        let springs = &self.remaining.springs;
        (self.conduction).conduct(positions, springs, &self.diffusivity, dt, temperatures);
    }

    /// Target lengths, the surface, springs and particles by the masses that are left.
    fn shrink_and_cut(&mut self) {
        let (burning, ratios) = (&self.setup.burning, &self.state.mass_ratios);
        for (targets, springs) in self.targets.iter_mut().zip(&self.setup.shell.springs) {
            burning.set_targets(&springs.ends, &springs.initial_lengths, ratios, targets);
        }
        // Corners and centres are numbered as corners and lattice particles are.
        self.surface.rebuild(|node| burning.level(ratios[node]));
        self.surface.mark_triangles(&mut self.is_triangle_there);
        self.remaining
            .update(&self.setup.shell, &self.is_triangle_there);
    }

    /// `share` is that of `dt` in the step: so much of a step's friction is taken.
    fn move_particles(
        &mut self,
        dt: f64,
        share: f64,
        surroundings: &Surroundings,
    ) -> Result<ProjectionReport, NotPositiveDefinite> {
        self.set_mobility(&surroundings.held);
        let state = &mut self.state;
        self.trial.copy_from_slice(&state.positions);
        let slowed = 1.0 / (1.0 + dt * self.setup.damping);
        for ((x, velocity), &mobility) in self
            .trial
            .iter_mut()
            .zip(&state.velocities)
            .zip(&self.mobility)
        {
            if mobility > 0.0 {
                *x += dt * slowed * (velocity + dt * surroundings.gravity);
            }
        }
        for &(particle, place) in &surroundings.held {
            self.trial[particle as usize] = place;
        }
        let colliders = surroundings.colliders.iter();
        let colliders = colliders.map(|collider| Collider {
            friction: 1.0 - (1.0 - collider.friction).powf(share),
            ..collider.with_clearance(self.clearance)
        });
        let mobility = &self.mobility;
        let in_matrix = match self.setup.projection.held_ends_count {
            true => &self.mobility_in_matrix,
            false => mobility,
        };
        let lengths = Lengths {
            targets: &self.targets,
            is_there: &self.remaining.springs,
        };
        let options = &self.setup.projection;
        let correct = |x: &mut [Vec3]| {
            (colliders.clone()).for_each(|collider| collider.push_out(x, mobility));
        };
        let taken = match &mut self.global {
            None => {
                let mobility = Mobility {
                    in_matrix,
                    in_move: mobility,
                };
                (self.projection).project(&mut self.trial, lengths, mobility, options, correct)
            }
            Some(global) => {
                let limits = GlobalLimits {
                    compliance: options.compliance,
                    dt,
                    iterations: options.sweeps,
                    tolerance: options.tolerance,
                };
                global.project(&mut self.trial, lengths, mobility, limits, correct)?
            }
        };
        for ((x, velocity), moved) in state
            .positions
            .iter_mut()
            .zip(&mut state.velocities)
            .zip(&self.trial)
        {
            *velocity = (moved - *x) / dt;
            *x = *moved;
        }
        let touching = TOUCHING * self.setup.shell.thickness;
        for collider in colliders.clone() {
            collider.slow(&state.positions, mobility, touching, &mut state.velocities);
        }
        Ok(taken)
    }

    /// Inverse masses [1/kg], 0 of particles that are held or gone.
    fn set_mobility(&mut self, held: &[(u32, Vec3)]) {
        let particles = self.masses.iter().zip(&self.state.mass_ratios);
        for ((mobility, (mass, ratio)), &is_there) in self
            .mobility
            .iter_mut()
            .zip(particles)
            .zip(&self.remaining.particles)
        {
            *mobility = if is_there { 1.0 / (mass * ratio) } else { 0.0 };
        }
        self.mobility_in_matrix.copy_from_slice(&self.mobility);
        for &(particle, _) in held {
            self.mobility[particle as usize] = 0.0;
        }
    }

    /// What the shell was made of.
    pub fn setup(&self) -> &BurningSetup {
        &self.setup
    }

    /// The state.
    pub fn state(&self) -> &BurningState {
        &self.state
    }

    /// The surface that is left.
    pub fn surface(&self) -> &RenderSurface {
        &self.surface
    }

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

impl BurningState {
    /// The first particle with a value that is not finite.
    fn first_not_finite(&self) -> Option<usize> {
        let is_finite = |v: &Vec3| v.iter().all(|value| value.is_finite());
        (0..self.positions.len()).find(|&p| {
            !(is_finite(&self.positions[p])
                && is_finite(&self.velocities[p])
                && self.temperatures[p].is_finite())
        })
    }
}

impl BurningShell {
    /// Checks the numbers of a setup.
    ///
    /// # Errors
    /// A number out of its range, by the name that scenes give it.
    pub fn check(setup: &BurningSetup) -> Result<(), BurningError> {
        positive("thickness", setup.shell.thickness)?;
        positive("area_density", setup.area_density)?;
        not_negative("temperature", setup.temperature)?;
        not_negative("ambient_temperature", setup.ambient_temperature)?;
        not_negative("cooling_rate", setup.cooling_rate)?;
        not_negative("diffusivity", setup.diffusivity)?;
        not_negative("damping", setup.damping)?;
        positive("compliance", setup.projection.compliance)?;
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
        setup
            .projection
            .weights
            .iter()
            .try_for_each(|&weight| share("weights", weight))
    }
}

#[cfg(test)]
mod tests;
