use super::*;
use crate::burning::double_layer::{Color, DoubleLayer};
use crate::burning::quad_mesh::QuadMesh;

fn shell(n: usize) -> DoubleLayer {
    DoubleLayer::new(QuadMesh::grid([n as f64; 2], [n, n]).unwrap(), 0.25)
}

fn all_there(springs: &[Springs]) -> Vec<Vec<bool>> {
    springs.iter().map(|s| vec![true; s.len()]).collect()
}

/// Initial lengths with those of the corner layer (blue and yellow; red by half of it) and of the lattice layer scaled.
fn scaled(shell: &DoubleLayer, corners: f64, lattice: f64) -> Vec<Vec<f64>> {
    let factors = [0.5 * (corners + lattice), lattice, corners, corners];
    let lengths = shell.springs.iter().zip(factors);
    lengths
        .map(|(springs, factor)| springs.initial_lengths.iter().map(|l| factor * l).collect())
        .collect()
}

/// The sheet, not quite flat: a flat one has no out-of-plane direction in blue, green and yellow.
fn perturbed(shell: &DoubleLayer) -> Vec<Vec3> {
    let wave = |(p, x): (usize, &Vec3)| x + Vec3::z() * 1e-3 * (12.9898 * p as f64).sin();
    shell.particles.iter().enumerate().map(wave).collect()
}

/// As in the paper.
fn unbounded() -> ProjectionOptions {
    ProjectionOptions {
        longest_move: f64::INFINITY,
        ..ProjectionOptions::default()
    }
}

fn sum_of_norms(errors: &[Errors]) -> f64 {
    errors.iter().map(|errors| errors.norm).sum()
}

/// The sum of the norms of all colours before and after each of `sweeps` sweeps over `projection`.
fn sweep_by_sweep(
    projection: &mut Projection,
    measure: &mut Projection,
    x: &mut [Vec3],
    lengths: [Lengths<'_>; 2],
    options: &ProjectionOptions,
) -> Vec<f64> {
    let inverse = vec![1.0; x.len()];
    let one = ProjectionOptions {
        sweeps: 1,
        ..options.clone()
    };
    let mut sums = vec![sum_of_norms(&measure.errors(x, lengths[1]))];
    for _ in 0..options.sweeps {
        projection.project(x, lengths[0], Mobility::new(&inverse), &one, |_| ());
        sums.push(sum_of_norms(&measure.errors(x, lengths[1])));
    }
    sums
}

/// Table 1: a particle between two held ones, on springs that cannot both have their lengths.
fn competing(held_ends_count: bool) -> Vec<[f64; 2]> {
    let positions = [-1.0, 0.0, 1.0].map(|x| Vec3::new(x, 0.0, 0.0));
    let spring = |ends: [u32; 2]| Springs {
        ends: vec![ends],
        initial_lengths: vec![1.0],
        is_continued: vec![false],
    };
    let springs = [spring([0, 1]), spring([1, 2])];
    let mut x = positions;
    let in_move = [0.0, 1.0, 0.0];
    let mobility = Mobility {
        in_matrix: if held_ends_count { &[1.0; 3] } else { &in_move },
        in_move: &in_move,
    };
    let (targets, is_there) = ([vec![1.65], vec![0.55]], all_there(&springs));
    let one = ProjectionOptions {
        sweeps: 1,
        ..unbounded()
    };
    let mut projections = springs.each_ref().map(|s| Projection::new([s], 3));
    let mut rows = Vec::new();
    for _ in 0..5 {
        let mut row = [0.0; 2];
        for (k, projection) in projections.iter_mut().enumerate() {
            let lengths = Lengths {
                targets: &targets[k..k + 1],
                is_there: &is_there[k..k + 1],
            };
            projection.project(&mut x, lengths, mobility, &one, |_| ());
            row[k] = x[1].x;
        }
        rows.push(row);
    }
    rows
}

#[test]
fn competing_springs_meet_where_table_1_has_them() {
    let expected = [
        [0.430625, 0.440148],
        [0.552719, 0.495462],
        [0.576723, 0.503877],
        [0.580488, 0.505097],
        [0.581036, 0.505272],
    ];
    // As printed, which is cut off and not rounded.
    let printed = [
        [0.4306, 0.4401],
        [0.5527, 0.4954],
        [0.5767, 0.5038],
        [0.5804, 0.5050],
        [0.5810, 0.5052],
    ];
    for ((row, expected), printed) in competing(true).iter().zip(expected).zip(printed) {
        for k in 0..2 {
            // The last printed digit of each.
            assert!((row[k] - expected[k]).abs() < 1e-6, "{row:?}");
            assert!((0.0..1e-4).contains(&(row[k] - printed[k])), "{row:?}");
        }
    }
}

#[test]
fn without_the_held_ends_in_the_matrix_the_competition_diverges() {
    let rows = competing(false);
    assert!(rows.last().unwrap()[1].abs() > 1.0, "{rows:?}");
}

#[test]
fn compatible_lengths_are_approached_in_every_sweep() {
    let shell = shell(16);
    let is_there = all_there(&shell.springs);
    let mut projection = Projection::new(&shell.springs, shell.particles.len());
    let mut measure = projection.clone();
    let mut x = perturbed(&shell);
    for increment in 1..=4 {
        let factor = 0.98_f64.powi(increment);
        let targets = scaled(&shell, factor, factor);
        let lengths = Lengths {
            targets: &targets,
            is_there: &is_there,
        };
        let options = unbounded();
        let sums = sweep_by_sweep(
            &mut projection,
            &mut measure,
            &mut x,
            [lengths; 2],
            &options,
        );
        assert!(sums.windows(2).all(|pair| pair[1] < pair[0]), "{sums:?}");
        assert!(sums[7] < 0.02 * sums[0], "{sums:?}");
    }
}

#[test]
fn a_shrunk_corner_layer_raises_the_sum_once_and_then_it_falls() {
    let shell = shell(16);
    let is_there = all_there(&shell.springs);
    let mut projection = Projection::new(&shell.springs, shell.particles.len());
    let mut measure = projection.clone();
    let targets = scaled(&shell, 0.995, 1.0);
    let lengths = Lengths {
        targets: &targets,
        is_there: &is_there,
    };
    let mut x = perturbed(&shell);
    let options = unbounded();
    let sums = sweep_by_sweep(
        &mut projection,
        &mut measure,
        &mut x,
        [lengths; 2],
        &options,
    );
    assert!(sums[1] > sums[0], "red is left with the misfit: {sums:?}");
    assert!(sums[7] < 2.0 * sums[0], "{sums:?}");
    let falls = sums[1..].windows(2).all(|pair| pair[1] <= pair[0]);
    assert!(falls, "{sums:?}");
}

/// All springs as one network, without lines, and the same with its lengths.
fn one_set(shell: &DoubleLayer, targets: &[Vec<f64>]) -> (Springs, Vec<f64>) {
    let ends = shell.springs.iter().flat_map(|s| s.ends.clone()).collect();
    let lengths = shell.springs.iter().flat_map(|s| s.initial_lengths.clone());
    let springs = Springs {
        ends,
        initial_lengths: lengths.collect(),
        is_continued: vec![false; shell.num_springs()],
    };
    (springs, targets.concat())
}

#[test]
fn all_colours_at_once_diverge_where_successive_ones_do_not() {
    let shell = shell(16);
    let is_there = all_there(&shell.springs);
    let targets = scaled(&shell, 0.995, 1.0);
    let (springs, all_targets) = one_set(&shell, &targets);
    let mut all = Projection::new([&springs], shell.particles.len());
    let mut measure = Projection::new(&shell.springs, shell.particles.len());
    let (all_targets, all_there) = ([all_targets], [vec![true; springs.len()]]);
    let lengths = [
        Lengths {
            targets: &all_targets,
            is_there: &all_there,
        },
        Lengths {
            targets: &targets,
            is_there: &is_there,
        },
    ];
    let mut x = perturbed(&shell);
    let options = unbounded();
    let sums = sweep_by_sweep(&mut all, &mut measure, &mut x, lengths, &options);
    // It may grow beyond all numbers, so the last sum may be none.
    let finite = sums.iter().copied().filter(|sum| sum.is_finite());
    assert!(finite.fold(0.0, f64::max) > 100.0 * sums[0], "{sums:?}");
}

#[test]
fn a_weight_removes_its_share_of_the_error() {
    let shell = shell(6);
    let blue = &shell.springs[Color::Blue as usize];
    let targets = [blue.initial_lengths.iter().map(|l| 0.999 * l).collect()];
    let is_there = [vec![true; blue.len()]];
    let lengths = Lengths {
        targets: &targets,
        is_there: &is_there,
    };
    for weight in [0.1, 0.5] {
        let mut projection = Projection::new([blue], shell.particles.len());
        let mut x = shell.particles.clone();
        let options = ProjectionOptions {
            sweeps: 1,
            weights: [weight; 4],
            ..ProjectionOptions::default()
        };
        let before = projection.errors(&x, lengths)[0].norm;
        let inverse = vec![1.0; x.len()];
        projection.project(&mut x, lengths, Mobility::new(&inverse), &options, |_| ());
        let after = projection.errors(&x, lengths)[0].norm;
        // The constraint is quadratic: a strain of a thousandth leaves as much.
        assert!((after / before - (1.0 - weight)).abs() < 1e-3);
    }
}
