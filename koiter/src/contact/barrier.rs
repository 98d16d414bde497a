//! The logarithmic barrier ([`crate::geometry::log_barrier`]) of distances.
//!
//! ```text
//! b(s/ŝ),   s = d² − ξ²,   ŝ = (ξ + d̂)² − ξ²
//! ```
//!
//! d distance of the midsurfaces [m], ξ distance at which the surfaces touch [m], d̂ gap at which the barrier begins [m].
//! b is dimensionless and twice continuously differentiable at ŝ; it goes to infinity as the surfaces touch. Reference:
//! "Codimensional IPC" (2021), Eq. (13), scaled by ŝ².

use crate::geometry::log_barrier;

/// The barrier of pairs that touch at one distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogBarrier {
    /// ξ [m].
    pub touching_distance: f64,
    /// ŝ [m²].
    pub range: f64,
}

impl LogBarrier {
    /// From ξ and d̂ [m].
    pub fn new(touching_distance: f64, d_hat: f64) -> Self {
        Self {
            touching_distance,
            range: d_hat * (2.0 * touching_distance + d_hat),
        }
    }

    /// s for a squared distance; positive while the surfaces do not touch.
    #[inline]
    pub fn excess(&self, distance_squared: f64) -> f64 {
        distance_squared - self.touching_distance * self.touching_distance
    }

    /// Whether the barrier acts at a squared distance.
    #[inline]
    pub fn is_active(&self, distance_squared: f64) -> bool {
        self.excess(distance_squared) < self.range
    }

    /// b; infinite where surfaces touch or overlap.
    #[inline]
    pub fn value(&self, distance_squared: f64) -> f64 {
        log_barrier(self.excess(distance_squared) / self.range)[0]
    }

    /// b, ∂b/∂D and ∂²b/∂D² with respect to the squared distance D.
    #[inline]
    pub fn derivatives(&self, distance_squared: f64) -> [f64; 3] {
        let [value, first, second] = log_barrier(self.excess(distance_squared) / self.range);
        [
            value,
            first / self.range,
            second / (self.range * self.range),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_differences() {
        let barrier = LogBarrier::new(2e-3, 1e-3);
        for gap in [1e-4, 5e-4, 9.9e-4] {
            let d = (2e-3f64 + gap).powi(2);
            let h = 1e-5 * (d - 4e-6);
            let [_, first, second] = barrier.derivatives(d);
            let difference = (barrier.value(d + h) - barrier.value(d - h)) / (2.0 * h);
            assert!((first - difference).abs() < 1e-6 * first.abs().max(1.0));
            let difference =
                (barrier.derivatives(d + h)[1] - barrier.derivatives(d - h)[1]) / (2.0 * h);
            assert!((second - difference).abs() < 1e-6 * second.abs().max(1.0));
        }
    }

    #[test]
    fn the_barrier_ends_smoothly_and_is_infinite_at_touch() {
        let barrier = LogBarrier::new(0.0, 1e-3);
        let end = (1e-3f64).powi(2);
        assert_eq!(barrier.value(end * 1.01), 0.0);
        assert!(barrier.derivatives(end * (1.0 - 1e-9))[2].abs() * end * end < 1e-7);
        assert_eq!(barrier.value(0.0), f64::INFINITY);
    }
}
