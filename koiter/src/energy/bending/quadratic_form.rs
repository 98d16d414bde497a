//! Sums of products of linear functionals, with a positive semidefinite part of each term.
//!
//! The second derivatives of altitudes and hinge angles are sums `Σ k u v` of products of functionals
//! ([`crate::geometry::Wing`]). Scaled to equal length, `4 u v = (u + v)² − (u − v)²` and the two squares are orthogonal,
//! so the positive part of a product is known in closed form and no eigen-decomposition is needed.

use crate::Vec3;
use crate::geometry::Wing;

/// Unknowns of a hinge with an edge angle: edge ends a, b, apex c, opposite apex d, angle; padded to a power of two.
pub(super) const WIDTH: usize = 16;

/// A linear functional of the unknowns of a hinge, or of `W` others.
pub(super) type Functional<const W: usize = WIDTH> = [f64; W];

/// A symmetric bilinear form on the unknowns of a hinge, or on `W` others.
pub(super) struct QuadraticForm<const W: usize = WIDTH> {
    pub(super) rows: [Functional<W>; W],
    kept: f64,
}

impl<const W: usize> QuadraticForm<W> {
    /// Zero. Every term added later contributes its positive semidefinite part and the share `kept` of its negative one.
    pub(super) fn zero(kept: f64) -> Self {
        Self {
            rows: [[0.0; W]; W],
            kept,
        }
    }

    fn add_outer(&mut self, k: f64, u: &Functional<W>) {
        for (row, &ui) in self.rows.iter_mut().zip(u) {
            let scale = k * ui;
            for (entry, &uj) in row.iter_mut().zip(u) {
                *entry += scale * uj;
            }
        }
    }

    /// Adds `k u²`.
    pub(super) fn add_square(&mut self, k: f64, u: &Functional<W>) {
        let k = if k > 0.0 { k } else { self.kept * k };
        if k != 0.0 {
            self.add_outer(k, u);
        }
    }

    /// Adds `k u v`.
    pub(super) fn add_product(&mut self, k: f64, u: &Functional<W>, v: &Functional<W>) {
        if self.kept > 0.0 {
            let half = 0.5 * k * self.kept;
            for i in 0..W {
                let (ui, vi) = (half * u[i], half * v[i]);
                for j in 0..W {
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
            let sum: Functional<W> = std::array::from_fn(|i| su * u[i] + sv * v[i]);
            self.add_outer(0.25 * clamped, &sum);
        }
    }
}

pub(super) fn dot<const W: usize>(u: &Functional<W>, v: &Functional<W>) -> f64 {
    u.iter().zip(v).map(|(a, b)| a * b).sum()
}

pub(super) fn scaled_sum<const W: usize>(
    u: &Functional<W>,
    v: &Functional<W>,
    scale: f64,
) -> Functional<W> {
    std::array::from_fn(|i| u[i] + scale * v[i])
}

/// The five functionals of a wing, placed among the unknowns of a hinge, or among `W` others.
pub(super) struct WingFunctionals<const W: usize = WIDTH> {
    pub(super) turning: Functional<W>,
    pub(super) stretching: Functional<W>,
    pub(super) sliding: Functional<W>,
    pub(super) tilting: Functional<W>,
    pub(super) swinging: Functional<W>,
}

impl WingFunctionals {
    /// `points` are the places (0: a, 1: b, 2: c, 3: d) of the wing's edge ends and apex.
    pub(super) fn new(wing: &Wing, points: [usize; 3]) -> Self {
        Self::placed(wing, |f| {
            let mut out = [0.0; WIDTH];
            for (v, p) in f.iter().zip(points) {
                out[3 * p..3 * p + 3].copy_from_slice(v.as_slice());
            }
            out
        })
    }
}

impl<const W: usize> WingFunctionals<W> {
    /// `place` writes a functional of the wing's edge ends and apex as one of the unknowns. It must keep those in the
    /// directions of the edge, the altitude and the normal orthogonal to each other.
    pub(super) fn placed(wing: &Wing, place: impl Fn([Vec3; 3]) -> Functional<W>) -> Self {
        Self {
            turning: place(wing.turning()),
            stretching: place(wing.stretching()),
            sliding: place(wing.sliding()),
            tilting: place(wing.tilting()),
            swinging: place(wing.swinging()),
        }
    }

    /// Adds `k` times this wing's share of θ″: `2 N T + Ψ (2 M + K)`.
    pub(super) fn add_angle(&self, k: f64, form: &mut QuadraticForm<W>) {
        form.add_product(2.0 * k, &self.turning, &self.stretching);
        let twice = std::array::from_fn(|i| 2.0 * self.sliding[i] + self.swinging[i]);
        form.add_product(k, &self.tilting, &twice);
    }

    /// Adds `k` times `h″ / h = N² + M² − (M + K)²`.
    pub(super) fn add_altitude(&self, k: f64, form: &mut QuadraticForm<W>) {
        form.add_square(k, &self.turning);
        form.add_square(k, &self.sliding);
        form.add_square(-k, &scaled_sum(&self.sliding, &self.swinging, 1.0));
    }
}
