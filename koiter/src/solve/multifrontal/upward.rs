//! A pass over the fronts from the leaves to the roots, in parallel over subtrees.
//!
//! Each front owns a part of the data and passes an update to its parent. Large subtrees run in parallel; small ones are
//! visited front by front, with the updates of finished children on a stack. Children are always taken in the same order:
//! the bits do not depend on the number of threads.

use std::ops::Range;

use super::dense::{Scratch, join};
use super::fronts::{Front, FrontTree};

/// What is done at each front.
pub(super) trait UpwardPass: Sync {
    /// The front's own part of the data; parts follow each other in the order of fronts.
    fn own(&self, front: &Front) -> Range<usize>;
    /// Entries that the front passes to its parent.
    fn update_size(&self, front: &Front) -> usize;
    /// Multiplications below which a subtree is left to one thread.
    fn task(&self) -> f64;
    /// Visits a front: `children` are its children with their updates, `update` (zeros at first) is what it passes on.
    ///
    /// # Errors
    /// The position of a pivot that is not positive.
    fn visit<'a>(
        &self,
        front: &Front,
        own: &mut [f64],
        children: impl Iterator<Item = (&'a Front, &'a [f64])>,
        update: &mut [f64],
        scratch: &mut Scratch,
    ) -> Result<(), usize>;
}

/// Visits all fronts; `data` is the whole of what they own.
///
/// # Errors
/// The earliest error, in the order of fronts, of the subtrees that were visited.
pub(super) fn upward(
    tree: &FrontTree,
    pass: &impl UpwardPass,
    data: &mut [f64],
) -> Result<(), usize> {
    subtrees(tree, pass, &tree.roots, data).map(|_| ())
}

/// Visits neighbouring subtrees; returns their updates, in order.
fn subtrees(
    tree: &FrontTree,
    pass: &impl UpwardPass,
    roots: &[u32],
    data: &mut [f64],
) -> Result<Vec<Vec<f64>>, usize> {
    let small = tree.flops(roots) < pass.task();
    match *roots {
        [] => Ok(Vec::new()),
        [root] if small => Ok(vec![sequential(tree, pass, root, data)?]),
        [root] => Ok(vec![parallel(tree, pass, root, data)?]),
        _ => {
            let (left, right) = tree.halve(roots);
            let start = pass.own(tree.first_front(left[0])).start;
            let middle = pass.own(tree.first_front(right[0])).start;
            let (left_data, right_data) = data.split_at_mut(middle - start);
            let (a, b) = join(
                || subtrees(tree, pass, left, left_data),
                || subtrees(tree, pass, right, right_data),
            );
            let mut updates = a?;
            updates.extend(b?);
            Ok(updates)
        }
    }
}

/// A large subtree: its children's subtrees in parallel, then its root.
fn parallel(
    tree: &FrontTree,
    pass: &impl UpwardPass,
    root: u32,
    data: &mut [f64],
) -> Result<Vec<f64>, usize> {
    let front = tree.front(root);
    let start = pass.own(tree.first_front(root)).start;
    let (below, own) = data.split_at_mut(pass.own(front).start - start);
    let updates = subtrees(tree, pass, &front.children, below)?;
    let children = (front.children.iter().zip(&updates))
        .map(|(&child, update)| (tree.front(child), update.as_slice()));
    let mut update = vec![0.0; pass.update_size(front)];
    pass.visit(front, own, children, &mut update, &mut Scratch::new())?;
    Ok(update)
}

/// A small subtree. A front's update is made above those of its children and then moved down over them.
fn sequential(
    tree: &FrontTree,
    pass: &impl UpwardPass,
    root: u32,
    data: &mut [f64],
) -> Result<Vec<f64>, usize> {
    let start = pass.own(tree.first_front(root)).start;
    let mut stack: Vec<f64> = Vec::new();
    let mut scratch = Scratch::new();
    for front in tree.subtree(root) {
        let top = stack.len();
        let children = front.children.iter().map(|&child| tree.front(child));
        let base = top - children.clone().map(|c| pass.update_size(c)).sum::<usize>();
        stack.resize(top + pass.update_size(front), 0.0);
        let (held, update) = stack.split_at_mut(top);
        let mut at = base;
        let children = children.map(|child| {
            let range = at..at + pass.update_size(child);
            at = range.end;
            (child, &held[range])
        });
        let own = pass.own(front);
        let own = &mut data[own.start - start..own.end - start];
        pass.visit(front, own, children, update, &mut scratch)?;
        stack.copy_within(top.., base);
        stack.truncate(base + pass.update_size(front));
    }
    Ok(stack)
}
