//! The logarithmic barrier, as a function of what is left of its range.
//!
//! ```text
//! b(r) = −(r − 1)² ln r   for 0 < r < 1, else 0
//! ```
//!
//! r is 1 where the barrier begins and 0 where it is infinite. b is convex, falls, and is twice continuously
//! differentiable at 1. Reference: "Codimensional IPC" (2021), Eq. (13), scaled to a range of 1.

/// b, b′ and b″; infinite and not a number where nothing is left.
#[inline]
pub fn log_barrier(ratio: f64) -> [f64; 3] {
    if ratio >= 1.0 {
        return [0.0; 3];
    }
    if !(ratio > 0.0) {
        return [f64::INFINITY, f64::NAN, f64::NAN];
    }
    let (log, below) = (ratio.ln(), ratio - 1.0);
    [
        -below * below * log,
        -2.0 * below * log - below * below / ratio,
        -2.0 * log - 4.0 * below / ratio + (below / ratio).powi(2),
    ]
}

/// `(b′(r₁) − b′(r₂)) / (r₁ − r₂)` of two ratios in (0, 1], to round-off however near they are: b″ where they are equal.
/// `difference` is r₁ − r₂, which the caller may know better than by subtraction.
#[inline]
pub fn log_barrier_slope_quotient([r1, r2]: [f64; 2], difference: f64) -> f64 {
    // b′ = −2 (r − 1) ln r − (r − 2 + 1/r); the quotient of (r − 1) ln r is (r₁ − 1) Δln/Δr + ln r₂.
    let log_quotient = match difference == 0.0 {
        true => 1.0 / r2,
        false => (difference / r2).ln_1p() / difference,
    };
    -2.0 * ((r1 - 1.0) * log_quotient + r2.ln()) - (1.0 - 1.0 / (r1 * r2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quotient_of_slopes_is_that_of_far_ratios_and_the_second_derivative_of_equal_ones() {
        for [r1, r2] in [[0.2, 0.9], [0.5, 1e-3], [0.7, 1.0]] {
            let expected = (log_barrier(r1)[1] - log_barrier(r2)[1]) / (r1 - r2);
            let found = log_barrier_slope_quotient([r1, r2], r1 - r2);
            // Round-off of the slopes over their difference.
            assert!(
                (found - expected).abs() < 1e-13 * expected.abs(),
                "{r1} {r2}"
            );
        }
        for r in [1e-6, 0.3, 0.8] {
            let second = log_barrier(r)[2];
            let quotient = log_barrier_slope_quotient([r; 2], 0.0);
            assert!((quotient - second).abs() < 1e-13 * second, "{r}");
            let near = log_barrier_slope_quotient([r * (1.0 + 1e-12), r], r * 1e-12);
            // The ratios differ by 1e-12, and b″ with them.
            assert!((near - second).abs() < 1e-11 * second, "{r}");
        }
    }

    #[test]
    fn the_barrier_is_convex_and_begins_smoothly() {
        for k in 1..1000 {
            let [value, first, second] = log_barrier(k as f64 * 1e-3);
            assert!(value > 0.0 && first < 0.0 && second > 0.0, "{k}");
        }
        assert!(log_barrier(1.0 - 1e-9)[2] < 1e-8);
        assert_eq!(log_barrier(1.0), [0.0; 3]);
        assert_eq!(log_barrier(0.0)[0], f64::INFINITY);
    }
}
