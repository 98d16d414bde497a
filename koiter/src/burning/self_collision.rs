//! A double layer that keeps out of itself: pushes among the projections, and motion that ends where it would cross.
//!
//! ```text
//! r = Σ w_i x_i   closest points of a vertex and a face, or of two edges       d = ± |r|,  n = ± r / |r|
//! d < g:   Δx_p = m_p⁻¹ c_p (g − d) n / Σ m⁻¹ c²                                g = min(distance, half the height of a face)
//! ```
//!
//! c_p what particle p counts in r (a centre of a quad is the mean of four), + until the pair has passed through since the
//! start of the step. Pushes follow every projection, as those of planes and balls do; what is too
//! close at the start is let out by a tenth of g in a step, so that nothing is thrown apart.
//!
//! Projections undo a part of the pushes, so what is left is tested as a whole: where a pair would meet on its straight way
//! through the step, its corners go only as far as they keep a tenth of their distance ([`additive_ccd`]), again and again
//! until nothing meets; what still does stays where it was. So a surface that does not cross itself never will, but for
//! particles that are held and carried into each other. The paper names self-collision and does not say how.

use super::collision_surface::{CollisionSurface, Nodes};
use super::double_layer::DoubleLayer;
use super::error::BurningError;
use super::numbers::{positive, within};
use crate::Vec3;
use crate::contact::{Aabb, Pair, PairKind, additive_ccd, intersections};

/// Share of the distance that is wanted by which what is too close is let out in a step.
const RECOVERY: f64 = 0.1;
/// Share of the height of the lowest face at a node that others keep away: faces that share no node are no closer in a flat
/// sheet, so neighbours do not push each other.
const ROOM: f64 = 0.5;
/// What is less than this share above the distance that is wanted rubs.
const TOUCHING: f64 = 0.01;
/// Rounds in which motions are shortened; then those that still meet end at once.
const ROUNDS: usize = 8;

/// How a shell keeps out of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelfCollisionOptions {
    /// How far apart parts of the surface are kept [m]; half the height of the triangles there where that is less.
    pub distance: f64,
    /// The share of their motion along each other that touching parts lose in a step.
    pub friction: f64,
}

impl SelfCollisionOptions {
    /// Checks the numbers.
    ///
    /// # Errors
    /// A number out of its range, by the name that scenes give it.
    pub fn check(&self) -> Result<(), BurningError> {
        positive("distance", self.distance)?;
        within("friction", self.friction, [0.0, 1.0], "from 0 to 1")
    }
}

/// A pair that is near.
#[derive(Clone, Copy, Debug)]
struct Near {
    pair: Pair,
    /// Unit vector between the closest points at the start of the step.
    outward: Vec3,
    /// The distance that is wanted [m].
    wanted: f64,
}

/// What a near pair is at some positions.
struct Apart {
    weights: [f64; 4],
    normal: Vec3,
    /// Negative where it has passed through.
    distance: f64,
}

/// The collisions of a double layer with itself.
#[derive(Clone, Debug)]
pub(super) struct SelfCollision {
    options: SelfCollisionOptions,
    nodes: Nodes,
    surface: CollisionSurface,
    /// Of the lowest face at each node, at rest [m].
    heights: Vec<f64>,
    gaps: Vec<f64>,
    near: Vec<Near>,
    /// How much of its motion each corner makes.
    reaches: Vec<f64>,
    /// Number of touching pairs that each corner is in.
    touching: Vec<u32>,
}

impl SelfCollision {
    pub(super) fn new(shell: &DoubleLayer, options: SelfCollisionOptions) -> Self {
        let (nodes, surface) = (Nodes::new(shell), CollisionSurface::new(shell));
        let mut heights = vec![f64::INFINITY; nodes.len()];
        for face in surface.faces() {
            let [a, b, c] = face.map(|node| nodes.value(node, |corner| shell.particles[corner]));
            let longest = [b - a, c - b, a - c].map(|edge| edge.norm());
            let longest = longest.into_iter().fold(0.0, f64::max);
            let height = (b - a).cross(&(c - a)).norm() / longest;
            for &node in face {
                heights[node as usize] = height.min(heights[node as usize]);
            }
        }
        Self {
            gaps: vec![0.0; nodes.len()],
            near: Vec::new(),
            reaches: vec![1.0; shell.num_corners()],
            touching: vec![0; shell.num_corners()],
            options,
            nodes,
            surface,
            heights,
        }
    }

    /// Checks that the start shape does not cross itself.
    ///
    /// # Errors
    /// The quads that do.
    pub(super) fn check_start(shell: &DoubleLayer) -> Result<(), BurningError> {
        let (nodes, surface) = (Nodes::new(shell), CollisionSurface::new(shell));
        let position = |node: u32| nodes.value(node, |corner| shell.particles[corner]);
        let positions: Vec<Vec3> = (0..nodes.len() as u32).map(position).collect();
        let found = intersections(&positions, surface.edges(), surface.faces(), |_, _| false);
        match found.first() {
            None => Ok(()),
            Some(found) => Err(BurningError::CrossesItself {
                quads: [
                    surface.quads_of_edge(found.edge as usize)[0],
                    found.face / 4,
                ],
            }),
        }
    }

    /// Finds what is near at the start of a step, or comes near by less than its gap on the way to `goal`, where particles would
    /// be without springs: what is faster is held back. `share` is that of the part in the step, `shrinkage` the factor on
    /// lengths at a corner.
    pub(super) fn begin(
        &mut self,
        start: &[Vec3],
        goal: &[Vec3],
        share: f64,
        is_face_there: &[bool],
        shrinkage: impl Fn(usize) -> f64,
    ) {
        let distance = self.options.distance;
        self.surface.set_present(is_face_there);
        for (node, (gap, height)) in self.gaps.iter_mut().zip(&self.heights).enumerate() {
            let shrunk = self.nodes.value(node as u32, &shrinkage) * height;
            *gap = distance.min(ROOM * shrunk);
        }
        let (nodes, gaps) = (&self.nodes, &self.gaps);
        let widest = gaps.iter().copied().fold(0.0, f64::max);
        let corner_box = |p: usize| Aabb::around([start[p]], widest);
        let near = |pair: Pair| {
            let at_start = nodes.positions(pair.vertices, start);
            let gap = pair.vertices.map(|node| gaps[node as usize]);
            let gap = gap.into_iter().fold(f64::INFINITY, f64::min);
            let closest = pair.closest(&at_start);
            let before = closest.distance_squared.sqrt();
            if !(before > 0.0 && before < 2.0 * gap) {
                return None;
            }
            let at_goal = nodes.positions(pair.vertices, goal);
            let mean = (0..4)
                .map(|i| 0.25 * (at_goal[i] - at_start[i]))
                .sum::<Vec3>();
            let motion = std::array::from_fn(|i| (at_goal[i] - at_start[i] - mean).norm());
            let is_near = before < gap + approach(pair.kind, motion);
            is_near.then(|| Near {
                pair,
                outward: closest.separation / before,
                wanted: gap.min(before + RECOVERY * share * gap),
            })
        };
        self.near = self.surface.pairs(nodes, corner_box, near);
    }

    /// Moves near pairs apart that have come too close since `start`.
    pub(super) fn push_apart(&self, start: &[Vec3], x: &mut [Vec3], inverse_masses: &[f64]) {
        for near in &self.near {
            let apart = self.apart(near, start, x);
            if apart.distance < near.wanted {
                let carriers = self.nodes.carriers(&near.pair, &apart.weights);
                let change = (near.wanted - apart.distance) * apart.normal;
                carriers.shift(x, inverse_masses, change);
            }
        }
    }

    /// Takes from touching pairs their share of their motion along each other since `start`, a `share` of a step ago.
    pub(super) fn rub(
        &mut self,
        start: &[Vec3],
        x: &mut [Vec3],
        inverse_masses: &[f64],
        share: f64,
    ) {
        let friction = self.options.friction;
        if friction == 0.0 {
            return;
        }
        let touches = |apart: &Apart, near: &Near| apart.distance < (1.0 + TOUCHING) * near.wanted;
        self.touching.fill(0);
        for near in &self.near {
            let apart = self.apart(near, start, x);
            if touches(&apart, near) {
                let carriers = self.nodes.carriers(&near.pair, &apart.weights);
                carriers
                    .particles()
                    .for_each(|p| self.touching[p as usize] += 1);
            }
        }
        for near in &self.near {
            let apart = self.apart(near, start, x);
            if !touches(&apart, near) {
                continue;
            }
            let motion = |node: u32| self.nodes.value(node, |corner| x[corner] - start[corner]);
            let moved = near.pair.vertices.iter().zip(apart.weights);
            let moved: Vec3 = moved.map(|(&node, weight)| weight * motion(node)).sum();
            let along = moved - apart.normal.dot(&moved) * apart.normal;
            let carriers = self.nodes.carriers(&near.pair, &apart.weights);
            // Each of the pairs that a corner is in takes its part of the share.
            let pairs = carriers.particles().map(|p| self.touching[p as usize]);
            let part = share / f64::from(pairs.max().unwrap_or(1));
            let taken = 1.0 - (1.0 - friction).powf(part);
            carriers.shift(x, inverse_masses, -taken * along);
        }
    }

    /// What a near pair is at `x`. It has passed through where its closest points have changed sides and, on the straight
    /// way, met: without that they have gone around a rim.
    fn apart(&self, near: &Near, start: &[Vec3], x: &[Vec3]) -> Apart {
        let at_end = self.nodes.positions(near.pair.vertices, x);
        let closest = near.pair.closest(&at_end);
        let distance = closest.distance_squared.sqrt();
        let (normal, distance) = match distance > 0.0 {
            true => (closest.separation / distance, distance),
            false => (near.outward, 0.0),
        };
        let has_passed = normal.dot(&near.outward) < 0.0 && {
            let at_start = self.nodes.positions(near.pair.vertices, start);
            let motion = std::array::from_fn(|i| at_end[i] - at_start[i]);
            additive_ccd(&near.pair, &at_start, &motion, 0.0).fraction < 1.0
        };
        let sign = if has_passed { -1.0 } else { 1.0 };
        Apart {
            weights: closest.weights,
            normal: sign * normal,
            distance: sign * distance,
        }
    }

    /// Shortens the motion from `start` to `x` where the surface would meet itself; returns how many corners that stops.
    pub(super) fn hold_back(
        &mut self,
        start: &[Vec3],
        x: &mut [Vec3],
        inverse_masses: &[f64],
    ) -> usize {
        let nodes = &self.nodes;
        let ends = &*x;
        let moved = |corner: usize| ends[corner] - start[corner];
        let may_meet = |pair: Pair| {
            let before = pair
                .distance_squared(&nodes.positions(pair.vertices, start))
                .sqrt();
            // Of a centre the mean: so far it goes at most when its corners make shares of their motions.
            let longest = pair
                .vertices
                .map(|node| nodes.value(node, |corner| moved(corner).norm()));
            (before > 0.0 && before <= approach(pair.kind, longest)).then_some(pair)
        };
        let corner_box = |p: usize| Aabb::around([start[p], ends[p]], 0.0);
        let pairs = self.surface.pairs(nodes, corner_box, may_meet);
        self.reaches.fill(1.0);
        for round in 0.. {
            let mut is_done = true;
            for pair in &pairs {
                let reaches = &self.reaches;
                let motion = pair
                    .vertices
                    .map(|node| nodes.value(node, |corner| moved(corner) * reaches[corner]));
                let at_start = nodes.positions(pair.vertices, start);
                let fraction = additive_ccd(pair, &at_start, &motion, 0.0).fraction;
                if fraction >= 1.0 {
                    continue;
                }
                let kept = if round < ROUNDS { fraction } else { 0.0 };
                for corner in nodes.carriers(pair, &[1.0; 4]).particles() {
                    let corner = corner as usize;
                    if inverse_masses[corner] > 0.0 && self.reaches[corner] > 0.0 {
                        self.reaches[corner] *= kept;
                        is_done = false;
                    }
                }
            }
            if is_done {
                break;
            }
        }
        self.shorten(start, x, inverse_masses)
    }

    /// Takes corners as far as they reach, and lattice particles as far as the least of their corners.
    fn shorten(&self, start: &[Vec3], x: &mut [Vec3], inverse_masses: &[f64]) -> usize {
        let is_stopped =
            |corner: &usize| self.reaches[*corner] < 1.0 && x[*corner] != start[*corner];
        let stopped = (0..self.reaches.len()).filter(is_stopped).count();
        let corners = self.reaches.iter().copied();
        let least = |quad: &[u32; 4]| {
            let reaches = quad.map(|corner| self.reaches[corner as usize]);
            reaches.into_iter().fold(1.0, f64::min)
        };
        let lattice = self.nodes.quads().iter().map(least);
        for (particle, reach) in corners.chain(lattice).enumerate() {
            if reach < 1.0 && inverse_masses[particle] > 0.0 {
                let from = start[particle];
                x[particle] = from + reach * (x[particle] - from);
            }
        }
        stopped
    }
}

/// Most by which two primitives approach when their nodes go so far [m].
fn approach(kind: PairKind, moved: [f64; 4]) -> f64 {
    match kind {
        PairKind::VertexFace => moved[0] + moved[1].max(moved[2]).max(moved[3]),
        PairKind::EdgeEdge => moved[0].max(moved[1]) + moved[2].max(moved[3]),
    }
}

#[cfg(test)]
mod tests;
