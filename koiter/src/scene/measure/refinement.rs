//! Whether an error falls under refinement.

/// How an error changes with the number of vertices V, over several meshes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// p of the power law `error ∝ V^p` that fits best (least squares of logarithms); NaN for fewer than two meshes.
    pub rate: f64,
    /// Error of the finest mesh.
    pub error: f64,
    /// Whether it is smaller than that of the mesh before.
    pub still_falls: bool,
}

/// An error falls by a power law if it falls at least this fast in V; errors of first order in the edge length have −0.5.
/// Those that do not converge mostly scatter about 0, but may fall as fast where their error only passes zero: hence the
/// other two conditions of [`Refinement::converges`].
const SLOWEST_RATE: f64 = -0.25;

/// Above this relative error nothing is said to converge, however it falls.
const LARGEST_ERROR: f64 = 0.1;

impl Refinement {
    /// From pairs of a number of vertices and a relative error, from coarse to fine.
    pub fn of(errors: &[(usize, f64)]) -> Self {
        let logarithms: Vec<[f64; 2]> = errors
            .iter()
            .filter(|(_, error)| *error > 0.0)
            .map(|&(vertices, error)| [(vertices as f64).ln(), error.ln()])
            .collect();
        let count = logarithms.len() as f64;
        let mean = |k: usize| logarithms.iter().map(|point| point[k]).sum::<f64>() / count;
        let [x, y] = [mean(0), mean(1)];
        let (mut across, mut along) = (0.0, 0.0);
        for point in &logarithms {
            across += (point[0] - x) * (point[1] - y);
            along += (point[0] - x) * (point[0] - x);
        }
        Self {
            rate: if logarithms.len() < 2 {
                f64::NAN
            } else {
                across / along
            },
            error: errors.last().map_or(f64::NAN, |(_, error)| *error),
            still_falls: matches!(errors, [.., (_, before), (_, last)] if last < before),
        }
    }

    /// Whether there is a pattern of an error that goes to zero.
    pub fn converges(&self) -> bool {
        self.rate < SLOWEST_RATE && self.still_falls && self.error < LARGEST_ERROR
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_laws_are_found_and_constants_are_not() {
        let law = |p: f64| [100usize, 400, 1600].map(|v| (v, 3.0 * (v as f64).powf(p)));
        let first_order = Refinement::of(&law(-0.5));
        assert!((first_order.rate + 0.5).abs() < 1e-12 && first_order.converges());
        assert!(!Refinement::of(&law(-0.1)).converges());
        assert!(!Refinement::of(&[(100, 0.02), (400, 0.021), (1600, 0.019)]).converges());
        assert!(!Refinement::of(&[(100, 0.01)]).converges());
    }
}
