//! Forward and backward substitution.
//!
//! Going up, a front solves for its columns and passes to its parent what it subtracts from the rows below; going down, it
//! takes the solution of those rows from its parent. A solution with several right-hand sides has its `width` entries of
//! one unknown side by side.

use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};

use super::dense::{Scratch, join};
use super::fronts::{Front, FrontTree};
use super::upward::{DEEPEST_TASK, UpwardPass};

/// The factor of a matrix and the number of right-hand sides.
#[derive(Clone, Copy)]
pub(super) struct Substitution<'a> {
    pub(super) tree: &'a FrontTree,
    pub(super) factor: &'a [f64],
    pub(super) width: usize,
}

impl<'a> Substitution<'a> {
    /// L₁₁ and L₂₁ of a front.
    fn panel(&self, front: &Front) -> (MatRef<'a, f64>, MatRef<'a, f64>) {
        let values = &self.factor[front.panel()];
        MatRef::from_column_major_slice(values, front.num_rows(), front.num_columns())
            .split_at_row(front.num_columns())
    }
}

/// Solves L y = b; what a front owns is its part of b, then of y.
impl UpwardPass for Substitution<'_> {
    fn own(&self, front: &Front) -> Range<usize> {
        front.columns.start * self.width..front.columns.end * self.width
    }

    fn update_size(&self, front: &Front) -> usize {
        front.num_update * self.width
    }

    fn task(&self) -> f64 {
        1e8
    }

    fn visit<'a>(
        &self,
        front: &Front,
        own: &mut [f64],
        children: impl Iterator<Item = (&'a Front, &'a [f64])> + Clone + Send,
        update: &mut [f64],
        _: &mut Scratch,
    ) -> Result<(), usize> {
        let (columns, width) = (front.num_columns(), self.width);
        for (child, child_update) in children {
            for run in &child.runs {
                let (from, to, length) = run.scaled(width);
                let (target, first) = if run.parent < columns as u32 {
                    (&mut *own, 0)
                } else {
                    (&mut *update, columns * width)
                };
                let target = &mut target[to - first..][..length];
                for (t, s) in target.iter_mut().zip(&child_update[from..][..length]) {
                    *t += s;
                }
            }
        }
        let (diagonal, below) = self.panel(front);
        let mut own = MatMut::from_row_major_slice_mut(own, columns, width);
        let update = MatMut::from_row_major_slice_mut(update, front.num_update, width);
        solve_lower_triangular_in_place(diagonal, own.rb_mut(), Par::Seq);
        matmul(update, Accum::Add, below, own.rb(), -1.0, Par::Seq);
        Ok(())
    }
}

impl Substitution<'_> {
    /// Solves Lᵀ x = y in place.
    pub(super) fn backward(&self, y: &mut [f64]) {
        self.subtrees(&self.tree.roots, &[], y, 0);
    }

    /// Neighbouring subtrees of one parent, `depth` fronts below a root, whose rows have the solution `above`.
    fn subtrees(&self, roots: &[u32], above: &[f64], x: &mut [f64], depth: usize) {
        let small = self.tree.flops(roots) < self.task() || depth > DEEPEST_TASK;
        match *roots {
            [] => {}
            [root] if small => self.sequential(root, above, x),
            [root] => {
                let front = self.tree.front(root);
                let (below, own) = x.split_at_mut(self.own(front).start - self.start(root));
                let mut rows = vec![0.0; front.num_rows() * self.width];
                self.solve_front(front, above, own, &mut rows);
                self.subtrees(&front.children, &rows, below, depth + 1);
            }
            _ => {
                let (left, right) = self.tree.halve(roots);
                let (left_x, right_x) = x.split_at_mut(self.start(right[0]) - self.start(left[0]));
                join(
                    || self.subtrees(left, above, left_x, depth),
                    || self.subtrees(right, above, right_x, depth),
                );
            }
        }
    }

    /// Where the unknowns of a subtree start.
    fn start(&self, root: u32) -> usize {
        self.own(self.tree.first_front(root)).start
    }

    /// A subtree from its root down. The rows of the fronts between the root and the current one stand on a stack.
    fn sequential(&self, root: u32, above: &[f64], x: &mut [f64]) {
        let start = self.start(root);
        let mut path: Vec<(u32, usize)> = Vec::new();
        let mut stack = above.to_vec();
        let mut parent_rows = 0;
        let first = self.tree.front(root).first_descendant as u32;
        for index in (first..=root).rev() {
            let front = self.tree.front(index);
            if index != root {
                while let Some(&(on_path, at)) = path.last() {
                    if Some(on_path) == front.parent {
                        parent_rows = at;
                        break;
                    }
                    stack.truncate(at);
                    path.pop();
                }
            }
            let own = self.own(front);
            let own = &mut x[own.start - start..own.end - start];
            let at = stack.len();
            stack.resize(at + front.num_rows() * self.width, 0.0);
            let (held, rows) = stack.split_at_mut(at);
            self.solve_front(front, &held[parent_rows..], own, rows);
            path.push((index, at));
        }
    }

    /// Solves for the front's columns and sets `rows` to the solution of all its rows, taken from those of its parent.
    fn solve_front(&self, front: &Front, parent: &[f64], own: &mut [f64], rows: &mut [f64]) {
        let (columns, width) = (front.num_columns(), self.width);
        let (solved, below) = rows.split_at_mut(columns * width);
        for run in &front.runs {
            let (to, from, length) = run.scaled(width);
            below[to..to + length].copy_from_slice(&parent[from..from + length]);
        }
        let (diagonal, panel) = self.panel(front);
        let below = MatRef::from_row_major_slice(below, front.num_update, width);
        let mut x = MatMut::from_row_major_slice_mut(own, columns, width);
        matmul(
            x.rb_mut(),
            Accum::Add,
            panel.transpose(),
            below,
            -1.0,
            Par::Seq,
        );
        solve_upper_triangular_in_place(diagonal.transpose(), x, Par::Seq);
        solved.copy_from_slice(own);
    }
}
