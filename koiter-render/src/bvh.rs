//! A bounding volume hierarchy that answers one question: does anything lie between here and there?
//!
//! Four children a node and four triangles a leaf, each four tested at once. Built by the surface area heuristic on
//! binned centroids (Wald 2007), anew for every frame: cloth moves too much for refitting to pay.

use wide::f32x4;

use crate::surface::Surface;
use crate::vector::Vec3;

const BINS: usize = 12;
/// Subtrees with fewer triangles are built by one thread.
const PARALLEL_ABOVE: usize = 4096;
/// Below this depth ranges are halved, which bounds the depth by 32 + log₄ of the number of triangles, 48 in all.
const MAX_UNEVEN_DEPTH: usize = 32;
/// Room for three waiting children at each of 48 levels, and four.
const STACK: usize = 160;
const LEAF: u32 = 1 << 31;
/// Coordinate of the box of a missing child: no ray of ours is that long.
const FAR: f32 = 1e30;

/// The hierarchy.
pub(crate) struct Bvh {
    nodes: Vec<Node>,
    blocks: Vec<Block>,
}

/// Boxes of up to four children; `child` is a node, or a block with the bit [`LEAF`].
struct Node {
    min: [f32x4; 3],
    max: [f32x4; 3],
    child: [u32; 4],
}

/// Up to four triangles: corner and two edges. Missing ones have no area.
struct Block {
    corner: [f32x4; 3],
    edge_1: [f32x4; 3],
    edge_2: [f32x4; 3],
}

#[derive(Clone, Copy)]
struct Item {
    min: Vec3,
    max: Vec3,
    center: [f32; 3],
    face: u32,
}

impl Bvh {
    pub(crate) fn build(surface: &Surface) -> Self {
        let mut items: Vec<Item> = (0..surface.faces.len() as u32)
            .map(|face| {
                let [a, b, c] = surface.corners(face);
                let (min, max) = (a.min(b).min(c), a.max(b).max(c));
                Item {
                    min,
                    max,
                    center: ((min + max) * 0.5).to_array(),
                    face,
                }
            })
            .collect();
        let mut bvh = Self {
            nodes: Vec::new(),
            blocks: Vec::new(),
        };
        if !items.is_empty() {
            bvh = build_node(surface, &mut items, 0);
        }
        bvh
    }

    /// Whether a triangle crosses the ray at a distance between 0 and `reach`. `direction` has unit length.
    pub(crate) fn is_blocked(&self, origin: Vec3, direction: Vec3, reach: f32) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        let from = origin.to_array().map(f32x4::splat);
        let along = direction.to_array().map(f32x4::splat);
        // A component of zero would give 0 · ∞ on the face of a box.
        let inverse = direction.to_array().map(|d| {
            f32x4::splat(if d.abs() > 1e-12 {
                1.0 / d
            } else {
                1e12f32.copysign(d)
            })
        });
        let reach_4 = f32x4::splat(reach);
        let mut stack = [0u32; STACK];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let node = &self.nodes[stack[waiting] as usize];
            let mut enter = f32x4::ZERO;
            let mut leave = reach_4;
            for axis in 0..3 {
                let t_0 = (node.min[axis] - from[axis]) * inverse[axis];
                let t_1 = (node.max[axis] - from[axis]) * inverse[axis];
                enter = enter.fast_max(t_0.fast_min(t_1));
                leave = leave.fast_min(t_0.fast_max(t_1));
            }
            let mut hits = enter.simd_le(leave).to_bitmask();
            while hits != 0 {
                let child = node.child[hits.trailing_zeros() as usize];
                hits &= hits - 1;
                if child & LEAF == 0 {
                    stack[waiting] = child;
                    waiting += 1;
                } else if self.blocks[(child & !LEAF) as usize].is_crossed(from, along, reach_4) {
                    return true;
                }
            }
        }
        false
    }
}

impl Block {
    /// Möller and Trumbore 1997, for four triangles, both sides.
    #[inline]
    fn is_crossed(&self, from: [f32x4; 3], along: [f32x4; 3], reach: f32x4) -> bool {
        let p = cross(along, self.edge_2);
        let determinant = dot(self.edge_1, p);
        let inverse = f32x4::ONE / determinant;
        let offset = [0, 1, 2].map(|axis| from[axis] - self.corner[axis]);
        let u = dot(offset, p) * inverse;
        let q = cross(offset, self.edge_1);
        let v = dot(along, q) * inverse;
        let t = dot(self.edge_2, q) * inverse;
        // Without area the inverse is infinite and u, v, t are NaN or infinite: one of the comparisons fails.
        let zero = f32x4::ZERO;
        let inside = u.simd_ge(zero) & v.simd_ge(zero) & (u + v).simd_le(f32x4::ONE);
        (inside & t.simd_gt(zero) & t.simd_le(reach)).any()
    }
}

#[inline]
fn dot(a: [f32x4; 3], b: [f32x4; 3]) -> f32x4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
fn cross(a: [f32x4; 3], b: [f32x4; 3]) -> [f32x4; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Builds the subtree of some triangles; its root is node 0.
fn build_node(surface: &Surface, items: &mut [Item], depth: usize) -> Bvh {
    let is_large = items.len() > PARALLEL_ABOVE;
    let mut ranges: Vec<&mut [Item]> = vec![items];
    while ranges.len() < 4 {
        let largest = (0..ranges.len())
            .max_by_key(|&i| (ranges[i].len(), i))
            .filter(|&i| ranges[i].len() > 4);
        let Some(largest) = largest else { break };
        let range = ranges.swap_remove(largest);
        let middle = split(range, depth);
        let (left, right) = range.split_at_mut(middle);
        ranges.extend([left, right]);
    }
    let boxes: Vec<(Vec3, Vec3)> = ranges.iter().map(|range| bounding_box(range)).collect();
    let lane = |pick: &dyn Fn(&(Vec3, Vec3)) -> f32| {
        f32x4::from(std::array::from_fn::<f32, 4, _>(|i| {
            boxes.get(i).map_or(FAR, pick)
        }))
    };
    let mut bvh = Bvh {
        nodes: Vec::new(),
        blocks: Vec::new(),
    };
    bvh.nodes.push(Node {
        min: [lane(&|b| b.0.x), lane(&|b| b.0.y), lane(&|b| b.0.z)],
        max: [lane(&|b| b.1.x), lane(&|b| b.1.y), lane(&|b| b.1.z)],
        child: [LEAF; 4],
    });
    let mut subtrees: Vec<Option<Bvh>> = ranges.iter().map(|_| None).collect();
    let build = |(range, subtree): (&mut &mut [Item], &mut Option<Bvh>)| {
        if range.len() > 4 {
            *subtree = Some(build_node(surface, range, depth + 1));
        }
    };
    if is_large {
        use rayon::prelude::*;
        ranges.par_iter_mut().zip(&mut subtrees).for_each(build);
    } else {
        ranges.iter_mut().zip(&mut subtrees).for_each(build);
    }
    for (i, (range, subtree)) in ranges.iter().zip(subtrees).enumerate() {
        bvh.nodes[0].child[i] = match subtree {
            Some(subtree) => bvh.append(subtree),
            None => {
                bvh.blocks.push(block(surface, range));
                LEAF | (bvh.blocks.len() - 1) as u32
            }
        };
    }
    bvh
}

impl Bvh {
    /// Adds another tree and returns its root.
    fn append(&mut self, mut other: Bvh) -> u32 {
        let (nodes, blocks) = (self.nodes.len() as u32, self.blocks.len() as u32);
        for node in &mut other.nodes {
            node.child = node
                .child
                .map(|child| child + if child & LEAF == 0 { nodes } else { blocks });
        }
        self.nodes.append(&mut other.nodes);
        self.blocks.append(&mut other.blocks);
        nodes
    }
}

fn block(surface: &Surface, items: &[Item]) -> Block {
    let corners: [[Vec3; 3]; 4] = std::array::from_fn(|i| {
        items
            .get(i)
            .map_or([Vec3::default(); 3], |item| surface.corners(item.face))
    });
    let lanes = |pick: &dyn Fn([Vec3; 3]) -> Vec3| {
        let vectors = corners.map(|triangle| pick(triangle).to_array());
        [0, 1, 2].map(|axis| f32x4::from(vectors.map(|vector| vector[axis])))
    };
    Block {
        corner: lanes(&|t| t[0]),
        edge_1: lanes(&|t| t[1] - t[0]),
        edge_2: lanes(&|t| t[2] - t[0]),
    }
}

fn bounding_box(items: &[Item]) -> (Vec3, Vec3) {
    items[1..]
        .iter()
        .fold((items[0].min, items[0].max), |(min, max), item| {
            (min.min(item.min), max.max(item.max))
        })
}

fn half_area((min, max): (Vec3, Vec3)) -> f32 {
    let size = max - min;
    size.x * size.y + size.y * size.z + size.z * size.x
}

/// Reorders the triangles and returns where to cut them in two; neither half is empty.
fn split(items: &mut [Item], depth: usize) -> usize {
    let mut low = [f32::INFINITY; 3];
    let mut high = [f32::NEG_INFINITY; 3];
    for item in items.iter() {
        for axis in 0..3 {
            low[axis] = low[axis].min(item.center[axis]);
            high[axis] = high[axis].max(item.center[axis]);
        }
    }
    let extent = |axis: usize| high[axis] - low[axis];
    let axis = (1..3).fold(0, |best, axis| {
        if extent(axis) > extent(best) {
            axis
        } else {
            best
        }
    });
    if depth < MAX_UNEVEN_DEPTH && extent(axis) > 0.0 {
        let to_bin = BINS as f32 / extent(axis);
        let bin = |item: &Item| (((item.center[axis] - low[axis]) * to_bin) as usize).min(BINS - 1);
        if let Some(cut) = cheapest_cut(items, bin) {
            return partition(items, |item| bin(item) < cut);
        }
    }
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        a.center[axis]
            .total_cmp(&b.center[axis])
            .then(a.face.cmp(&b.face))
    });
    middle
}

/// The bin before which cutting costs least, `None` when all triangles fall into one bin.
fn cheapest_cut(items: &[Item], bin: impl Fn(&Item) -> usize) -> Option<usize> {
    let nothing = (
        Vec3::from_f64([f64::INFINITY; 3]),
        Vec3::from_f64([f64::NEG_INFINITY; 3]),
    );
    let mut boxes = [nothing; BINS];
    let mut counts = [0usize; BINS];
    for item in items {
        let b = bin(item);
        boxes[b] = (boxes[b].0.min(item.min), boxes[b].1.max(item.max));
        counts[b] += 1;
    }
    let join = |a: (Vec3, Vec3), b: (Vec3, Vec3)| (a.0.min(b.0), a.1.max(b.1));
    let cost = |range: std::ops::Range<usize>| {
        let count: usize = counts[range.clone()].iter().sum();
        (count > 0).then(|| count as f32 * half_area(range.map(|b| boxes[b]).fold(nothing, join)))
    };
    (1..BINS)
        .filter_map(|cut| Some((cut, cost(0..cut)? + cost(cut..BINS)?)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(cut, _)| cut)
}

/// Moves what fits `is_left` to the front and returns how many do.
fn partition(items: &mut [Item], is_left: impl Fn(&Item) -> bool) -> usize {
    let mut count = 0;
    for i in 0..items.len() {
        if is_left(&items[i]) {
            items.swap(i, count);
            count += 1;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::vec3;
    use crate::{Bounds, Camera, CameraView, Ground, PartView, RenderOptions, Scene};

    fn surface_of(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Surface {
        let scene = Scene {
            parts: vec![PartView::shell(positions, faces)],
            ground: Ground::None,
        };
        // A camera for a box of radius one about the origin leaves the coordinates as they are.
        let side = 1.0 / 3f64.sqrt();
        let bounds = Bounds {
            min: [-side; 3],
            max: [side; 3],
        };
        let options = RenderOptions::new(4, 4, Camera::fit(&bounds, CameraView::Iso, 1.0));
        Surface::gather(&scene, &bounds, &options, (0.0, 1.0))
    }

    /// Numbers between −1 and 1 from a linear congruence.
    fn noise(state: &mut u64) -> f64 {
        *state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (*state >> 33) as f64 / (1u64 << 30) as f64 - 1.0
    }

    #[test]
    fn rays_meet_the_same_triangles_as_without_a_hierarchy() {
        let mut state = 7;
        let mut positions = Vec::new();
        for _ in 0..6000 {
            let center: [f64; 3] = std::array::from_fn(|_| noise(&mut state));
            for _ in 0..3 {
                positions.push(center.map(|c| c + 0.1 * noise(&mut state)));
            }
        }
        let faces: Vec<[u32; 3]> = (0..6000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let surface = surface_of(&positions, &faces);
        let bvh = Bvh::build(&surface);
        let mut blocked = 0;
        for _ in 0..300 {
            let point = |state: &mut u64| {
                vec3(
                    noise(state) as f32,
                    noise(state) as f32,
                    noise(state) as f32,
                )
            };
            let (origin, direction) = (
                point(&mut state),
                point(&mut state).normalized_or(vec3(1.0, 0.0, 0.0)),
            );
            let one_by_one = (0..6000).any(|face| {
                let item = Item {
                    min: origin,
                    max: origin,
                    center: [0.0; 3],
                    face,
                };
                let [from, along] = [origin, direction].map(|v| v.to_array().map(f32x4::splat));
                block(&surface, &[item]).is_crossed(from, along, f32x4::splat(0.7))
            });
            assert_eq!(bvh.is_blocked(origin, direction, 0.7), one_by_one);
            blocked += usize::from(one_by_one);
        }
        assert!(
            (50..290).contains(&blocked),
            "{blocked} of 300 rays: the test says little"
        );
    }

    #[test]
    fn coincident_triangles_and_axis_parallel_rays_are_no_trouble() {
        let positions = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
        let bvh = Bvh::build(&surface_of(&positions, &[[0, 1, 2]; 1000]));
        let (down, side) = (vec3(0.0, 0.0, -1.0), vec3(1.0, 0.0, 0.0));
        assert!(bvh.is_blocked(vec3(0.0, 0.0, 1.0), down, 2.0));
        assert!(!bvh.is_blocked(vec3(0.0, 0.0, 1.0), down, 0.5));
        assert!(!bvh.is_blocked(vec3(0.0, 0.0, 1.0), side, 2.0));
    }
}
