//! Heat: sources, cooling, and conduction along the springs by one step of backward Euler.
//!
//! ```text
//! T* = T + h k_s (T_s − T)  within a source,  + h k_c (T_a − T)  everywhere          (each by backward Euler)
//! (E_i + c h Σ_j κ_ij / d_ij) T_i − c h Σ_j (κ_ij / d_ij) T_j = E_i T*_i              E_i = Σ_j d_ij
//! ```
//!
//! T temperature [K], d lengths of the springs as they are [m], κ_ij = α_i + α_j twice the mean diffusivity [m²/s], c
//! [`DIMENSION_FACTOR`]. This is backward Euler of Eq. (3) of the paper times E_i: the matrix is symmetric and positive
//! definite, Σ E_i T_i does not change, and no temperature leaves the range of those before. The umbrella operator of the
//! paper, (2/E) Σ (T_j − T_i) / d, is half of the Laplacian on a surface; c = 2 makes it whole.

use super::diffusion::Diffusion;
use super::double_layer::DoubleLayer;
use crate::Vec3;

/// What makes the umbrella operator the Laplacian of a surface; 1 is the paper's formula.
pub const DIMENSION_FACTOR: f64 = 2.0;
/// A spring that is crushed below this share of its initial length conducts as if it were so long.
const LEAST_LENGTH: f64 = 0.05;

/// Which layers of a shell a source heats: the top one is where normals point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Deserialize, serde::Serialize, schemars::JsonSchema),
    serde(rename_all = "kebab-case")
)]
#[non_exhaustive]
pub enum Side {
    /// Both layers.
    #[default]
    Both,
    /// The top layer; of double layers the lattice particles.
    Top,
    /// The bottom layer; of double layers the corner particles.
    Bottom,
}

impl Side {
    /// Whether a source on this side heats a layer.
    pub fn heats(self, layer: Self) -> bool {
        self == Self::Both || self == layer
    }
}

/// A ball that heats what is within it, or a source that heats all particles.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatSource {
    /// Centre [m] and radius [m]; `None`: everywhere.
    pub ball: Option<(Vec3, f64)>,
    /// Its temperature T_s [K].
    pub temperature: f64,
    /// How fast particles take it on, k_s [1/s].
    pub rate: f64,
    /// Factors on the rate by particle, from a texture; empty: 1.
    pub intensity: Vec<f64>,
}

/// Heats particles within sources for `dt` [s].
pub(super) fn heat(sources: &[HeatSource], positions: &[Vec3], dt: f64, temperatures: &mut [f64]) {
    for source in sources {
        for (particle, temperature) in temperatures.iter_mut().enumerate() {
            let is_within = source.ball.is_none_or(|(center, radius)| {
                (positions[particle] - center).norm_squared() <= radius * radius
            });
            if is_within {
                let intensity = source.intensity.get(particle).copied().unwrap_or(1.0);
                relax(
                    temperature,
                    source.temperature,
                    source.rate * intensity * dt,
                );
            }
        }
    }
}

/// Cools particles towards the temperature around them [K], at `rate` [1/s] for `dt` [s].
pub(super) fn cool(ambient: f64, rate: f64, dt: f64, temperatures: &mut [f64]) {
    for temperature in temperatures {
        relax(temperature, ambient, rate * dt);
    }
}

/// Backward Euler of T' = k (goal − T) over a time of `share` / k.
fn relax(temperature: &mut f64, goal: f64, share: f64) {
    // The same twice, so that neither a share near 0 loses digits nor one that is infinite gives no number.
    let part = match share < 1.0 {
        true => share / (1.0 + share),
        false => 1.0 / (1.0 + 1.0 / share),
    };
    *temperature += (goal - *temperature) * part;
}

/// Conduction along the springs of a double layer.
#[derive(Clone, Debug)]
pub struct Conduction {
    least_lengths: Vec<f64>,
    diffusion: Diffusion,
}

impl Conduction {
    /// Along all springs of a double layer.
    pub fn new(shell: &DoubleLayer) -> Self {
        let springs = shell.springs.iter();
        let ends: Vec<_> = springs.clone().flat_map(|s| s.ends.clone()).collect();
        let lengths = springs.flat_map(|s| &s.initial_lengths);
        Self {
            least_lengths: lengths.map(|length| LEAST_LENGTH * length).collect(),
            diffusion: Diffusion::new(ends, shell.particles.len()),
        }
    }

    /// Conducts heat for `dt` [s]; `diffusivity` [m²/s] a particle. Returns the iterations it took.
    pub fn conduct(
        &mut self,
        positions: &[Vec3],
        is_there: &[Vec<bool>; 4],
        diffusivity: &[f64],
        dt: f64,
        temperatures: &mut [f64],
    ) -> usize {
        let Diffusion {
            ends,
            conductances,
            capacities,
            ..
        } = &mut self.diffusion;
        capacities.fill(0.0);
        let springs = ends.iter().zip(&self.least_lengths);
        let springs = springs.zip(is_there.iter().flatten());
        for (((&[a, b], &least), &is_there), conductance) in springs.zip(conductances) {
            let (a, b) = (a as usize, b as usize);
            *conductance = 0.0;
            if is_there {
                let length = (positions[a] - positions[b]).norm().max(least);
                let twice_mean = diffusivity[a] + diffusivity[b];
                *conductance = DIMENSION_FACTOR * dt * twice_mean / length;
                capacities[a] += length;
                capacities[b] += length;
            }
        }
        self.diffusion.conduct(temperatures)
    }

    /// E_i of every particle at the last step [m]: its weight in the mean temperature that conduction keeps.
    pub fn extents(&self) -> &[f64] {
        &self.diffusion.capacities
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::burning::quad_mesh::QuadMesh;

    fn sheet(size: f64, n: usize, thickness: f64) -> DoubleLayer {
        DoubleLayer::new(QuadMesh::grid([size; 2], [n, n]).unwrap(), thickness)
    }

    fn all_there(shell: &DoubleLayer) -> [Vec<bool>; 4] {
        shell.springs.each_ref().map(|s| vec![true; s.len()])
    }

    /// A sheet stretched unevenly, so that lengths and E differ from particle to particle.
    fn graded(shell: &DoubleLayer) -> Vec<Vec3> {
        let stretch = |x: &Vec3| Vec3::new(x.x + 0.8 * x.x * x.x, x.y * (1.0 + 0.3 * x.x), x.z);
        shell.particles.iter().map(stretch).collect()
    }

    #[test]
    fn conduction_conserves_heat_and_keeps_to_the_range_on_graded_sheets() {
        let shell = sheet(1.0, 14, 0.03);
        let x = graded(&shell);
        let mut conduction = Conduction::new(&shell);
        let hot = |p: usize| {
            293.0 + 700.0 * f64::from(p.is_multiple_of(17)) + 50.0 * (0.9 * p as f64).sin()
        };
        let start: Vec<f64> = (0..x.len()).map(hot).collect();
        let (low, high) = start
            .iter()
            .fold((f64::MAX, f64::MIN), |(l, h), &t| (l.min(t), h.max(t)));
        // Uneven, as by a texture.
        let alpha: Vec<f64> = (0..x.len())
            .map(|p| 1e-3 * (1.2 + (p as f64).cos()))
            .collect();
        let mut temperatures = start.clone();
        for _ in 0..5 {
            let before = temperatures.clone();
            conduction.conduct(&x, &all_there(&shell), &alpha, 0.5, &mut temperatures);
            let heat =
                |t: &[f64]| -> f64 { conduction.extents().iter().zip(t).map(|(e, t)| e * t).sum() };
            let change = heat(&temperatures) / heat(&before) - 1.0;
            assert!(change.abs() < 1e-10, "{change}");
            let range = low * (1.0 - 1e-10)..high * (1.0 + 1e-10);
            assert!(temperatures.iter().all(|t| range.contains(t)));
        }
        assert!(
            temperatures
                .iter()
                .zip(&start)
                .any(|(a, b)| (a - b).abs() > 100.0),
            "heat moved"
        );
    }

    #[test]
    fn constant_temperatures_stay() {
        let shell = sheet(1.0, 8, 0.05);
        let mut temperatures = vec![400.0; shell.particles.len()];
        let alpha = vec![1e-2; shell.particles.len()];
        Conduction::new(&shell).conduct(
            &graded(&shell),
            &all_there(&shell),
            &alpha,
            1.0,
            &mut temperatures,
        );
        assert!(
            temperatures
                .iter()
                .all(|t| (t - 400.0).abs() < 1e-10 * 400.0)
        );
    }

    #[test]
    fn a_spot_spreads_as_the_heat_kernel_has_it() {
        // Variance of a Gaussian spot in the plane: s² (t) = s² (0) + 2 α t along each axis.
        let (size, n, alpha, dt, steps) = (1.0, 80, 1e-3, 2e-3, 400);
        let shell = sheet(size, n, 0.05 * size / n as f64);
        let spot = |x: &Vec3| (-(x.x * x.x + x.y * x.y) / (2.0 * 0.05_f64.powi(2))).exp();
        let mut temperatures: Vec<f64> = shell.particles.iter().map(spot).collect();
        let diffusivity = vec![alpha; temperatures.len()];
        let mut conduction = Conduction::new(&shell);
        let there = all_there(&shell);
        let variance = |t: &[f64]| -> f64 {
            let sum: f64 = t.iter().sum();
            shell
                .particles
                .iter()
                .zip(t)
                .map(|(x, t)| x.x * x.x * t)
                .sum::<f64>()
                / sum
        };
        let before = variance(&temperatures);
        for _ in 0..steps {
            conduction.conduct(
                &shell.particles,
                &there,
                &diffusivity,
                dt,
                &mut temperatures,
            );
        }
        let spread = variance(&temperatures) - before;
        let expected = 2.0 * alpha * dt * steps as f64;
        let ratio = spread / expected;
        assert!(
            (ratio - 1.0).abs() < 0.02,
            "effective diffusivity {ratio} of that asked for"
        );
        // And the peak falls as 1 / s².
        let middle = shell.num_corners() / 2;
        let peak = temperatures[middle];
        let kernel = 0.05_f64.powi(2) / (0.05_f64.powi(2) + expected);
        assert!((peak / kernel - 1.0).abs() < 0.02, "{peak} for {kernel}");
    }

    #[test]
    fn balls_heat_what_is_within_and_air_cools() {
        let shell = sheet(1.0, 10, 0.01);
        let mut temperatures = vec![300.0; shell.particles.len()];
        let source = HeatSource {
            ball: Some((Vec3::zeros(), 0.2)),
            temperature: 1000.0,
            rate: 25.0,
            intensity: Vec::new(),
        };
        heat(&[source], &shell.particles, 0.004, &mut temperatures);
        for (x, &t) in shell.particles.iter().zip(&temperatures) {
            let expected = if x.norm() <= 0.2 {
                300.0 + 700.0 * 0.1 / 1.1
            } else {
                300.0
            };
            assert!((t - expected).abs() < 1e-10, "{t} for {expected}");
        }
        // However long a step, nothing overshoots.
        cool(293.0, 2.0, 1e9, &mut temperatures);
        assert!(temperatures.iter().all(|t| (t - 293.0).abs() < 1e-6));
    }
}
