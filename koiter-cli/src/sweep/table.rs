//! What came out of a sweep, a row a run.

use std::path::Path;

use koiter::io::result::ResultReader;
use koiter::io::write_atomically;
use serde_json::{Map, Value, json};

use super::plan::Plan;
use super::workers::Outcome;
use crate::failure::Failure;

/// Figures of the summary that stand in the table.
const FIGURES: [&str; 8] = [
    "converged",
    "steps",
    "time",
    "newton_iterations",
    "seconds",
    "min_gap",
    "intersections",
    "faces",
];

/// A table: names of columns, and a value a column for every run.
pub(super) struct Table {
    columns: Vec<String>,
    rows: Vec<Vec<Value>>,
}

impl Table {
    /// Reads the summaries; a run without one has empty cells.
    pub(super) fn collect(plan: &Plan, outcomes: &[Outcome], out: &Path) -> Self {
        let summaries: Vec<Value> = (plan.runs.iter())
            .map(|run| summary(&out.join(&run.folder)).unwrap_or(Value::Null))
            .collect();
        let mut probes: Vec<String> = Vec::new();
        for summary in &summaries {
            for name in flat_probes(summary).keys() {
                if !probes.contains(name) {
                    probes.push(name.clone());
                }
            }
        }
        let mut columns = vec!["run".to_owned()];
        columns.extend(plan.keys.iter().map(|(key, _)| key.clone()));
        columns.extend(["status", "starts"].map(str::to_owned));
        columns.extend(FIGURES.map(str::to_owned));
        columns.extend(probes.iter().cloned());
        let rows =
            (plan.runs.iter().zip(outcomes).zip(&summaries)).map(|((run, outcome), summary)| {
                let mut row = vec![json!(run.folder)];
                row.extend(run.values.iter().map(|value| json!(value)));
                row.extend([json!(outcome.status), json!(outcome.starts)]);
                row.extend(FIGURES.map(|name| summary[name].clone()));
                let values = flat_probes(summary);
                let of = |name: &String| values.get(name).cloned().unwrap_or(Value::Null);
                row.extend(probes.iter().map(of));
                row
            });
        Self {
            rows: rows.collect(),
            columns,
        }
    }

    /// Writes table.csv and table.json.
    pub(super) fn write(&self, out: &Path) -> Result<(), Failure> {
        for (name, text) in [
            ("table.csv", self.csv()),
            ("table.json", self.json().to_string()),
        ] {
            let path = out.join(name);
            write_atomically(&path, text.as_bytes())
                .map_err(|error| Failure::writing(&path, &error))?;
        }
        Ok(())
    }

    /// `{"columns": […], "runs": [{column: value}, …]}`.
    pub(super) fn json(&self) -> Value {
        let object = |row: &Vec<Value>| -> Value {
            let pairs = self.columns.iter().cloned().zip(row.iter().cloned());
            Value::Object(pairs.collect::<Map<_, _>>())
        };
        let runs: Vec<Value> = self.rows.iter().map(object).collect();
        json!({ "columns": self.columns, "runs": runs })
    }

    fn csv(&self) -> String {
        let line = |cells: Vec<String>| cells.join(",") + "\n";
        let heading = line(self.columns.iter().map(|name| csv_cell(name)).collect());
        let rows = self.rows.iter();
        heading
            + &rows
                .map(|row| line(row.iter().map(|value| csv_cell(&plain(value))).collect()))
                .collect::<String>()
    }

    /// Columns for a terminal, each as wide as its widest cell; those without values are left out.
    pub(super) fn text(&self) -> String {
        let used: Vec<usize> = (0..self.columns.len())
            .filter(|&c| self.rows.iter().any(|row| !row[c].is_null()))
            .collect();
        let mut lines = vec![String::new(); 1 + self.rows.len()];
        for &c in &used {
            let mut cells = vec![self.columns[c].clone()];
            cells.extend(self.rows.iter().map(|row| short(&row[c])));
            let width = cells.iter().map(|cell| cell.chars().count()).max();
            for (line, cell) in lines.iter_mut().zip(&cells) {
                *line += &format!("{cell:<width$}  ", width = width.unwrap_or(0));
            }
        }
        let lines: Vec<&str> = lines.iter().map(|line| line.trim_end()).collect();
        lines.join("\n")
    }
}

fn summary(folder: &Path) -> Option<Value> {
    ResultReader::open(folder).ok()?.summary().ok()?
}

/// The last values of probes; of vectors by component.
fn flat_probes(summary: &Value) -> Map<String, Value> {
    let mut flat = Map::new();
    for (name, value) in summary["probes"].as_object().into_iter().flatten() {
        match value.as_array() {
            None => {
                flat.insert(name.clone(), value.clone());
            }
            Some(components) => {
                let named = ["x", "y", "z"].iter().zip(components);
                flat.extend(named.map(|(axis, value)| (format!("{name}.{axis}"), value.clone())));
            }
        }
    }
    flat
}

fn plain(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// Four digits are enough for a terminal.
fn short(value: &Value) -> String {
    match value.as_f64() {
        Some(number) if !value.is_u64() && !value.is_i64() => {
            let size = number.abs();
            match size == 0.0 || (1e-3..1e5).contains(&size) {
                true => format!("{number:.4}"),
                false => format!("{number:.3e}"),
            }
        }
        _ => plain(value),
    }
}

fn csv_cell(text: &str) -> String {
    match text.contains([',', '"', '\n']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_with_commas_and_quotes_are_quoted() {
        let table = Table {
            columns: vec!["g".to_owned(), "x".to_owned()],
            rows: vec![
                vec![json!("[0, \"a\"]"), Value::Null],
                vec![json!(1.5), json!(true)],
            ],
        };
        assert_eq!(table.csv(), "g,x\n\"[0, \"\"a\"\"]\",\n1.5,true\n");
        assert_eq!(table.json()["runs"][1]["g"], 1.5);
    }

    #[test]
    fn vectors_of_probes_have_a_column_a_component() {
        let flat = flat_probes(&json!({"probes": {"tip": [1.0, 2.0, 3.0], "force": 4.0}}));
        assert_eq!(flat["tip.y"], 2.0);
        assert_eq!(flat["force"], 4.0);
        assert!(flat_probes(&Value::Null).is_empty());
    }
}
