//! The figures of a run: `summary.json`.

use serde::Serialize;
use serde_json::Value;

use super::as_map;
use crate::integrate::StepReport;
use crate::io::result::Totals;
use crate::scene::SystemStats;

/// `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Steps taken.
    pub steps: usize,
    /// Steps the run was to take.
    pub planned_steps: usize,
    /// Whether it was stopped before its end.
    pub interrupted: bool,
    /// Time at the end [s].
    pub time: f64,
    /// Wall time [s].
    pub seconds: f64,
    /// Wall time of steps by part [s].
    #[serde(serialize_with = "as_map")]
    pub seconds_by_part: Vec<(String, f64)>,
    /// Newton iterations.
    pub newton_iterations: usize,
    /// Steps that failed as a whole and were taken in parts.
    pub steps_in_parts: usize,
    /// Smallest gap between surfaces [m]; infinite, in JSON `null`, where nothing was near.
    pub min_gap: f64,
    /// Intersections found; `None` where contact is off and nothing was checked.
    pub intersections: Option<usize>,
    /// Vertices of all shells.
    pub vertices: usize,
    /// Faces of all shells.
    pub faces: usize,
    /// Unknowns.
    pub dofs: usize,
    /// Numbers in the lower half of the Hessian.
    pub hessian_nonzeros: usize,
    /// Most memory that the program had at a time, where it is known.
    pub peak_memory_bytes: Option<u64>,
    /// Figures of what burns after the last step.
    #[serde(serialize_with = "as_map", skip_serializing_if = "Vec::is_empty")]
    pub measures: Vec<(&'static str, f64)>,
    /// Highest temperature of what burns at the ends of all steps since the run was begun or taken up again [K].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hottest: Option<f64>,
    /// Last values of the probes by name.
    pub probes: Value,
    /// Whether all steps converged.
    pub converged: bool,
}

impl Summary {
    pub(super) fn new(stats: &SystemStats, planned_steps: usize, contact: bool) -> Self {
        Self {
            steps: 0,
            planned_steps,
            interrupted: false,
            time: 0.0,
            seconds: 0.0,
            seconds_by_part: Vec::new(),
            newton_iterations: 0,
            steps_in_parts: 0,
            min_gap: f64::INFINITY,
            intersections: contact.then_some(0),
            vertices: stats.vertices,
            faces: stats.faces,
            dofs: stats.dofs,
            hessian_nonzeros: stats.hessian_nonzeros,
            peak_memory_bytes: None,
            measures: Vec::new(),
            hottest: None,
            probes: Value::Null,
            converged: true,
        }
    }

    /// Adds a step.
    pub(super) fn add(&mut self, report: &StepReport) {
        self.steps = report.step;
        self.time = report.time;
        self.newton_iterations += report.newton_iterations;
        self.steps_in_parts += usize::from(report.parts > 1);
        self.min_gap = self.min_gap.min(report.min_gap);
        if let Some(count) = &mut self.intersections {
            *count += report.intersections;
        }
        self.converged &= report.converged;
        self.measures.clone_from(&report.measures);
        if let Some(temperature) = self.measure("highest_temperature") {
            self.hottest = Some(self.hottest.map_or(temperature, |t| t.max(temperature)));
        }
        for &(part, seconds) in &report.seconds {
            match self
                .seconds_by_part
                .iter_mut()
                .find(|(name, _)| *name == part)
            {
                Some((_, sum)) => *sum += seconds,
                None => self.seconds_by_part.push((part.to_owned(), seconds)),
            }
        }
    }

    fn measure(&self, name: &str) -> Option<f64> {
        let found = self.measures.iter().find(|(known, _)| *known == name);
        found.map(|(_, value)| *value)
    }

    /// The highest temperature of a run in which nothing burnt though something could have [K].
    pub fn never_ignited(&self) -> Option<f64> {
        let is_whole = self.measure("mean_mass_ratio") == Some(1.0);
        self.hottest.filter(|_| is_whole)
    }

    /// Goes on after `step` steps that added up to `totals`.
    pub(super) fn take_up(&mut self, step: usize, time: f64, totals: &Totals) {
        self.steps = step;
        self.time = time;
        self.newton_iterations = totals.newton_iterations as usize;
        self.steps_in_parts = totals.in_parts as usize;
        self.min_gap = totals.min_gap;
        self.intersections = self.intersections.map(|_| totals.intersections as usize);
        self.converged = totals.unconverged == 0;
        self.seconds_by_part = totals.seconds_by_part.clone();
    }

    /// What a checkpoint keeps of the sums.
    pub(super) fn totals(&self) -> Totals {
        Totals {
            newton_iterations: self.newton_iterations as u64,
            in_parts: self.steps_in_parts as u64,
            intersections: self.intersections.unwrap_or(0) as u64,
            min_gap: self.min_gap,
            seconds_by_part: self.seconds_by_part.clone(),
            ..Totals::default()
        }
    }

    /// Adds what is known at the end.
    pub(super) fn finish(&mut self, seconds: f64, probes: Value, peak_memory_bytes: Option<u64>) {
        self.seconds = seconds;
        self.probes = probes;
        self.peak_memory_bytes = peak_memory_bytes;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_in_which_nothing_burnt_knows_how_warm_it_was() {
        let step = |ratio, temperature| StepReport {
            measures: vec![
                ("mean_mass_ratio", ratio),
                ("highest_temperature", temperature),
            ],
            ..StepReport::default()
        };
        let mut summary = Summary::new(&SystemStats::default(), 3, true);
        assert_eq!(summary.never_ignited(), None);
        summary.add(&step(1.0, 480.0));
        summary.add(&step(1.0, 320.0));
        assert_eq!(summary.never_ignited(), Some(480.0));
        summary.add(&step(0.99, 520.0));
        assert_eq!(summary.never_ignited(), None);
    }

    #[test]
    fn a_summary_adds_steps_up() {
        let stats = SystemStats {
            vertices: 4,
            faces: 2,
            dofs: 17,
            hessian_nonzeros: 99,
            estimated_memory_bytes: 0,
            energies: vec![],
        };
        let mut summary = Summary::new(&stats, 1, true);
        for (step, converged) in [(1, true), (2, false)] {
            summary.add(&StepReport {
                step,
                time: 0.1 * step as f64,
                newton_iterations: 5,
                parts: step,
                seconds: vec![("solve", 0.5)],
                min_gap: 1.0 / step as f64,
                converged,
                ..StepReport::default()
            });
        }
        assert_eq!(
            (summary.steps, summary.newton_iterations, summary.min_gap),
            (2, 10, 0.5)
        );
        assert_eq!(summary.steps_in_parts, 1);
        assert_eq!(summary.seconds_by_part, [("solve".to_owned(), 1.0)]);
        assert!(!summary.converged);
    }
}
