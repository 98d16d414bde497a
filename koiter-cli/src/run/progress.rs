//! The progress bar: on a terminal only.

use indicatif::{ProgressBar, ProgressStyle};
use koiter::integrate::StepReport;

/// A bar of steps, or nothing.
pub(super) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// indicatif draws nothing when standard error is no terminal.
    pub(super) fn new(num_steps: usize, done: usize, quiet: bool) -> Self {
        let bar = match quiet {
            true => ProgressBar::hidden(),
            false => ProgressBar::new(num_steps as u64),
        };
        let template = "{bar:24} step {pos}/{len}  {msg}  {elapsed} + {eta} left";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        // Steps of an earlier run do not count for the time left.
        bar.set_position(done as u64);
        bar.reset_eta();
        bar.set_message("first step");
        bar.tick();
        Self { bar }
    }

    /// Shows a step.
    pub(super) fn show(&mut self, report: &StepReport) {
        self.bar.set_message(describe(report));
        self.bar.inc(1);
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

fn describe(report: &StepReport) -> String {
    let gap = match report.min_gap.is_finite() {
        true => format!("gap {}", length(report.min_gap)),
        false => "no contact".to_owned(),
    };
    format!(
        "t = {:.3} s  {} iterations  {} contacts  {gap}",
        report.time, report.newton_iterations, report.contacts
    )
}

fn length(metres: f64) -> String {
    match metres.abs() {
        x if x >= 1.0 => format!("{metres:.2} m"),
        x if x >= 1e-3 => format!("{:.2} mm", metres * 1e3),
        _ => format!("{:.1} µm", metres * 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_told_in_one_line() {
        let report = StepReport {
            time: 0.5,
            newton_iterations: 7,
            contacts: 12,
            min_gap: 2.5e-5,
            ..StepReport::default()
        };
        assert_eq!(
            describe(&report),
            "t = 0.500 s  7 iterations  12 contacts  gap 25.0 µm"
        );
        let free = StepReport {
            min_gap: f64::INFINITY,
            ..report
        };
        assert!(describe(&free).ends_with("no contact"));
    }
}
