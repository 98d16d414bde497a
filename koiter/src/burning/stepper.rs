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
use super::error::BurningError;
use super::global_solve::{GlobalLimits, GlobalSolve};
use super::heat::{Conduction, cool, heat};
use super::mass_spring;
use super::network::Mobility;
use super::projection::{Lengths, Projection, ProjectionMethod, ProjectionReport};
use super::self_collision::SelfCollision;
use super::setup::{BurningSetup, Surroundings};
use super::state::BurningState;
use super::surface::RenderSurface;
use crate::Vec3;
use crate::solve::NotPositiveDefinite;

/// Most parts of a step; what would burn faster burns later.
const MAX_PARTS: usize = 50;
/// A particle this close to a body, as a share of the thickness, touches it.
const TOUCHING: f64 = 0.01;

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
    /// Corners whose motion was shortened, so that the surface does not cross itself, summed over the parts.
    pub held_back: usize,
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
        self.held_back += other.held_back;
        for (seconds, more) in self.seconds.iter_mut().zip(other.seconds) {
            *seconds += more;
        }
    }
}

/// A shell that burns.
pub struct BurningShell {
    pub(super) setup: BurningSetup,
    pub(super) state: BurningState,
    pub(super) masses: Vec<f64>,
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
    self_collision: Option<SelfCollision>,
    /// Longest stable step of springs by Hooke's law [s]; infinite for projections.
    longest_step: f64,
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
            self_collision: (setup.self_collision)
                .map(|options| SelfCollision::new(shell, options)),
            longest_step: mass_spring::longest_step(&setup),
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
        let stable = (dt / self.longest_step).ceil() as usize;
        let parts = (parts as usize).clamp(1, MAX_PARTS).max(stable);
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
        let mut lap = |report: &mut BurningReport, part: usize| {
            let now = Instant::now();
            report.seconds[part] += (now - clock).as_secs_f64();
            clock = now;
        };
        self.warm(dt, surroundings);
        lap(report, 0);
        let (setup, state) = (&self.setup, &mut self.state);
        (setup.burning).burn(
            dt,
            &setup.loss_factors,
            &mut state.temperatures,
            &mut state.mass_ratios,
        );
        self.shrink_and_cut();
        lap(report, 1);
        self.move_particles(dt, surroundings, report)?;
        lap(report, 2);
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
    pub(super) fn shrink_and_cut(&mut self) {
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

    fn move_particles(
        &mut self,
        dt: f64,
        surroundings: &Surroundings,
        report: &mut BurningReport,
    ) -> Result<(), NotPositiveDefinite> {
        // So much of a step's friction is taken.
        let share = 1.0 / report.parts as f64;
        self.set_mobility(&surroundings.held);
        self.fall(dt, surroundings);
        let colliders = surroundings.colliders.iter().map(|collider| Collider {
            friction: 1.0 - (1.0 - collider.friction).powf(share),
            ..collider.with_clearance(self.clearance)
        });
        let colliders: Vec<Collider> = colliders.collect();
        if let Some(collision) = &mut self.self_collision {
            let start = &self.state.positions;
            let (burning, ratios) = (&self.setup.burning, &self.state.mass_ratios);
            let shrinkage = |corner: usize| burning.length_factor(ratios[corner]);
            let is_there = &self.is_triangle_there;
            collision.begin(start, &self.trial, share, is_there, shrinkage);
        }
        let taken = self.bring_to_lengths(dt, &colliders)?;
        report.sweeps += taken.sweeps;
        report.gradient_iterations += taken.gradient_iterations;
        report.unmet += usize::from(!taken.converged);
        let (start, mobility) = (&self.state.positions, &self.mobility);
        if let Some(collision) = &mut self.self_collision {
            collision.rub(start, &mut self.trial, mobility, share);
            // What is rubbed goes along the other part, and perhaps into a body.
            (colliders.iter()).for_each(|collider| collider.push_out(&mut self.trial, mobility));
            report.held_back += collision.hold_back(start, &mut self.trial, mobility);
        }
        self.take_up_trial(dt, &colliders);
        Ok(())
    }

    /// Free motion, into `trial`.
    fn fall(&mut self, dt: f64, surroundings: &Surroundings) {
        let state = &self.state;
        self.trial.copy_from_slice(&state.positions);
        let slowed = self.slowed(dt);
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
    }

    /// What damping leaves of a velocity after `dt` [s].
    fn slowed(&self, dt: f64) -> f64 {
        1.0 / (1.0 + dt * self.setup.damping)
    }

    /// What springs and bodies make of `trial`.
    fn bring_to_lengths(
        &mut self,
        dt: f64,
        colliders: &[Collider],
    ) -> Result<ProjectionReport, NotPositiveDefinite> {
        let (mobility, options) = (&self.mobility, &self.setup.projection);
        let lengths = Lengths {
            targets: &self.targets,
            is_there: &self.remaining.springs,
        };
        let (collision, start) = (&self.self_collision, &self.state.positions);
        let correct = |x: &mut [Vec3]| {
            if let Some(collision) = collision {
                collision.push_apart(start, x, mobility);
            }
            (colliders.iter()).for_each(|collider| collider.push_out(x, mobility));
        };
        let slowed = self.slowed(dt);
        let trial = &mut self.trial;
        match (options.method, &mut self.global) {
            (ProjectionMethod::MassSpring, _) => {
                let shell = &self.setup.shell;
                let stiffness = dt * dt * slowed * options.stiffness;
                mass_spring::pull(shell, start, trial, lengths, mobility, stiffness);
                correct(trial);
                Ok(ProjectionReport {
                    converged: true,
                    ..ProjectionReport::default()
                })
            }
            (_, Some(global)) => {
                let limits = GlobalLimits {
                    compliance: options.compliance,
                    dt,
                    iterations: options.sweeps,
                    tolerance: options.tolerance,
                };
                global.project(trial, lengths, mobility, limits, correct)
            }
            _ => {
                let in_matrix = match options.held_ends_count {
                    true => &self.mobility_in_matrix,
                    false => mobility,
                };
                let mobility = Mobility {
                    in_matrix,
                    in_move: mobility,
                };
                Ok((self.projection).project(trial, lengths, mobility, options, correct))
            }
        }
    }

    /// Makes `trial` the state; bodies take from velocities.
    fn take_up_trial(&mut self, dt: f64, colliders: &[Collider]) {
        let state = &mut self.state;
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
        for collider in colliders {
            let velocities = &mut state.velocities;
            collider.slow(&state.positions, &self.mobility, touching, velocities);
        }
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
}

#[cfg(test)]
mod tests;
