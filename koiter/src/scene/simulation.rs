//! A running simulation.

use super::arc_length;
use super::assemble::{Assembly, BuildError, assemble, write_points};
use super::bezier::BezierBody;
use super::burning::Burning;
use super::display::{PartTopology, tessellate};
use super::heated::Heated;
use super::holds::Holds;
use super::loads::set_factors;
use super::model::{IntegratorKind, Model, Phase};
use super::phases::phase_of_step;
use super::processes::Processes;
use super::symmetry::held_by;
use crate::Vec3;
use crate::assembly::{Assembled, Dof, DofLayout, Energy};
use crate::energy::bending::ExtraUnknowns;
use crate::integrate::{
    Bdf2, ImplicitEuler, Integrator, LinearStatic, LoadPattern, Memory, Newmark, Prescribed,
    QuasiStatic, State, StepError, StepReport, System,
};
use crate::mesh::VertexId;

/// A model with its state, advanced step by step.
pub struct Simulation {
    pub(super) model: Model,
    pub(super) system: System,
    pub(super) state: State,
    pub(super) phases: Vec<Phase>,
    /// One a phase.
    integrators: Vec<Box<dyn Integrator>>,
    /// The phase of the last step, or of the step under way.
    phase: usize,
    obstacles: Vec<(Dof, Vec<Vec3>)>,
    pub(super) holds: Holds,
    pub(super) processes: Processes,
    parts: Vec<PartTopology>,
    /// The share of a step that is tried first.
    pub(super) share: f64,
    /// What the load factor of arc length multiplies.
    pub(super) load_pattern: Option<LoadPattern>,
    pub(super) burning: Burning,
    pub(super) heated: Heated,
    pub(super) bezier: Option<BezierBody>,
}

impl Simulation {
    /// Builds energies and masses, solves for rest and start directors, and checks the start.
    ///
    /// # Errors
    /// A rest state that cannot be used; a start that touches or intersects.
    pub fn new(model: Model) -> Result<Self, BuildError> {
        let Assembly {
            mut system,
            q,
            velocities,
            obstacles,
            clamps,
        } = assemble(&model)?;
        let heated =
            Heated::new(&model, &system).map_err(|(shell, error)| BuildError::Burning {
                shell: model.shells[shell].name.clone(),
                error,
            })?;
        let processes = Processes::new(&model, &mut system, &q)
            .map_err(|(process, error)| BuildError::Process { process, error })?;
        let phases = model.all_phases();
        let integrators = (phases.iter())
            .map(|phase| integrator(&model, phase.integrator))
            .collect::<Result<_, _>>()?;
        let load_pattern = match model.follows_path() {
            true => Some(arc_length::load_pattern(&model)?),
            false => None,
        };
        let burning =
            Burning::new(&model).map_err(|(double_layer, error)| BuildError::DoubleLayer {
                double_layer,
                error,
            })?;
        let bezier = BezierBody::new(&model)?;
        let parts = tessellate(&model, bezier.as_ref());
        let holds = Holds::new(&model, clamps);
        let state = State {
            velocities,
            ..State::at_rest(q, 0.0, 0)
        };
        Ok(Self {
            model,
            system,
            state,
            phases,
            integrators,
            phase: 0,
            obstacles,
            holds,
            processes,
            parts,
            share: 1.0,
            load_pattern,
            burning,
            heated,
            bezier,
        })
    }

    /// Advances by one step of `dt` [s] (statics: to the equilibrium at the schedules' values after `dt`).
    ///
    /// # Errors
    /// See [`StepError`]; the state is then that before the step.
    pub fn step(&mut self, dt: f64) -> Result<StepReport, StepError> {
        // Inside the pool, so that its many short loops start without waking other threads.
        #[cfg(feature = "parallel")]
        return rayon::scope(|_| self.step_in_pool(dt));
        #[cfg(not(feature = "parallel"))]
        self.step_in_pool(dt)
    }

    fn step_in_pool(&mut self, dt: f64) -> Result<StepReport, StepError> {
        if !self.burning.is_empty() {
            return self.step_double_layers(dt);
        }
        if self.bezier.is_some() {
            return self.step_bezier(dt);
        }
        self.enter_phase(self.state.step + 1);
        let mut report = self.step_elastic(dt)?;
        report.measures.extend(self.heated_measures());
        Ok(report)
    }

    fn step_elastic(&mut self, dt: f64) -> Result<StepReport, StepError> {
        match self.phase().integrator {
            IntegratorKind::LinearStatic | IntegratorKind::ArcLength => {
                let report = self.step_to(self.state.time + dt, dt)?;
                Ok(StepReport { parts: 1, ..report })
            }
            IntegratorKind::ImplicitEuler
            | IntegratorKind::Bdf2
            | IntegratorKind::Newmark
            | IntegratorKind::QuasiStatic => self.step_in_parts(dt),
        }
    }

    /// The phase that a step with this number, from 1, belongs to is that of the coming or last step.
    pub(super) fn enter_phase(&mut self, step: usize) {
        let phase = phase_of_step(&self.phases, step);
        if phase != self.phase {
            // Steps of another size or kind have not failed yet.
            (self.phase, self.share) = (phase, 1.0);
        }
        self.system.is_dynamic = self.phase().integrator.is_dynamic();
    }

    pub(super) fn phase(&self) -> &Phase {
        &self.phases[self.phase]
    }

    /// One step of the integrator, to the time `time` [s], `dt` [s] from now.
    pub(super) fn step_to(&mut self, time: f64, dt: f64) -> Result<StepReport, StepError> {
        self.begin_step(dt)?;
        let parts = &self.system.space.shells;
        let window = [self.state.time, time];
        let phase = &self.phases[self.phase];
        (self.holds).switch(&self.model, phase, parts, &self.state.q, window);
        self.apply_schedules(time);
        let (rests, burnt) = (self.processes.rests(), self.heated.states());
        let clock = std::time::Instant::now();
        let heated = self.heated.advance(
            &self.model,
            &mut self.system,
            &mut self.state,
            &mut self.processes,
            window,
        );
        if let Err((shell, error)) = heated {
            self.heated.put_back(&mut self.system, &burnt);
            self.processes.restore(&mut self.system, &rests);
            return Err(StepError::NotFinite {
                step: self.state.step + 1,
                energy: "heat".to_owned(),
                element: format!("{}: {error}", self.model.shells[shell].name),
            });
        }
        let seconds = clock.elapsed().as_secs_f64();
        (self.processes).advance(&mut self.system, &self.state.q, window, dt);
        let prescribed = self.prescribed_at(time);
        let integrator = &mut self.integrators[self.phase];
        let mut result = integrator.step(&mut self.system, &mut self.state, &prescribed, dt);
        if let Ok(report) = &mut result
            && !self.heated.is_empty()
        {
            report.seconds.push(("heat", seconds));
        }
        if result.is_err() {
            self.heated.put_back(&mut self.system, &burnt);
            self.processes.restore(&mut self.system, &rests);
            self.apply_schedules(self.state.time);
        }
        result
    }

    /// Lets the integrator look at the start of a step before schedules move on.
    fn begin_step(&mut self, dt: f64) -> Result<(), StepError> {
        let knows = matches!(self.state.memory, Memory::Accelerated { .. });
        if knows || self.phase().integrator != IntegratorKind::Newmark {
            return Ok(());
        }
        self.apply_schedules(self.state.time);
        let is_fixed = self.prescribed_at(self.state.time).is_fixed;
        let integrator = &mut self.integrators[self.phase];
        integrator.begin(&mut self.system, &mut self.state, &is_fixed, dt)
    }

    /// Gravity, loads and clamps as they are at a time [s].
    pub(super) fn apply_schedules(&mut self, time: f64) {
        if let Some(pattern) = &self.load_pattern {
            pattern.apply(self.load_factor().unwrap_or(0.0), &mut self.system);
            return;
        }
        let phase = &self.phases[self.phase];
        let scale = self.model.gravity_scale.as_ref();
        self.system.gravity.acceleration =
            phase.gravity * scale.map_or(1.0, |scale| scale.at(time));
        set_factors(&self.model, phase, time, &mut self.system.loads);
        self.system.set_time(time);
        self.holds
            .move_clamps(&self.model, time, self.system.clamps.local_mut());
    }

    pub(super) fn prescribed_at(&self, time: f64) -> Prescribed {
        let shells = &self.system.space.shells;
        let mut prescribed = Prescribed {
            is_fixed: vec![false; self.system.layout.num_solved_dofs()],
            target: self.state.q.clone(),
        };
        self.holds
            .prescribe(&self.model, shells, time, &mut prescribed);
        self.heated.hold_the_rest(&self.system, &mut prescribed);
        let Prescribed { is_fixed, target } = &mut prescribed;
        for (dof, value) in held_by(&self.model, shells) {
            is_fixed[dof] = true;
            target[dof] = value;
        }
        for (obstacle, (first, points)) in self.model.obstacles.iter().zip(&self.obstacles) {
            write_points(target, *first, &obstacle.points_at(points, time));
        }
        prescribed
    }

    /// Adds an energy, such as one of the caller's own ([`crate::assembly::ElementFunction`]), to those that are minimised and
    /// listed by name. Its unknowns are those of [`Self::layout`]; checkpoints do not know of it.
    ///
    /// # Panics
    /// If steps have been taken already: the pattern of the matrix is that of the energies at the first.
    pub fn add_energy(&mut self, energy: Box<dyn Energy>) {
        assert!(
            self.system.workspace.matrix().is_none(),
            "energies are added before the first step"
        );
        self.system.elastic.push(energy);
        self.apply_schedules(self.state.time);
    }

    /// The unknowns and their nodes.
    pub fn layout(&self) -> &DofLayout {
        &self.system.layout
    }

    /// The first of the three unknowns of a vertex of a shell.
    pub fn vertex(&self, shell: usize, vertex: VertexId) -> Dof {
        Dof(self.system.space.shells[shell].first_vertex.0 + 3 * vertex.0)
    }

    /// Simulated time [s].
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// The factor on scheduled loads, where they are followed by arc length.
    pub fn load_factor(&self) -> Option<f64> {
        self.load_pattern.as_ref()?;
        Some((self.state.path.as_ref()).map_or(0.0, |point| point.load_factor))
    }

    /// Whether a path of loads has come to its end: further steps would leave it.
    pub fn has_ended(&self) -> bool {
        let last = self.model.solver.last_load_factor;
        self.load_factor().is_some_and(|factor| factor >= last)
    }

    /// Steps taken.
    pub fn step_count(&self) -> usize {
        self.state.step
    }

    /// What is simulated.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Masses [kg] and rotational inertias [kg·m²] of the solved unknowns.
    pub fn masses(&self) -> &[f64] {
        &self.system.masses
    }

    /// Vertex positions of a shell [m].
    pub fn shell_positions(&self, shell: usize) -> Vec<Vec3> {
        if let Some(body) = &self.bezier {
            return body.positions(shell);
        }
        self.shell_points(shell, &self.state.q)
    }

    /// Vertex velocities of a shell [m/s].
    pub fn shell_velocities(&self, shell: usize) -> Vec<Vec3> {
        if let Some(body) = &self.bezier {
            return body.velocities(shell);
        }
        self.shell_points(shell, &self.state.velocities)
    }

    pub(super) fn shell_points(&self, shell: usize, values: &[f64]) -> Vec<Vec3> {
        let part = &self.system.space.shells[shell];
        (0..part.mesh.num_vertices())
            .map(|v| part.position(v, values))
            .collect()
    }

    /// The unknowns of a shell beside the positions of its vertices: see [`ExtraUnknowns`].
    pub fn extra_unknowns(&self, shell: usize) -> (ExtraUnknowns, &[f64]) {
        let part = &self.system.space.shells[shell];
        (part.extra, &self.state.q[part.extra_dofs()])
    }

    /// Total force that a constraint exerts on its vertices [N], friction of contact left out.
    ///
    /// The force that balances elasticity, damping, gravity, loads, contact and inertia of the last step at the held coordinates; where
    /// two constraints hold the same coordinate both are told its force.
    pub fn reaction(&self, constraint: usize) -> Vec3 {
        if let Some(body) = &self.bezier {
            return body.reaction(&self.model, constraint, self.time());
        }
        let mut gradient = vec![0.0; self.system.layout.num_dofs()];
        for energy in &self.system.elastic {
            energy.add_gradient(&self.state.q, &mut gradient);
        }
        (self.system.damping).add_gradient(&self.state.q, &mut gradient);
        self.system
            .gravity
            .add_gradient(&self.state.q, &mut gradient);
        (self.system.loads).add_gradient(&self.state.q, &mut gradient);
        (self.system.symmetry).add_gradient(&self.state.q, &mut gradient);
        if let Some(contact) = &self.system.contact {
            contact.add_gradient(&self.state.q, &mut gradient);
        }
        let index = constraint;
        let constraint = &self.model.constraints[index];
        let mut held = vec![false; gradient.len()];
        let mut force = Vec3::zeros();
        if !self.holds.is_acting(index) {
            return force;
        }
        let part = &self.system.space.shells[constraint.shell];
        let first = part.first_vertex.0 as usize;
        for vertex in &constraint.vertices {
            for axis in (0..3).filter(|&axis| constraint.axes[axis]) {
                let dof = first + 3 * vertex.0 as usize + axis;
                let inertia = self.system.masses[dof] * self.state.accelerations[dof];
                force[axis] += gradient[dof] + inertia;
                held[dof] = true;
            }
        }
        // A clamp turns the surface by pushing free vertices too.
        let clamp = self
            .holds
            .clamps
            .of_constraint(index, self.system.clamps.local());
        let mut pushes = vec![0.0; gradient.len()];
        Assembled::new(clamp, &self.system.layout).add_gradient(&self.state.q, &mut pushes);
        for dof in part.vertex_dofs().filter(|&dof| !held[dof]) {
            force[(dof - first) % 3] -= pushes[dof];
        }
        force
    }

    /// Energies by name [J].
    pub fn energies(&self) -> Vec<(String, f64)> {
        if let Some(body) = &self.bezier {
            return body.energies(&self.model, self.time());
        }
        self.system.energies(&self.state)
    }

    /// The surfaces to show: shells, then obstacles.
    pub fn parts(&self) -> &[PartTopology] {
        &self.parts
    }
}

/// An integrator with the options of a model.
fn integrator(model: &Model, kind: IntegratorKind) -> Result<Box<dyn Integrator>, BuildError> {
    let solver = &model.solver;
    let velocity_tolerance = solver.velocity_tolerance;
    Ok(match kind {
        IntegratorKind::ImplicitEuler => Box::new(ImplicitEuler { velocity_tolerance }),
        IntegratorKind::Bdf2 => Box::new(Bdf2 { velocity_tolerance }),
        IntegratorKind::Newmark => Box::new(Newmark {
            beta: solver.newmark.beta,
            gamma: solver.newmark.gamma,
            energy_growth: solver.newmark.energy_growth,
            velocity_tolerance,
        }),
        IntegratorKind::QuasiStatic => Box::new(QuasiStatic {
            displacement_tolerance: solver.displacement_tolerance,
        }),
        IntegratorKind::LinearStatic => Box::new(LinearStatic),
        IntegratorKind::ArcLength => Box::new(arc_length::integrator(model)?),
    })
}
