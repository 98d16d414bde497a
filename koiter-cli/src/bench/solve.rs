//! The linear system of an implicit step with BAC: our factorisation beside that of the crate faer.

use koiter::solve::{LinearSolver, nested_dissection};

use super::sheet::Sheet;
use super::table::Table;
use super::{fastest, on_threads, thread_counts};
use crate::arguments::SizeArguments;
use crate::failure::Failure;

pub(super) fn bench(options: &SizeArguments) -> Result<Table, Failure> {
    let mut table = Table::new(
        "linear system of an implicit step with membrane and BAC",
        &[
            ("faces", "triangles"),
            ("unknowns", "unknowns"),
            ("solver", "factorisation"),
            ("threads", "threads"),
            ("ordering_seconds", "ordering, s"),
            ("analysis_seconds", "analysis, s"),
            ("factor_seconds", "factor, s"),
            ("solve_seconds", "solve, s"),
            ("factor_entries", "entries"),
            ("residual", "log10 residual"),
        ],
    );
    for &faces in &options.faces {
        let mut sheet = Sheet::new(faces)?;
        let num_faces = sheet.num_faces;
        let matrix = sheet.step_matrix();
        let unknowns = matrix.pattern.num_rows();
        let mut ordering = None;
        let ordering_seconds = fastest(1, || ordering = Some(nested_dissection(&matrix.pattern)));
        let ordering = ordering.expect("it was just made");
        let exact: Vec<f64> = (0..unknowns).map(|i| (i as f64 * 0.7).sin()).collect();
        let rhs = matrix.multiply(&exact);
        for (name, solver) in [
            ("multifrontal", LinearSolver::Multifrontal),
            ("faer", LinearSolver::Supernodal),
        ] {
            for threads in thread_counts() {
                let row = on_threads(threads, || {
                    let mut factor = solver.create();
                    let analysis = fastest(1, || factor.analyze(&matrix.pattern, &ordering));
                    let mut result = Ok(());
                    let numeric = fastest(options.repeats, || result = factor.factorize(matrix));
                    let mut x = rhs.clone();
                    let solve = fastest(options.repeats, || {
                        x.copy_from_slice(&rhs);
                        factor.solve(&mut x);
                    });
                    result.map(|()| (analysis, numeric, solve, factor.factor_entries(), x))
                })?;
                let (analysis, numeric, solve, entries, x) =
                    row.map_err(|error| Failure::run(error.to_string()))?;
                let back = matrix.multiply(&x);
                let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|a| a * a).sum::<f64>().sqrt();
                let residual = norm(&mut back.iter().zip(&rhs).map(|(a, b)| a - b))
                    / norm(&mut rhs.iter().copied());
                table.push([
                    num_faces.into(),
                    unknowns.into(),
                    name.into(),
                    threads.into(),
                    ordering_seconds.into(),
                    analysis.into(),
                    numeric.into(),
                    solve.into(),
                    entries.into(),
                    residual.log10().into(),
                ]);
            }
        }
    }
    Ok(table)
}
