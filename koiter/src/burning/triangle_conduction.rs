//! Heat in a shell of triangles: along each of its two layers, and from one to the other.
//!
//! ```text
//! A_i Ṫ_i = Σ_j α_ij w_ij (T_j − T_i) + A_i k_x (T'_i − T_i),     w_ij = (cot φ + cot φ') / 2 ≥ 0
//! ```
//!
//! T temperature of a vertex in a layer, T' that in the other layer [K], A_i a third of the area of the faces around the
//! vertex [m²], α_ij mean diffusivity of both ends [m²/s], k_x rate of exchange [1/s], φ, φ' the angles opposite an edge. Edges
//! are those of the intrinsic Delaunay triangulation of the rest shape, where no weight is negative: so backward Euler
//! conserves Σ A_i T_i over both layers, and no temperature leaves the range of those before, on any mesh. Heat flows through
//! the material, by rest lengths: that the shell bends or shrinks meanwhile does not change its paths.

use std::collections::BTreeMap;

use super::diffusion::Diffusion;
use crate::mesh::Surface;
use crate::rest::IntrinsicTriangulation;

/// Conduction in both layers of a shell: values are those of the bottom layer by vertex, then those of the top layer.
#[derive(Clone, Debug)]
pub struct TriangleConduction {
    /// w of the connections in a layer; those of the bottom layer come first, then the same of the top layer.
    weights: Vec<f64>,
    num_vertices: usize,
    diffusion: Diffusion,
}

impl TriangleConduction {
    /// On a rest shape.
    pub fn new(rest: &Surface) -> Self {
        let n = rest.positions.len();
        let mut intrinsic = IntrinsicTriangulation::of_surface(rest);
        intrinsic.make_delaunay();
        let mut weights = BTreeMap::<[u32; 2], f64>::new();
        for (face, corners) in intrinsic.faces().iter().enumerate() {
            for (c, cotangent) in intrinsic.cotangents(face).into_iter().enumerate() {
                let (a, b) = (corners[(c + 1) % 3], corners[(c + 2) % 3]);
                // An edge that ends where it began carries nothing.
                if a != b {
                    *weights.entry([a.min(b), a.max(b)]).or_default() += 0.5 * cotangent;
                }
            }
        }
        let in_layer = |layer: u32| {
            let first = layer * n as u32;
            weights.keys().map(move |ends| ends.map(|v| first + v))
        };
        let across = (0..n as u32).map(|v| [v, n as u32 + v]);
        let ends = in_layer(0).chain(in_layer(1)).chain(across).collect();
        let mut diffusion = Diffusion::new(ends, 2 * n);
        for (face, corners) in rest.mesh.faces().iter().enumerate() {
            let third = rest.face_area(face) / 3.0;
            for &v in corners {
                diffusion.capacities[v as usize] += third;
                diffusion.capacities[n + v as usize] += third;
            }
        }
        Self {
            // Delaunay up to round-off.
            weights: weights.values().map(|weight| weight.max(0.0)).collect(),
            num_vertices: n,
            diffusion,
        }
    }

    /// Conducts heat for `dt` [s]; `diffusivity` [m²/s] by vertex, `exchange_rate` [1/s]; nothing flows to or from vertices that
    /// are not there. Returns the iterations it took.
    pub fn conduct(
        &mut self,
        is_there: &[bool],
        diffusivity: &[f64],
        exchange_rate: f64,
        dt: f64,
        temperatures: &mut [f64],
    ) -> usize {
        let n = self.num_vertices;
        let Diffusion {
            ends,
            conductances,
            capacities,
            ..
        } = &mut self.diffusion;
        let in_layers = 2 * self.weights.len();
        let weights = self.weights.iter().cycle();
        let connections = ends[..in_layers].iter().zip(weights);
        for (conductance, (ends, weight)) in conductances.iter_mut().zip(connections) {
            let [a, b] = ends.map(|node| node as usize % n);
            let mean = 0.5 * (diffusivity[a] + diffusivity[b]);
            let flows = is_there[a] && is_there[b];
            *conductance = if flows { dt * mean * weight } else { 0.0 };
        }
        for (vertex, conductance) in conductances[in_layers..].iter_mut().enumerate() {
            *conductance = match is_there[vertex] {
                true => dt * exchange_rate * capacities[vertex],
                false => 0.0,
            };
        }
        self.diffusion.conduct(temperatures)
    }

    /// A_i [m²], of both layers.
    pub fn areas(&self) -> &[f64] {
        &self.diffusion.capacities
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::generate::{GridDiagonals, grid};

    /// A sheet sheared so far that most of its edges are not Delaunay.
    fn sheared(n: usize) -> Surface {
        let mut sheet = grid(1.0, 1.0, n, n, GridDiagonals::Uniform).unwrap();
        for x in &mut sheet.positions {
            x.x += 2.3 * x.y;
            x.z = 0.1 * (5.0 * x.x).sin();
        }
        sheet
    }

    #[test]
    fn heat_is_conserved_and_no_temperature_leaves_the_range_on_a_bad_mesh() {
        let sheet = sheared(16);
        let n = sheet.positions.len();
        let mut conduction = TriangleConduction::new(&sheet);
        let hot = |i: usize| 293.0 + 700.0 * f64::from(i.is_multiple_of(13)) + (i as f64).sin();
        let start: Vec<f64> = (0..2 * n).map(hot).collect();
        let low = start.iter().copied().fold(f64::MAX, f64::min);
        let high = start.iter().copied().fold(f64::MIN, f64::max);
        let alpha: Vec<f64> = (0..n).map(|v| 1e-3 * (1.5 + (v as f64).cos())).collect();
        // A few vertices have burnt: nothing flows to them.
        let is_there: Vec<bool> = (0..n).map(|v| !v.is_multiple_of(29)).collect();
        let heat =
            |t: &[f64], areas: &[f64]| -> f64 { areas.iter().zip(t).map(|(a, t)| a * t).sum() };
        let mut temperatures = start.clone();
        for dt in [1e-3, 0.1, 10.0] {
            conduction.conduct(&is_there, &alpha, 3.0, dt, &mut temperatures);
            let (before, after) = (
                heat(&start, conduction.areas()),
                heat(&temperatures, conduction.areas()),
            );
            // The residual is solved to 1e-14; three steps of a few hundred terms.
            assert!((after / before - 1.0).abs() < 1e-10, "{after} {before}");
            let range = low * (1.0 - 1e-10)..high * (1.0 + 1e-10);
            assert!(temperatures.iter().all(|t| range.contains(t)));
        }
        assert_eq!(temperatures[0], start[0], "what has burnt is left alone");
        let moved = temperatures.iter().zip(&start);
        assert!(moved.clone().any(|(a, b)| (a - b).abs() > 100.0));
    }

    #[test]
    fn a_spot_spreads_as_the_heat_kernel_has_it() {
        // Variance of a Gaussian in the plane: s²(t) = s²(0) + 2 α t along each axis; its peak falls as 1/s².
        let sheet = grid(1.0, 1.0, 80, 80, GridDiagonals::Alternating).unwrap();
        let (alpha, dt, steps) = (1e-3, 2e-3, 400);
        let n = sheet.positions.len();
        let spot = |i: usize| {
            let x = sheet.positions[i % n];
            (-(x.x * x.x + x.y * x.y) / (2.0 * 0.05_f64.powi(2))).exp()
        };
        let mut temperatures: Vec<f64> = (0..2 * n).map(spot).collect();
        let mut conduction = TriangleConduction::new(&sheet);
        let variance = |t: &[f64]| -> f64 {
            let moments = sheet.positions.iter().zip(t).map(|(x, t)| x.x * x.x * t);
            moments.sum::<f64>() / t[..n].iter().sum::<f64>()
        };
        let before = variance(&temperatures);
        let (there, diffusivity) = (vec![true; n], vec![alpha; n]);
        for _ in 0..steps {
            conduction.conduct(&there, &diffusivity, 0.0, dt, &mut temperatures);
        }
        let expected = 2.0 * alpha * dt * f64::from(steps);
        let ratio = (variance(&temperatures) - before) / expected;
        // Cells of a quarter of the spot's width.
        assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
        let kernel = 0.05_f64.powi(2) / (0.05_f64.powi(2) + expected);
        let peak = temperatures[40 * 81 + 40];
        assert!((peak / kernel - 1.0).abs() < 0.02, "{peak} {kernel}");
    }

    #[test]
    fn layers_exchange_heat_at_their_rate() {
        let sheet = grid(1.0, 1.0, 4, 4, GridDiagonals::Uniform).unwrap();
        let n = sheet.positions.len();
        let mut temperatures = vec![300.0; n];
        temperatures.extend(vec![500.0; n]);
        let mut conduction = TriangleConduction::new(&sheet);
        let (rate, dt, steps) = (2.0, 1e-3, 250);
        for _ in 0..steps {
            conduction.conduct(&vec![true; n], &vec![0.0; n], rate, dt, &mut temperatures);
        }
        let difference = temperatures[n + 3] - temperatures[3];
        let expected = 200.0 * (1.0_f64 + 2.0 * rate * dt).powi(-steps);
        assert!(
            (difference / expected - 1.0).abs() < 1e-10,
            "{difference} {expected}"
        );
    }
}
