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
    let found = competition();
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
    for (step, (found, published)) in found.iter().zip(PUBLISHED).enumerate() {
        let [[green, blue], [green_there, blue_there]] = [*found, published];
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

/// The largest difference from a printed digit.
pub(super) fn largest_difference() -> f64 {
    let found = competition().into_iter().zip(PUBLISHED);
    found
        .flat_map(|(found, published)| (0..2).map(move |i| (found[i] - published[i]).abs()))
        .fold(0.0, f64::max)
}

/// Where the particle is after the green and after the blue spring, step by step.
fn competition() -> Vec<[f64; 2]> {
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
    let step = |_| {
        let mut after = [0.0; 2];
        for (after, (projection, targets)) in after.iter_mut().zip(&mut colors) {
            let lengths = Lengths {
                targets,
                is_there: &[vec![true]],
            };
            projection.project(&mut x, lengths, mobility, &one_sweep(), |_| ());
            *after = x[1].x;
        }
        after
    };
    PUBLISHED.map(step).to_vec()
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
    let mut sheet = Sheet::new();
    sheet.shrink(corners, lattice);
    let mut sums = vec![sheet.sum()];
    sums.extend((0..7).map(|_| sheet.sweep()));
    sums
}

/// A sheet of 16 x 16 cells that is projected sweep by sweep.
pub(super) struct Sheet {
    shell: DoubleLayer,
    x: Vec<Vec3>,
    targets: Vec<Vec<f64>>,
    is_there: Vec<Vec<bool>>,
    colors: Projection,
    /// All springs as one set.
    one_set: Projection,
}

impl Sheet {
    pub(super) fn new() -> Self {
        let mesh = QuadMesh::grid([16.0; 2], [16; 2]).expect("a grid of 16 x 16 cells is sound");
        let shell = DoubleLayer::new(mesh, 0.25);
        // Not quite flat: a flat sheet has no way out of its plane in three of the colours.
        let bent = |(p, x): (usize, &Vec3)| x + Vec3::z() * 1e-3 * (12.9898 * p as f64).sin();
        let all = Springs {
            ends: shell.springs.iter().flat_map(|s| s.ends.clone()).collect(),
            initial_lengths: (shell.springs.iter())
                .flat_map(|s| s.initial_lengths.clone())
                .collect(),
            is_continued: vec![false; shell.num_springs()],
        };
        Self {
            x: shell.particles.iter().enumerate().map(bent).collect(),
            targets: shell
                .springs
                .iter()
                .map(|s| s.initial_lengths.clone())
                .collect(),
            is_there: shell.springs.iter().map(|s| vec![true; s.len()]).collect(),
            colors: Projection::new(&shell.springs, shell.particles.len()),
            one_set: Projection::new([&all], shell.particles.len()),
            shell,
        }
    }

    /// Scales the lengths of the layers.
    pub(super) fn shrink(&mut self, corners: f64, lattice: f64) {
        let factors = [0.5 * (corners + lattice), lattice, corners, corners];
        let springs = self.shell.springs.iter().zip(factors);
        for (targets, (springs, factor)) in self.targets.iter_mut().zip(springs) {
            *targets = springs.initial_lengths.iter().map(|l| factor * l).collect();
        }
    }

    /// Sum of the norms of C over the colours.
    pub(super) fn sum(&mut self) -> f64 {
        let lengths = Lengths {
            targets: &self.targets,
            is_there: &self.is_there,
        };
        let errors = self.colors.errors(&self.x, lengths);
        errors.iter().map(|errors| errors.norm).sum()
    }

    /// One sweep over the colours; the sum after it.
    pub(super) fn sweep(&mut self) -> f64 {
        let inverse_masses = vec![1.0; self.x.len()];
        let lengths = Lengths {
            targets: &self.targets,
            is_there: &self.is_there,
        };
        let mobility = Mobility::new(&inverse_masses);
        (self.colors).project(&mut self.x, lengths, mobility, &one_sweep(), |_| ());
        self.sum()
    }

    /// One step of all springs at once; the sum after it.
    pub(super) fn step_at_once(&mut self) -> f64 {
        let inverse_masses = vec![1.0; self.x.len()];
        let (targets, is_there) = ([self.targets.concat()], [self.is_there.concat()]);
        let lengths = Lengths {
            targets: &targets,
            is_there: &is_there,
        };
        let mobility = Mobility::new(&inverse_masses);
        (self.one_set).project(&mut self.x, lengths, mobility, &one_sweep(), |_| ());
        self.sum()
    }
}
