//! The table for people.

use super::case::{Case, Question};
use super::study::{Finding, Study};
use crate::output::say;

/// Prints a case with all models below each other.
pub(super) fn print(case: &Case, studies: &[Study]) {
    say!("\n{}: {}", case.name, case.title);
    let Some(first) = studies.first() else { return };
    let meshes: Vec<String> = (first.cells.iter())
        .map(|cells| {
            let numbers: Vec<String> = cells.iter().map(usize::to_string).collect();
            format!("{:>10}", numbers.join("x"))
        })
        .collect();
    if matches!(case.question, Question::Path { .. }) {
        say!(
            "  deviation: the largest along the path, over the largest reference on it; local: the largest, over the reference at \
             the same load"
        );
    }
    say!(
        "  {:18} {:10} {} {:>10} {:>9} {:>9} {:>6} {:>12} {:>9}  {:15} {:>6}",
        "quantity",
        "bending",
        meshes.join(" "),
        "reference",
        "deviation",
        "local",
        "order",
        "extrapolated",
        "deviation",
        "mark",
        "s"
    );
    for k in 0..first.findings.len() {
        for study in studies {
            print_row(&study.findings[k], study, k == 0);
        }
    }
}

fn print_row(finding: &Finding, study: &Study, with_time: bool) {
    let figures: Vec<String> = (finding.figures.iter())
        .map(|figure| format!("{:>10}", digits(*figure)))
        .collect();
    let dash = || "-".to_owned();
    let (order, limit, off) = match finding.limit {
        Some((order, limit, off)) => (format!("{order:.2}"), digits(limit), percent(off)),
        None => (dash(), dash(), dash()),
    };
    let local = finding.local_deviation.map_or_else(dash, percent);
    let seconds = if with_time {
        format!("{:.1}", study.seconds)
    } else {
        String::new()
    };
    say!(
        "  {:18} {:10} {} {:>10} {:>9} {local:>9} {order:>6} {limit:>12} {off:>9}  {:15} {seconds:>6}",
        finding.quantity.name,
        study.model.info().name,
        figures.join(" "),
        digits(finding.quantity.reference),
        percent(finding.deviation),
        finding.verdict.mark(),
    );
}

fn percent(deviation: f64) -> String {
    format!("{:+.2} %", 100.0 * deviation)
}

/// Five digits.
fn digits(figure: f64) -> String {
    let size = figure.abs();
    if size == 0.0 || !size.is_finite() {
        return format!("{figure}");
    }
    let before = size.log10().floor() as i32;
    let after = usize::try_from(4 - before).unwrap_or(0).min(8);
    format!("{figure:.after$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_five_digits() {
        for (figure, text) in [
            (0.001_265_32, "0.0012653"),
            (49.348, "49.348"),
            (12.0, "12.000"),
            (-123_456.0, "-123456"),
            (0.0, "0"),
        ] {
            assert_eq!(digits(figure), text);
        }
    }
}
