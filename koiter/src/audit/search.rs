//! Which faces come near a segment: a binary tree of boxes, halved at the median of their widest direction.

use std::ops::Range;

use crate::Vec3;

/// Faces a leaf holds. Between 2 and 16 the time hardly changes.
const LEAF: usize = 4;

/// A tree of boxes around faces.
#[derive(Debug)]
pub(super) struct BoxTree {
    nodes: Vec<Node>,
    /// Faces, leaf by leaf.
    faces: Vec<u32>,
}

#[derive(Debug)]
struct Node {
    low: Vec3,
    high: Vec3,
    /// Faces below this node, in the tree's order.
    range: Range<usize>,
    /// Where the second child is; the first follows its parent. Leaves have none.
    second: Option<usize>,
}

struct Item {
    face: u32,
    low: Vec3,
    high: Vec3,
}

impl BoxTree {
    /// Over the faces numbered `chosen`.
    pub(super) fn new(faces: &[[u32; 3]], chosen: &[u32], x: &[Vec3]) -> Self {
        let item = |&face: &u32| {
            let [a, b, c] = faces[face as usize].map(|v| x[v as usize]);
            Item {
                face,
                low: a.inf(&b).inf(&c),
                high: a.sup(&b).sup(&c),
            }
        };
        let mut items: Vec<Item> = chosen.iter().map(item).collect();
        let mut tree = Self {
            nodes: Vec::with_capacity(items.len()),
            faces: Vec::new(),
        };
        if !items.is_empty() {
            tree.build(&mut items, 0);
        }
        tree.faces = items.iter().map(|item| item.face).collect();
        tree
    }

    fn build(&mut self, items: &mut [Item], first: usize) {
        let around =
            |low: Vec3, high: Vec3, item: &Item| (low.inf(&item.low), high.sup(&item.high));
        let (low, high) = items
            .iter()
            .fold((items[0].low, items[0].high), |(low, high), item| {
                around(low, high, item)
            });
        let node = self.nodes.len();
        let range = first..first + items.len();
        self.nodes.push(Node {
            low,
            high,
            range,
            second: None,
        });
        if items.len() <= LEAF {
            return;
        }
        let axis = (high - low).imax();
        let middle = items.len() / 2;
        let at = |item: &Item| item.low[axis] + item.high[axis];
        items.select_nth_unstable_by(middle, |a, b| {
            at(a).total_cmp(&at(b)).then(a.face.cmp(&b.face))
        });
        let (lower, upper) = items.split_at_mut(middle);
        self.build(lower, first);
        self.nodes[node].second = Some(self.nodes.len());
        self.build(upper, first + middle);
    }

    /// Calls `see` with every face of the leaves whose box the box of a segment overlaps.
    pub(super) fn visit(&self, segment: &[Vec3; 2], mut see: impl FnMut(u32)) {
        let (low, high) = (segment[0].inf(&segment[1]), segment[0].sup(&segment[1]));
        let overlaps =
            |node: &Node| (0..3).all(|k| node.low[k] <= high[k] && low[k] <= node.high[k]);
        let mut open = vec![0];
        while let Some(index) = open.pop() {
            let Some(node) = self.nodes.get(index).filter(|node| overlaps(node)) else {
                continue;
            };
            match node.second {
                Some(second) => open.extend([second, index + 1]),
                None => self.faces[node.range.clone()]
                    .iter()
                    .for_each(|&face| see(face)),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_face_near_a_segment_is_seen_once() {
        // Strips of every size, at places without order.
        let mut state = 7u32;
        let mut random = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        let x: Vec<Vec3> = (0..600)
            .map(|_| Vec3::new(random(), random(), 0.1 * random()))
            .collect();
        let faces: Vec<[u32; 3]> = (0..200).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        let chosen: Vec<u32> = (0..200).filter(|f| f % 3 != 0).collect();
        let tree = BoxTree::new(&faces, &chosen, &x);
        for segment in x.chunks_exact(2) {
            let mut seen = Vec::new();
            tree.visit(&[segment[0], segment[1]], |face| seen.push(face));
            let count = seen.len();
            seen.sort_unstable();
            seen.dedup();
            assert_eq!(seen.len(), count);
            let (low, high) = (segment[0].inf(&segment[1]), segment[0].sup(&segment[1]));
            for &face in &chosen {
                let corners = faces[face as usize].map(|v| x[v as usize]);
                let near = (0..3).all(|k| {
                    corners.iter().any(|c| c[k] <= high[k])
                        && corners.iter().any(|c| c[k] >= low[k])
                });
                assert!(!near || seen.contains(&face));
            }
        }
        BoxTree::new(&faces, &[], &x).visit(&[Vec3::zeros(), Vec3::x()], |_| panic!("it is empty"));
    }
}
