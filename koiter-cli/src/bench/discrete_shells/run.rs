//! One shell of a scene, on its own, step by step.

use koiter::integrate::StepReport;
use koiter::scene::model::{Model, Phase};
use koiter::scene::{NoFiles, Scene, SceneFile, Simulation, Timeline};
use koiter::{Vec3, mesh::Surface};

use crate::arguments::SceneArguments;
use crate::failure::Failure;
use crate::scene_source::load_silently;

/// A scene that ships, with other settings.
pub(super) fn shipped(name: &str, overrides: &[&str]) -> Result<Scene, Failure> {
    let arguments = SceneArguments {
        scene: name.into(),
        overrides: overrides.iter().map(|&text| text.to_owned()).collect(),
        memory: None,
    };
    Ok(load_silently(&arguments)?.scene)
}

/// A scene of `benchmarks/`, with other settings.
pub(super) fn written(name: &str, text: &str, overrides: &[String]) -> Result<Scene, Failure> {
    let file = SceneFile::parse(name, text, overrides)?;
    Ok(Scene::build(&file, &NoFiles)?)
}

/// Takes all shells but one out of a model, and what holds them. Loads and processes stay what they are: scenes with several
/// shells have none.
pub(super) fn keep(model: &mut Model, name: &str) -> Result<(), Failure> {
    let place = model.shells.iter().position(|shell| shell.name == name);
    let Some(place) = place.filter(|_| model.loads.is_empty() && model.processes.is_empty()) else {
        let message = format!("the scene has no shell '{name}' that could stand alone");
        return Err(Failure::run(message));
    };
    let is_kept: Vec<bool> = (model.constraints.iter())
        .map(|constraint| constraint.shell == place)
        .collect();
    let of_phase = |phase: &mut Phase| {
        let kept = phase.constraints.iter().zip(&is_kept);
        phase.constraints = (kept.filter(|(_, kept)| **kept))
            .map(|(holds, _)| *holds)
            .collect();
    };
    model.phases.iter_mut().for_each(of_phase);
    model
        .constraints
        .retain(|constraint| constraint.shell == place);
    for constraint in &mut model.constraints {
        constraint.shell = 0;
    }
    model.shells = vec![model.shells.swap_remove(place)];
    Ok(())
}

/// What is followed along a run.
pub(super) struct Trace {
    pub(super) simulation: Simulation,
    /// Energy at the start [J].
    pub(super) start: f64,
    /// Largest kinetic energy so far [J].
    pub(super) kinetic: f64,
    /// Energy less that at the start, after every step [J].
    pub(super) gains: Vec<f64>,
    /// Steps that were taken in parts.
    pub(super) cut: usize,
}

impl Trace {
    pub(super) fn new(model: Model) -> Result<Self, Failure> {
        let simulation = Simulation::new(model).map_err(Failure::start)?;
        let start = simulation.total_energy();
        Ok(Self {
            simulation,
            start,
            kinetic: 0.0,
            gains: Vec::new(),
            cut: 0,
        })
    }

    /// Takes a step of a timeline; one that does not converge is an error.
    pub(super) fn step(&mut self, dt: f64) -> Result<StepReport, Failure> {
        let report = self.simulation.step(dt).map_err(Failure::step)?;
        if !report.converged {
            let step = self.simulation.step_count();
            return Err(Failure::run(format!("step {step} did not converge")));
        }
        self.cut += usize::from(report.parts > 1);
        self.kinetic = self.kinetic.max(energy(&self.simulation, "kinetic"));
        self.gains.push(self.simulation.total_energy() - self.start);
        Ok(report)
    }

    /// Takes all steps of a timeline up to a time [s], looking at the simulation after each.
    pub(super) fn run(
        &mut self,
        timeline: &Timeline,
        until: f64,
        mut look: impl FnMut(&Self, &StepReport),
    ) -> Result<(), Failure> {
        let steps = timeline.steps_until(until) as usize;
        for step in 1..=steps.min(timeline.num_steps()) {
            let report = self.step(timeline.dt(step))?;
            look(self, &report);
        }
        Ok(())
    }

    /// The largest change of energy [J].
    pub(super) fn largest_gain(&self) -> f64 {
        self.gains
            .iter()
            .fold(0.0, |largest, gain| gain.abs().max(largest))
    }

    /// The one shell as it is.
    pub(super) fn surface(&self) -> Surface {
        Surface {
            mesh: self.simulation.model().shells[0].surface.mesh.clone(),
            positions: self.simulation.shell_positions(0),
        }
    }
}

/// An energy by name [J]; 0 if there is none.
pub(super) fn energy(simulation: &Simulation, name: &str) -> f64 {
    let energies = simulation.energies();
    let named = energies.iter().filter(|(known, _)| *known == name);
    named.map(|(_, value)| value).sum()
}

/// The vertex nearest to a point.
pub(super) fn nearest(positions: &[Vec3], point: Vec3) -> usize {
    let distance = |&v: &usize| (positions[v] - point).norm();
    let all = 0..positions.len();
    let nearest = all.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.expect("a shell has vertices")
}
