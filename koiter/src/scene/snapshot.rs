//! What a simulation owes to its past, so that it can be left and taken up again to the same bits.

use super::bezier::{BezierBody, BezierState};
use super::holds::Anchor;
use super::simulation::Simulation;
use crate::burning::{BurningState, HeatedState};
use crate::integrate::{Memory, PathPoint, State};
use crate::process::RestState;
use crate::solve::{LinearWorkspace, WorkspaceHistory};

/// Everything of a simulation that its model does not say: a new simulation of the same model, restored from it, takes
/// the same steps as the old one, bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Positions, edge angles, their rates, time, number of steps, place on a path of loads, what the integrator keeps.
    pub state: State,
    /// Barrier stiffness [J/m²], which grows where gaps shrink; `None` where contact is off.
    pub kappa: Option<f64>,
    /// How far the directors of edges under moments have turned [rad], in the order of loads and edges.
    pub turned: Vec<f64>,
    /// The share of a step that is tried first.
    pub share: f64,
    /// Where constraints that began during the run and still act took over.
    pub anchors: Vec<Anchor>,
    /// The rest states that processes have changed, of the shells on which they act.
    pub rests: Vec<RestState>,
    /// Angles of hinges [rad], which may lie beyond half a turn: of each bending energy and each damper that follows them.
    pub angles: Vec<Vec<f64>>,
    /// The double layers.
    pub double_layers: Vec<BurningState>,
    /// Temperatures, masses and tears of the burning shells.
    pub heated_shells: Vec<HeatedState>,
    /// The Bézier shells.
    pub bezier: Option<BezierState>,
    /// What the linear solver keeps between steps.
    pub solver: WorkspaceHistory,
}

/// A snapshot is not of this model.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the saved state does not fit the scene: {reason}")]
pub struct RestoreError {
    /// What does not fit.
    pub reason: String,
}

impl Simulation {
    /// What this simulation owes to its past.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            state: self.state.clone(),
            kappa: self.system.contact.as_ref().map(|contact| contact.kappa()),
            turned: self.system.loads.turned(),
            share: self.share,
            anchors: self.holds.anchors().to_vec(),
            rests: self.processes.rests(),
            angles: self.system.branches(&self.state.q),
            double_layers: self.burning.states(),
            heated_shells: self.heated.states(),
            bezier: self.bezier.as_ref().map(BezierBody::state),
            solver: self.system.workspace.history(),
        }
    }

    /// Takes up what a simulation of the same model left.
    ///
    /// # Errors
    /// A snapshot of other sizes, or with values that are not finite; the simulation is then as it was.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), RestoreError> {
        let refuse = |reason| RestoreError { reason };
        self.check(snapshot).map_err(refuse)?;
        let bezier = match (&self.bezier, &snapshot.bezier) {
            (None, None) => None,
            (Some(_), Some(state)) => {
                Some(BezierBody::restored(&self.model, state).map_err(refuse)?)
            }
            _ => return Err(refuse("it is of other kinds of shells".to_owned())),
        };
        let workspace =
            LinearWorkspace::with_history(&snapshot.solver, &self.system.layout).map_err(refuse)?;
        (self.burning.restore(&snapshot.double_layers)).map_err(refuse)?;
        (self
            .heated
            .restore(&mut self.system, &snapshot.heated_shells))
        .map_err(refuse)?;
        self.system.workspace = workspace;
        self.bezier = bezier;
        self.state = snapshot.state.clone();
        self.processes.restore(&mut self.system, &snapshot.rests);
        self.system.restore_branches(&snapshot.angles);
        (self.system.loads).restore_turned(&snapshot.turned, &self.state.q);
        self.enter_phase(self.state.step.max(1));
        self.share = snapshot.share;
        let (phase, parts) = (self.phase().clone(), &self.system.space.shells);
        let (model, time) = (&self.model, self.state.time);
        (self.holds).restore(model, &phase, parts, time, &snapshot.anchors);
        self.apply_schedules(time);
        if let (Some(contact), Some(kappa)) = (&mut self.system.contact, snapshot.kappa) {
            contact.set_kappa(kappa);
            contact.begin_step(&self.state.q);
        }
        Ok(())
    }

    fn check(&self, snapshot: &Snapshot) -> Result<(), String> {
        let state = &snapshot.state;
        for (what, values, expected) in [
            ("positions", &state.q, self.state.q.len()),
            ("velocities", &state.velocities, self.state.velocities.len()),
            ("accelerations", &state.accelerations, self.state.q.len()),
            (
                "angles of moments",
                &snapshot.turned,
                self.system.loads.turned().len(),
            ),
        ] {
            if values.len() != expected {
                return Err(format!("it has {} {what} for {expected}", values.len()));
            }
            if let Some(value) = values.iter().find(|value| !value.is_finite()) {
                return Err(format!("one of its {what} is {value}"));
            }
        }
        if !(state.time.is_finite() && state.time >= 0.0) {
            return Err(format!("its time is {} s", state.time));
        }
        if !(snapshot.share > 0.0 && snapshot.share <= 1.0) {
            return Err(format!("its share of a step is {}", snapshot.share));
        }
        self.check_rests(snapshot)?;
        self.check_path(state.path.as_ref())?;
        self.check_memory(&state.memory)?;
        (snapshot.anchors.iter()).try_for_each(|anchor| self.check_anchor(anchor))?;
        match (&self.system.contact, snapshot.kappa) {
            (None, None) => Ok(()),
            (Some(_), Some(kappa)) if kappa.is_finite() && kappa > 0.0 => Ok(()),
            (_, kappa) => Err(format!("its barrier stiffness is {kappa:?}")),
        }
    }

    /// Rest states and angles are as many as those of this simulation.
    fn check_rests(&self, snapshot: &Snapshot) -> Result<(), String> {
        let sizes = |rests: &[RestState]| -> Vec<usize> {
            let sizes = |rest: &RestState| [rest.curvature.len(), rest.strain.len()];
            rests.iter().flat_map(sizes).collect()
        };
        let lengths = |lists: &[Vec<f64>]| -> Vec<usize> { lists.iter().map(Vec::len).collect() };
        let own = self.processes.rests();
        // Flow begins with the first step, and belongs to numbers or to forms of three.
        let flows = snapshot.rests.iter().all(|saved| {
            let (flows, values) = (saved.flow.len(), saved.curvature.len());
            flows == 0 || flows == values || 3 * flows == values
        });
        let values = snapshot.rests.iter();
        let mut values = values
            .flat_map(|rest| rest.curvature.iter().chain(&rest.flow).chain(&rest.strain))
            .chain(snapshot.angles.iter().flatten());
        match () {
            () if sizes(&snapshot.rests) != sizes(&own) || !flows => {
                Err("its rest states are of other shells".into())
            }
            () if lengths(&snapshot.angles) != lengths(&self.system.branches(&self.state.q)) => {
                Err("its angles are of other hinges".into())
            }
            () if values.any(|value| !value.is_finite()) => {
                Err("one of its rest states is not finite".into())
            }
            () => Ok(()),
        }
    }

    fn check_anchor(&self, anchor: &Anchor) -> Result<(), String> {
        let is_there = |&index: &usize| index < self.model().constraints.len();
        let values = anchor.q.iter().chain([&anchor.time]);
        match () {
            () if !anchor.constraints.iter().all(is_there) => {
                Err("a constraint that began does not exist".into())
            }
            () if anchor.q.len() != self.state.q.len() => {
                let (given, needed) = (anchor.q.len(), self.state.q.len());
                Err(format!(
                    "a constraint began at {given} positions for {needed}"
                ))
            }
            () if values.clone().any(|value| !value.is_finite()) => {
                Err("a constraint began at positions that are not finite".into())
            }
            () => Ok(()),
        }
    }

    /// Every integrator keeps something else, or nothing.
    fn check_memory(&self, memory: &Memory) -> Result<(), String> {
        let sound = |dt: f64| dt > 0.0;
        let fits = |values: &[f64]| {
            values.len() == self.state.q.len() && values.iter().all(|value| value.is_finite())
        };
        let is_whole = match memory {
            Memory::None => true,
            Memory::Before { dt, q, velocities } => {
                sound(*dt) && dt.is_finite() && fits(q) && fits(velocities)
            }
            Memory::Accelerated {
                stable,
                largest_kinetic,
            } => {
                stable.as_ref().is_none_or(|stable| sound(stable.dt)) && largest_kinetic.is_finite()
            }
        };
        match is_whole {
            true => Ok(()),
            false => Err("what its integrator kept of the last step is not whole".into()),
        }
    }

    /// Other integrators know no path; before the first step there is none.
    fn check_path(&self, point: Option<&PathPoint>) -> Result<(), String> {
        let Some(point) = point else {
            return Ok(());
        };
        let numbers = [point.load_factor, point.arc_length];
        let mut values = numbers.iter().chain(&point.increment);
        match () {
            () if self.load_pattern.is_none() => {
                Err("it is on a path by arc length, the scene is not".into())
            }
            () if point.increment.len() != self.state.q.len() => {
                let (given, needed) = (point.increment.len(), self.state.q.len());
                Err(format!("its increment has {given} values for {needed}"))
            }
            () if point.arc_length <= 0.0 || values.any(|value| !value.is_finite()) => {
                Err("its place on the path is not finite".into())
            }
            () => Ok(()),
        }
    }
}
