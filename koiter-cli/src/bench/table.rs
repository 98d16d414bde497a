//! Figures in rows, for people and for scripts.

use std::fmt;

use serde_json::{Map, Value, json};

/// A table of figures. Each column has a key (for scripts) and a heading with its unit (for people).
pub(super) struct Table {
    title: &'static str,
    columns: &'static [(&'static str, &'static str)],
    rows: Vec<Vec<Cell>>,
    /// What scripts get beside the rows: curves and the like.
    pub(super) details: Option<Value>,
    /// What could not be measured, a line each; the program then ends with a failure.
    pub(super) failures: Vec<String>,
}

/// An entry of a table.
pub(super) enum Cell {
    Text(String),
    Count(usize),
    Figure(f64),
    /// Four digits, whatever its size.
    Precise(f64),
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::Count(count)
    }
}

impl From<f64> for Cell {
    fn from(figure: f64) -> Self {
        Self::Figure(figure)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => f.pad(text),
            Self::Count(count) => f.pad(&count.to_string()),
            // Three digits: timings have no more.
            Self::Figure(figure) if figure.abs() >= 100.0 => f.pad(&format!("{figure:.0}")),
            Self::Figure(figure) if figure.abs() >= 10.0 => f.pad(&format!("{figure:.1}")),
            Self::Figure(figure) if figure.abs() >= 1.0 => f.pad(&format!("{figure:.2}")),
            Self::Figure(figure) => f.pad(&format!("{figure:.3}")),
            Self::Precise(figure) => f.pad(&four_digits(*figure)),
        }
    }
}

/// Plain from a thousandth to a hundred thousand, else with an exponent.
fn four_digits(figure: f64) -> String {
    let size = figure.abs();
    if size == 0.0 || !size.is_finite() {
        return format!("{figure}");
    }
    let digits_before = size.log10().floor() as i32;
    match digits_before {
        -3..=4 => format!(
            "{figure:.0$}",
            usize::try_from(3 - digits_before).unwrap_or(0)
        ),
        _ => format!("{figure:.3e}"),
    }
}

impl Table {
    pub(super) fn new(
        title: &'static str,
        columns: &'static [(&'static str, &'static str)],
    ) -> Self {
        Self {
            title,
            columns,
            rows: Vec::new(),
            details: None,
            failures: Vec::new(),
        }
    }

    /// Adds a row, in the order of the columns.
    pub(super) fn push(&mut self, row: impl IntoIterator<Item = Cell>) {
        self.rows.push(row.into_iter().collect());
    }

    /// `{"bench": title, "rows": [{key: value, …}, …]}`, and `"details"` where there are some.
    pub(super) fn json(&self) -> Value {
        let value = |cell: &Cell| match cell {
            Cell::Text(text) => json!(text),
            Cell::Count(count) => json!(count),
            Cell::Figure(figure) | Cell::Precise(figure) => json!(figure),
        };
        let rows: Vec<Map<String, Value>> = (self.rows.iter())
            .map(|row| {
                let cells = self.columns.iter().zip(row);
                cells
                    .map(|((key, _), cell)| ((*key).to_owned(), value(cell)))
                    .collect()
            })
            .collect();
        let mut object = json!({ "bench": self.title, "rows": rows });
        if let Some(details) = &self.details {
            object["details"] = details.clone();
        }
        object
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        let width = |k: usize| {
            let cells = self
                .rows
                .iter()
                .map(|row| row[k].to_string().chars().count());
            cells.fold(self.columns[k].1.chars().count(), usize::max)
        };
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();
        for ((_, heading), width) in self.columns.iter().zip(&widths) {
            write!(f, "  {heading:>width$}")?;
        }
        for row in &self.rows {
            writeln!(f)?;
            for (cell, width) in row.iter().zip(&widths) {
                write!(f, "  {cell:>width$}")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn precise_figures_have_four_digits() {
        for (figure, text) in [
            (13.2071, "13.21"),
            (-0.0044502, "-0.004450"),
            (2.3e-14, "2.300e-14"),
            (123456.0, "1.235e5"),
            (12345.6, "12346"),
            (0.0, "0"),
        ] {
            assert_eq!(Cell::Precise(figure).to_string(), text);
        }
    }
}
