//! The length constraints of the springs of one colour, and one projection onto them.
//!
//! ```text
//! C_j = |x_a − x_b|² / l_j − l_j        ∂C_j/∂x_a = g_j = 2 (x_a − x_b) / l_j = −∂C_j/∂x_b        (Eqs. 10, 11)
//! A = J W Jᵀ        A λ = w C        x ← x − W Jᵀ λ                                                  (Eqs. 16, 17, 19)
//! ```
//!
//! l target length [m], W inverse masses [1/kg] (0 where a particle is held), w ≤ 1 the weight of the colour: smaller is
//! softer. The paper prints A = J Jᵀ, which loses momentum as soon as masses differ.
//!
//! A spring meets at most three others at each end of a grid: rows of A have seven entries, and are kept with a fixed width
//! (ELLPACK). Conjugate gradients solve for λ, preconditioned by the part of A next to the diagonal: springs are numbered
//! along straight lines ([`Springs`]), so this part is nearly all of A in a thin smooth sheet, and the number of iterations
//! does not grow with the number of springs there. (Red springs at right angles are coupled by t² beside d² / 2; at t = d / 4
//! a grid of 60 × 60 takes 106 iterations instead of 24 for 10 × 10.)
//!
//! On a closed surface a colour can carry a self-stress, and A is singular. Its diagonal is enlarged by [`SHIFT`], which
//! bounds λ along such a stress; the positions do not see it, since W Jᵀ λ vanishes there.

use super::springs::{Springs, vector};
use crate::Vec3;

/// Relative enlargement of the diagonal of A: large beside round-off, small beside the tolerance of the lengths.
const SHIFT: f64 = 1e-9;
/// A pivot of the preconditioner below this share of its diagonal entry is replaced by the entry.
const LEAST_PIVOT: f64 = 1e-6;
/// The row width of grids, for which the product with A is compiled with its loop unrolled.
const GRID_WIDTH: usize = 6;
const NO_SLOT: u32 = u32::MAX;

/// Who moves how easily.
#[derive(Clone, Copy, Debug)]
pub struct Mobility<'a> {
    /// Inverse masses in the matrix A [1/kg].
    pub in_matrix: &'a [f64],
    /// Inverse masses with which positions are moved [1/kg]; the same, but for the paper's Table 1, where held particles
    /// count in A although they do not move.
    pub in_move: &'a [f64],
}

impl<'a> Mobility<'a> {
    /// By inverse masses [1/kg].
    pub fn new(inverse_masses: &'a [f64]) -> Self {
        Self {
            in_matrix: inverse_masses,
            in_move: inverse_masses,
        }
    }
}

/// When conjugate gradients stop, and how far their result may lead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepLimits {
    /// When the residual has fallen to this share of the right-hand side.
    pub tolerance: f64,
    /// After so many iterations.
    pub iterations: usize,
    /// No particle moves further in a step than this share of the mean initial length: where springs fold, A is nearly
    /// singular, and whole Newton steps tangle the layers.
    pub longest_move: f64,
}

/// What is known of a network before it is projected.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Largest |C| / l.
    pub largest: f64,
    /// √ Σ C² [m].
    pub norm: f64,
}

/// The constraints of one colour, with the memory to project onto them.
#[derive(Clone, Debug)]
pub struct Network {
    ends: Vec<[u32; 2]>,
    /// Neighbours a row.
    width: usize,
    /// Row by row; a row's own number where there is no neighbour.
    neighbors: Vec<u32>,
    /// Which end of the row's spring is shared, and whether gradients there have opposite signs.
    shares: Vec<Share>,
    /// The place of the next spring of the same line in each row.
    next_slot: Vec<u32>,
    gradients: Vec<Vec3>,
    errors: Vec<f64>,
    diagonal: Vec<f64>,
    couplings: Vec<f64>,
    inverse_pivots: Vec<f64>,
    ratios: Vec<f64>,
    multipliers: Vec<f64>,
    residual: Vec<f64>,
    correction: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
    moves: Vec<Vec3>,
    mean_length: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Share {
    end: u8,
    /// 1, −1, or 0 where there is no neighbour.
    sign: i8,
}

impl Network {
    /// The constraints of `springs` between `num_particles` particles.
    ///
    /// # Panics
    /// If an end is not a particle.
    pub fn new(springs: &Springs, num_particles: usize) -> Self {
        let ends = springs.ends.clone();
        let n = ends.len();
        let mut incident = vec![Vec::new(); num_particles];
        for (spring, pair) in ends.iter().enumerate() {
            for (end, &particle) in pair.iter().enumerate() {
                incident[particle as usize].push((spring as u32, end));
            }
        }
        let meets = |pair: &[u32; 2]| -> usize {
            pair.iter().map(|&p| incident[p as usize].len() - 1).sum()
        };
        let width = ends.iter().map(meets).max().unwrap_or(0);
        let mut neighbors: Vec<u32> = (0..n as u32)
            .flat_map(|j| std::iter::repeat_n(j, width))
            .collect();
        let mut shares = vec![Share::default(); n * width];
        let mut next_slot = vec![NO_SLOT; n];
        for (spring, pair) in ends.iter().enumerate() {
            let at_ends = (0..2).flat_map(|end| {
                let others = incident[pair[end] as usize].iter();
                others.map(move |&(other, other_end)| (end, other, other_end))
            });
            let others = at_ends.filter(|&(_, other, _)| other as usize != spring);
            for (slot, (end, other, other_end)) in others.enumerate() {
                neighbors[spring * width + slot] = other;
                shares[spring * width + slot] = Share {
                    end: end as u8,
                    sign: if end == other_end { 1 } else { -1 },
                };
                if springs.is_continued[spring] && other as usize == spring + 1 {
                    next_slot[spring] = slot as u32;
                }
            }
        }
        Self {
            width,
            neighbors,
            shares,
            next_slot,
            gradients: vec![Vec3::zeros(); n],
            errors: vec![0.0; n],
            diagonal: vec![1.0; n],
            couplings: vec![0.0; n * width],
            inverse_pivots: vec![0.0; n],
            ratios: vec![0.0; n],
            multipliers: vec![0.0; n],
            residual: vec![0.0; n],
            correction: vec![0.0; n],
            direction: vec![0.0; n],
            product: vec![0.0; n],
            moves: vec![Vec3::zeros(); num_particles],
            mean_length: springs.initial_lengths.iter().sum::<f64>() / n.max(1) as f64,
            ends,
        }
    }

    /// Most entries of a row of A, its diagonal included.
    pub fn row_width(&self) -> usize {
        self.width + 1
    }

    /// Constraint errors C [m] and gradients at `positions`; springs that are not there have neither.
    pub fn measure(&mut self, positions: &[Vec3], targets: &[f64], is_there: &[bool]) -> Errors {
        let mut found = Errors::default();
        for (spring, &ends) in self.ends.iter().enumerate() {
            if !is_there[spring] {
                (self.errors[spring], self.gradients[spring]) = (0.0, Vec3::zeros());
                continue;
            }
            let (along, target) = (vector(ends, positions), targets[spring]);
            let error = along.norm_squared() / target - target;
            self.errors[spring] = error;
            self.gradients[spring] = along * (2.0 / target);
            found.largest = found.largest.max(error.abs() / target);
            found.norm += error * error;
        }
        found.norm = found.norm.sqrt();
        found
    }

    /// Moves `positions` by one Newton step towards the constraints measured last; returns the iterations it took.
    pub fn project(
        &mut self,
        positions: &mut [Vec3],
        mobility: Mobility<'_>,
        weight: f64,
        limits: StepLimits,
    ) -> usize {
        self.assemble(mobility.in_matrix);
        self.factorize_lines();
        let iterations = match self.width {
            GRID_WIDTH => self.solve(weight, limits, multiply::<GRID_WIDTH>),
            _ => self.solve(weight, limits, multiply_any),
        };
        self.moves.fill(Vec3::zeros());
        let springs = self.ends.iter().zip(&self.gradients).zip(&self.multipliers);
        for ((&[a, b], gradient), &multiplier) in springs {
            let push = gradient * multiplier;
            self.moves[a as usize] -= push;
            self.moves[b as usize] += push;
        }
        let mut longest: f64 = 0.0;
        for (step, mobility) in self.moves.iter_mut().zip(mobility.in_move) {
            *step *= *mobility;
            longest = longest.max(step.norm_squared());
        }
        // The step as a whole, so that momentum is kept.
        let allowed = limits.longest_move * self.mean_length;
        let share = (allowed / longest.sqrt()).min(1.0);
        for (x, step) in positions.iter_mut().zip(&self.moves) {
            *x += share * step;
        }
        iterations
    }

    /// Writes A.
    fn assemble(&mut self, inverse_masses: &[f64]) {
        for (spring, &[a, b]) in self.ends.iter().enumerate() {
            let mass = [inverse_masses[a as usize], inverse_masses[b as usize]];
            let gradient = self.gradients[spring];
            let diagonal = (mass[0] + mass[1]) * gradient.norm_squared() * (1.0 + SHIFT);
            // A spring that is not there, or between held particles, has no multiplier.
            self.diagonal[spring] = if diagonal > 0.0 { diagonal } else { 1.0 };
            let row = spring * self.width..(spring + 1) * self.width;
            let entries = self.couplings[row.clone()]
                .iter_mut()
                .zip(&self.neighbors[row.clone()])
                .zip(&self.shares[row]);
            for ((value, &other), share) in entries {
                let inner = gradient.dot(&self.gradients[other as usize]);
                *value = f64::from(share.sign) * mass[usize::from(share.end)] * inner;
            }
        }
    }

    /// L D Lᵀ of the part of A along lines.
    fn factorize_lines(&mut self) {
        let mut carried = 0.0;
        let mut ratio = 0.0;
        for spring in 0..self.ends.len() {
            let diagonal = self.diagonal[spring];
            let mut pivot = diagonal - ratio * carried;
            if !(pivot > LEAST_PIVOT * diagonal) {
                (pivot, ratio) = (diagonal, 0.0);
            }
            self.ratios[spring] = ratio;
            self.inverse_pivots[spring] = 1.0 / pivot;
            carried = match self.next_slot[spring] {
                NO_SLOT => 0.0,
                slot => self.couplings[spring * self.width + slot as usize],
            };
            ratio = carried / pivot;
        }
    }

    /// Conjugate gradients for A λ = w C.
    fn solve(&mut self, weight: f64, limits: StepLimits, multiply: Multiply) -> usize {
        self.multipliers.fill(0.0);
        for (residual, error) in self.residual.iter_mut().zip(&self.errors) {
            *residual = weight * error;
        }
        let start = norm_squared(&self.residual);
        let goal = limits.tolerance * limits.tolerance * start;
        if !(start > 0.0) {
            return 0;
        }
        let mut rho = self.precondition();
        self.direction.copy_from_slice(&self.correction);
        for iteration in 0..limits.iterations {
            let curvature = multiply(self);
            if !(curvature > 0.0) || !(rho > 0.0) {
                return iteration;
            }
            let step = rho / curvature;
            let mut left = 0.0;
            let pairs = self.multipliers.iter_mut().zip(&self.direction);
            let residuals = self.residual.iter_mut().zip(&self.product);
            for ((multiplier, direction), (residual, product)) in pairs.zip(residuals) {
                *multiplier += step * direction;
                *residual -= step * product;
                left += *residual * *residual;
            }
            if left <= goal {
                return iteration + 1;
            }
            let next = self.precondition();
            let keep = next / rho;
            rho = next;
            for (direction, correction) in self.direction.iter_mut().zip(&self.correction) {
                *direction = correction + keep * *direction;
            }
        }
        limits.iterations
    }

    /// `correction` = M⁻¹ `residual`; returns their inner product.
    fn precondition(&mut self) -> f64 {
        let mut before = 0.0;
        let forward = self
            .correction
            .iter_mut()
            .zip(&self.residual)
            .zip(&self.ratios);
        for ((correction, residual), ratio) in forward {
            before = residual - ratio * before;
            *correction = before;
        }
        let (mut after, mut ratio_after, mut inner) = (0.0, 0.0, 0.0);
        let backward = self.correction.iter_mut().zip(&self.residual);
        let pivots = self.inverse_pivots.iter().zip(&self.ratios);
        for ((correction, residual), (inverse_pivot, ratio)) in backward.zip(pivots).rev() {
            after = *correction * inverse_pivot - ratio_after * after;
            *correction = after;
            inner += after * residual;
            ratio_after = *ratio;
        }
        inner
    }
}

/// Writes `product` = A `direction`; returns their inner product.
type Multiply = fn(&mut Network) -> f64;

fn multiply<const WIDTH: usize>(network: &mut Network) -> f64 {
    let (couplings, _) = network.couplings.as_chunks::<WIDTH>();
    let (neighbors, _) = network.neighbors.as_chunks::<WIDTH>();
    let x = &network.direction[..];
    let rows = couplings.iter().zip(neighbors).zip(&network.diagonal);
    let mut inner = 0.0;
    for ((((couplings, neighbors), diagonal), own), product) in
        rows.zip(x).zip(&mut network.product)
    {
        let mut sum = diagonal * own;
        for k in 0..WIDTH {
            sum += couplings[k] * x[neighbors[k] as usize];
        }
        *product = sum;
        inner += sum * own;
    }
    inner
}

fn multiply_any(network: &mut Network) -> f64 {
    let width = network.width;
    let x = &network.direction[..];
    let mut inner = 0.0;
    for (spring, product) in network.product.iter_mut().enumerate() {
        let row = spring * width..(spring + 1) * width;
        let entries = network.couplings[row.clone()]
            .iter()
            .zip(&network.neighbors[row]);
        let own = x[spring];
        let sum: f64 = entries
            .map(|(value, &other)| value * x[other as usize])
            .sum();
        *product = sum + network.diagonal[spring] * own;
        inner += *product * own;
    }
    inner
}

fn norm_squared(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::burning::double_layer::{COLORS, DoubleLayer};
    use crate::burning::quad_mesh::QuadMesh;

    const EXACT: StepLimits = StepLimits {
        tolerance: 1e-13,
        iterations: 2000,
        longest_move: f64::INFINITY,
    };

    fn shell(n: usize) -> DoubleLayer {
        DoubleLayer::new(QuadMesh::grid([n as f64; 2], [n, n]).unwrap(), 0.25)
    }

    #[test]
    fn rows_of_grids_are_seven_wide() {
        let shell = shell(6);
        for (springs, color) in shell.springs.iter().zip(COLORS) {
            let width = Network::new(springs, shell.particles.len()).row_width();
            assert_eq!(width, 7, "{color:?}");
        }
    }

    #[test]
    fn a_newton_step_solves_linearised_constraints_and_keeps_momentum() {
        let shell = shell(5);
        let masses: Vec<f64> = (0..shell.particles.len())
            .map(|p| 1.0 + 0.3 * (p as f64).sin())
            .collect();
        let inverse: Vec<f64> = masses.iter().map(|mass| 1.0 / mass).collect();
        for springs in &shell.springs {
            let mut network = Network::new(springs, shell.particles.len());
            let targets: Vec<f64> = springs.initial_lengths.iter().map(|l| 0.97 * l).collect();
            let all = vec![true; springs.len()];
            let mut x = shell.particles.clone();
            for (p, x) in x.iter_mut().enumerate() {
                x.z += 0.05 * (1.7 * p as f64).cos();
            }
            let before = x.clone();
            let first = network.measure(&x, &targets, &all).norm;
            let (errors, gradients) = (network.errors.clone(), network.gradients.clone());
            network.project(&mut x, Mobility::new(&inverse), 1.0, EXACT);
            let moved = |p: u32| x[p as usize] - before[p as usize];
            for (j, &[a, b]) in springs.ends.iter().enumerate() {
                let left = errors[j] + gradients[j].dot(&(moved(a) - moved(b)));
                // The shift of the diagonal, times the condition of A.
                assert!(left.abs() < 1e-6 * first, "{left}");
            }
            let momentum: Vec3 = (0..x.len()).map(|p| masses[p] * (x[p] - before[p])).sum();
            assert!(momentum.norm() < 1e-12 * masses.len() as f64);
        }
    }

    #[test]
    fn lines_make_the_iterations_independent_of_the_number_of_springs() {
        let iterations = |n: usize| -> Vec<usize> {
            let mesh = QuadMesh::grid([n as f64; 2], [n, n]).unwrap();
            // In a thick shell red springs at right angles are coupled too, and lines are less of A.
            let shell = DoubleLayer::new(mesh, 0.02);
            let inverse = vec![1.0; shell.particles.len()];
            let limits = StepLimits {
                tolerance: 1e-7,
                iterations: 500,
                ..EXACT
            };
            let of_color = |springs: &Springs| {
                let mut network = Network::new(springs, shell.particles.len());
                let target = |(j, l): (usize, &f64)| l * (0.97 + 0.02 * (j as f64 * 0.37).sin());
                let targets: Vec<f64> = springs
                    .initial_lengths
                    .iter()
                    .enumerate()
                    .map(target)
                    .collect();
                let mut x = shell.particles.clone();
                network.measure(&x, &targets, &vec![true; springs.len()]);
                network.project(&mut x, Mobility::new(&inverse), 1.0, limits)
            };
            shell.springs.iter().map(of_color).collect()
        };
        let (small, large) = (iterations(10), iterations(60));
        for (small, large) in small.iter().zip(&large) {
            assert!(
                *large <= 2 * small.max(&8),
                "{large} iterations for {small}"
            );
        }
    }

    #[test]
    fn springs_that_are_not_there_move_nothing() {
        let shell = shell(3);
        let springs = &shell.springs[0];
        let mut network = Network::new(springs, shell.particles.len());
        let inverse = vec![1.0; shell.particles.len()];
        let targets: Vec<f64> = springs.initial_lengths.iter().map(|l| 0.5 * l).collect();
        let mut x = shell.particles.clone();
        let errors = network.measure(&x, &targets, &vec![false; springs.len()]);
        network.project(&mut x, Mobility::new(&inverse), 1.0, EXACT);
        assert_eq!((errors, x), (Errors::default(), shell.particles));
    }

    #[test]
    fn colours_of_a_torus_are_singular_and_still_projected() {
        let mesh = QuadMesh::torus(1.0, 0.35, [24, 12]).unwrap();
        let shell = DoubleLayer::new(mesh, 0.05);
        let inverse = vec![1.0; shell.particles.len()];
        for springs in &shell.springs {
            let mut network = Network::new(springs, shell.particles.len());
            let targets: Vec<f64> = springs.initial_lengths.iter().map(|l| 0.99 * l).collect();
            let all = vec![true; springs.len()];
            let mut x = shell.particles.clone();
            let first = network.measure(&x, &targets, &all).norm;
            for _ in 0..4 {
                network.measure(&x, &targets, &all);
                network.project(&mut x, Mobility::new(&inverse), 1.0, EXACT);
            }
            let last = network.measure(&x, &targets, &all).norm;
            assert!(last < 1e-6 * first, "{first} to {last}");
        }
    }
}
