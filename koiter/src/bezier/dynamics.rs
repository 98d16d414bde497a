//! Motion in time by implicit Euler steps, each a minimisation.
//!
//! ```text
//! Σ potentials + Σ_i m_i |x_i − x̃_i|² / 2Δt² + J_i |log(R_i R̃_iᵀ)|² / 2Δt² + α (m_i |x_i − x_i⁰|² + …) / 2Δt
//! ```
//!
//! with x̃ = x⁰ + Δt v, R̃ = exp(Δt ω) R⁰ and the damping α [1/s]. A step begins at the pose before it and every iteration
//! lowers this sum, so a step that is broken off early is a stable one too: it only is not yet where it should be.

use super::change::Change;
use super::newton::Potential;
use super::pose::NODE_UNKNOWNS;
use super::{
    BezierError, BezierShell, NewtonLimits, NewtonOutcome, Pose, Solver, Supports, Tangent,
};
use crate::Vec3;
use crate::assembly::{HessianBuilder, NodeId, ordered_sum};

/// A quadratic pull of every node towards a pose: `w_i |x − x̃|²/2 + u_i |log(R R̃ᵀ)|²/2`.
struct Pull<'a> {
    towards: Pose,
    masses: &'a [f64],
    inertias: &'a [f64],
    factor: f64,
}

impl Pull<'_> {
    fn offset(&self, node: usize, pose: &Pose) -> (Vec3, Vec3) {
        let turn = pose.rotations[node] * self.towards.rotations[node].inverse();
        (
            pose.positions[node] - self.towards.positions[node],
            turn.scaled_axis(),
        )
    }
}

impl Potential for Pull<'_> {
    fn value(&self, pose: &Pose) -> Option<f64> {
        let sum = ordered_sum(pose.len(), |node| {
            let (x, turn) = self.offset(node, pose);
            self.masses[node] * x.norm_squared() + self.inertias[node] * turn.norm_squared()
        });
        Some(0.5 * self.factor * sum)
    }

    fn add_derivatives(
        &self,
        pose: &Pose,
        _tangent: Tangent,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        for node in 0..pose.len() {
            let (x, turn) = self.offset(node, pose);
            let weights = [self.masses[node], self.inertias[node]].map(|w| self.factor * w);
            for axis in 0..3 {
                gradient[NODE_UNKNOWNS * node + axis] += weights[0] * x[axis];
                // Of the rotation the derivative of the logarithm leaves its own vector as it is.
                gradient[NODE_UNKNOWNS * node + 3 + axis] += weights[1] * turn[axis];
            }
            let id = NodeId(node as u32);
            hessian.add(
                id,
                id,
                true,
                |r, c| if r == c { weights[r / 3] } else { 0.0 },
            );
        }
    }
}

/// A shell in motion.
pub struct Dynamics {
    /// The shell.
    pub shell: BezierShell,
    /// What is held where it is. Move the pose of held nodes to move them.
    pub supports: Supports,
    /// Where it is.
    pub pose: Pose,
    /// Velocities of the nodes, six numbers each [m/s, rad/s].
    pub velocities: Vec<f64>,
    /// Damping α by the mass [1/s].
    pub damping: f64,
    solver: Solver,
}

impl Dynamics {
    /// A shell at rest in its rest shape.
    pub fn new(shell: BezierShell, supports: Supports) -> Self {
        let pose = shell.rest_pose();
        Self::at(shell, supports, pose)
    }

    /// A shell at rest in a pose.
    pub fn at(shell: BezierShell, supports: Supports, pose: Pose) -> Self {
        Self {
            solver: Solver::new(shell.layout()),
            velocities: vec![0.0; NODE_UNKNOWNS * pose.len()],
            shell,
            supports,
            pose,
            damping: 0.0,
        }
    }

    /// One step of `dt` [s] under further potentials.
    ///
    /// # Errors
    /// As [`Solver::minimize`]; pose and velocities are then those before the step.
    pub fn step(
        &mut self,
        others: &mut [&mut dyn Potential],
        dt: f64,
        limits: &NewtonLimits,
    ) -> Result<NewtonOutcome, BezierError> {
        self.step_from(self.pose.clone(), others, dt, limits)
    }

    /// A step that begins to search at a pose in which what is held is already where it goes.
    ///
    /// # Errors
    /// As [`Solver::minimize`]; pose and velocities are then those before the step.
    pub fn step_from(
        &mut self,
        mut pose: Pose,
        others: &mut [&mut dyn Potential],
        dt: f64,
        limits: &NewtonLimits,
    ) -> Result<NewtonOutcome, BezierError> {
        let mut motion = self.velocities.clone();
        for (m, held) in motion.iter_mut().zip(self.supports.held()) {
            if *held {
                *m = 0.0;
            }
        }
        let (masses, inertias) = (
            self.shell.masses().to_vec(),
            self.shell.rotational_inertias().to_vec(),
        );
        let start = self.pose.clone();
        let pull = |towards: Pose, factor: f64| Pull {
            towards,
            masses: &masses,
            inertias: &inertias,
            factor,
        };
        let mut inertia = pull(start.moved(&motion, dt), 1.0 / (dt * dt));
        let mut damping = pull(start.clone(), self.damping / dt);
        let mut potentials: Vec<&mut dyn Potential> =
            vec![&mut self.shell, &mut inertia, &mut damping];
        potentials.extend(others.iter_mut().map(|p| &mut **p as &mut dyn Potential));
        let outcome = self
            .solver
            .minimize(&mut potentials, &self.supports, &mut pose, limits)?;
        self.velocities = start.motion_to(&pose);
        self.velocities.iter_mut().for_each(|v| *v /= dt);
        self.pose = pose;
        Ok(outcome)
    }

    /// Equilibrium from here: no inertia. Velocities become zero.
    ///
    /// # Errors
    /// As [`Solver::minimize`]; the pose is then the one before.
    pub fn settle(
        &mut self,
        others: &mut [&mut dyn Potential],
        limits: &NewtonLimits,
    ) -> Result<NewtonOutcome, BezierError> {
        self.settle_from(self.pose.clone(), others, limits)
    }

    /// Equilibrium that is searched from a pose in which what is held is already where it goes.
    ///
    /// # Errors
    /// As [`Solver::minimize`]; the pose is then the one before.
    pub fn settle_from(
        &mut self,
        mut pose: Pose,
        others: &mut [&mut dyn Potential],
        limits: &NewtonLimits,
    ) -> Result<NewtonOutcome, BezierError> {
        let mut potentials: Vec<&mut dyn Potential> = vec![&mut self.shell];
        potentials.extend(others.iter_mut().map(|p| &mut **p as &mut dyn Potential));
        let outcome = self
            .solver
            .minimize(&mut potentials, &self.supports, &mut pose, limits)?;
        self.pose = pose;
        self.velocities.fill(0.0);
        Ok(outcome)
    }

    /// What the solver keeps between steps ([`Solver::couplings`]).
    pub fn couplings(&self) -> Vec<[u32; 2]> {
        self.solver.couplings()
    }

    /// Takes up what a solver kept.
    pub fn restore_couplings(&mut self, couplings: &[[u32; 2]]) {
        self.solver.restore_couplings(couplings);
    }

    /// This motion on a shell that was cut or sewn. `pose` is that after sewing; without one it is that of the cut.
    pub fn changed(&self, change: &Change, pose: Option<Pose>) -> Self {
        let pose = pose.unwrap_or_else(|| change.pose(&self.pose));
        let supports = change.supports(&self.supports);
        let mut changed = Self::at(change.shell.clone(), supports, pose);
        changed.velocities = change.velocities(&self.velocities);
        changed.damping = self.damping;
        changed
    }

    /// Kinetic energy [J].
    pub fn kinetic_energy(&self) -> f64 {
        let inertias = self
            .shell
            .masses()
            .iter()
            .zip(self.shell.rotational_inertias());
        let squared = |part: &[f64]| part.iter().map(|v| v * v).sum::<f64>();
        0.5 * (self.velocities.chunks_exact(NODE_UNKNOWNS).zip(inertias))
            .map(|(v, (mass, inertia))| mass * squared(&v[..3]) + inertia * squared(&v[3..]))
            .sum::<f64>()
    }
}
