//! One step of backward Euler of heat that flows between nodes.
//!
//! ```text
//! (C_i + Σ_j k_ij) T_i − Σ_j k_ij T_j = C_i T*_i
//! ```
//!
//! T* temperatures before, T after [K], C heat capacities, k conductances times the time step, in any common unit. With k not
//! negative the matrix is an M-matrix: Σ C_i T_i does not change, and no temperature leaves the range of those before.

/// Solved until the residual has fallen to this share: conservation is as good.
const TOLERANCE: f64 = 1e-14;
const MAX_ITERATIONS: usize = 2000;

/// Nodes, what connects them, and room for the solver.
#[derive(Clone, Debug)]
pub(super) struct Diffusion {
    /// The nodes that each connection joins.
    pub(super) ends: Vec<[u32; 2]>,
    /// k, one a connection.
    pub(super) conductances: Vec<f64>,
    /// C, one a node.
    pub(super) capacities: Vec<f64>,
    diagonal: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
}

impl Diffusion {
    /// Between `n` nodes; nothing flows until conductances are set.
    pub(super) fn new(ends: Vec<[u32; 2]>, n: usize) -> Self {
        Self {
            conductances: vec![0.0; ends.len()],
            capacities: vec![0.0; n],
            diagonal: vec![0.0; n],
            residual: vec![0.0; n],
            direction: vec![0.0; n],
            product: vec![0.0; n],
            ends,
        }
    }

    /// T from T*; returns the iterations it took.
    pub(super) fn conduct(&mut self, temperatures: &mut [f64]) -> usize {
        self.diagonal.copy_from_slice(&self.capacities);
        for (&[a, b], conductance) in self.ends.iter().zip(&self.conductances) {
            self.diagonal[a as usize] += conductance;
            self.diagonal[b as usize] += conductance;
        }
        for diagonal in self.diagonal.iter_mut().filter(|d| **d == 0.0) {
            // A node without heat and without connections keeps its temperature.
            *diagonal = 1.0;
        }
        self.solve(temperatures)
    }

    /// Conjugate gradients from the temperatures before, preconditioned by the diagonal.
    fn solve(&mut self, temperatures: &mut [f64]) -> usize {
        // C T − A T: what conduction alone moves.
        self.residual.fill(0.0);
        for (&[a, b], conductance) in self.ends.iter().zip(&self.conductances) {
            let (a, b) = (a as usize, b as usize);
            let flow = conductance * (temperatures[a] - temperatures[b]);
            self.residual[a] -= flow;
            self.residual[b] += flow;
        }
        let scale: f64 = self
            .capacities
            .iter()
            .zip(&*temperatures)
            .map(|(c, t)| (c * t).powi(2))
            .sum();
        let mut rho = 0.0;
        for ((direction, residual), diagonal) in self
            .direction
            .iter_mut()
            .zip(&self.residual)
            .zip(&self.diagonal)
        {
            *direction = residual / diagonal;
            rho += residual * *direction;
        }
        for iteration in 0..MAX_ITERATIONS {
            let left: f64 = self.residual.iter().map(|r| r * r).sum();
            if !(left > TOLERANCE * TOLERANCE * scale) {
                return iteration;
            }
            let step = rho / self.multiply();
            let mut next = 0.0;
            for node in 0..temperatures.len() {
                temperatures[node] += step * self.direction[node];
                self.residual[node] -= step * self.product[node];
                next += self.residual[node].powi(2) / self.diagonal[node];
            }
            let keep = next / rho;
            rho = next;
            for node in 0..temperatures.len() {
                self.direction[node] =
                    self.residual[node] / self.diagonal[node] + keep * self.direction[node];
            }
        }
        MAX_ITERATIONS
    }

    /// `product` = A `direction`; returns their inner product.
    fn multiply(&mut self) -> f64 {
        for ((product, diagonal), direction) in self
            .product
            .iter_mut()
            .zip(&self.diagonal)
            .zip(&self.direction)
        {
            *product = diagonal * direction;
        }
        for (&[a, b], conductance) in self.ends.iter().zip(&self.conductances) {
            let (a, b) = (a as usize, b as usize);
            self.product[a] -= conductance * self.direction[b];
            self.product[b] -= conductance * self.direction[a];
        }
        self.product
            .iter()
            .zip(&self.direction)
            .map(|(p, d)| p * d)
            .sum()
    }
}
