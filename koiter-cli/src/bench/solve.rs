//! The linear system of an implicit step with BAC: our factorisation beside that of the crate faer.

use koiter::assembly::SymmetricMatrix;
use koiter::solve::{LinearSolver, NodeOrdering, nested_dissection};

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
        for (name, solver) in [
            ("multifrontal", LinearSolver::Multifrontal),
            ("faer", LinearSolver::Supernodal),
        ] {
            for threads in thread_counts() {
                let run = on_threads(threads, || measure(solver, matrix, &ordering, options))??;
                table.push([
                    num_faces.into(),
                    unknowns.into(),
                    name.into(),
                    threads.into(),
                    ordering_seconds.into(),
                    run.analysis.into(),
                    run.factor.into(),
                    run.solve.into(),
                    run.entries.into(),
                    run.residual.log10().into(),
                ]);
            }
        }
    }
    Ok(table)
}

/// Seconds, and how well it solved.
struct Measured {
    analysis: f64,
    factor: f64,
    solve: f64,
    entries: usize,
    residual: f64,
}

fn measure(
    solver: LinearSolver,
    matrix: &SymmetricMatrix,
    ordering: &NodeOrdering,
    options: &SizeArguments,
) -> Result<Measured, Failure> {
    let unknowns = matrix.pattern.num_rows();
    let exact: Vec<f64> = (0..unknowns).map(|i| (i as f64 * 0.7).sin()).collect();
    let rhs = matrix.multiply(&exact);
    let mut solver = solver.create();
    let analysis = fastest(1, || solver.analyze(&matrix.pattern, ordering));
    let mut result = Ok(());
    let factor = fastest(options.repeats, || result = solver.factorize(matrix));
    result.map_err(|error| Failure::run(error.to_string()))?;
    let mut x = rhs.clone();
    let solve = fastest(options.repeats, || {
        x.copy_from_slice(&rhs);
        solver.solve(&mut x);
    });
    let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|a| a * a).sum::<f64>().sqrt();
    let back = matrix.multiply(&x);
    let error = norm(&mut back.iter().zip(&rhs).map(|(a, b)| a - b));
    Ok(Measured {
        analysis,
        factor,
        solve,
        entries: solver.factor_entries(),
        residual: error / norm(&mut rhs.iter().copied()),
    })
}
