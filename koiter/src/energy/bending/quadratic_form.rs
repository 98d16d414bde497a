//! Sums of products of linear functionals, with a positive semidefinite part of each term.
//!
//! The second derivatives of altitudes and hinge angles are sums `Σ k u v` of products of functionals
//! ([`crate::geometry::Wing`]). Scaled to equal length, `4 u v = (u + v)² − (u − v)²` and the two squares are orthogonal,
//! so the positive part of a product is known in closed form and no eigen-decomposition is needed.

use crate::Vec3;
use crate::geometry::Wing;

/// Unknowns of a hinge with an edge angle: edge ends a, b, apex c, opposite apex d, angle; padded to a power of two.
pub(super) const WIDTH: usize = 16;

/// A linear functional of the unknowns of a hinge.
pub(super) type Functional = [f64; WIDTH];

/// A symmetric bilinear form on the unknowns of a hinge.
pub(super) struct QuadraticForm {
    pub(super) rows: [Functional; WIDTH],
    kept: f64,
}

impl QuadraticForm {
    /// Zero. Every term added later contributes its positive semidefinite part and the share `kept` of its negative one.
    pub(super) fn zero(kept: f64) -> Self {
        Self {
            rows: [[0.0; WIDTH]; WIDTH],
            kept,
        }
    }

    fn add_outer(&mut self, k: f64, u: &Functional) {
        for (row, &ui) in self.rows.iter_mut().zip(u) {
            let scale = k * ui;
            for (entry, &uj) in row.iter_mut().zip(u) {
                *entry += scale * uj;
            }
        }
    }

    /// Adds `k u²`.
    pub(super) fn add_square(&mut self, k: f64, u: &Functional) {
        let k = if k > 0.0 { k } else { self.kept * k };
        if k != 0.0 {
            self.add_outer(k, u);
        }
    }

    /// Adds `k u v`.
    pub(super) fn add_product(&mut self, k: f64, u: &Functional, v: &Functional) {
        if self.kept > 0.0 {
            let half = 0.5 * k * self.kept;
            for i in 0..WIDTH {
                let (ui, vi) = (half * u[i], half * v[i]);
                for j in 0..WIDTH {
                    self.rows[i][j] += ui * v[j] + vi * u[j];
                }
            }
        }
        let clamped = (1.0 - self.kept) * k.abs();
        if clamped == 0.0 {
            return;
        }
        let (uu, vv) = (dot(u, u), dot(v, v));
        if uu > 0.0 && vv > 0.0 {
            let balance = (vv / uu).sqrt().sqrt();
            let (su, sv) = (balance, k.signum() / balance);
            let sum: Functional = std::array::from_fn(|i| su * u[i] + sv * v[i]);
            self.add_outer(0.25 * clamped, &sum);
        }
    }
}

pub(super) fn dot(u: &Functional, v: &Functional) -> f64 {
    u.iter().zip(v).map(|(a, b)| a * b).sum()
}

pub(super) fn scaled_sum(u: &Functional, v: &Functional, scale: f64) -> Functional {
    std::array::from_fn(|i| u[i] + scale * v[i])
}

/// The five functionals of a wing, placed among the unknowns of a hinge.
pub(super) struct WingFunctionals {
    pub(super) turning: Functional,
    pub(super) stretching: Functional,
    pub(super) sliding: Functional,
    pub(super) tilting: Functional,
    pub(super) swinging: Functional,
}

impl WingFunctionals {
    /// `points` are the places (0: a, 1: b, 2: c, 3: d) of the wing's edge ends and apex.
    pub(super) fn new(wing: &Wing, points: [usize; 3]) -> Self {
        let place = |f: [Vec3; 3]| {
            let mut out = [0.0; WIDTH];
            for (v, p) in f.iter().zip(points) {
                out[3 * p..3 * p + 3].copy_from_slice(v.as_slice());
            }
            out
        };
        Self {
            turning: place(wing.turning()),
            stretching: place(wing.stretching()),
            sliding: place(wing.sliding()),
            tilting: place(wing.tilting()),
            swinging: place(wing.swinging()),
        }
    }

    /// Adds `k` times this wing's share of θ″: `2 N T + Ψ (2 M + K)`.
    pub(super) fn add_angle(&self, k: f64, form: &mut QuadraticForm) {
        form.add_product(2.0 * k, &self.turning, &self.stretching);
        let twice = std::array::from_fn(|i| 2.0 * self.sliding[i] + self.swinging[i]);
        form.add_product(k, &self.tilting, &twice);
    }

    /// Adds `k` times `h″ / h = N² + M² − (M + K)²`.
    pub(super) fn add_altitude(&self, k: f64, form: &mut QuadraticForm) {
        form.add_square(k, &self.turning);
        form.add_square(k, &self.sliding);
        form.add_square(-k, &scaled_sum(&self.sliding, &self.swinging, 1.0));
    }
}
