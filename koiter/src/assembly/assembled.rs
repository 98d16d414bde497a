//! Any local energy as an energy over all unknowns.

use nalgebra::{SMatrix, SVector};

use super::energy::WorstElement;
use super::{
    Dof, DofLayout, Energy, HessianBuilder, LocalEnergy, LocalHessian, NodeId, Pattern,
    PatternBuilder, PsdProjection, RestMeasures, ordered_sum, parallel_map,
};

/// Elements whose Hessians are held at a time: few enough to stay in the cache, enough to occupy all cores.
const BATCH: usize = 512;

/// Elements whose gradients are held at a time.
const GRADIENT_BATCH: usize = 4096;

/// A [`LocalEnergy`] summed over its elements.
pub struct Assembled<L, const N: usize, const K: usize> {
    local: L,
    /// First unknown and node of every local node; `None` where a neighbour is missing.
    nodes: Vec<[Option<(Dof, NodeId)>; K]>,
    /// For each element the slots of its `K (K + 1) / 2` blocks, lower triangle by rows; [`NO_SLOT`] where a neighbour is
    /// missing or a node is not solved for.
    slots: Vec<u32>,
    num_solved_nodes: u32,
    /// Of all derivatives.
    factor: f64,
    /// Elements that give nothing; empty: none.
    is_gone: Vec<bool>,
    /// The element that bounded the last step most.
    limiter: Option<usize>,
}

/// Of a block that has no place in the matrix.
const NO_SLOT: u32 = u32::MAX;

impl<const N: usize, const K: usize, L: LocalEnergy<N, K>> Assembled<L, N, K> {
    /// Gathers the element's nodes once.
    pub fn new(local: L, layout: &DofLayout) -> Self {
        let nodes = (0..local.num_stencils())
            .map(|s| {
                local
                    .nodes(s)
                    .map(|dof| dof.map(|dof| (dof, layout.node(dof))))
            })
            .collect();
        Self {
            local,
            nodes,
            slots: Vec::new(),
            num_solved_nodes: layout.num_solved_nodes() as u32,
            factor: 1.0,
            is_gone: Vec::new(),
            limiter: None,
        }
    }

    /// The local energy.
    pub fn local(&self) -> &L {
        &self.local
    }

    /// The local energy, to change its parameters; its elements and their nodes must stay.
    pub fn local_mut(&mut self) -> &mut L {
        &mut self.local
    }

    fn is_there(&self, stencil: usize) -> bool {
        !self.is_gone.get(stencil).is_some_and(|&is_gone| is_gone)
    }

    /// The element's unknowns.
    pub fn gather(&self, stencil: usize, q: &[f64]) -> SVector<f64, N> {
        let mut out = SVector::<f64, N>::zeros();
        let mut row = 0;
        for (node, size) in self.nodes[stencil].iter().zip(L::NODE_SIZES) {
            if let Some((dof, _)) = node {
                let start = dof.0 as usize;
                out.as_mut_slice()[row..row + size].copy_from_slice(&q[start..start + size]);
            }
            row += size;
        }
        out
    }

    fn scatter_gradient(&self, stencil: usize, local: &SVector<f64, N>, gradient: &mut [f64]) {
        let mut row = 0;
        for (node, size) in self.nodes[stencil].iter().zip(L::NODE_SIZES) {
            if let Some((dof, _)) = node {
                let start = dof.0 as usize;
                for (g, l) in gradient[start..start + size]
                    .iter_mut()
                    .zip(&local.as_slice()[row..row + size])
                {
                    *g += self.factor * l;
                }
            }
            row += size;
        }
    }

    fn scatter_hessian(
        &self,
        stencil: usize,
        local: &SMatrix<f64, N, N>,
        hessian: &mut HessianBuilder<'_>,
    ) {
        let mut starts = [0; K];
        for k in 1..K {
            starts[k] = starts[k - 1] + L::NODE_SIZES[k - 1];
        }
        let mut slot = stencil * (K * (K + 1) / 2);
        for (i, node_i) in self.nodes[stencil].iter().enumerate() {
            for (j, node_j) in self.nodes[stencil][..=i].iter().enumerate() {
                if let (Some((_, a)), Some((_, b))) = (node_i, node_j) {
                    let (row, column) = (starts[i], starts[j]);
                    let entry = |r, c| self.factor * local[(row + r, column + c)];
                    match self.slots[slot] {
                        NO_SLOT => hessian.add(*a, *b, i == j, entry),
                        slot => hessian.add_at(slot, *a, *b, i == j, entry),
                    }
                }
                slot += 1;
            }
        }
    }

    /// Adds the gradients of all elements, in order, and returns their values.
    fn add_gradients(&self, q: &[f64], gradient: &mut [f64]) -> Vec<f64> {
        let count = self.nodes.len();
        let mut values = Vec::with_capacity(count);
        for first in (0..count).step_by(GRADIENT_BATCH) {
            let locals = parallel_map(GRADIENT_BATCH.min(count - first), |k| {
                match self.is_there(first + k) {
                    true => (self.local).gradient(first + k, &self.gather(first + k, q)),
                    false => (0.0, SVector::zeros()),
                }
            });
            for (k, (value, local)) in locals.iter().enumerate() {
                values.push(*value);
                self.scatter_gradient(first + k, local, gradient);
            }
        }
        values
    }

    fn evaluate(&self, stencil: usize, q: &[f64], projection: PsdProjection) -> LocalHessian<N> {
        if !self.is_there(stencil) {
            return LocalHessian::zero();
        }
        let local = self.gather(stencil, q);
        match projection {
            PsdProjection::Exact => self.local.hessian(stencil, &local),
            partial => (self.local).projected_hessian(stencil, &local, partial.kept()),
        }
    }

    fn scatter(
        &self,
        first: usize,
        batch: &[LocalHessian<N>],
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        for (k, local) in batch.iter().enumerate() {
            self.scatter_gradient(first + k, &local.gradient, gradient);
            self.scatter_hessian(first + k, &local.hessian, hessian);
        }
    }
}

impl<const N: usize, const K: usize, L: LocalEnergy<N, K>> Energy for Assembled<L, N, K> {
    fn name(&self) -> &str {
        self.local.name()
    }

    fn set_time(&mut self, time: f64) {
        self.local.set_time(time);
    }

    fn settings(&self) -> &[f64] {
        self.local.settings()
    }

    fn value(&self, q: &[f64]) -> f64 {
        if self.factor == 0.0 {
            return 0.0;
        }
        let sum = ordered_sum(self.nodes.len(), |s| match self.is_there(s) {
            true => self.local.value(s, &self.gather(s, q)),
            false => 0.0,
        });
        self.factor * sum
    }

    fn add_gradient(&self, q: &[f64], gradient: &mut [f64]) {
        if self.factor == 0.0 {
            return;
        }
        self.add_gradients(q, gradient);
    }

    fn add_value_and_gradient(&self, q: &[f64], gradient: &mut [f64]) -> f64 {
        if self.factor == 0.0 {
            return 0.0;
        }
        let values = self.add_gradients(q, gradient);
        self.factor * ordered_sum(values.len(), |s| values[s])
    }

    /// Elements are evaluated in parallel batch by batch and added in order, one batch while the next is evaluated.
    fn add_derivatives(
        &self,
        q: &[f64],
        projection: PsdProjection,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        let count = if self.factor == 0.0 {
            0
        } else {
            self.nodes.len()
        };
        let evaluate = |first: usize| {
            parallel_map(BATCH.min(count.saturating_sub(first)), |k| {
                self.evaluate(first + k, q, projection)
            })
        };
        let mut batch = evaluate(0);
        let mut first = 0;
        while !batch.is_empty() {
            #[cfg(feature = "parallel")]
            let (next, ()) = rayon::join(
                || evaluate(first + BATCH),
                || self.scatter(first, &batch, gradient, hessian),
            );
            #[cfg(not(feature = "parallel"))]
            let next = {
                self.scatter(first, &batch, gradient, hessian);
                evaluate(first + BATCH)
            };
            batch = next;
            first += BATCH;
        }
    }

    fn add_stress_stiffness(&self, q: &[f64], motion: &[f64], hessian: &mut HessianBuilder<'_>) {
        for stencil in (0..self.nodes.len()).filter(|&s| self.is_there(s)) {
            let (here, along) = (self.gather(stencil, q), self.gather(stencil, motion));
            if let Some(local) = self.local.stress_stiffness(stencil, &here, &along) {
                self.scatter_hessian(stencil, &local, hessian);
            }
        }
    }

    fn add_to_pattern(&self, _q: &[f64], pattern: &mut PatternBuilder) {
        for nodes in &self.nodes {
            let all = nodes.iter().flatten().map(|(_, node)| *node);
            pattern.couple(all.filter(|node| node.0 < self.num_solved_nodes));
        }
    }

    fn bind(&mut self, pattern: &Pattern) {
        let per_stencil = K * (K + 1) / 2;
        let nodes = &self.nodes;
        self.slots = parallel_map(nodes.len() * per_stencil, |index| {
            let (stencil, pair) = (index / per_stencil, index % per_stencil);
            // Row of the pair-th entry of a lower triangle by rows.
            let i = (((8 * pair + 1) as f64).sqrt() as usize - 1) / 2;
            let j = pair - i * (i + 1) / 2;
            match (nodes[stencil][i], nodes[stencil][j]) {
                (Some((_, a)), Some((_, b))) if a.max(b).0 < self.num_solved_nodes => pattern
                    .slot(a.max(b), a.min(b))
                    .expect("the element is in the pattern"),
                _ => NO_SLOT,
            }
        });
    }

    fn max_step(&mut self, q: &[f64], direction: &[f64]) -> f64 {
        self.limiter = None;
        let mut bound = 1.0;
        if L::BOUNDS_STEPS {
            let steps = parallel_map(self.nodes.len(), |s| {
                if !self.is_there(s) {
                    return 1.0;
                }
                let (q, direction) = (self.gather(s, q), self.gather(s, direction));
                self.local.max_step(s, &q, &direction)
            });
            for (stencil, &step) in steps.iter().enumerate() {
                if step < bound {
                    (bound, self.limiter) = (step, Some(stencil));
                }
            }
        }
        bound
    }

    fn rest_measures(&self) -> Option<&dyn RestMeasures> {
        (L::MEASURES > 0).then_some(self)
    }

    fn rest_measures_mut(&mut self) -> Option<&mut dyn RestMeasures> {
        match L::MEASURES {
            0 => None,
            _ => Some(self),
        }
    }

    fn step_limiter(&self) -> Option<String> {
        let element = self.local.describe(self.limiter?);
        Some(format!("{} at {element}", self.name()))
    }

    fn is_admissible(&self, q: &[f64]) -> bool {
        let is_admissible =
            |s| !self.is_there(s) || self.local.is_admissible(s, &self.gather(s, q));
        (0..self.nodes.len()).all(is_admissible)
    }

    fn undefined_element(&self, q: &[f64]) -> Option<String> {
        let is_undefined =
            |s: &usize| self.is_there(*s) && !self.local.is_admissible(*s, &self.gather(*s, q));
        let element = (0..self.nodes.len()).find(is_undefined)?;
        Some(self.local.describe(element))
    }

    fn worst_element(&self, q: &[f64]) -> Option<WorstElement> {
        let norms = parallel_map(self.nodes.len(), |s| {
            if !self.is_there(s) {
                return 0.0;
            }
            let (value, gradient) = self.local.gradient(s, &self.gather(s, q));
            if value.is_finite() {
                self.factor * gradient.norm()
            } else {
                f64::NAN
            }
        });
        let worst = match norms.iter().position(|n| !n.is_finite()) {
            Some(broken) => broken,
            None => (0..norms.len()).max_by(|&a, &b| norms[a].total_cmp(&norms[b]))?,
        };
        Some(WorstElement {
            description: self.local.describe(worst),
            unknown: self.nodes[worst].iter().flatten().map(|node| node.0).next(),
            gradient_norm: norms[worst],
        })
    }

    fn at_held_positions<'a>(
        &'a self,
        q: &[f64],
        layout: &DofLayout,
    ) -> Option<Box<dyn Energy + 'a>> {
        (self.local).at_held_positions(&|stencil| self.gather(stencil, q), layout)
    }
}

impl<const N: usize, const K: usize, L: LocalEnergy<N, K>> RestMeasures for Assembled<L, N, K> {
    fn measure(&self, q: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.nodes.len() * L::MEASURES];
        for (stencil, measures) in all.chunks_exact_mut(L::MEASURES).enumerate() {
            (self.local).measure(stencil, &self.gather(stencil, q), measures);
        }
        all
    }

    fn rest(&self) -> Vec<f64> {
        let mut all = vec![0.0; self.nodes.len() * L::MEASURES];
        for (stencil, measures) in all.chunks_exact_mut(L::MEASURES).enumerate() {
            self.local.rest(stencil, measures);
        }
        all
    }

    fn set_rest(&mut self, rest: &[f64]) {
        for (stencil, measures) in rest.chunks_exact(L::MEASURES).enumerate() {
            self.local.set_rest(stencil, measures);
        }
    }

    fn has_branches(&self) -> bool {
        L::HAS_BRANCHES
    }

    fn follow(&mut self, measures: &[f64]) {
        for (stencil, measures) in measures.chunks_exact(L::MEASURES).enumerate() {
            self.local.follow(stencil, measures);
        }
    }

    fn set_factor(&mut self, factor: f64) {
        self.factor = factor;
    }

    fn set_present(&mut self, is_there: &[bool], cuts: &[[bool; 3]]) {
        self.is_gone = is_there.iter().map(|is_there| !is_there).collect();
        for (stencil, edges) in cuts.iter().enumerate() {
            self.local.set_cut(stencil, *edges);
        }
    }
}
