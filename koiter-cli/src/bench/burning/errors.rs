//! How successive projections converge: Table 1 and Fig. 8 of the paper.

use koiter::Vec3;
use koiter::burning::{
    DoubleLayer, Lengths, Mobility, Projection, ProjectionOptions, QuadMesh, Springs,
};

use super::super::table::Table;

/// Positions of Table 1, as printed (cut off after four digits).
const PUBLISHED: [[f64; 2]; 5] = [
    [0.4306, 0.4401],
    [0.5527, 0.4954],
    [0.5767, 0.5038],
    [0.5804, 0.5050],
    [0.5810, 0.5052],
];

/// One sweep, as the paper takes it.
fn one_sweep() -> ProjectionOptions {
    ProjectionOptions {
        sweeps: 1,
        longest_move: f64::INFINITY,
        ..ProjectionOptions::default()
    }
}

/// Two springs of lengths 1.65 and 0.55 pull a particle that has one unit of room on each side.
pub(super) fn competing_springs() -> Table {
    let mut table = Table::new(
        "Table 1: a particle on two springs that cannot both have their lengths",
        &[
            ("step", "step"),
            ("green", "after green"),
            ("published_green", "paper"),
            ("blue", "after blue"),
            ("published_blue", "paper"),
        ],
    );
    let spring = |ends: [u32; 2]| Springs {
        ends: vec![ends],
        initial_lengths: vec![1.0],
        is_continued: vec![false],
    };
    let mut x = [-1.0, 0.0, 1.0].map(|x| Vec3::new(x, 0.0, 0.0));
    let mut colors = [([0, 1], 1.65), ([1, 2], 0.55)]
        .map(|(ends, length)| (Projection::new([&spring(ends)], 3), [vec![length]]));
    // The ends are held and count all the same: the printed digits need it.
    let mobility = Mobility {
        in_matrix: &[1.0; 3],
        in_move: &[0.0, 1.0, 0.0],
    };
    for (step, published) in PUBLISHED.iter().enumerate() {
        let mut after = [0.0; 2];
        for (after, (projection, targets)) in after.iter_mut().zip(&mut colors) {
            let lengths = Lengths {
                targets,
                is_there: &[vec![true]],
            };
            projection.project(&mut x, lengths, mobility, &one_sweep(), |_| ());
            *after = x[1].x;
        }
        let [[green, blue], [green_there, blue_there]] = [after, *published];
        table.push([
            (step + 1).into(),
            format!("{green:.6}").as_str().into(),
            format!("{green_there:.4}").as_str().into(),
            format!("{blue:.6}").as_str().into(),
            format!("{blue_there:.4}").as_str().into(),
        ]);
    }
    table
}

/// Sums of the errors of all colours over seven sweeps, after lengths changed at once.
pub(super) fn sweeps() -> Table {
    let mut table = Table::new(
        "Fig. 8: sum of the norms of C over the colours, before and after each sweep (16 x 16 cells of 1 m, 0.25 m thick)",
        &[
            ("lengths", "lengths"),
            ("before", "before"),
            ("sweep_1", "1"),
            ("sweep_2", "2"),
            ("sweep_3", "3"),
            ("sweep_4", "4"),
            ("sweep_5", "5"),
            ("sweep_6", "6"),
            ("sweep_7", "7"),
        ],
    );
    for (name, corners, lattice) in [
        ("both layers x 0.98", 0.98, 0.98),
        ("corner layer x 0.995", 0.995, 1.0),
        ("corner layer x 0.98", 0.98, 1.0),
        ("corner layer x 0.8", 0.8, 1.0),
    ] {
        let mut row = vec![name.into()];
        row.extend(
            sums(corners, lattice)
                .into_iter()
                .map(|sum| format!("{sum:.4}").as_str().into()),
        );
        table.push(row);
    }
    table
}

fn sums(corners: f64, lattice: f64) -> Vec<f64> {
    let mesh = QuadMesh::grid([16.0; 2], [16; 2]).expect("a grid of 16 x 16 cells is sound");
    let shell = DoubleLayer::new(mesh, 0.25);
    // Not quite flat: a flat sheet has no way out of its plane in three of the colours.
    let bent = |(p, x): (usize, &Vec3)| x + Vec3::z() * 1e-3 * (12.9898 * p as f64).sin();
    let mut x: Vec<Vec3> = shell.particles.iter().enumerate().map(bent).collect();
    let inverse_masses = vec![1.0; x.len()];
    let factors = [0.5 * (corners + lattice), lattice, corners, corners];
    let scaled = shell.springs.iter().zip(factors);
    let targets: Vec<Vec<f64>> = scaled
        .map(|(springs, factor)| springs.initial_lengths.iter().map(|l| factor * l).collect())
        .collect();
    let is_there: Vec<Vec<bool>> = shell.springs.iter().map(|s| vec![true; s.len()]).collect();
    let lengths = Lengths {
        targets: &targets,
        is_there: &is_there,
    };
    let mut projection = Projection::new(&shell.springs, x.len());
    let sum = |projection: &mut Projection, x: &[Vec3]| -> f64 {
        projection
            .errors(x, lengths)
            .iter()
            .map(|errors| errors.norm)
            .sum()
    };
    let mut sums = vec![sum(&mut projection, &x)];
    for _ in 0..7 {
        let mobility = Mobility::new(&inverse_masses);
        projection.project(&mut x, lengths, mobility, &one_sweep(), |_| ());
        sums.push(sum(&mut projection, &x));
    }
    sums
}
