//! Everything a step needs: unknowns, energies, masses, contact, and the workspace of the solver.

use super::damping::Damping;
use super::diagnostics::{Diagnostics, LargestForce};
use super::offset_surface::OffsetSurfaces;
use super::report::{StepError, StepReport};
use super::shell_part::ShellPart;
use super::state::State;
use crate::assembly::{Assembled, DofLayout, Energy};
use crate::contact::{Contact, Friction};
use crate::energy::bending::{DirectorClamp, SymmetryEdges};
use crate::energy::loads::Loads;
use crate::energy::{Gravity, Inertia};
use crate::solve::{
    HessianChoice, LinearWorkspace, NewtonOptions, NewtonReport, Problem, SolveError, minimize,
    minimize_stably,
};

/// What is prescribed at the end of a step.
#[derive(Clone, Debug)]
pub struct Prescribed {
    /// Which of the solved unknowns are held.
    pub is_fixed: Vec<bool>,
    /// Their values, and those of everything that is not solved for; other entries are ignored.
    pub target: Vec<f64>,
}

/// The parts of a simulation that do not change with its state.
pub struct System {
    /// Grouping of the unknowns.
    pub layout: DofLayout,
    /// Membrane and bending of every shell.
    pub elastic: Vec<Box<dyn Energy>>,
    /// What damps motion.
    pub damping: Damping,
    /// Clamped edges.
    pub clamps: Assembled<DirectorClamp, 7, 3>,
    /// Edges on planes of symmetry.
    pub symmetry: Assembled<SymmetryEdges, 10, 4>,
    /// Gravity.
    pub gravity: Gravity,
    /// What pushes and turns from outside.
    pub loads: Loads,
    /// Lumped masses [kg] and rotational inertias [kg·m²] of the solved unknowns.
    pub masses: Vec<f64>,
    /// Whether there is motion: statics has no kinetic energy to report.
    pub is_dynamic: bool,
    /// Contact, unless it is off.
    pub contact: Option<Contact>,
    /// Speed below which friction is smoothed [m/s].
    pub friction_speed: f64,
    /// Solves of a step at most, each with the normal forces of the last, until they settle.
    pub friction_iterations: usize,
    /// Measures steps.
    pub space: OffsetSurfaces,
    /// Pattern, matrix and factor.
    pub workspace: LinearWorkspace,
    /// Iteration limit of Newton's method.
    pub max_iterations: usize,
}

/// What a minimisation tells.
pub(super) struct Solved {
    pub(super) newton: NewtonReport,
    /// The potential of friction at the end [J]: what the step's sliding takes. `None` without contact.
    friction: Option<f64>,
    /// The elastic energies at the end, where they came with the forces; else empty.
    elastic: Vec<f64>,
}

impl Solved {
    /// Of a step without a minimisation, with the elastic energies at its end and where its time went.
    pub(super) fn explicit(elastic: Vec<f64>, seconds: Vec<(&'static str, f64)>) -> Self {
        Self {
            newton: NewtonReport {
                converged: true,
                seconds,
                ..Default::default()
            },
            friction: None,
            elastic,
        }
    }
}

impl System {
    /// Minimises the sum of energies from `q`, with friction against the motion since `start`, and fills the report's
    /// common part.
    pub(super) fn solve(
        &mut self,
        q: &mut [f64],
        inertia: Option<&mut Inertia>,
        sliding: (&[f64], f64),
        prescribed: &Prescribed,
        tolerance: f64,
    ) -> Result<Solved, SolveError> {
        let (start, sliding_dt) = sliding;
        let mut friction = Friction {
            contacts: Vec::new(),
            start: start.to_vec(),
            smoothing: self.friction_speed * sliding_dt,
            layout: self.layout.clone(),
        };
        if let Some(contact) = &mut self.contact {
            contact.begin_step(q);
            contact.lag(q, &mut friction);
        }
        let options = NewtonOptions {
            tolerance,
            max_iterations: self.max_iterations,
            hessian: HessianChoice::Projected,
        };
        let mut inertia = inertia;
        let mut newton = {
            let inertia = inertia.as_deref_mut();
            self.minimize(q, inertia, &mut friction, prescribed, &options)?
        };
        for _ in 1..self.friction_iterations {
            let Some(contact) = self.contact.as_mut().filter(|_| newton.converged) else {
                break;
            };
            contact.refresh(q);
            contact.lag(q, &mut friction);
            let left = NewtonOptions {
                max_iterations: options.max_iterations.saturating_sub(newton.iterations),
                ..options.clone()
            };
            if left.max_iterations == 0 {
                break;
            }
            let inertia = inertia.as_deref_mut();
            let next = self.minimize(q, inertia, &mut friction, prescribed, &left)?;
            // The new forces moved nothing by more than the tolerance: they are those that were used.
            let is_settled = next.converged && next.iterations == 1;
            newton.go_on(next);
            if is_settled {
                break;
            }
        }
        let friction = self.contact.is_some().then(|| friction.value(q));
        Ok(Solved {
            newton,
            friction,
            elastic: Vec::new(),
        })
    }

    /// Minimises the sum of energies with friction as it was lagged.
    fn minimize(
        &mut self,
        q: &mut [f64],
        inertia: Option<&mut Inertia>,
        friction: &mut Friction,
        prescribed: &Prescribed,
        options: &NewtonOptions,
    ) -> Result<NewtonReport, SolveError> {
        if inertia.is_none() {
            self.damping.rest();
        }
        let mut energies: Vec<&mut dyn Energy> = Vec::new();
        for energy in &mut self.elastic {
            energies.push(energy.as_mut());
        }
        energies.extend(self.damping.energies());
        energies.push(&mut self.clamps);
        energies.push(&mut self.symmetry);
        energies.push(&mut self.gravity);
        energies.push(&mut self.loads);
        // Inertia holds a body on a saddle for the moment that a step takes; at rest it would not stay there.
        let minimize = if inertia.is_some() {
            minimize
        } else {
            minimize_stably
        };
        if let Some(inertia) = inertia {
            energies.push(inertia);
        }
        if let Some(contact) = &mut self.contact {
            energies.push(contact);
            energies.push(friction);
        }
        let mut problem = Problem {
            energies,
            layout: &self.layout,
            space: &self.space,
            is_fixed: &prescribed.is_fixed,
            target: &prescribed.target,
        };
        minimize(&mut problem, options, &mut self.workspace, q)
    }

    /// Energies by name at a state; the kinetic energy only where there is motion, that of clamps where there are some.
    pub fn energies(&self, state: &State) -> Vec<(String, f64)> {
        let elastic = self.elastic.iter().map(|energy| energy.value(&state.q));
        self.energies_with(state, elastic.collect())
    }

    /// [`Self::energies`] where those of `elastic` are known.
    fn energies_with(&self, state: &State, elastic: Vec<f64>) -> Vec<(String, f64)> {
        let mut energies: Vec<(String, f64)> = Vec::new();
        let mut add = |name: &str, value: f64| match energies.iter_mut().find(|(n, _)| n == name) {
            Some((_, total)) => *total += value,
            None => energies.push((name.into(), value)),
        };
        for (energy, value) in self.elastic.iter().zip(elastic) {
            add(energy.name(), value);
        }
        if !self.clamps.local().edges.is_empty() {
            add(self.clamps.name(), self.clamps.value(&state.q));
        }
        if !self.symmetry.local().edges.is_empty() {
            add(self.symmetry.name(), self.symmetry.value(&state.q));
        }
        add("gravity", self.gravity.value(&state.q));
        if !self.loads.loads.is_empty() {
            add(self.loads.name(), self.loads.value(&state.q));
        }
        if self.is_dynamic {
            add("kinetic", self.kinetic(state));
        }
        if let Some(contact) = &self.contact {
            add("contact", contact.value(&state.q));
        }
        energies
    }

    pub(super) fn kinetic(&self, state: &State) -> f64 {
        let moving = self.masses.iter().zip(&state.velocities);
        moving.map(|(m, v)| 0.5 * m * v * v).sum()
    }

    /// Φ of all energies, and what holds each unknown in its motion: ∇Φ + M a.
    pub(super) fn potential_and_reactions(
        &mut self,
        state: &State,
    ) -> Result<(f64, Vec<f64>), SolveError> {
        let mut reactions = self.gradient_of_energies(&state.q)?;
        let moving = self.masses.iter().zip(&state.accelerations);
        for (reaction, (mass, acceleration)) in reactions.iter_mut().zip(moving) {
            *reaction += mass * acceleration;
        }
        let energies = self.energies(state);
        let potential = energies.iter().filter(|(name, _)| *name != "kinetic");
        Ok((potential.map(|(_, value)| value).sum(), reactions))
    }

    /// ∇Φ of all energies at `q` and what damping adds, what the forces add up to with the sign changed.
    pub(super) fn total_gradient(&mut self, q: &[f64]) -> Result<Vec<f64>, SolveError> {
        Ok(self.total_gradient_and_elastic(q)?.0)
    }

    /// [`Self::total_gradient`] with the elastic energies.
    pub(super) fn total_gradient_and_elastic(
        &mut self,
        q: &[f64],
    ) -> Result<(Vec<f64>, Vec<f64>), SolveError> {
        let (mut gradient, elastic) = self.gradient_and_elastic(q)?;
        self.damping.add_gradient(q, &mut gradient);
        Ok((gradient, elastic))
    }

    /// ∇Φ of all energies at `q`; contact is brought up to date.
    fn gradient_of_energies(&mut self, q: &[f64]) -> Result<Vec<f64>, SolveError> {
        Ok(self.gradient_and_elastic(q)?.0)
    }

    fn gradient_and_elastic(&mut self, q: &[f64]) -> Result<(Vec<f64>, Vec<f64>), SolveError> {
        if let Some(contact) = &mut self.contact {
            contact.prepare(q);
            contact.refresh(q);
        }
        let mut energies: Vec<&dyn Energy> = self.elastic.iter().map(AsRef::as_ref).collect();
        energies.extend([&self.clamps as &dyn Energy, &self.symmetry]);
        energies.extend([&self.gravity as &dyn Energy, &self.loads]);
        energies.extend(self.contact.iter().map(|contact| contact as &dyn Energy));
        let mut gradient = vec![0.0; q.len()];
        let mut elastic = Vec::with_capacity(self.elastic.len());
        for (index, energy) in energies.iter().enumerate() {
            if index < self.elastic.len() {
                elastic.push(energy.add_value_and_gradient(q, &mut gradient));
            } else {
                energy.add_gradient(q, &mut gradient);
            }
            let is_defined = energy.is_admissible(q);
            if !is_defined || gradient.iter().any(|g| !g.is_finite()) {
                let worst = energy.worst_element(q);
                return Err(SolveError::NotFinite {
                    energy: energy.name().into(),
                    element: worst.map_or("an unknown place".into(), |w| w.description),
                });
            }
        }
        Ok((gradient, elastic))
    }

    /// Checks the new state, adopts it, and completes the report.
    pub(super) fn finish(
        &mut self,
        state: &mut State,
        next: State,
        solved: Solved,
        mut report: StepReport,
    ) -> Result<StepReport, StepError> {
        let Solved {
            newton,
            friction,
            elastic,
        } = solved;
        let is_explicit = !elastic.is_empty();
        let clock = std::time::Instant::now();
        let mut seconds = newton.seconds.clone();
        let mut diagnostics = Diagnostics::of_newton(&newton);
        if let Some(contact) = &mut self.contact {
            contact.begin_step(&next.q);
            let touching = contact.touching(&next.q);
            if !touching.is_empty() {
                let worst: Vec<&str> = touching
                    .iter()
                    .take(3)
                    .map(|t| t.description.as_str())
                    .collect();
                return Err(StepError::Intersection {
                    step: next.step,
                    details: worst.join("; "),
                });
            }
            let statistics = contact.statistics();
            (report.contacts, report.min_gap, report.kappa) =
                (statistics.contacts, statistics.min_gap, statistics.kappa);
            diagnostics.closest = statistics.closest;
            diagnostics.contacts_by_bodies = statistics.by_bodies;
        } else {
            report.min_gap = f64::INFINITY;
        }
        seconds.push(("audit", clock.elapsed().as_secs_f64()));
        let clock = std::time::Instant::now();
        // They say what a search for a minimum has to overcome; an explicit step is shorter than their evaluation.
        if !is_explicit {
            diagnostics.largest_forces = self.largest_forces(&next.q);
        }
        seconds.push(("diagnostics", clock.elapsed().as_secs_f64()));
        self.loads.rebase(&next.q);
        report.step = next.step;
        report.time = next.time;
        report.newton_iterations = newton.iterations;
        report.line_search_steps = newton.line_search_steps;
        report.converged = newton.converged;
        report.seconds = seconds;
        report.energies = match is_explicit {
            true => self.energies_with(&next, elastic),
            false => self.energies(&next),
        };
        report
            .energies
            .extend(friction.map(|taken| ("friction".into(), taken)));
        if self.is_dynamic {
            let taken = self.damping.taken(&self.layout, &state.q, &next.q);
            report.taken = taken.iter().map(|(name, _)| name.clone()).collect();
            report.energies.extend(taken);
        }
        self.follow(&next.q);
        if !newton.converged {
            report.diagnosis = Some(diagnose(&newton, &diagnostics));
        }
        report.diagnostics = diagnostics;
        *state = next;
        Ok(report)
    }

    /// Energies that depend on time are those of this time [s].
    pub(crate) fn set_time(&mut self, time: f64) {
        for energy in &mut self.elastic {
            energy.set_time(time);
        }
        self.damping.set_time(time);
    }

    /// Angles of hinges go on from those at `q`, which may be beyond half a turn.
    pub(crate) fn follow(&mut self, q: &[f64]) {
        for shell in &self.space.shells {
            let energy = shell.bending.map(|index| &mut self.elastic[index]);
            let measures = energy.and_then(|energy| energy.rest_measures_mut());
            if let Some(measures) = measures.filter(|measures| measures.has_branches()) {
                let now = measures.measure(q);
                measures.follow(&now);
            }
        }
        self.damping.follow(q);
    }

    /// The angles of hinges at `q` as they are followed, of every energy that follows some.
    pub(crate) fn branches(&self, q: &[f64]) -> Vec<Vec<f64>> {
        let elastic = self.elastic.iter().map(AsRef::as_ref);
        let all = elastic.chain(
            self.damping
                .dampers
                .iter()
                .map(|damper| damper.energy.as_ref()),
        );
        let measures = all.filter_map(|energy| energy.rest_measures());
        measures
            .filter(|measures| measures.has_branches())
            .map(|measures| measures.measure(q))
            .collect()
    }

    /// Angles go on from these.
    pub(crate) fn restore_branches(&mut self, angles: &[Vec<f64>]) {
        let dampers = self.damping.dampers.iter_mut();
        let elastic = self.elastic.iter_mut();
        let all = elastic.chain(dampers.map(|damper| &mut damper.energy));
        let measures = all.filter_map(|energy| energy.rest_measures_mut());
        let following = measures.filter(|measures| measures.has_branches());
        for (measures, angles) in following.zip(angles) {
            measures.follow(angles);
        }
    }

    /// The element of each energy that pulls most; of energies of one name the strongest.
    fn largest_forces(&self, q: &[f64]) -> Vec<LargestForce> {
        let elastic = self.elastic.iter().map(|energy| energy.as_ref());
        let contact = self.contact.iter().map(|contact| contact as &dyn Energy);
        let mut found: Vec<LargestForce> = Vec::new();
        for energy in elastic.chain(contact) {
            let Some(worst) = energy.worst_element(q) else {
                continue;
            };
            let part = worst.unknown.and_then(|dof| self.shell_of(dof.0 as usize));
            let largest = LargestForce {
                energy: energy.name().into(),
                force: worst.gradient_norm,
                place: match part {
                    Some(name) => format!("{} of '{name}'", worst.description),
                    None => worst.description,
                },
            };
            match found
                .iter_mut()
                .find(|known| known.energy == largest.energy)
            {
                Some(known) if known.force >= largest.force => {}
                Some(known) => *known = largest,
                None => found.push(largest),
            }
        }
        found
    }

    /// Name of the shell that an unknown belongs to.
    fn shell_of(&self, dof: usize) -> Option<&str> {
        let mut shells = self.space.shells.iter();
        let owns = |shell: &&ShellPart| {
            shell.vertex_dofs().contains(&dof) || shell.extra_dofs().contains(&dof)
        };
        shells.find(owns).map(|shell| shell.name.as_str())
    }
}

/// Why Newton's method did not converge, and what to try.
fn diagnose(newton: &NewtonReport, diagnostics: &Diagnostics) -> String {
    let mut text = format!(
        "Newton's method stopped after {} iterations with a last step of {:.2e} m",
        newton.iterations, newton.last_step
    );
    if !diagnostics.residual_at.is_empty() {
        text += &format!(", largest at {}", diagnostics.residual_at);
    }
    if newton.remaining > 0.0 {
        text += &format!(
            "; prescribed motions are short of their targets by {:.2e} m",
            newton.remaining
        );
    }
    text += &format!("; {}", diagnostics.reason(newton.iterations));
    for largest in &diagnostics.largest_forces {
        let LargestForce {
            energy,
            force,
            place,
        } = largest;
        text += &format!("; largest force of '{energy}': {force:.2e} N at {place}");
    }
    format!(
        "{text}. {}; or more iterations (solver.max_iterations)",
        diagnostics.advice()
    )
}

impl From<(usize, SolveError)> for StepError {
    fn from((step, error): (usize, SolveError)) -> Self {
        match error {
            SolveError::NotFinite { energy, element } => Self::NotFinite {
                step,
                energy,
                element,
            },
            other => Self::LinearSolve {
                step,
                reason: other.to_string(),
            },
        }
    }
}
