//! What a step tells.

use std::collections::HashMap;
use std::time::Duration;

use koiter::integrate::StepReport;
use pyo3::prelude::*;

/// What a step tells: `step`, `time` [s], `dt` [s], `newton_iterations`, `converged`, `contacts`, `min_gap` [m], `energies` [J]
/// and `seconds` by name, `diagnosis` where it did not converge.
#[pyclass(frozen, module = "koiter")]
pub(crate) struct Step {
    pub(crate) report: StepReport,
    wall: Duration,
}

impl Step {
    /// A step that took so much wall time.
    pub(crate) fn new(report: StepReport, wall: Duration) -> Self {
        Self { report, wall }
    }
}

#[pymethods]
impl Step {
    /// Number of the step, from 1.
    #[getter]
    fn step(&self) -> usize {
        self.report.step
    }

    /// Time at its end [s].
    #[getter]
    fn time(&self) -> f64 {
        self.report.time
    }

    /// Its length [s].
    #[getter]
    fn dt(&self) -> f64 {
        self.report.dt
    }

    /// Newton iterations it took.
    #[getter]
    fn newton_iterations(&self) -> usize {
        self.report.newton_iterations
    }

    /// Whether it found its minimum to the tolerance.
    #[getter]
    fn converged(&self) -> bool {
        self.report.converged
    }

    /// Pairs within reach of the barrier at its end.
    #[getter]
    fn contacts(&self) -> usize {
        self.report.contacts
    }

    /// Smallest gap at its end [m]; infinite where nothing is near.
    #[getter]
    fn min_gap(&self) -> f64 {
        self.report.min_gap
    }

    /// Energies by name [J].
    #[getter]
    fn energies(&self) -> HashMap<&str, f64> {
        let energies = self.report.energies.iter();
        energies
            .map(|(name, value)| (name.as_str(), *value))
            .collect()
    }

    /// Where its time went [s].
    #[getter]
    fn seconds(&self) -> HashMap<&'static str, f64> {
        self.report.seconds.iter().copied().collect()
    }

    /// Wall time that the step took in the compiled half [s].
    #[getter]
    fn wall_seconds(&self) -> f64 {
        self.wall.as_secs_f64()
    }

    /// Why it did not converge, and where; `None` if it did.
    #[getter]
    fn diagnosis(&self) -> Option<&str> {
        self.report.diagnosis.as_deref()
    }

    fn __repr__(&self) -> String {
        let StepReport {
            step,
            time,
            newton_iterations,
            converged,
            ..
        } = &self.report;
        let converged = if *converged { "True" } else { "False" };
        format!(
            "Step(step={step}, time={time}, newton_iterations={newton_iterations}, converged={converged})"
        )
    }
}
