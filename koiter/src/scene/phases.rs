//! The phases of a model, and the steps they are made of.

use super::model::{IntegratorKind, Model, Phase};

impl Model {
    /// All phases; of a model that names none, the one that it is.
    pub(super) fn all_phases(&self) -> Vec<Phase> {
        if !self.phases.is_empty() {
            return self.phases.clone();
        }
        vec![Phase {
            name: String::new(),
            steps: usize::MAX,
            integrator: self.integrator,
            gravity: self.gravity,
            constraints: vec![true; self.constraints.len()],
            loads: vec![true; self.loads.len()],
        }]
    }

    /// Whether a path by arc length is followed, which is all of a run.
    pub(super) fn follows_path(&self) -> bool {
        let phases = self.all_phases();
        (phases.iter()).any(|phase| phase.integrator == IntegratorKind::ArcLength)
    }
}

/// Index of the phase that the step with a number, from 1, belongs to.
pub(super) fn phase_of_step(phases: &[Phase], step: usize) -> usize {
    let mut end = 0usize;
    let ends = phases.iter().map(|phase| {
        end = end.saturating_add(phase.steps);
        end
    });
    let found = ends.take(phases.len() - 1).position(|end| step <= end);
    found.unwrap_or(phases.len() - 1)
}

/// The steps of a run: which size they have, when they end, and after which of them a frame is due.
#[derive(Clone, Debug, PartialEq)]
pub struct Timeline {
    phases: Vec<PhaseSteps>,
}

/// The steps of a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseSteps {
    /// Name of the phase; empty where the scene names none.
    pub name: String,
    /// Beginning [s].
    pub start: f64,
    /// Step [s].
    pub dt: f64,
    /// Number of steps.
    pub steps: usize,
    /// A frame every so many steps.
    pub frame_steps: usize,
}

impl Timeline {
    /// # Panics
    /// Without phases.
    pub fn new(phases: Vec<PhaseSteps>) -> Self {
        assert!(!phases.is_empty(), "a run has a phase");
        Self { phases }
    }

    /// The phases.
    pub fn phases(&self) -> &[PhaseSteps] {
        &self.phases
    }

    /// Number of steps to the end.
    pub fn num_steps(&self) -> usize {
        self.phases.iter().map(|phase| phase.steps).sum()
    }

    /// The phase of a step, from 1, and the number of steps before it; steps beyond the end are of the last phase.
    fn phase_of(&self, step: usize) -> (&PhaseSteps, usize) {
        let mut before = 0;
        let (last, others) = self.phases.split_last().expect("a run has a phase");
        for phase in others {
            if step <= before + phase.steps {
                return (phase, before);
            }
            before += phase.steps;
        }
        (last, before)
    }

    /// Size of a step, counted from 1 [s].
    pub fn dt(&self, step: usize) -> f64 {
        self.phase_of(step).0.dt
    }

    /// Time after so many steps [s], without the last digit that sums and products are off by: 0.3, not
    /// 0.30000000000000004.
    pub fn time(&self, step: usize) -> f64 {
        let (phase, before) = self.phase_of(step);
        decimal(phase.start + (step - before) as f64 * phase.dt)
    }

    /// The smallest number of steps that reach a time [s], at least 1; huge times give huge numbers.
    pub fn steps_until(&self, time: f64) -> f64 {
        let mut before = 0;
        for (phase, next) in self.phases.iter().zip(&self.phases[1..]) {
            if time <= next.start {
                return phase.steps_until(time, before);
            }
            before += phase.steps;
        }
        self.phases
            .last()
            .map_or(1.0, |phase| phase.steps_until(time, before))
    }

    /// Whether a frame is due after so many steps: at regular steps, and where a phase ends that another follows.
    pub fn has_frame(&self, step: usize) -> bool {
        let (phase, before) = self.phase_of(step);
        let is_end = step == before + phase.steps && step < self.num_steps();
        is_end || (step - before).is_multiple_of(phase.frame_steps)
    }

    /// Frames that are due up to the end of so many steps, that of the start included.
    pub fn num_frames(&self, step: usize) -> usize {
        let mut frames = 1;
        let mut before = 0;
        let last = self.phases.len() - 1;
        for (index, phase) in self.phases.iter().enumerate() {
            let taken = step - before;
            let within = if index == last {
                taken
            } else {
                taken.min(phase.steps)
            };
            frames += within / phase.frame_steps;
            let is_over = index < last && within == phase.steps;
            frames += usize::from(is_over && !within.is_multiple_of(phase.frame_steps));
            if !is_over {
                break;
            }
            before += phase.steps;
        }
        frames
    }
}

impl PhaseSteps {
    fn steps_until(&self, time: f64, before: usize) -> f64 {
        let steps = ((time - self.start) / self.dt - WHOLE_STEP).ceil();
        before as f64 + steps.max(1.0)
    }
}

/// An end that is a whole number of steps up to this share of one takes exactly these.
pub(super) const WHOLE_STEP: f64 = 1e-9;

/// The shortest decimal of fifteen digits.
fn decimal(number: f64) -> f64 {
    format!("{number:.14e}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn phase(name: &str, start: f64, dt: f64, steps: usize, frame_steps: usize) -> PhaseSteps {
        PhaseSteps {
            name: name.into(),
            start,
            dt,
            steps,
            frame_steps,
        }
    }

    /// Five large steps, then eight small ones.
    fn timeline() -> Timeline {
        Timeline::new(vec![
            phase("push", 0.0, 0.1, 5, 2),
            phase("pop", 0.5, 1e-3, 8, 3),
        ])
    }

    #[test]
    fn times_are_written_as_they_are_meant() {
        let one = |dt| Timeline::new(vec![phase("", 0.0, dt, 10, 1)]);
        assert_eq!(one(0.1).time(3).to_string(), "0.3");
        assert_eq!(one(0.02).time(0), 0.0);
        assert!((one(1.0 / 60.0).time(7) / (7.0 / 60.0) - 1.0).abs() < 1e-14);
        assert_eq!(timeline().time(5), 0.5);
        assert_eq!(timeline().time(8), 0.503);
        assert_eq!(
            [5, 6, 99].map(|step| timeline().dt(step)),
            [0.1, 1e-3, 1e-3]
        );
    }

    #[test]
    fn frames_are_due_in_every_phase_and_where_one_ends() {
        let timeline = timeline();
        assert_eq!(timeline.num_steps(), 13);
        let due: Vec<usize> = (1..=13).filter(|&step| timeline.has_frame(step)).collect();
        assert_eq!(due, [2, 4, 5, 8, 11]);
        for step in 0..=20 {
            let counted = (1..=step).filter(|&step| timeline.has_frame(step)).count();
            assert_eq!(timeline.num_frames(step), 1 + counted, "{step}");
        }
    }

    #[test]
    fn a_time_is_reached_by_the_first_step_that_ends_there_or_later() {
        let steps = [0.05, 0.3, 0.5, 0.5005, 0.503, 0.508, 0.6].map(|t| timeline().steps_until(t));
        assert_eq!(steps, [1.0, 3.0, 5.0, 6.0, 8.0, 13.0, 105.0]);
    }

    #[test]
    fn steps_beyond_the_end_belong_to_the_last_phase() {
        let named = |steps| Phase {
            name: String::new(),
            steps,
            integrator: IntegratorKind::ImplicitEuler,
            gravity: crate::Vec3::zeros(),
            constraints: vec![],
            loads: vec![],
        };
        let phases = [named(2), named(3)];
        let found = [1, 2, 3, 5, 6, 99].map(|step| phase_of_step(&phases, step));
        assert_eq!(found, [0, 0, 1, 1, 1, 1]);
        assert_eq!(phase_of_step(&[named(usize::MAX)], 7), 0);
    }
}
