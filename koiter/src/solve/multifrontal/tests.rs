//! The tree against dense elimination, and the same bits for any number of threads.

use std::sync::Arc;

use super::*;
use crate::assembly::{DofLayout, NodeId, PatternBuilder};

/// Rows and columns of dense panels: below, at and above the block sizes of the kernels.
const PANELS: [(usize, usize); 8] = [
    (3, 3),
    (5, 2),
    (17, 9),
    (40, 40),
    (61, 30),
    (130, 128),
    (300, 140),
    (500, 301),
];

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap()
}

struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 33) as usize) % n
    }
}

/// A random graph of nodes of one and three unknowns, often in several pieces, and a random order.
fn random_case(random: &mut Random, num_nodes: usize) -> (Pattern, NodeOrdering) {
    let mut layout = DofLayout::new();
    for _ in 0..num_nodes {
        layout.push_nodes(1, [1, 3][random.below(2)], true);
    }
    let mut builder = PatternBuilder::default();
    if num_nodes > 0 {
        // Local couplings (long trees), random ones, and now and then a node coupled to all.
        for _ in 0..random.below(3 * num_nodes) {
            let a = random.below(num_nodes);
            let b = if random.below(3) == 0 {
                random.below(num_nodes)
            } else {
                (a + 1 + random.below(2)).min(num_nodes - 1)
            };
            builder.couple([NodeId(a as u32), NodeId(b as u32)]);
        }
        if random.below(8) == 0 {
            let hub = random.below(num_nodes) as u32;
            for b in 0..num_nodes as u32 {
                builder.couple([NodeId(hub), NodeId(b)]);
            }
        }
    }
    let pattern = Pattern::new(&layout, &builder.finish());
    let mut order: Vec<u32> = (0..num_nodes as u32).collect();
    if random.below(4) > 0 {
        for i in (1..num_nodes).rev() {
            order.swap(i, random.below(i + 1));
        }
    }
    (pattern, NodeOrdering::of(order))
}

/// Structure of the factor by elimination of a dense graph: rows of every position.
fn dense_structure(pattern: &Pattern, nodes: &[u32]) -> Vec<Vec<usize>> {
    let n = nodes.len();
    let mut place = vec![0; n];
    for (k, &node) in nodes.iter().enumerate() {
        place[node as usize] = k;
    }
    let mut full = vec![vec![false; n]; n];
    for node in 0..n as u32 {
        for &other in pattern.coupled(NodeId(node)) {
            let (a, b) = (place[node as usize], place[other as usize]);
            (full[a][b], full[b][a]) = (true, true);
        }
    }
    for k in 0..n {
        let rows: Vec<usize> = (k + 1..n).filter(|&i| full[i][k]).collect();
        for &i in &rows {
            for &j in &rows {
                full[i][j] = true;
            }
        }
    }
    (0..n)
        .map(|k| (k + 1..n).filter(|&i| full[i][k]).collect())
        .collect()
}

#[test]
fn the_tree_is_that_of_a_dense_elimination() {
    let mut random = Random(11);
    for trial in 0..4000 {
        let n = random.below(40);
        let (pattern, ordering) = random_case(&mut random, n);
        let order = ordering.elimination_order(&pattern);
        let structure = dense_structure(&pattern, &order.nodes);
        let sizes: Vec<usize> = (order.nodes.iter())
            .map(|&k| pattern.size(NodeId(k)))
            .collect();
        let counts = fronts::column_counts(&order, &sizes);
        for k in 0..n {
            let parent = structure[k].first().map_or(u32::MAX, |&p| p as u32);
            assert_eq!(order.parent[k], parent, "trial {trial} parent of {k}");
            let expected = sizes[k] + structure[k].iter().map(|&i| sizes[i]).sum::<usize>();
            assert_eq!(counts[k], expected, "trial {trial} column {k}");
        }
        let tree = FrontTree::new(&pattern, &order);
        // Fronts cover all columns once, in order, and each has exactly the union of its columns' rows.
        let mut starts = vec![0];
        for &s in &sizes {
            starts.push(starts.last().unwrap() + s);
        }
        let mut next = 0;
        for (index, front) in tree.fronts.iter().enumerate() {
            assert_eq!(front.columns.start, next);
            next = front.columns.end;
            let first = starts.binary_search(&front.columns.start).unwrap();
            let end = starts.binary_search(&front.columns.end).unwrap();
            let mut rows: Vec<usize> = (first..end)
                .flat_map(|k| structure[k].iter().copied().filter(|&i| i >= end))
                .collect();
            rows.sort_unstable();
            rows.dedup();
            let update: usize = rows.iter().map(|&i| sizes[i]).sum();
            assert_eq!(front.num_update, update, "trial {trial} front {index}");
            let covered: u32 = front.runs.iter().map(|r| r.length).sum();
            assert_eq!(
                covered as usize,
                if front.parent.is_some() { update } else { 0 }
            );
            for run in &front.runs {
                let parent = tree.front(front.parent.unwrap());
                let c = parent.num_columns() as u32;
                assert!(run.parent + run.length <= c || run.parent >= c);
                assert!((run.parent + run.length) as usize <= parent.num_rows());
            }
            assert_eq!(front.parent.is_none(), tree.roots.contains(&(index as u32)));
            assert!(front.parent.is_some() || front.num_update == 0);
            let below: usize = front
                .children
                .iter()
                .map(|&c| c as usize + 1 - tree.front(c).first_descendant)
                .sum();
            assert_eq!(front.first_descendant + below, index);
        }
        assert_eq!(next, *starts.last().unwrap());
    }
}

fn bits(x: &[f64]) -> Vec<u64> {
    x.iter().map(|v| v.to_bits()).collect()
}

#[test]
fn random_systems_are_solved_to_the_same_bits_by_any_number_of_threads() {
    let mut random = Random(5);
    for trial in 0..400 {
        // Large ones have subtrees and fronts that run in parallel.
        let n = if trial % 100 == 0 {
            1200
        } else {
            random.below(60)
        };
        let (pattern, ordering) = random_case(&mut random, n);
        let mut matrix = SymmetricMatrix::zeros(Arc::new(pattern));
        for (i, value) in matrix.values.iter_mut().enumerate() {
            *value = (i as f64).sin();
        }
        let pattern = Arc::clone(&matrix.pattern);
        let rows = pattern.num_rows();
        for (i, &position) in pattern.diagonal_positions().iter().enumerate() {
            matrix.values[position as usize] = 3.0 + rows as f64 + i as f64 * 0.01;
        }
        let expected: Vec<f64> = (0..2 * rows).map(|i| (i as f64 * 0.7).cos()).collect();
        let rhs: Vec<f64> = (expected.chunks(rows.max(1)))
            .flat_map(|c| matrix.multiply(c))
            .collect();
        let mut first: Option<(Vec<u64>, Vec<u64>)> = None;
        for threads in [1, 3] {
            pool(threads).install(|| {
                let mut solver = Multifrontal::default();
                solver.analyze(&pattern, &ordering);
                for _ in 0..2 {
                    solver.factorize(&matrix).unwrap();
                    let mut x = rhs.clone();
                    solver.solve(&mut x);
                    for (a, b) in x.iter().zip(&expected) {
                        // The diagonal exceeds the rest of every row: a condition of a few thousand at most.
                        assert!((a - b).abs() < 1e-11, "trial {trial}: {a} for {b}");
                    }
                    let now = (bits(&solver.factor), bits(&x));
                    match &first {
                        None => first = Some(now),
                        Some(before) => assert!(*before == now, "trial {trial}"),
                    }
                }
            });
        }
    }
}

#[test]
fn the_failing_unknown_is_exact_and_the_same_for_any_number_of_threads() {
    let mut random = Random(77);
    for trial in 0..400 {
        let n = 1 + random.below(300);
        let (pattern, ordering) = random_case(&mut random, n);
        let mut matrix = SymmetricMatrix::zeros(Arc::new(pattern));
        let pattern = Arc::clone(&matrix.pattern);
        let rows = pattern.num_rows();
        for (i, value) in matrix.values.iter_mut().enumerate() {
            *value = (i as f64).sin();
        }
        for &position in pattern.diagonal_positions() {
            matrix.values[position as usize] = 3.0 + rows as f64;
        }
        let bad = [random.below(rows), random.below(rows)];
        for b in bad {
            matrix.values[pattern.diagonal_positions()[b] as usize] = -1e-3;
        }
        let scalar = ordering.scalar_order(&pattern);
        let first = scalar
            .iter()
            .find(|&&d| bad.contains(&(d as usize)))
            .unwrap();
        for threads in [1, 3] {
            pool(threads).install(|| {
                let mut solver = Multifrontal::default();
                solver.analyze(&pattern, &ordering);
                let failure = solver.factorize(&matrix).unwrap_err();
                assert_eq!(failure.dof, *first as usize, "trial {trial}");
            });
        }
    }
}

#[test]
fn roots_hold_no_buffers() {
    let mut layout = DofLayout::new();
    layout.push_nodes(1000, 1, true);
    let pattern = Arc::new(Pattern::new(&layout, &PatternBuilder::default().finish()));
    let ordering = NodeOrdering::of((0..1000).collect());
    let mut matrix = SymmetricMatrix::zeros(Arc::clone(&pattern));
    matrix.values.fill(2.0);
    pool(2).install(|| {
        let mut solver = Multifrontal::default();
        solver.analyze(&pattern, &ordering);
        for _ in 0..3 {
            solver.factorize(&matrix).unwrap();
            solver.solve(&mut [1.0; 1000]);
        }
        assert!(solver.buffers.0.lock().unwrap().len() <= 2, "one a thread");
    });
}

/// Kernels must not look at the alignment of their memory: buffers are handed out by chance.
#[test]
fn alignment_does_not_change_bits() {
    use faer::MatMut;
    for (rows, columns) in PANELS {
        let mut seen: Option<Vec<u64>> = None;
        let mut seen_s: Option<Vec<u64>> = None;
        for shift in 0..9 {
            let mut memory = vec![0.0f64; rows * columns + 64];
            let base = memory.as_ptr().align_offset(64);
            let panel = &mut memory[base + shift..][..rows * columns];
            for j in 0..columns {
                for i in j..rows {
                    panel[j * rows + i] = if i == j {
                        rows as f64
                    } else {
                        ((i * 7 + j * 13) as f64).sin()
                    };
                }
            }
            let mut m = MatMut::from_column_major_slice_mut(panel, rows, columns);
            dense::factorize_panel(m.as_mut(), &mut dense::Scratch::new()).unwrap();
            let now = bits(panel);
            match &seen {
                None => seen = Some(now),
                Some(b) => assert!(*b == now, "panel {rows} {columns} {shift}"),
            }
            let n = rows - columns;
            if n > 0 {
                let mut memory = vec![0.0f64; n * n + 64];
                let base = memory.as_ptr().align_offset(64);
                let update = &mut memory[base + shift..][..n * n];
                let m = faer::MatRef::from_column_major_slice(panel, rows, columns);
                let below = m.split_at_row(columns).1;
                dense::subtract_square(MatMut::from_column_major_slice_mut(update, n, n), below);
                let now = bits(update);
                match &seen_s {
                    None => seen_s = Some(now),
                    Some(b) => assert!(*b == now, "update {rows} {columns} {shift}"),
                }
            }
        }
    }
}

#[test]
fn alignment_does_not_change_bits_of_substitution() {
    use faer::linalg::matmul::matmul;
    use faer::linalg::triangular_solve::{
        solve_lower_triangular_in_place, solve_upper_triangular_in_place,
    };
    use faer::{Accum, MatMut, MatRef, Par};
    for (rows, columns) in PANELS {
        for width in [1, 2, 3] {
            let panel: Vec<f64> = (0..rows * columns)
                .map(|k| {
                    if k % rows == k / rows {
                        4.0
                    } else {
                        (k as f64).sin() / rows as f64
                    }
                })
                .collect();
            let (diag, below) =
                MatRef::from_column_major_slice(&panel, rows, columns).split_at_row(columns);
            let n = rows - columns;
            let mut seen: Option<Vec<u64>> = None;
            for shift in 0..9 {
                let mut a = vec![0.0f64; columns * width + 64];
                let mut b = vec![0.0f64; n * width + 64];
                let (pa, pb) = (a.as_ptr().align_offset(64), b.as_ptr().align_offset(64));
                let a = &mut a[pa + shift..][..columns * width];
                let b = &mut b[pb + (shift * 3) % 8..][..n * width];
                for (i, x) in a.iter_mut().enumerate() {
                    *x = (i as f64 * 0.3).cos();
                }
                for (i, x) in b.iter_mut().enumerate() {
                    *x = (i as f64 * 0.9).cos();
                }
                let mut ma = MatMut::from_row_major_slice_mut(a, columns, width);
                solve_lower_triangular_in_place(diag, ma.as_mut(), Par::Seq);
                let mut mb = MatMut::from_row_major_slice_mut(b, n, width);
                matmul(mb.as_mut(), Accum::Add, below, ma.as_ref(), -1.0, Par::Seq);
                matmul(
                    ma.as_mut(),
                    Accum::Add,
                    below.transpose(),
                    mb.as_ref(),
                    -1.0,
                    Par::Seq,
                );
                solve_upper_triangular_in_place(diag.transpose(), ma.as_mut(), Par::Seq);
                let mut now = bits(a);
                now.extend(bits(b));
                match &seen {
                    None => seen = Some(now),
                    Some(x) => assert!(*x == now, "{rows} {columns} {width} {shift}"),
                }
            }
        }
    }
}
