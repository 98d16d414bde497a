//! What holds of springs and of their projections.

use koiter::burning::{DoubleLayer, QuadMesh};

use super::errors::{Sheet, largest_difference};
use crate::bench::gates::{Gate, Gates};

pub(super) fn check(gates: &mut Gates) {
    for cells in [10, 100] {
        let mesh = QuadMesh::grid([1.0; 2], [cells; 2]).expect("a grid is sound");
        let springs = DoubleLayer::new(mesh, 0.25 / cells as f64).num_springs() as f64;
        let gate = Gate::Near(10.0 * (cells * cells) as f64, 0.0);
        gates.check(
            "springs",
            &format!("of {cells} x {cells} cells"),
            "",
            springs,
            gate,
        );
    }
    let figure = "largest difference from a printed digit";
    gates.check(
        "Table 1",
        figure,
        "",
        largest_difference(),
        Gate::Below(1e-4),
    );

    let mut sheet = Sheet::new();
    let mut rises = 0;
    for step in 1..=10 {
        let ratio = 0.98_f64.powi(step);
        sheet.shrink(ratio, ratio);
        let mut before = sheet.sum();
        for _ in 0..7 {
            let after = sheet.sweep();
            rises += usize::from(after > before);
            before = after;
        }
    }
    let case = "Fig. 8, both layers x 0.98 a step";
    let figure = "sweeps of 70 that raise the sum of errors";
    gates.check(case, figure, "", rises as f64, Gate::Below(1.0));

    let case = "Fig. 8, corner layer x 0.995 at once";
    let mut sheet = Sheet::new();
    sheet.shrink(0.995, 1.0);
    let first = sheet.sum();
    let sums: Vec<f64> = (0..7).map(|_| sheet.sweep()).collect();
    let rises = sums.windows(2).filter(|pair| pair[1] > pair[0]).count();
    let figure = "sweeps from the second that raise the sum of errors";
    gates.check(case, figure, "", rises as f64, Gate::Below(1.0));
    let mut at_once = Sheet::new();
    at_once.shrink(0.995, 1.0);
    let once: Vec<f64> = (0..7).map(|_| at_once.step_at_once()).collect();
    // It may grow beyond all numbers.
    let most = once
        .into_iter()
        .filter(|sum| sum.is_finite())
        .fold(0.0, f64::max);
    let figure = "sum of errors after 7 sweeps, over the first";
    gates.check(case, figure, "", sums[6] / first, Gate::Below(2.0));
    let figure = "the same, all springs as one set";
    gates.check(case, figure, "", most / first, Gate::Above(100.0));
}
