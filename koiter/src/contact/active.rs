//! Contact of all bodies: what may touch, what acts, and how strongly.

use super::barrier::LogBarrier;
use super::candidates::Candidates;
use super::collision_mesh::CollisionMesh;
use super::friction_table::FrictionTable;
use super::neighbours::list_margin;
use super::pair::{Pair, PairKind, mollify};
use super::plane::CollisionPlane;
use super::search::Limiter;
use crate::Vec3;
use crate::assembly::{DofLayout, Energy, parallel_map};
use crate::geometry::ClosestPoints;

/// The mollifier's threshold relative to the squared rest lengths of the two edges ("Incremental Potential Contact").
const MOLLIFIER_THRESHOLD: f64 = 1e-3;

/// The barrier is stiffened by at most this factor over a run.
const LARGEST_STIFFENING: f64 = 1e6;

/// Contact of all bodies of a scene.
pub struct Contact {
    pub(super) mesh: CollisionMesh,
    pub(super) planes: Vec<CollisionPlane>,
    pub(super) friction: FrictionTable,
    pub(super) layout: DofLayout,
    pub(super) d_hat: f64,
    pub(super) kappa: f64,
    pub(super) largest_kappa: f64,
    /// What lists of neighbours look further than the barrier reaches [m].
    pub(super) margin: f64,
    pub(super) candidates: Candidates,
    /// Pairs that do not collide, in order ([`Self::put_to_sleep`]).
    pub(super) asleep: Vec<Pair>,
    /// Candidates whose barrier acts at the last refresh.
    pub(super) active: Vec<Pair>,
    pub(super) active_planes: Vec<ActiveVertex>,
    pub(super) smallest_gap: f64,
    /// Where that is.
    pub(super) closest: Option<Limiter>,
    pub(super) limiter: Option<Limiter>,
    /// The fraction of the last motion that was allowed.
    pub(super) last_bound: f64,
}

/// What the barrier of a pair needs.
pub(super) struct ActivePair {
    pub(super) positions: [Vec3; 4],
    pub(super) closest: ClosestPoints,
    pub(super) barrier: LogBarrier,
    pub(super) threshold: f64,
    /// Area the pair stands for [m²].
    pub(super) area: f64,
}

pub(super) struct ActiveVertex {
    pub(super) vertex: u32,
    pub(super) plane: usize,
    pub(super) distance: f64,
}

impl Contact {
    /// `d_hat` [m] gap at which the barrier begins, `kappa` [J/m²] its stiffness an area.
    pub fn new(
        mesh: CollisionMesh,
        planes: Vec<CollisionPlane>,
        layout: DofLayout,
        d_hat: f64,
        kappa: f64,
    ) -> Self {
        Self {
            friction: FrictionTable::new(&mesh, &planes),
            margin: list_margin(&mesh, d_hat),
            mesh,
            planes,
            layout,
            d_hat,
            kappa,
            largest_kappa: kappa * LARGEST_STIFFENING,
            candidates: Candidates::default(),
            asleep: Vec::new(),
            active: Vec::new(),
            active_planes: Vec::new(),
            smallest_gap: f64::INFINITY,
            closest: None,
            limiter: None,
            last_bound: 1.0,
        }
    }

    /// The collision mesh.
    pub fn mesh(&self) -> &CollisionMesh {
        &self.mesh
    }

    /// Leaves of a body only these of its faces: see [`CollisionMesh::set_present`].
    pub fn set_present(&mut self, body: usize, is_there: &[bool]) {
        self.mesh.set_present(body, is_there);
        self.forget_search();
        self.active.clear();
    }

    /// Barrier stiffness [J/m²].
    pub fn kappa(&self) -> f64 {
        self.kappa
    }

    /// Restores the barrier stiffness of an earlier state.
    pub fn set_kappa(&mut self, kappa: f64) {
        self.kappa = kappa;
    }

    /// Begins a step at `q`: finds the pairs in reach as if there had been no search before. The shape of the trees and the
    /// list of neighbours decide the order of the pairs, and with it the last bits of every sum over them.
    pub fn begin_step(&mut self, q: &[f64]) {
        let is_new = self.candidates.searches == 1
            && self
                .candidates
                .neighbours
                .were_listed_at(&self.positions(q));
        if !is_new {
            self.forget_search();
        }
        self.prepare(q);
    }

    fn forget_search(&mut self) {
        self.candidates = Candidates::default();
    }

    /// Positions of the vertices of the collision mesh in `q`.
    pub fn positions(&self, q: &[f64]) -> Vec<Vec3> {
        (0..self.mesh.vertices.len() as u32)
            .map(|v| self.mesh.position(v, q))
            .collect()
    }

    pub(super) fn touching_distance(&self, pair: &Pair) -> f64 {
        let other = if pair.kind == PairKind::VertexFace {
            1
        } else {
            2
        };
        self.mesh.offset(pair.vertices[0]) + self.mesh.offset(pair.vertices[other])
    }

    /// Gap between the surfaces of a pair, by positions of the vertices of the collision mesh [m].
    #[inline]
    pub(super) fn gap(&self, pair: &Pair, x: &[Vec3]) -> f64 {
        let positions = pair.vertices.map(|v| x[v as usize]);
        pair.distance_squared(&positions).sqrt() - self.touching_distance(pair)
    }

    #[inline]
    pub(super) fn pair_positions(&self, pair: &Pair, q: &[f64]) -> [Vec3; 4] {
        pair.vertices.map(|v| self.mesh.position(v, q))
    }

    #[inline]
    pub(super) fn pair_barrier(&self, pair: &Pair) -> LogBarrier {
        LogBarrier::new(self.touching_distance(pair), self.d_hat)
    }

    pub(super) fn activate(&self, pair: &Pair, q: &[f64]) -> ActivePair {
        let positions = self.pair_positions(pair, q);
        ActivePair {
            closest: pair.closest(&positions),
            positions,
            barrier: self.pair_barrier(pair),
            threshold: self.mollifier_threshold(pair),
            area: self.area(pair),
        }
    }

    pub(super) fn pair_value(&self, pair: &Pair, q: &[f64]) -> f64 {
        let positions = self.pair_positions(pair, q);
        let (barrier, squared) = (self.pair_barrier(pair), pair.distance_squared(&positions));
        if !barrier.is_active(squared) {
            return 0.0;
        }
        let mollifier = mollify(&positions, self.mollifier_threshold(pair));
        self.kappa * self.area(pair) * mollifier * barrier.value(squared)
    }

    fn mollifier_threshold(&self, pair: &Pair) -> f64 {
        if pair.kind == PairKind::VertexFace {
            return 0.0;
        }
        let rest = |a: u32, b: u32| self.mesh.rest_length_squared(a, b);
        MOLLIFIER_THRESHOLD
            * rest(pair.vertices[0], pair.vertices[1])
            * rest(pair.vertices[2], pair.vertices[3])
    }

    /// The area a pair stands for: that of its primitive on a shell, so that coarse obstacles are no stiffer than fine
    /// ones; the mean where both are on shells.
    fn area(&self, pair: &Pair) -> f64 {
        let [a, b, c, d] = pair.vertices;
        match pair.kind {
            PairKind::VertexFace if self.mesh.is_obstacle(a) => self.mesh.face_area(&[b, c, d]),
            PairKind::VertexFace => self.mesh.vertex_areas[a as usize],
            PairKind::EdgeEdge => {
                let (first, second) = (self.mesh.edge_area(a, b), self.mesh.edge_area(c, d));
                match (self.mesh.is_obstacle(a), self.mesh.is_obstacle(c)) {
                    (false, false) => 0.5 * (first + second),
                    (true, _) => second,
                    (_, true) => first,
                }
            }
        }
    }

    pub(super) fn plane_barrier(&self, vertex: u32) -> LogBarrier {
        LogBarrier::new(self.mesh.offset(vertex), self.d_hat)
    }

    /// Vertices of shells near a plane, as `(vertex, plane, distance)`.
    pub(super) fn near_planes(&self, q: &[f64]) -> Vec<ActiveVertex> {
        let mut near = Vec::new();
        for (plane, obstacle) in self.planes.iter().enumerate() {
            let distances = parallel_map(self.mesh.vertices.len(), |v| {
                let vertex = v as u32;
                let distance = obstacle.distance(&self.mesh.position(vertex, q), q);
                let close = distance - self.mesh.offset(vertex) < self.d_hat;
                let can_touch = !self.mesh.is_obstacle(vertex) && !self.mesh.is_gone(vertex);
                (close && can_touch).then_some(distance)
            });
            let found = distances.iter().enumerate();
            near.extend(found.filter_map(|(v, d)| {
                d.map(|distance| ActiveVertex {
                    vertex: v as u32,
                    plane,
                    distance,
                })
            }));
        }
        near
    }

    pub(super) fn plane_value(&self, near: &ActiveVertex) -> f64 {
        if near.distance <= 0.0 {
            return f64::INFINITY;
        }
        let barrier = self
            .plane_barrier(near.vertex)
            .value(near.distance * near.distance);
        self.kappa * self.mesh.vertex_areas[near.vertex as usize] * barrier
    }

    /// Force of a plane on a vertex along the normal, and its slope by the distance.
    pub(super) fn plane_derivatives(&self, near: &ActiveVertex) -> [f64; 2] {
        let [_, first, second] = self
            .plane_barrier(near.vertex)
            .derivatives(near.distance * near.distance);
        let scale = self.kappa * self.mesh.vertex_areas[near.vertex as usize];
        [
            scale * first * 2.0 * near.distance,
            scale * (4.0 * second * near.distance * near.distance + 2.0 * first),
        ]
    }

    /// Collects the active pairs at `q` among the candidates.
    pub fn refresh(&mut self, q: &[f64]) {
        const CHUNK: usize = 1024;
        let candidates = &self.candidates.pairs;
        let chunks = parallel_map(candidates.len().div_ceil(CHUNK), |chunk| {
            let mut active = Vec::new();
            let mut smallest = (f64::INFINITY, None);
            for pair in candidates[chunk * CHUNK..].iter().take(CHUNK) {
                let squared = pair.distance_squared(&self.pair_positions(pair, q));
                let barrier = self.pair_barrier(pair);
                if barrier.is_active(squared) {
                    active.push(*pair);
                    let gap = squared.sqrt() - barrier.touching_distance;
                    if gap < smallest.0 {
                        smallest = (gap, Some(Limiter::Pair(*pair)));
                    }
                }
            }
            (active, smallest)
        });
        (self.smallest_gap, self.closest) = (f64::INFINITY, None);
        self.active.clear();
        for (active, (gap, closest)) in chunks {
            self.active.extend(active);
            if gap < self.smallest_gap {
                (self.smallest_gap, self.closest) = (gap, closest);
            }
        }
        self.active_planes = self.near_planes(q);
        for near in &self.active_planes {
            let gap = near.distance - self.mesh.offset(near.vertex);
            if gap < self.smallest_gap {
                self.smallest_gap = gap;
                self.closest = Some(Limiter::Plane(near.vertex, near.plane));
            }
        }
    }

    pub(super) fn describe_on_plane(&self, vertex: u32, plane: usize) -> String {
        let name = &self.planes[plane].name;
        format!("{} against '{name}'", self.mesh.describe_vertex(vertex))
    }

    pub(super) fn describe_pair(&self, pair: &Pair) -> String {
        let [a, b, c, d] = pair.vertices;
        match pair.kind {
            PairKind::VertexFace => {
                format!(
                    "{} against {}",
                    self.mesh.describe_vertex(a),
                    self.mesh.describe("face", &[b, c, d])
                )
            }
            PairKind::EdgeEdge => {
                format!(
                    "{} against {}",
                    self.mesh.describe("edge", &[a, b]),
                    self.mesh.describe("edge", &[c, d])
                )
            }
        }
    }
}
