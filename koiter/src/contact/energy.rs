//! The barrier energy of everything that may touch.

use nalgebra::{SMatrix, SVector};

use super::active::{ActiveVertex, Contact};
use super::pair::{Pair, derivatives, gradient};
use crate::Vec3;
use crate::assembly::{
    Dof, Energy, HessianBuilder, PatternBuilder, PsdProjection, WorstElement, ordered_sum,
    parallel_map,
};

/// When the smallest gap falls below this fraction of d̂ and keeps shrinking, or keeps steps short, the barrier is stiffened.
const STIFFEN_BELOW: f64 = 0.02;

/// Contact that lets less than this of a Newton step be taken keeps it short: forces far beyond the barrier's, as those of
/// metal, press a pair to a gap that no longer shrinks, and hundreds of steps get on by a hundredth each.
const KEPT_SHORT: f64 = 0.1;

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
        self.last_bound = 1.0;
    }

    fn begin_iteration(&mut self, q: &[f64]) {
        let before = self.smallest_gap;
        self.refresh(q);
        let pressed = self.smallest_gap < before || self.last_bound < KEPT_SHORT;
        if pressed
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
        self.last_bound = self.bound_step(q, direction);
        self.last_bound
    }

    fn worst_element(&self, q: &[f64]) -> Option<WorstElement> {
        let norms = parallel_map(self.active.len(), |i| {
            self.pair_gradient(&self.active[i], q).norm()
        });
        let worst = (0..norms.len()).max_by(|&a, &b| norms[a].total_cmp(&norms[b]))?;
        let description = self.describe_pair(&self.active[worst]);
        Some(WorstElement {
            description,
            unknown: None,
            gradient_norm: norms[worst],
        })
    }

    fn step_limiter(&self) -> Option<String> {
        self.describe_limiter()
    }
}

impl Contact {
    fn node(&self, dof: Dof) -> crate::assembly::NodeId {
        self.layout.node(dof)
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
