//! Where the time of a run went and what limited it: a few lines at its end, from the lines of `stats.jsonl`, those of a run
//! that was interrupted before included.

use koiter::io::result::{ResultError, ResultReader};
use serde::Deserialize;
use std::path::Path;

use crate::output::say;

/// Parts of the time that are told.
const PARTS: usize = 5;

/// A run that converges everywhere and stays below this mean is not slow: what limited it is left out.
const FEW_ITERATIONS: f64 = 5.0;

/// What the end of a run tells.
#[derive(Default)]
pub(super) struct Account {
    seconds: Vec<(String, f64)>,
    steps: usize,
    iterations: usize,
    unconverged: usize,
    limits: Vec<Limit>,
    slowest: Option<StepView>,
    closest: Option<StepView>,
}

#[derive(Clone, Default, Deserialize)]
#[serde(default)]
struct StepView {
    step: usize,
    time: f64,
    newton_iterations: usize,
    converged: bool,
    min_gap: Option<f64>,
    min_gap_at: Option<String>,
    seconds: serde_json::Map<String, serde_json::Value>,
    limits: Vec<Limit>,
    reason: String,
}

#[derive(Clone, Default, Deserialize)]
#[serde(default)]
struct Limit {
    by: String,
    count: usize,
    smallest_fraction: f64,
    at: String,
    #[serde(skip)]
    step: usize,
}

impl StepView {
    fn seconds(&self) -> f64 {
        self.seconds
            .values()
            .filter_map(|value| value.as_f64())
            .sum()
    }
}

impl Account {
    /// From the figures of a result.
    pub(super) fn read(folder: &Path) -> Result<Self, ResultError> {
        let mut account = Self::default();
        for line in ResultReader::open(folder)?.stats()? {
            // A line of another version lacks some of it.
            account.add(serde_json::from_value(line).unwrap_or_default());
        }
        account.seconds.sort_by(|a, b| b.1.total_cmp(&a.1));
        account
            .limits
            .sort_by_key(|limit| std::cmp::Reverse(limit.count));
        Ok(account)
    }

    fn add(&mut self, step: StepView) {
        self.steps += 1;
        self.iterations += step.newton_iterations;
        self.unconverged += usize::from(!step.converged);
        for (part, value) in &step.seconds {
            let value = value.as_f64().unwrap_or(0.0);
            match self.seconds.iter_mut().find(|(name, _)| name == part) {
                Some((_, sum)) => *sum += value,
                None => self.seconds.push((part.clone(), value)),
            }
        }
        for limit in &step.limits {
            let limit = Limit {
                step: step.step,
                ..limit.clone()
            };
            match self.limits.iter_mut().find(|known| known.by == limit.by) {
                None => self.limits.push(limit),
                Some(known) => {
                    let count = known.count + limit.count;
                    if limit.smallest_fraction < known.smallest_fraction {
                        *known = limit;
                    }
                    known.count = count;
                }
            }
        }
        let gap = |step: &StepView| step.min_gap.unwrap_or(f64::INFINITY);
        if gap(&step) < self.closest.as_ref().map_or(f64::INFINITY, gap) {
            self.closest = Some(step.clone());
        }
        if self
            .slowest
            .as_ref()
            .is_none_or(|slowest| step.seconds() > slowest.seconds())
        {
            self.slowest = Some(step);
        }
    }

    /// Prints it; nothing for a run without steps.
    pub(super) fn print(&self) {
        for line in self.lines() {
            say!("{line}");
        }
    }

    fn lines(&self) -> Vec<String> {
        let Some(slowest) = &self.slowest else {
            return Vec::new();
        };
        let all: f64 = self.seconds.iter().map(|(_, seconds)| seconds).sum();
        let parts = self.seconds.iter().take(PARTS).map(|(part, seconds)| {
            format!("{} {:.0} %", part.replace('_', " "), 100.0 * seconds / all)
        });
        let parts: Vec<String> = parts.collect();
        let mut lines = vec![format!("where the time went: {}", parts.join(", "))];
        lines.push(format!(
            "slowest step: {} (t = {:.3} s), {:.2} s and {} iterations; on average {:.1} iterations",
            slowest.step,
            slowest.time,
            slowest.seconds(),
            slowest.newton_iterations,
            self.iterations as f64 / self.steps as f64
        ));
        if self.iterations as f64 > FEW_ITERATIONS * self.steps as f64 || self.unconverged > 0 {
            if !slowest.reason.is_empty() {
                lines.push(format!("  there, {}", slowest.reason));
            }
            lines.extend(self.limits.iter().map(|limit| limit.line(self.iterations)));
        }
        if let Some((closest, place)) = self
            .closest
            .as_ref()
            .and_then(|c| Some((c, c.min_gap_at.as_ref()?)))
        {
            lines.push(format!(
                "smallest gap: {:.2e} m in step {}, {place}",
                closest.min_gap.unwrap_or(f64::INFINITY),
                closest.step
            ));
        }
        lines
    }
}

impl Limit {
    fn line(&self, iterations: usize) -> String {
        let what = match self.by.as_str() {
            "decrease" => "the energy did not fall over the whole of".to_owned(),
            by => format!("{} cut short", by.replace('_', " ")),
        };
        let place = match self.at.is_empty() {
            true => String::new(),
            false => format!(", {}", self.at),
        };
        format!(
            "limited by: {what} {} of {iterations} Newton steps; the shortest, {:.1e}, in step {}{place}",
            self.count, self.smallest_fraction, self.step
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn steps_add_up_to_a_few_lines() {
        let mut account = Account::default();
        for line in [
            json!({ "step": 1, "time": 0.1, "newton_iterations": 4, "converged": true, "min_gap": null, "seconds": { "assembly": 1.0 } }),
            json!({ "step": 2, "time": 0.2, "newton_iterations": 30, "converged": true, "min_gap": 1e-4,
                "min_gap_at": "vertex 1 of 'a' against 'b'", "seconds": { "assembly": 1.0, "linear_solve": 6.0 },
                "limits": [{ "by": "contact", "count": 20, "smallest_fraction": 0.01, "at": "here" }], "reason": "it was hard" }),
            json!({ "step": 3, "newton_iterations": 2, "converged": true,
                "limits": [{ "by": "contact", "count": 1, "smallest_fraction": 0.5, "at": "there" }] }),
            json!({}),
        ] {
            account.add(serde_json::from_value(line).unwrap());
        }
        let text = account.lines().join("\n");
        for part in [
            "assembly 25 %",
            "slowest step: 2 (t = 0.200 s), 7.00 s and 30 iterations",
            "there, it was hard",
            "contact cut short 21 of 36 Newton steps; the shortest, 1.0e-2, in step 2, here",
            "smallest gap: 1.00e-4 m in step 2, vertex 1 of 'a' against 'b'",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
        assert!(Account::default().lines().is_empty());
    }
}
