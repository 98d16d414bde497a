//! The figures of a run: a line of `stats.jsonl` a step, and `summary.json`.

use crate::output::say;
use std::path::{Path, PathBuf};

use koiter::integrate::StepReport;
use koiter::io::result::Totals;
use koiter::scene::{SystemStats, readable_bytes};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use serde_json::Value;

use crate::memory;

/// A line of `stats.jsonl`. Numbers that are not finite (the gap when nothing is near) are null.
#[derive(Serialize)]
pub(super) struct StatsLine<'a> {
    step: usize,
    time: f64,
    dt: f64,
    newton_iterations: usize,
    line_search_steps: usize,
    converged: bool,
    residual: f64,
    contacts: usize,
    min_gap: f64,
    /// The pair with the smallest gap.
    min_gap_at: Option<&'a str>,
    kappa: f64,
    /// Where the last Newton step was largest.
    residual_at: &'a str,
    /// The smallest fraction of a Newton step that a line search left.
    smallest_fraction: f64,
    limits: Vec<LimitRecord<'a>>,
    indefinite_hessians: usize,
    diagonal_shifts: usize,
    saddles: usize,
    /// Why there were so many iterations.
    reason: String,
    #[serde(serialize_with = "as_map")]
    contacts_by_bodies: &'a [(String, usize)],
    largest_forces: Vec<ForceRecord<'a>>,
    #[serde(serialize_with = "as_map")]
    energies: &'a [(String, f64)],
    #[serde(serialize_with = "as_map", skip_serializing_if = "<[_]>::is_empty")]
    measures: &'a [(&'static str, f64)],
    #[serde(serialize_with = "as_map")]
    seconds: &'a [(&'static str, f64)],
    #[serde(skip_serializing_if = "Option::is_none")]
    load_factor: Option<f64>,
    /// Whether an equilibrium on a path of loads is stable, and if not, in how many directions it falls.
    #[serde(skip_serializing_if = "Option::is_none")]
    stable: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    negative_eigenvalues: Option<usize>,
    /// 1, unless the step was cut because it failed.
    parts: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    cut: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    diagnosis: Option<&'a str>,
}

/// Line searches that one cause ended.
#[derive(Serialize)]
struct LimitRecord<'a> {
    by: &'a str,
    count: usize,
    smallest_fraction: f64,
    at: &'a str,
}

/// The element of an energy that pulls most.
#[derive(Serialize)]
struct ForceRecord<'a> {
    energy: &'a str,
    force: f64,
    at: &'a str,
}

impl<'a> StatsLine<'a> {
    pub(super) fn new(report: &'a StepReport) -> Self {
        let diagnostics = &report.diagnostics;
        let limits = diagnostics.limits.iter().map(|limit| LimitRecord {
            by: &limit.by,
            count: limit.count,
            smallest_fraction: limit.smallest_fraction,
            at: &limit.place,
        });
        let forces = diagnostics.largest_forces.iter();
        let forces = forces.map(|largest| ForceRecord {
            energy: &largest.energy,
            force: largest.force,
            at: &largest.place,
        });
        Self {
            min_gap_at: diagnostics.closest.as_deref(),
            residual_at: &diagnostics.residual_at,
            smallest_fraction: diagnostics.smallest_fraction(),
            limits: limits.collect(),
            indefinite_hessians: diagnostics.indefinite,
            diagonal_shifts: diagnostics.shifts,
            saddles: diagnostics.saddles,
            reason: diagnostics.reason(report.newton_iterations),
            contacts_by_bodies: &diagnostics.contacts_by_bodies,
            largest_forces: forces.collect(),
            step: report.step,
            time: report.time,
            dt: report.dt,
            newton_iterations: report.newton_iterations,
            line_search_steps: report.line_search_steps,
            converged: report.converged,
            residual: report.residual,
            contacts: report.contacts,
            min_gap: report.min_gap,
            kappa: report.kappa,
            energies: &report.energies,
            measures: &report.measures,
            seconds: &report.seconds,
            load_factor: report.load_factor,
            stable: report.negative_eigenvalues.map(|count| count == 0),
            negative_eigenvalues: report.negative_eigenvalues,
            parts: report.parts,
            cut: report.cut.as_deref(),
            diagnosis: report.diagnosis.as_deref(),
        }
    }
}

/// `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Summary {
    pub(super) steps: usize,
    /// Steps the run was to take.
    pub(super) planned_steps: usize,
    /// Whether it was stopped before its end.
    pub(super) interrupted: bool,
    pub(super) time: f64,
    pub(super) seconds: f64,
    #[serde(serialize_with = "as_map")]
    pub(super) seconds_by_part: Vec<(String, f64)>,
    pub(super) newton_iterations: usize,
    /// Steps that failed as a whole and were taken in parts.
    pub(super) steps_in_parts: usize,
    pub(super) min_gap: f64,
    /// `null` where contact is off and nothing was checked.
    pub(super) intersections: Option<usize>,
    pub(super) vertices: usize,
    pub(super) faces: usize,
    pub(super) dofs: usize,
    pub(super) hessian_nonzeros: usize,
    pub(super) peak_memory_bytes: Option<u64>,
    /// Figures of double layers after the last step.
    #[serde(serialize_with = "as_map", skip_serializing_if = "Vec::is_empty")]
    pub(super) measures: Vec<(&'static str, f64)>,
    pub(super) probes: Value,
    pub(super) converged: bool,
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
    pub(super) fn finish(&mut self, seconds: f64, probes: Value) {
        self.seconds = seconds;
        self.probes = probes;
        self.peak_memory_bytes = memory::peak_bytes();
    }

    /// Prints the summary for people.
    pub(super) fn print(&self) {
        let gap = match self.min_gap.is_finite() {
            true => format!("smallest gap {:.3e} m", self.min_gap),
            false => "nothing came near anything".to_owned(),
        };
        say!(
            "{} steps to t = {:.3} s in {:.1} s, {} Newton iterations",
            self.steps,
            self.time,
            self.seconds,
            self.newton_iterations
        );
        if self.steps_in_parts > 0 {
            say!(
                "{} steps were taken in parts, for they failed as a whole: 'cut' in stats.jsonl says why",
                self.steps_in_parts
            );
        }
        match self.intersections {
            Some(count) => say!("{count} intersections; {gap}"),
            None => say!("contact is off: intersections were not looked for"),
        }
        if let Some(bytes) = self.peak_memory_bytes {
            say!(
                "{} vertices, {} triangles, {} at most",
                self.vertices,
                self.faces,
                readable_bytes(bytes as f64)
            );
        }
        for (name, value) in &self.measures {
            say!("{}: {value:.4}", name.replace('_', " "));
        }
        if let Value::Object(probes) = &self.probes {
            for (name, value) in probes {
                say!("probe {name}: {value}");
            }
        }
    }

    /// Prints where the result is, and the files made.
    pub(super) fn print_files(&self, folder: &Path, made: &[PathBuf]) {
        say!("result: {}", folder.display());
        for path in made {
            say!("made: {}", path.display());
        }
    }
}

fn as_map<S: Serializer, N: Serialize, V: Serialize>(
    pairs: &impl AsRef<[(N, V)]>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let pairs = pairs.as_ref();
    let mut map = serializer.serialize_map(Some(pairs.len()))?;
    for (name, value) in pairs {
        map.serialize_entry(name, value)?;
    }
    map.end()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_the_promised_keys_and_null_for_infinity() {
        let report = StepReport {
            step: 1,
            min_gap: f64::INFINITY,
            energies: vec![("membrane".into(), 2.0)],
            seconds: vec![("solve", 0.5)],
            ..StepReport::default()
        };
        let line = serde_json::to_value(StatsLine::new(&report)).unwrap();
        assert_eq!(line["energies"]["membrane"], 2.0);
        assert_eq!(line["min_gap"], Value::Null);
        for key in [
            "step",
            "time",
            "dt",
            "newton_iterations",
            "seconds",
            "contacts",
            "line_search_steps",
            "converged",
            "limits",
            "smallest_fraction",
            "largest_forces",
            "contacts_by_bodies",
            "reason",
        ] {
            assert!(line.get(key).is_some(), "{key}");
        }
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
