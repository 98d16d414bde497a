//! Whether an error falls under refinement.

/// How an error changes with the number of vertices V, over several meshes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// p of the power law `error ∝ V^p` that fits best (least squares of logarithms); NaN for fewer than two meshes.
    pub rate: f64,
    /// The same from the last two meshes alone.
    pub last_rate: f64,
    /// Error of the finest mesh.
    pub error: f64,
}

/// What the errors of some meshes say of those of finer ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Trend {
    /// The error goes to zero.
    Converges,
    /// It does not.
    Stays,
    /// It falls as if it went to zero, but is still so large that it may come to rest before; or there is one mesh only.
    Open,
}

/// An error falls by a power law if it falls at least this fast in V; errors of first order in the edge length have −0.5.
/// Those that do not converge mostly scatter about 0, but may fall as fast where their error only passes zero: hence the
/// condition that it also falls from the last mesh but one to the last.
const SLOWEST_RATE: f64 = -0.25;

/// Below this relative error there is only what directors are found to and the digits of the exact value.
const NEGLIGIBLE: f64 = 1e-6;

/// Above this relative error nothing is said to converge, however it falls: the models that do not converge are off by
/// more in their limits, and begin with larger errors.
const LARGEST_ERROR: f64 = 0.1;

impl Refinement {
    /// From pairs of a number of vertices and a relative error, from coarse to fine.
    pub fn of(errors: &[(usize, f64)]) -> Self {
        Self {
            rate: fitted_rate(errors),
            last_rate: fitted_rate(&errors[errors.len().saturating_sub(2)..]),
            error: errors.last().map_or(f64::NAN, |(_, error)| *error),
        }
    }

    /// Whether there is a pattern of an error that goes to zero.
    pub fn trend(&self) -> Trend {
        if self.rate.is_nan() {
            return Trend::Open;
        }
        let falls = self.rate < SLOWEST_RATE && self.last_rate < 0.0;
        if self.error < NEGLIGIBLE || falls && self.error < LARGEST_ERROR {
            Trend::Converges
        } else if falls && self.last_rate < SLOWEST_RATE {
            Trend::Open
        } else {
            Trend::Stays
        }
    }
}

/// The slope of the line of least squares through the logarithms.
fn fitted_rate(errors: &[(usize, f64)]) -> f64 {
    let logarithms: Vec<[f64; 2]> = errors
        .iter()
        .filter(|(_, error)| *error > 0.0)
        .map(|&(vertices, error)| [(vertices as f64).ln(), error.ln()])
        .collect();
    if logarithms.len() < 2 {
        return f64::NAN;
    }
    let count = logarithms.len() as f64;
    let mean = |k: usize| logarithms.iter().map(|point| point[k]).sum::<f64>() / count;
    let [x, y] = [mean(0), mean(1)];
    let (mut across, mut along) = (0.0, 0.0);
    for point in &logarithms {
        across += (point[0] - x) * (point[1] - y);
        along += (point[0] - x) * (point[0] - x);
    }
    across / along
}

#[cfg(test)]
mod tests {
    use super::*;

    fn power(factor: f64, p: f64) -> [(usize, f64); 3] {
        [100usize, 400, 1600].map(|v| (v, factor * (v as f64).powf(p)))
    }

    #[test]
    fn power_laws_are_found_and_constants_are_not() {
        let first_order = Refinement::of(&power(3.0, -0.5));
        assert!((first_order.rate + 0.5).abs() < 1e-12);
        assert_eq!(first_order.trend(), Trend::Converges);
        assert_eq!(Refinement::of(&power(3.0, -0.1)).trend(), Trend::Stays);
        let at_the_last_digit = [(100, 3e-6), (400, 2e-8), (1600, 3e-8)];
        assert_eq!(Refinement::of(&at_the_last_digit).trend(), Trend::Converges);
        let constant = [(100, 0.02), (400, 0.021), (1600, 0.019)];
        assert_eq!(Refinement::of(&constant).trend(), Trend::Stays);
    }

    #[test]
    fn coarse_meshes_do_not_tell_what_finer_ones_do() {
        // The error ends at 0.25 and still falls by first order: it may come to rest at 0.2, or not.
        assert_eq!(Refinement::of(&power(10.0, -0.5)).trend(), Trend::Open);
        let levels_off = [(100, 1.0), (400, 0.5), (1600, 0.45)];
        assert_eq!(Refinement::of(&levels_off).trend(), Trend::Stays);
        assert_eq!(Refinement::of(&[(100, 0.01)]).trend(), Trend::Open);
        assert_eq!(Refinement::of(&[]).trend(), Trend::Open);
    }
}
