//! The figures of a step: a line of `stats.jsonl`.

use serde::Serialize;

use super::as_map;
use crate::integrate::StepReport;

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

#[cfg(test)]
mod tests {
    use serde_json::Value;

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
}
