//! Figures beside what they are to be.

use super::table::{Cell, Table};

/// What a figure is to be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Gate {
    /// A reference value, to a relative tolerance.
    Near(f64, f64),
    /// Below this.
    Below(f64),
    /// Above this.
    Above(f64),
    /// Between these.
    Between(f64, f64),
    /// Of a value that another program gives for other settings: no more than a comparison.
    Beside(f64),
    /// Told only.
    Free,
}

impl Gate {
    fn holds(self, value: f64) -> Option<bool> {
        match self {
            Self::Near(reference, tolerance) => Some((value / reference - 1.0).abs() <= tolerance),
            Self::Below(limit) => Some(value < limit),
            Self::Above(limit) => Some(value > limit),
            Self::Between(low, high) => Some((low..=high).contains(&value)),
            Self::Beside(_) | Self::Free => None,
        }
    }

    fn reference(self) -> Option<f64> {
        match self {
            Self::Near(reference, _) | Self::Beside(reference) => Some(reference),
            _ => None,
        }
    }

    fn words(self) -> String {
        match self {
            Self::Near(_, tolerance) => format!("± {} %", 100.0 * tolerance),
            Self::Below(limit) => format!("< {}", short(limit)),
            Self::Above(limit) => format!("> {}", short(limit)),
            Self::Between(low, high) => format!("{} to {}", short(low), short(high)),
            Self::Beside(_) | Self::Free => "–".to_owned(),
        }
    }
}

/// As it is written in a source: 0.02, 1e-10.
fn short(limit: f64) -> String {
    match (1e-3..1e5).contains(&limit.abs()) || limit == 0.0 {
        true => limit.to_string(),
        false => format!("{limit:e}"),
    }
}

/// A table of figures with their gates; what is outside becomes a failure.
pub(super) struct Gates {
    pub(super) table: Table,
}

impl Gates {
    pub(super) fn new(title: &'static str) -> Self {
        Self {
            table: Table::new(
                title,
                &[
                    ("case", "case"),
                    ("figure", "figure"),
                    ("unit", "unit"),
                    ("value", "value"),
                    ("reference", "reference"),
                    ("gate", "gate"),
                    ("verdict", ""),
                ],
            ),
        }
    }

    /// Adds a figure of a case.
    pub(super) fn check(&mut self, case: &str, figure: &str, unit: &str, value: f64, gate: Gate) {
        let verdict = match gate.holds(value) {
            Some(true) => "ok",
            Some(false) => "outside",
            None => "",
        };
        if verdict == "outside" {
            let of = (gate.reference())
                .map_or_else(String::new, |r| format!(" of {}", Cell::Precise(r)));
            let value = format!("{} {unit}", Cell::Precise(value));
            let (value, words) = (value.trim_end(), gate.words());
            let failure = format!("{case}: {figure} is {value}, outside {words}{of}");
            self.table.failures.push(failure);
        }
        let dash = || Cell::Text("–".into());
        self.table.push([
            case.into(),
            figure.into(),
            unit.into(),
            Cell::Precise(value),
            gate.reference().map_or_else(dash, Cell::Precise),
            Cell::Text(gate.words()),
            verdict.into(),
        ]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_outside_is_told_and_what_is_not_a_number_is_outside() {
        let mut gates = Gates::new("figures");
        gates.check("case", "fine", "m", 1.01, Gate::Near(1.0, 0.02));
        gates.check("case", "fine too", "m", 7.0, Gate::Between(6.0, 8.0));
        gates.check("case", "told", "m", 1e9, Gate::Beside(1.0));
        assert!(gates.table.failures.is_empty());
        gates.check("case", "off", "m", -0.95, Gate::Near(-1.0, 0.02));
        gates.check("case", "lost", "", f64::NAN, Gate::Below(1.0));
        let expected = "case: off is -0.9500 m, outside ± 2 % of -1.000";
        assert_eq!(gates.table.failures[0], expected);
        assert_eq!(gates.table.failures.len(), 2);
    }
}
