//! Numeric factorisation.
//!
//! Each front gathers its entries of the matrix and the updates of its children, eliminates its columns and passes the
//! Schur complement of its remaining rows to its parent.

use std::ops::Range;

use faer::MatMut;
use faer::prelude::{Reborrow, ReborrowMut};

use super::dense::{Scratch, factorize_panel, join, subtract_square};
use super::fronts::{BlockPlace, Front, FrontTree, Lie};
use super::upward::UpwardPass;

/// Fronts of more entries than this are gathered by two tasks.
const LARGE_FRONT: usize = 1 << 17;

/// Gathers and eliminates; what a front owns is its panel of the factor.
pub(super) struct Elimination<'a> {
    pub(super) tree: &'a FrontTree,
    /// Entries of the matrix, in the order of its pattern.
    pub(super) entries: &'a [f64],
}

impl UpwardPass for Elimination<'_> {
    fn own(&self, front: &Front) -> Range<usize> {
        front.panel()
    }

    fn update_size(&self, front: &Front) -> usize {
        front.num_update * front.num_update
    }

    fn task(&self) -> f64 {
        2e7
    }

    fn visit<'a>(
        &self,
        front: &Front,
        panel: &mut [f64],
        children: impl Iterator<Item = (&'a Front, &'a [f64])> + Clone + Send,
        update: &mut [f64],
        scratch: &mut Scratch,
    ) -> Result<(), usize> {
        let (rows, columns) = (front.num_rows(), front.num_columns());
        let updates = children.clone();
        let gather = || {
            panel.fill(0.0);
            for block in &self.tree.blocks[front.blocks.clone()] {
                copy_block(block, self.entries, rows, panel);
            }
            for (child, child_update) in children {
                extend_add(child, child_update, 0..columns, panel, rows);
            }
        };
        let add_updates = || {
            for (child, child_update) in updates {
                extend_add(child, child_update, columns..rows, update, rows - columns);
            }
        };
        if rows * rows > LARGE_FRONT {
            join(gather, add_updates);
        } else {
            gather();
            add_updates();
        }
        eliminate(front, panel, update, scratch)
    }
}

fn copy_block(block: &BlockPlace, entries: &[f64], num_rows: usize, panel: &mut [f64]) {
    let place = block.place as usize;
    for c in 0..usize::from(block.columns) {
        let start = block.slot as usize + c * block.stride as usize - c * (c + 1) / 2;
        let first = if block.lie == Lie::Diagonal { c } else { 0 };
        for r in first..usize::from(block.rows) {
            let value = entries[start + r];
            match block.lie {
                Lie::Transposed => panel[place + r * num_rows + c] = value,
                Lie::Straight | Lie::Diagonal => panel[place + c * num_rows + r] = value,
            }
        }
    }
}

/// Adds those columns of a child's update that fall on the given columns of its parent's front. `target` has these columns
/// of `height` entries each.
fn extend_add(
    child: &Front,
    child_update: &[f64],
    columns: Range<usize>,
    target: &mut [f64],
    height: usize,
) {
    // A panel has all rows of the front, an update those below the panel: both start at the row of their first column.
    let first_row = columns.start;
    for (k, run) in child.runs.iter().enumerate() {
        if !columns.contains(&(run.parent as usize)) {
            continue;
        }
        for offset in 0..run.length as usize {
            let from = run.child as usize + offset;
            let source = &child_update[from * child.num_update..][..child.num_update];
            let to = run.parent as usize + offset;
            let target = &mut target[(to - columns.start) * height..][..height];
            let mut add = |child_row: usize, parent_row: usize, length: usize| {
                let target = &mut target[parent_row - first_row..][..length];
                for (t, s) in target.iter_mut().zip(&source[child_row..][..length]) {
                    *t += s;
                }
            };
            add(from, to, run.length as usize - offset);
            for below in &child.runs[k + 1..] {
                add(
                    below.child as usize,
                    below.parent as usize,
                    below.length as usize,
                );
            }
        }
    }
}

/// Eliminates the front's columns and subtracts their part from the update.
fn eliminate(
    front: &Front,
    panel: &mut [f64],
    update: &mut [f64],
    scratch: &mut Scratch,
) -> Result<(), usize> {
    let (rows, columns, n) = (front.num_rows(), front.num_columns(), front.num_update);
    let mut panel = MatMut::from_column_major_slice_mut(panel, rows, columns);
    factorize_panel(panel.rb_mut(), scratch).map_err(|column| front.columns.start + column)?;
    if n > 0 {
        let below = panel.rb().split_at_row(columns).1;
        subtract_square(MatMut::from_column_major_slice_mut(update, n, n), below);
    }
    Ok(())
}
