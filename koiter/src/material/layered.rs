//! Layers glued together, each with its own modulus, thickness and growth: bimetals, and leaves that curl as they dry.
//!
//! ```text
//! energy = Σ_i ∫_layer ½ |(a + 2 z b − ā_i) / 2|²_{C_i} dz = A/2 |(a − ā)/2|² + D/2 |b − b̄|² + constant
//! A = Σ E_i h_i,   D = Σ E_i (h_i³/12 + h_i z_i²),   ā = Σ E_i h_i ā_i / A,   b̄ = Σ E_i h_i z_i ā_i / (2 D)
//! ```
//!
//! a, b first and second fundamental form of the simulated surface, ā_i rest form of layer i after growth, h_i its
//! thickness and z_i the height of its middle [m], E_i Young's modulus [Pa]; |·|²_C the plane-stress norm, C = E C(ν), with one
//! Poisson's ratio ν for all layers. The surface is the neutral one, `Σ E_i h_i z_i = 0`: there the terms in a and b do not
//! mix, and the shell is a plain one whose rest forms no surface need realise. With different ν no surface is neutral
//! for all strains, and they are refused. Exact for small growth: all layers are measured in the common metric ā.
//! Reference: Timoshenko (1925) for two layers of a strip; van Rees, Vouga and Mahadevan (2017) for forms.

use nalgebra::Vector3;

use super::{ModuliError, Response, Section, StVenantKirchhoff, positive};

/// One layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Thickness [m].
    pub thickness: f64,
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Growth of lengths along the material's axis and across it: 0.01 is one in a hundred.
    pub growth: [f64; 2],
}

/// Layers of isotropic materials with one Poisson's ratio, the first below (on the side away from the normal).
#[derive(Clone, Debug, PartialEq)]
pub struct Layered {
    /// Stretching: `A` in place of a modulus [N/m].
    stretching: StVenantKirchhoff,
    /// Bending: `D` in place of a modulus [N·m].
    bending: StVenantKirchhoff,
    rest_stretch: [f64; 2],
    rest_curvature: [f64; 2],
}

impl Layered {
    /// From the layers, bottom first.
    ///
    /// # Errors
    /// No layer; a thickness or modulus that is not positive; a length that grows to nothing.
    pub fn new(layers: &[Layer], poissons_ratio: f64) -> Result<Self, ModuliError> {
        if layers.is_empty() {
            return Err(ModuliError::NoLayers);
        }
        for layer in layers {
            positive("the thickness of a layer", layer.thickness)?;
            positive("Young's modulus of a layer", layer.youngs_modulus)?;
            for growth in layer.growth {
                positive("1 + growth of a layer", 1.0 + growth)?;
            }
        }
        let stiffness = |layer: &Layer| layer.youngs_modulus * layer.thickness;
        let membrane: f64 = layers.iter().map(stiffness).sum();
        let mut bottom = 0.0;
        let from_bottom: Vec<f64> = layers
            .iter()
            .map(|layer| {
                bottom += layer.thickness;
                bottom - 0.5 * layer.thickness
            })
            .collect();
        let weighted = |heights: &[f64]| -> f64 {
            let terms = layers.iter().zip(heights);
            terms.map(|(layer, z)| stiffness(layer) * z).sum()
        };
        let neutral = weighted(&from_bottom) / membrane;
        let heights: Vec<f64> = from_bottom.iter().map(|z| z - neutral).collect();
        let rigidity: f64 = layers
            .iter()
            .zip(&heights)
            .map(|(layer, z)| stiffness(layer) * (layer.thickness.powi(2) / 12.0 + z * z))
            .sum();
        // Of the grown forms only the difference from 1 is summed: small growth keeps its digits.
        let sum = |axis: usize, weight: &dyn Fn(f64) -> f64| -> f64 {
            let terms = layers.iter().zip(&heights).map(|(layer, &z)| {
                let growth = layer.growth[axis];
                stiffness(layer) * weight(z) * growth * (2.0 + growth)
            });
            terms.sum()
        };
        Ok(Self {
            stretching: StVenantKirchhoff::new(membrane, poissons_ratio),
            bending: StVenantKirchhoff::new(rigidity, poissons_ratio),
            rest_stretch: [0, 1].map(|axis| (1.0 + sum(axis, &|_| 1.0) / membrane).sqrt()),
            rest_curvature: [0, 1].map(|axis| sum(axis, &|z| z) / (2.0 * rigidity)),
        })
    }

    /// Rest lengths along the material's axis and across it, in units of those before growth: the roots of ā.
    pub fn rest_stretch(&self) -> [f64; 2] {
        self.rest_stretch
    }

    /// b̄ along the material's axis and across it [1/m], per length before growth.
    pub fn rest_curvature(&self) -> [f64; 2] {
        self.rest_curvature
    }
}

impl Section for Layered {
    fn stretch(&self, _face: usize, strain: &Vector3<f64>) -> Response {
        self.stretching.evaluate(strain)
    }
    fn bend(&self, _face: usize, curvature_change: &Vector3<f64>) -> Response {
        self.bending.evaluate(curvature_change)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Homogeneous;
    use super::*;

    fn layer(thickness: f64, youngs_modulus: f64, growth: f64) -> Layer {
        Layer {
            thickness,
            youngs_modulus,
            growth: [growth; 2],
        }
    }

    #[test]
    fn equal_layers_are_one_shell() {
        let layers = [layer(1e-3, 2e6, 0.0), layer(3e-3, 2e6, 0.0)];
        let layered = Layered::new(&layers, 0.3).unwrap();
        let single = Homogeneous::uniform(StVenantKirchhoff::new(2e6, 0.3), 4e-3, 1);
        let strain = Vector3::new(0.1, -0.05, 0.02);
        for (found, expected) in [
            (layered.stretch(0, &strain), single.stretch(0, &strain)),
            (layered.bend(0, &strain), single.bend(0, &strain)),
        ] {
            assert!((found.density / expected.density - 1.0).abs() < 1e-14);
            assert!((found.tangent - expected.tangent).norm() < 1e-14 * expected.tangent.norm());
        }
        assert_eq!(
            (layered.rest_stretch(), layered.rest_curvature()),
            ([1.0; 2], [0.0; 2])
        );
    }

    /// κ = 6 (ε₁ − ε₂)(1 + m)² / (h (3 (1 + m)² + (1 + m n)(m² + 1/(m n)))), m = h₁/h₂, n = E₁/E₂: Timoshenko (1925).
    #[test]
    fn a_bimetal_curves_as_timoshenko_says() {
        for (m, n) in [(1.0, 1.0), (0.5, 3.0), (2.0, 0.2)] {
            let (h, misfit) = (1e-3, 1e-6);
            let upper = h / (1.0 + m);
            let layers = [layer(m * upper, n * 2e9, 0.0), layer(upper, 2e9, misfit)];
            let [along, across] = Layered::new(&layers, 0.3).unwrap().rest_curvature();
            let expected = 6.0 * misfit * (1.0 + m) * (1.0 + m)
                / (h * (3.0 * (1.0 + m) * (1.0 + m) + (1.0 + m * n) * (m * m + 1.0 / (m * n))));
            // The growth of the form is (1 + g)² − 1, half of which exceeds g by half its square; the upper layer grows, so
            // normals fan out.
            assert!((along / expected - 1.0).abs() < misfit && along == across);
        }
    }

    #[test]
    fn equal_growth_only_stretches() {
        let layers = [layer(1e-3, 1e6, 0.1), layer(2e-3, 5e6, 0.1)];
        let layered = Layered::new(&layers, 0.3).unwrap();
        assert!((layered.rest_stretch()[0] - 1.1).abs() < 1e-15);
        assert!(layered.rest_curvature()[0].abs() < 1e-12);
    }

    #[test]
    fn impossible_layers_are_refused() {
        assert!(Layered::new(&[], 0.3).is_err());
        let error = Layered::new(&[layer(1e-3, 1e6, -1.0)], 0.3).unwrap_err();
        assert_eq!(
            error.to_string(),
            "1 + growth of a layer must be larger than 0, but it is 0"
        );
    }
}
