//! The barrier energy of everything that may touch.

use nalgebra::{SMatrix, SVector};

use super::barrier::LogBarrier;
use super::broad_phase::Aabb;
use super::candidates::Candidates;
use super::ccd::{Approach, additive_ccd};
use super::collision_mesh::CollisionMesh;
use super::friction::{Friction, FrictionContact};
use super::pair::{Pair, PairKind, derivatives, gradient, mollify};
use super::plane::CollisionPlane;
use crate::Vec3;
use crate::assembly::{
    Dof, DofLayout, Energy, HessianBuilder, PatternBuilder, PsdProjection, WorstElement,
    ordered_sum, parallel_map,
};
use crate::geometry::ClosestPoints;

/// The mollifier's threshold relative to the squared rest lengths of the two edges ("Incremental Potential Contact").
const MOLLIFIER_THRESHOLD: f64 = 1e-3;

/// When the smallest gap falls below this fraction of d̂ and keeps shrinking, the barrier is stiffened.
const STIFFEN_BELOW: f64 = 0.02;

/// The barrier is stiffened by at most this factor over a run.
const LARGEST_STIFFENING: f64 = 1e6;

/// Contact of all bodies of a scene.
pub struct Contact {
    pub(super) mesh: CollisionMesh,
    pub(super) planes: Vec<CollisionPlane>,
    layout: DofLayout,
    pub(super) d_hat: f64,
    kappa: f64,
    largest_kappa: f64,
    pub(super) candidates: Candidates,
    /// Candidates whose barrier acts at the last refresh.
    active: Vec<Pair>,
    active_planes: Vec<ActiveVertex>,
    smallest_gap: f64,
    limiter: Option<Limiter>,
}

/// What the barrier of a pair needs.
struct ActivePair {
    positions: [Vec3; 4],
    closest: ClosestPoints,
    barrier: LogBarrier,
    threshold: f64,
    /// Area the pair stands for [m²].
    area: f64,
}

pub(super) struct ActiveVertex {
    pub(super) vertex: u32,
    pub(super) plane: usize,
    pub(super) distance: f64,
}

enum Limiter {
    Pair(Pair),
    Plane(u32, usize),
    Reach,
    Length,
}

/// Steps longer than this many times the extent of everything are cut: searching them would only take time.
const LONGEST_STEP: f64 = 10.0;

/// The fraction of a motion that is worth searching.
fn sensible_reach(x: &[Vec3], dx: &[Vec3]) -> f64 {
    let bounds = Aabb::around(x.iter().copied(), 0.0);
    let extent = (0..3)
        .map(|k| bounds.high[k] - bounds.low[k])
        .fold(0.0, f64::max);
    let longest = dx.iter().map(Vec3::norm).fold(0.0, f64::max);
    if longest > LONGEST_STEP * extent && extent > 0.0 {
        LONGEST_STEP * extent / longest
    } else {
        1.0
    }
}

/// What a contact energy tells after a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactStatistics {
    /// Active pairs.
    pub contacts: usize,
    /// Smallest gap between surfaces [m]; infinity when nothing is within reach.
    pub min_gap: f64,
    /// Barrier stiffness [J/m²].
    pub kappa: f64,
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
            mesh,
            planes,
            layout,
            d_hat,
            kappa,
            largest_kappa: kappa * LARGEST_STIFFENING,
            candidates: Candidates::default(),
            active: Vec::new(),
            active_planes: Vec::new(),
            smallest_gap: f64::INFINITY,
            limiter: None,
        }
    }

    /// The collision mesh.
    pub fn mesh(&self) -> &CollisionMesh {
        &self.mesh
    }

    /// Barrier stiffness [J/m²].
    pub fn kappa(&self) -> f64 {
        self.kappa
    }

    /// Restores the barrier stiffness of an earlier state.
    pub fn set_kappa(&mut self, kappa: f64) {
        self.kappa = kappa;
    }

    /// Makes the coming search for pairs independent of those before: the shape of the trees decides the order of the
    /// pairs, and with it the last bits of every sum over them.
    pub fn forget_search(&mut self) {
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

    #[inline]
    fn pair_positions(&self, pair: &Pair, q: &[f64]) -> [Vec3; 4] {
        pair.vertices.map(|v| self.mesh.position(v, q))
    }

    #[inline]
    fn pair_barrier(&self, pair: &Pair) -> LogBarrier {
        LogBarrier::new(self.touching_distance(pair), self.d_hat)
    }

    fn activate(&self, pair: &Pair, q: &[f64]) -> ActivePair {
        let positions = self.pair_positions(pair, q);
        ActivePair {
            closest: pair.closest(&positions),
            positions,
            barrier: self.pair_barrier(pair),
            threshold: self.mollifier_threshold(pair),
            area: self.area(pair),
        }
    }

    fn pair_value(&self, pair: &Pair, q: &[f64]) -> f64 {
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

    fn plane_barrier(&self, vertex: u32) -> LogBarrier {
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
                (close && !self.mesh.is_obstacle(vertex)).then_some(distance)
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

    fn plane_value(&self, near: &ActiveVertex) -> f64 {
        if near.distance <= 0.0 {
            return f64::INFINITY;
        }
        let barrier = self
            .plane_barrier(near.vertex)
            .value(near.distance * near.distance);
        self.kappa * self.mesh.vertex_areas[near.vertex as usize] * barrier
    }

    /// Force of a plane on a vertex along the normal, and its slope by the distance.
    fn plane_derivatives(&self, near: &ActiveVertex) -> [f64; 2] {
        let [_, first, second] = self
            .plane_barrier(near.vertex)
            .derivatives(near.distance * near.distance);
        let scale = self.kappa * self.mesh.vertex_areas[near.vertex as usize];
        [
            scale * first * 2.0 * near.distance,
            scale * (4.0 * second * near.distance * near.distance + 2.0 * first),
        ]
    }

    /// Statistics at the state of the last [`Energy::begin_iteration`] or [`Contact::refresh`].
    pub fn statistics(&self) -> ContactStatistics {
        let contacts = self.active.len() + self.active_planes.len();
        ContactStatistics {
            contacts,
            min_gap: self.smallest_gap,
            kappa: self.kappa,
        }
    }

    /// Makes the candidates all pairs whose boxes come near each other on the whole way from `q` along `direction`, and
    /// returns whether there are few enough. A line search never stores them all: it hands each to collision detection.
    pub fn find_candidates(&mut self, q: &[f64], direction: &[f64]) -> bool {
        let found = self.sweep(q, direction, Some);
        let enough = found.is_some();
        self.candidates.pairs = found.unwrap_or_default();
        enough
    }

    /// Number of those pairs; `None` if there are too many.
    pub fn count_candidates(&mut self, q: &[f64], direction: &[f64]) -> Option<usize> {
        self.sweep(q, direction, |_| Some(()))
            .map(|found| found.len())
    }

    fn sweep<T: Send>(
        &mut self,
        q: &[f64],
        direction: &[f64],
        check: impl Fn(Pair) -> Option<T> + Sync + Send,
    ) -> Option<Vec<T>> {
        let (x, dx) = (self.positions(q), self.positions(direction));
        (self.candidates).find(&self.mesh, self.d_hat, &x, Some(&dx), check)
    }

    /// How far each candidate pair may go from the positions `x` along `dx`, by vertices of the collision mesh.
    pub fn approaches(&self, x: &[Vec3], dx: &[Vec3]) -> Vec<Approach> {
        parallel_map(self.candidates.pairs.len(), |i| {
            self.approach(&self.candidates.pairs[i], x, dx)
        })
    }

    fn approach(&self, pair: &Pair, x: &[Vec3], dx: &[Vec3]) -> Approach {
        let at = |of: &[Vec3]| pair.vertices.map(|v| of[v as usize]);
        additive_ccd(pair, &at(x), &at(dx), self.touching_distance(pair))
    }

    /// The pairs that come within reach of the barrier between `x` and `x + dx`, with the fraction of `dx` that each
    /// allows; `None` if too many boxes overlap.
    fn search(&mut self, x: &[Vec3], dx: &[Vec3]) -> Option<Vec<(Pair, f64)>> {
        let mut candidates = std::mem::take(&mut self.candidates);
        let near = |pair: Pair| {
            let approach = self.approach(&pair, x, dx);
            (approach.nearest < self.touching_distance(&pair) + self.d_hat)
                .then_some((pair, approach.fraction))
        };
        let found = candidates.find(&self.mesh, self.d_hat, x, Some(dx), near);
        self.candidates = candidates;
        found
    }

    /// Collects the active pairs at `q` among the candidates.
    pub fn refresh(&mut self, q: &[f64]) {
        const CHUNK: usize = 1024;
        let candidates = &self.candidates.pairs;
        let chunks = parallel_map(candidates.len().div_ceil(CHUNK), |chunk| {
            let mut active = Vec::new();
            let mut smallest_gap = f64::INFINITY;
            for pair in candidates[chunk * CHUNK..].iter().take(CHUNK) {
                let squared = pair.distance_squared(&self.pair_positions(pair, q));
                let barrier = self.pair_barrier(pair);
                if barrier.is_active(squared) {
                    active.push(*pair);
                    smallest_gap = smallest_gap.min(squared.sqrt() - barrier.touching_distance);
                }
            }
            (active, smallest_gap)
        });
        self.smallest_gap = (chunks.iter()).fold(f64::INFINITY, |gap, chunk| gap.min(chunk.1));
        self.active.clear();
        self.active
            .extend(chunks.into_iter().flat_map(|chunk| chunk.0));
        self.active_planes = self.near_planes(q);
        for near in &self.active_planes {
            let gap = near.distance - self.mesh.offset(near.vertex);
            self.smallest_gap = self.smallest_gap.min(gap);
        }
    }

    /// Normal forces and tangents at `q`, that of the last refresh, as the friction of the coming step.
    pub fn lag(&self, q: &[f64], friction: &mut Friction) {
        let coefficient = |a: f64, b: f64| (a * b).sqrt();
        let of_body = |v: u32| self.mesh.bodies[self.mesh.body[v as usize] as usize].friction;
        friction.contacts.clear();
        for pair in &self.active {
            let active = self.activate(pair, q);
            let other = if pair.kind == PairKind::VertexFace {
                1
            } else {
                2
            };
            let mu = coefficient(of_body(pair.vertices[0]), of_body(pair.vertices[other]));
            let distance = active.closest.distance_squared.sqrt();
            let slope = active.barrier.derivatives(active.closest.distance_squared)[1];
            let m = mollify(&active.positions, active.threshold);
            let force = -2.0 * self.kappa * active.area * m * slope * distance;
            if mu * force > 0.0 {
                friction.contacts.push(FrictionContact {
                    points: pair.vertices.map(|v| self.mesh.vertices[v as usize]),
                    weights: active.closest.weights,
                    normal: active.closest.separation / distance,
                    limit: mu * force,
                });
            }
        }
        for near in &self.active_planes {
            let plane = &self.planes[near.plane];
            let limit = coefficient(of_body(near.vertex), plane.friction)
                * -self.plane_derivatives(near)[0];
            if limit > 0.0 {
                let vertex = self.mesh.vertices[near.vertex as usize];
                friction.contacts.push(FrictionContact {
                    points: [vertex, plane.point, plane.point, plane.point],
                    weights: [1.0, -1.0, 0.0, 0.0],
                    normal: plane.normal,
                    limit,
                });
            }
        }
    }

    fn describe_pair(&self, pair: &Pair) -> String {
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

    /// Conservative bound of the step against planes: a tenth of every gap is kept.
    fn plane_bound(
        &self,
        x: &[Vec3],
        dx: &[Vec3],
        q: &[f64],
        direction: &[f64],
    ) -> (f64, Option<Limiter>) {
        let mut bound = (1.0, None);
        for (index, plane) in self.planes.iter().enumerate() {
            for v in (0..x.len() as u32).filter(|&v| !self.mesh.is_obstacle(v)) {
                let gap = plane.distance(&x[v as usize], q) - self.mesh.offset(v);
                let approach = -plane.approach(&dx[v as usize], direction);
                if approach * bound.0 > 0.9 * gap {
                    bound = (
                        (0.9 * gap / approach).max(0.0),
                        Some(Limiter::Plane(v, index)),
                    );
                }
            }
        }
        bound
    }
}

impl Energy for Contact {
    fn name(&self) -> &'static str {
        "contact"
    }

    fn prepare(&mut self, q: &[f64]) {
        let x = self.positions(q);
        let still = vec![Vec3::zeros(); x.len()];
        match self.search(&x, &still) {
            Some(found) => self.keep(found),
            None => log::warn!(
                "more candidate pairs than fit in memory: is d_hat larger than the mesh's edges?"
            ),
        }
        // The gap of the start, so that only what shrinks from here on stiffens the barrier.
        self.refresh(q);
    }

    fn begin_iteration(&mut self, q: &[f64]) {
        let before = self.smallest_gap;
        self.refresh(q);
        let shrinking = self.smallest_gap < before;
        if shrinking
            && self.smallest_gap < STIFFEN_BELOW * self.d_hat
            && self.kappa < self.largest_kappa
        {
            self.kappa *= 2.0;
        }
    }

    fn value(&self, q: &[f64]) -> f64 {
        let pairs = ordered_sum(self.candidates.pairs.len(), |i| {
            self.pair_value(&self.candidates.pairs[i], q)
        });
        pairs
            + self
                .near_planes(q)
                .iter()
                .map(|near| self.plane_value(near))
                .sum::<f64>()
    }

    fn add_gradient(&self, q: &[f64], gradient: &mut [f64]) {
        let locals = parallel_map(self.active.len(), |i| {
            self.pair_gradient(&self.active[i], q)
        });
        for (pair, local) in self.active.iter().zip(&locals) {
            self.scatter_gradient(pair, local, gradient);
        }
        for near in &self.active_planes {
            self.add_plane_gradient(near, self.plane_derivatives(near)[0], gradient);
        }
    }

    fn add_derivatives(
        &self,
        q: &[f64],
        projection: PsdProjection,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        const BATCH: usize = 4096;
        for first in (0..self.active.len()).step_by(BATCH) {
            let count = BATCH.min(self.active.len() - first);
            let locals = parallel_map(count, |k| {
                self.pair_derivatives(&self.active[first + k], q, projection)
            });
            for (pair, (local, block)) in self.active[first..].iter().zip(&locals) {
                self.scatter_gradient(pair, local, gradient);
                let dofs = pair.vertices.map(|v| self.mesh.vertices[v as usize]);
                for i in 0..4 {
                    for j in 0..=i {
                        let (a, b) = (self.layout.node(dofs[i]), self.layout.node(dofs[j]));
                        hessian.add(a, b, i == j, |r, c| block[(3 * i + r, 3 * j + c)]);
                    }
                }
            }
        }
        for near in &self.active_planes {
            let [first, second] = self.plane_derivatives(near);
            self.add_plane_gradient(near, first, gradient);
            let stiffness = second.max(projection.kept() * second);
            let plane = &self.planes[near.plane];
            let block = plane.normal * plane.normal.transpose() * stiffness;
            let (v, p) = (
                self.node(self.mesh.vertices[near.vertex as usize]),
                self.node(plane.point),
            );
            hessian.add(v, v, true, |r, c| block[(r, c)]);
            hessian.add(p, v, false, |r, c| -block[(r, c)]);
        }
    }

    fn add_to_pattern(&self, _q: &[f64], pattern: &mut PatternBuilder) {
        for pair in &self.active {
            pattern.couple((pair.vertices).map(|v| self.node(self.mesh.vertices[v as usize])));
        }
    }

    fn has_changing_pattern(&self) -> bool {
        true
    }

    fn max_step(&mut self, q: &[f64], direction: &[f64]) -> f64 {
        let x = self.positions(q);
        let mut dx = self.positions(direction);
        self.limiter = None;
        let mut reach = sensible_reach(&x, &dx);
        if reach < 1.0 {
            dx.iter_mut().for_each(|d| *d *= reach);
            self.limiter = Some(Limiter::Length);
        }
        let found = loop {
            if let Some(found) = self.search(&x, &dx) {
                break found;
            }
            // 40 halvings bring any finite step below d̂; a scene too dense even then keeps its last candidates.
            reach *= 0.5;
            self.limiter = Some(Limiter::Reach);
            if reach < 1e-12 {
                return 0.0;
            }
            dx.iter_mut().for_each(|d| *d *= 0.5);
        };
        let mut bound = 1.0;
        for (pair, fraction) in &found {
            if *fraction < bound {
                bound = *fraction;
                self.limiter = Some(Limiter::Pair(*pair));
            }
        }
        self.keep(found);
        let scaled: Vec<f64> = direction.iter().map(|d| d * reach).collect();
        let (by_plane, limiter) = self.plane_bound(&x, &dx, q, &scaled);
        if by_plane < bound {
            bound = by_plane;
            self.limiter = limiter;
        }
        bound * reach
    }

    fn worst_element(&self, q: &[f64]) -> Option<WorstElement> {
        let norms = parallel_map(self.active.len(), |i| {
            self.pair_gradient(&self.active[i], q).norm()
        });
        let worst = (0..norms.len()).max_by(|&a, &b| norms[a].total_cmp(&norms[b]))?;
        let description = self.describe_pair(&self.active[worst]);
        Some(WorstElement {
            description,
            gradient_norm: norms[worst],
        })
    }

    fn step_limiter(&self) -> Option<String> {
        Some(match self.limiter.as_ref()? {
            Limiter::Pair(pair) => format!("contact of {}", self.describe_pair(pair)),
            Limiter::Plane(vertex, plane) => {
                format!(
                    "contact of {} with '{}'",
                    self.mesh.describe_vertex(*vertex),
                    self.planes[*plane].name
                )
            }
            Limiter::Reach => "the number of candidate pairs".into(),
            Limiter::Length => {
                format!("its length: it is over {LONGEST_STEP} times the scene's size")
            }
        })
    }
}

impl Contact {
    fn node(&self, dof: Dof) -> crate::assembly::NodeId {
        self.layout.node(dof)
    }

    /// The pairs that the coming evaluations look at.
    fn keep(&mut self, found: Vec<(Pair, f64)>) {
        self.candidates.pairs.clear();
        (self.candidates.pairs).extend(found.into_iter().map(|(pair, _)| pair));
    }

    fn pair_gradient(&self, pair: &Pair, q: &[f64]) -> SVector<f64, 12> {
        let at = self.activate(pair, q);
        gradient(&at.closest, &at.barrier, &at.positions, at.threshold) * (self.kappa * at.area)
    }

    fn pair_derivatives(
        &self,
        pair: &Pair,
        q: &[f64],
        projection: PsdProjection,
    ) -> (SVector<f64, 12>, SMatrix<f64, 12, 12>) {
        let at = self.activate(pair, q);
        let (gradient, hessian) = derivatives(
            &at.closest,
            &at.barrier,
            &at.positions,
            at.threshold,
            projection,
        );
        let scale = self.kappa * at.area;
        (gradient * scale, hessian * scale)
    }

    fn scatter_gradient(&self, pair: &Pair, local: &SVector<f64, 12>, gradient: &mut [f64]) {
        for (k, &v) in pair.vertices.iter().enumerate() {
            let start = self.mesh.vertices[v as usize].0 as usize;
            for axis in 0..3 {
                gradient[start + axis] += local[3 * k + axis];
            }
        }
    }

    fn add_plane_gradient(&self, near: &ActiveVertex, slope: f64, gradient: &mut [f64]) {
        let plane = &self.planes[near.plane];
        let vertex = self.mesh.vertices[near.vertex as usize].0 as usize;
        for axis in 0..3 {
            gradient[vertex + axis] += slope * plane.normal[axis];
            gradient[plane.point.0 as usize + axis] -= slope * plane.normal[axis];
        }
    }
}
