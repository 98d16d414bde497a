//! From `time` and `[[phase]]` to phases and their steps.

use crate::Vec3;
use crate::scene::model::Phase;
use crate::scene::phases::{PhaseSteps, Timeline, WHOLE_STEP};
use crate::scene::spec::SceneSpec;

/// The phases that a scene names.
pub(super) fn phases(spec: &SceneSpec) -> Vec<Phase> {
    let steps = timeline(spec);
    let phases = spec.phase.iter().zip(steps.phases());
    let phases = phases.map(|(phase, PhaseSteps { steps, .. })| {
        let chosen = |names: &Option<Vec<String>>, name: &str| {
            (names.as_ref()).is_none_or(|names| names.iter().any(|chosen| chosen == name))
        };
        let constraints = spec.constraint.iter().enumerate();
        Phase {
            name: phase.name.clone(),
            steps: *steps,
            integrator: phase.integrator.unwrap_or(spec.integrator),
            gravity: Vec3::from(phase.gravity.unwrap_or(spec.gravity)),
            constraints: constraints
                .map(|(index, c)| chosen(&phase.constraints, &c.id(index)))
                .collect(),
            loads: (spec.load.iter())
                .map(|load| chosen(&phase.loads, &load.name))
                .collect(),
        }
    });
    phases.collect()
}

/// The steps of a scene.
pub(super) fn timeline(spec: &SceneSpec) -> Timeline {
    let windows = spec.windows().into_iter().enumerate();
    let phases = windows.map(|(index, [start, end, largest])| {
        let wanted = (end - start) / largest;
        let steps = (wanted - WHOLE_STEP).ceil().max(1.0);
        let phase = spec.phase.get(index);
        // The run as a whole keeps its step and may end later; a phase ends where the next begins.
        let dt = match (wanted - steps).abs() > WHOLE_STEP && phase.is_some() {
            true => (end - start) / steps,
            false => largest,
        };
        let output = &spec.output;
        let every_steps = phase.and_then(|phase| phase.every_steps);
        let every_seconds = |seconds: f64| ((seconds / dt).round() as usize).max(1);
        PhaseSteps {
            name: phase.map_or_else(String::new, |phase| phase.name.clone()),
            start,
            dt,
            steps: steps as usize,
            frame_steps: (every_steps.or(output.every_steps))
                .or(output.every_seconds.map(every_seconds))
                .unwrap_or(1),
        }
    });
    Timeline::new(phases.collect())
}
