//! What a sequence of meshes, each with cells half as large, says about its limit.
//!
//! ```text
//! p = log₂ (f₁ − f₂) / (f₂ − f₃)        f = f₃ + (f₃ − f₂) / (2ᵖ − 1)
//! ```

/// Orders below this say that the sequence has not begun to converge, or converges to no use.
const SLOWEST: f64 = 0.3;

/// Orders above this are accidents: no model here has an order of more than 2.
const FASTEST: f64 = 5.0;

/// Observed order and extrapolated value of the last three; `None` where they do not converge like a power.
pub(super) fn extrapolate(values: &[f64]) -> Option<(f64, f64)> {
    let [.., first, second, third] = *values else {
        return None;
    };
    let ratio = (first - second) / (second - third);
    let order = ratio.log2();
    let is_power = (SLOWEST..FASTEST).contains(&order);
    is_power.then(|| (order, third + (third - second) / (ratio - 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_is_extrapolated_exactly() {
        let values = [4.0, 2.0, 1.0].map(|h: f64| 3.0 + 0.1 * h.powf(1.5));
        let (order, limit) = extrapolate(&values).unwrap();
        assert!((order - 1.5).abs() < 1e-12 && (limit - 3.0).abs() < 1e-12);
    }

    #[test]
    fn what_does_not_converge_is_not_extrapolated() {
        for values in [
            &[1.0, 2.0][..],
            &[1.0, 2.0, 1.5],
            &[1.0, 2.0, 3.5],
            &[1.0; 3],
        ] {
            assert!(extrapolate(values).is_none(), "{values:?}");
        }
    }
}
