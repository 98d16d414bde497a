//! Which primitives may come near each other: a tree of axis-aligned boxes over Morton-sorted leaves.
//!
//! The tree's shape is that of an implicit binary heap over the sorted leaves, so it has no pointers and is refitted from
//! the leaves upwards in one sweep. Its quality follows the order of the leaves; the order is kept while primitives move
//! little and made anew otherwise ([`BoxTree::rebuild`]).

use std::sync::atomic::{AtomicUsize, Ordering};

use super::boxes::{Aabb, TreeBox};
use crate::assembly::parallel_map;

/// A binary tree of boxes over a set of primitives.
#[derive(Clone, Debug, Default)]
pub struct BoxTree {
    /// Primitive of each leaf.
    leaves: Vec<u32>,
    /// Number of leaves, rounded up to a power of two.
    width: usize,
    /// Node 1 is the root; the children of node k are 2k and 2k + 1; leaf i is node `width + i`.
    boxes: Vec<TreeBox>,
}

/// The bits of `x` (21 of them) spread to every third place.
fn spread(x: u64) -> u64 {
    let mut x = x & 0x1f_ffff;
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    (x | x << 2) & 0x1249249249249249
}

impl BoxTree {
    /// Sorts primitives along a Morton curve through their centres and fits the tree.
    pub fn rebuild(&mut self, boxes: &[Aabb]) {
        let all = boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(b));
        let code = |b: &Aabb| -> u64 {
            (0..3).fold(0, |code, axis| {
                let extent = all.high[axis] - all.low[axis];
                let centre = 0.5 * (b.low[axis] + b.high[axis]) - all.low[axis];
                let cell = if extent > 0.0 {
                    (centre / extent * 2_097_151.0) as u64
                } else {
                    0
                };
                code | spread(cell) << axis
            })
        };
        let mut keyed: Vec<(u64, u32)> = boxes
            .iter()
            .enumerate()
            .map(|(i, b)| (code(b), i as u32))
            .collect();
        keyed.sort_unstable();
        self.leaves = keyed.into_iter().map(|(_, leaf)| leaf).collect();
        self.width = boxes.len().next_power_of_two();
        self.refit(boxes);
    }

    /// Fits the tree to moved boxes of the same primitives.
    pub fn refit(&mut self, boxes: &[Aabb]) {
        self.boxes.clear();
        self.boxes.resize(2 * self.width.max(1), TreeBox::EMPTY);
        for (i, &leaf) in self.leaves.iter().enumerate() {
            self.boxes[self.width + i] = TreeBox::containing(&boxes[leaf as usize]);
        }
        for node in (1..self.width).rev() {
            self.boxes[node] = self.boxes[2 * node].union(&self.boxes[2 * node + 1]);
        }
    }

    /// Number of primitives.
    pub fn len(&self) -> usize {
        self.leaves.len()
    }

    /// Whether there is no primitive.
    pub fn is_empty(&self) -> bool {
        self.leaves.is_empty()
    }

    /// Sum of the half surface areas of all inner boxes [m²]: grows as the order of the leaves gets worse.
    pub fn cost(&self) -> f64 {
        // None of these where there is no primitive.
        let end = self.width.min(self.boxes.len());
        self.boxes[1.min(end)..end]
            .iter()
            .filter(|b| b.low[0] <= b.high[0])
            .map(|b| {
                let [x, y, z] = std::array::from_fn(|k| f64::from(b.high[k] - b.low[k]));
                x * y + y * z + z * x
            })
            .sum()
    }

    /// Calls `found` with every primitive whose box overlaps `query`, up to the rounding of single precision, in the order
    /// of the leaves.
    #[inline]
    pub fn overlapping(&self, query: &Aabb, found: impl FnMut(u32)) {
        self.overlapping_from(0, &TreeBox::containing(query), found);
    }

    /// The same among the leaves from number `first` on.
    #[inline]
    fn overlapping_from(&self, first: usize, query: &TreeBox, mut found: impl FnMut(u32)) {
        if first >= self.leaves.len() {
            return;
        }
        // Each entry is a node and the number of levels below it.
        let mut stack = [(1usize, self.width.trailing_zeros()); 64];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (node, levels) = stack[depth];
            let past_last_leaf = ((node + 1) << levels) - self.width;
            if past_last_leaf <= first || !self.boxes[node].overlaps(query) {
                continue;
            }
            if levels == 0 {
                found(self.leaves[node - self.width]);
            } else {
                stack[depth] = (2 * node + 1, levels - 1);
                stack[depth + 1] = (2 * node, levels - 1);
                depth += 2;
            }
        }
    }

    /// What `check` makes of all pairs `(query, primitive)` with overlapping boxes, by query and then by leaf; `None` if
    /// more than `limit` pairs are checked. `skip` tells pairs that do not count.
    pub fn pairs<T: Send>(
        &self,
        queries: &[Aabb],
        limit: usize,
        skip: impl Fn(u32, u32) -> bool + Sync + Send,
        check: impl Fn(u32, u32) -> Option<T> + Sync + Send,
    ) -> Option<Vec<T>> {
        chunked(queries.len(), limit, |query, chunk| {
            self.overlapping(&queries[query], |leaf| {
                if !skip(query as u32, leaf) {
                    chunk.add(check(query as u32, leaf));
                }
            });
        })
    }

    /// The same for all pairs of different primitives of the tree, each once with the smaller index first, in the order
    /// of the leaves.
    pub fn self_pairs<T: Send>(
        &self,
        limit: usize,
        skip: impl Fn(u32, u32) -> bool + Sync + Send,
        check: impl Fn(u32, u32) -> Option<T> + Sync + Send,
    ) -> Option<Vec<T>> {
        chunked(self.leaves.len(), limit, |leaf, chunk| {
            let own = self.leaves[leaf];
            self.overlapping_from(leaf + 1, &self.boxes[self.width + leaf], |other| {
                let (a, b) = (own.min(other), own.max(other));
                if !skip(a, b) {
                    chunk.add(check(a, b));
                }
            });
        })
    }
}

/// What a task found.
struct Chunk<T> {
    found: Vec<T>,
    checked: usize,
}

impl<T> Chunk<T> {
    #[inline]
    fn add(&mut self, item: Option<T>) {
        self.checked += 1;
        self.found.extend(item);
    }
}

/// What `search` finds for `0..count`, in order, by tasks of [`QUERY_CHUNK`]; `None` if more than `limit` were checked,
/// which ends the search early and does not depend on the order of tasks.
fn chunked<T: Send>(
    count: usize,
    limit: usize,
    search: impl Fn(usize, &mut Chunk<T>) + Sync + Send,
) -> Option<Vec<T>> {
    let total = AtomicUsize::new(0);
    let chunks = parallel_map(count.div_ceil(QUERY_CHUNK), |chunk| {
        let mut out = Chunk {
            found: Vec::new(),
            checked: 0,
        };
        for query in chunk * QUERY_CHUNK..((chunk + 1) * QUERY_CHUNK).min(count) {
            let before = out.checked;
            search(query, &mut out);
            let checked = out.checked - before;
            if total.fetch_add(checked, Ordering::Relaxed) + checked > limit {
                break;
            }
        }
        out.found
    });
    (total.into_inner() <= limit).then(|| chunks.into_iter().flatten().collect())
}

/// Queries a task takes at a time.
const QUERY_CHUNK: usize = 128;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;

    fn boxes(count: usize, seed: f64) -> Vec<Aabb> {
        (0..count)
            .map(|i| {
                let at = |k: f64| ((i as f64 + seed) * k).sin() * 2.0;
                Aabb::around([Vec3::new(at(1.3), at(2.7), at(3.1))], 0.2)
            })
            .collect()
    }

    #[test]
    fn the_tree_finds_exactly_the_overlapping_boxes() {
        for count in [0, 1, 2, 3, 64, 301] {
            let (a, b) = (boxes(count, 0.3), boxes(97, 0.7));
            let mut tree = BoxTree::default();
            tree.rebuild(&a);
            let every = |a, b| Some([a, b]);
            let mut found = (tree.pairs(&b, usize::MAX, |_, _| false, every)).unwrap();
            found.sort_unstable();
            let mut expected = Vec::new();
            for (j, q) in b.iter().enumerate() {
                expected.extend(
                    (0..count)
                        .filter(|&i| q.overlaps(&a[i]))
                        .map(|i| [j as u32, i as u32]),
                );
            }
            assert_eq!(found, expected);
            let mut pairs = (tree.self_pairs(usize::MAX, |_, _| false, every)).unwrap();
            pairs.sort_unstable();
            let mut expected = Vec::new();
            for i in 0..count {
                let later = (i + 1..count).filter(|&j| a[i].overlaps(&a[j]));
                expected.extend(later.map(|j| [i as u32, j as u32]));
            }
            assert_eq!(pairs, expected);
            let bounded = |limit| tree.self_pairs(limit, |_, _| false, every).is_some();
            assert!(
                bounded(expected.len()) && (expected.is_empty() || !bounded(expected.len() - 1))
            );
        }
    }

    #[test]
    fn a_refitted_tree_is_still_right() {
        let (a, moved) = (boxes(200, 0.1), boxes(200, 5.0));
        let mut tree = BoxTree::default();
        tree.rebuild(&a);
        tree.refit(&moved);
        let mut count = 0;
        tree.overlapping(&moved[7], |_| count += 1);
        assert_eq!(
            count,
            moved.iter().filter(|b| b.overlaps(&moved[7])).count()
        );
    }
}
