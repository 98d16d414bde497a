//! A pass over the fronts from the leaves to the roots, in parallel over subtrees.
//!
//! Each front owns a part of the data and passes an update to its parent. Large subtrees run in parallel; small ones are
//! visited front by front, with the updates of finished children on a stack. Children are always taken in the same order:
//! the bits do not depend on the number of threads.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::dense::{Scratch, join};
use super::fronts::{Front, FrontTree};

/// Fronts further below a root than this are left to one thread, which needs no recursion: nested dissection makes trees
/// of a few dozen levels, but an unlucky order can make a chain.
pub(super) const DEEPEST_TASK: usize = 200;

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
        children: impl Iterator<Item = (&'a Front, &'a [f64])> + Clone + Send,
        update: &mut [f64],
        scratch: &mut Scratch,
    ) -> Result<(), usize>;
}

/// Memory of updates, kept from pass to pass: asking the system for it anew costs more than filling it.
#[derive(Debug, Default)]
pub(super) struct Buffers(pub(super) Mutex<Vec<Vec<f64>>>);

impl Buffers {
    /// An empty buffer: the smallest that holds `size` entries, or else the largest, which then grows. So there are never
    /// more buffers than were in use at once.
    fn take(&self, size: usize) -> Vec<f64> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let best = (0..kept.len()).min_by_key(|&k| {
            let capacity = kept[k].capacity();
            (capacity < size, capacity.abs_diff(size))
        });
        let mut buffer = best.map_or_else(Vec::new, |index| kept.swap_remove(index));
        buffer.reserve_exact(size);
        buffer
    }

    fn give_back(&self, mut buffer: Vec<f64>) {
        buffer.clear();
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.push(buffer);
    }
}

/// Visits all fronts; `data` is the whole of what they own.
///
/// # Errors
/// The earliest error, in the order of fronts, of the subtrees that were visited.
pub(super) fn upward(
    tree: &FrontTree,
    pass: &impl UpwardPass,
    buffers: &Buffers,
    data: &mut [f64],
) -> Result<(), usize> {
    let walk = Walk {
        tree,
        pass,
        buffers,
    };
    walk.subtrees(&tree.roots, data, 0).map(|_| ())
}

struct Walk<'a, P> {
    tree: &'a FrontTree,
    pass: &'a P,
    buffers: &'a Buffers,
}

impl<P: UpwardPass> Walk<'_, P> {
    /// Where the data of a subtree starts.
    fn start(&self, root: u32) -> usize {
        self.pass.own(self.tree.first_front(root)).start
    }

    /// Visits neighbouring subtrees, `depth` fronts below a root; returns their updates, in order.
    fn subtrees(
        &self,
        roots: &[u32],
        data: &mut [f64],
        depth: usize,
    ) -> Result<Vec<Vec<f64>>, usize> {
        let small = self.tree.flops(roots) < self.pass.task() || depth > DEEPEST_TASK;
        match *roots {
            [] => Ok(Vec::new()),
            [root] if small => Ok(vec![self.sequential(root, data)?]),
            [root] => Ok(vec![self.parallel(root, data, depth)?]),
            _ => {
                let (left, right) = self.tree.halve(roots);
                let middle = self.start(right[0]) - self.start(left[0]);
                let (left_data, right_data) = data.split_at_mut(middle);
                let (a, b) = join(
                    || self.subtrees(left, left_data, depth),
                    || self.subtrees(right, right_data, depth),
                );
                let mut updates = a?;
                updates.extend(b?);
                Ok(updates)
            }
        }
    }

    /// A large subtree: its children's subtrees in parallel, then its root.
    fn parallel(&self, root: u32, data: &mut [f64], depth: usize) -> Result<Vec<f64>, usize> {
        let front = self.tree.front(root);
        let (below, own) = data.split_at_mut(self.pass.own(front).start - self.start(root));
        let updates = self.subtrees(&front.children, below, depth + 1)?;
        let children = (front.children.iter().zip(&updates))
            .map(|(&child, update)| (self.tree.front(child), update.as_slice()));
        let mut update = self.buffers.take(self.pass.update_size(front));
        update.resize(self.pass.update_size(front), 0.0);
        (self.pass).visit(front, own, children, &mut update, &mut Scratch::new())?;
        updates.into_iter().for_each(|u| self.buffers.give_back(u));
        Ok(self.passed_on(update))
    }

    /// A small subtree. A front's update is made above those of its children and then moved down over them.
    fn sequential(&self, root: u32, data: &mut [f64]) -> Result<Vec<f64>, usize> {
        let (tree, pass) = (self.tree, self.pass);
        let start = self.start(root);
        let mut stack = self.buffers.take(pass.update_size(tree.front(root)));
        let mut scratch = Scratch::new();
        for front in tree.subtree(root) {
            let top = stack.len();
            let children = front.children.iter().map(|&child| tree.front(child));
            let base = top - children.clone().map(|c| pass.update_size(c)).sum::<usize>();
            stack.resize(top + pass.update_size(front), 0.0);
            let (held, update) = stack.split_at_mut(top);
            let children = children.scan(base, |at, child| {
                let update = &held[*at..*at + pass.update_size(child)];
                *at += update.len();
                Some((child, update))
            });
            let own = pass.own(front);
            let own = &mut data[own.start - start..own.end - start];
            pass.visit(front, own, children, update, &mut scratch)?;
            stack.copy_within(top.., base);
            stack.truncate(base + pass.update_size(front));
        }
        Ok(self.passed_on(stack))
    }

    /// Roots pass on nothing, and their buffers serve the next: unknowns that are coupled to nothing are as many roots, and
    /// a search among as many buffers at each would take the square of the time.
    fn passed_on(&self, update: Vec<f64>) -> Vec<f64> {
        if !update.is_empty() {
            return update;
        }
        self.buffers.give_back(update);
        Vec::new()
    }
}
