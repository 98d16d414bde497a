//! How far a step may go: the search for pairs, collision detection, and what limits the step.

use super::active::Contact;
use super::boxes::Aabb;
use super::ccd::{Approach, additive_ccd};
use super::pair::Pair;
use crate::Vec3;
use crate::assembly::parallel_map;

/// What limited a step.
pub(super) enum Limiter {
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

impl Contact {
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
    pub(super) fn search(&mut self, x: &[Vec3], dx: &[Vec3]) -> Option<Vec<(Pair, f64)>> {
        let mut candidates = std::mem::take(&mut self.candidates);
        let near = |pair: Pair| {
            if self.is_asleep(&pair) {
                return None;
            }
            let approach = self.approach(&pair, x, dx);
            (approach.nearest < self.touching_distance(&pair) + self.d_hat)
                .then_some((pair, approach.fraction))
        };
        let found = if self.neighbours_cover(&mut candidates, x, dx) {
            Some(candidates.neighbours.checked(near))
        } else {
            candidates.find(&self.mesh, self.d_hat, x, Some(dx), near)
        };
        self.candidates = candidates;
        found
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
            let can_touch = |&v: &u32| !self.mesh.is_obstacle(v) && !self.mesh.is_gone(v);
            for v in (0..x.len() as u32).filter(can_touch) {
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

    /// The pairs that the coming evaluations look at.
    pub(super) fn keep(&mut self, found: Vec<(Pair, f64)>) {
        self.candidates.pairs.clear();
        (self.candidates.pairs).extend(found.into_iter().map(|(pair, _)| pair));
    }

    /// The largest fraction of `direction` that keeps all surfaces apart; keeps the pairs that come near on the way.
    pub(super) fn bound_step(&mut self, q: &[f64], direction: &[f64]) -> f64 {
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

    /// What limited the last step, in the user's terms.
    pub(super) fn describe_limiter(&self) -> Option<String> {
        Some(match self.limiter.as_ref()? {
            Limiter::Pair(pair) => self.describe_pair(pair),
            Limiter::Plane(vertex, plane) => self.describe_on_plane(*vertex, *plane),
            Limiter::Reach => "more candidate pairs than can be looked at".into(),
            Limiter::Length => {
                format!("the step is over {LONGEST_STEP} times the scene's size")
            }
        })
    }
}
