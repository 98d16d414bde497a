//! Which meshes a model is made of, as a number a body: a scene's text does not show that a mesh file was changed.

use super::model::{Composition, FineSurface, Model, ObstacleShape, RestPrescription, Surface};
use crate::Vec3;

/// FNV-1a, 64 bits: two different meshes share it once in 10¹⁹; not meant against forgery.
struct Fnv(u64);

impl Fnv {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn add_points(&mut self, points: &[Vec3]) {
        for value in points.iter().flat_map(|x| x.iter()) {
            self.add(&value.to_le_bytes());
        }
    }

    /// What a file says of single faces.
    fn add_composition(&mut self, composition: &Composition) {
        for value in composition.by_face.values() {
            self.add(&value.to_le_bytes());
        }
        self.add_points(&composition.axes);
        let RestPrescription { first, second, .. } = &composition.rest;
        for value in first.iter().chain(second).flatten().flatten() {
            self.add(&value.to_le_bytes());
        }
    }

    fn add_surface(&mut self, surface: &Surface) {
        for vertex in surface.mesh.faces().iter().flatten() {
            self.add(&vertex.to_le_bytes());
        }
        self.add_points(&surface.positions);
    }
}

impl Model {
    /// Name of each shell, double layer, Bézier shell, then obstacle, with a number that changes with any vertex or face of its mesh.
    pub fn fingerprints(&self) -> Vec<(String, u64)> {
        let shells = self.shells.iter().enumerate().map(|(index, shell)| {
            let mut hash = Fnv::new();
            hash.add_surface(&shell.surface);
            hash.add_points(&shell.rest_positions);
            hash.add_composition(&shell.composition);
            let heated = self.heated_shells.iter().filter(|part| part.shell == index);
            let setups = heated.map(|part| &part.setup);
            let textures = setups.flat_map(|s| [&s.loss_factors, &s.diffusivity_factors]);
            let intensities = (self.heat_sources.iter()).flat_map(|source| &source.intensity);
            for value in textures.chain(intensities).flatten() {
                hash.add(&value.to_le_bytes());
            }
            (shell.name.clone(), hash.0)
        });
        let layers = self.double_layers.iter().map(|layer| {
            let (mut hash, setup) = (Fnv::new(), &layer.setup);
            for vertex in setup.shell.mesh.quads().iter().flatten() {
                hash.add(&vertex.to_le_bytes());
            }
            hash.add_points(&setup.shell.particles);
            let sources = self
                .heat_sources
                .iter()
                .flat_map(|source| &source.intensity);
            let textures = sources.chain([&setup.loss_factors, &setup.diffusivity_factors]);
            for value in textures.flatten() {
                hash.add(&value.to_le_bytes());
            }
            (layer.name.clone(), hash.0)
        });
        let obstacles = self.obstacles.iter().map(|obstacle| {
            let mut hash = Fnv::new();
            if let ObstacleShape::Mesh(surface) = &obstacle.shape {
                hash.add_surface(surface);
            }
            for points in obstacle.deformation.iter().flat_map(|d| &d.values) {
                hash.add_points(points);
            }
            (obstacle.name.clone(), hash.0)
        });
        let bezier = self.bezier.iter().flat_map(|bezier| &bezier.parts);
        let bezier = bezier.map(|part| {
            let mut hash = Fnv::new();
            hash.add_surface(&part.shell.surface);
            hash.add_points(&part.normals);
            if let FineSurface::Bound { surface, .. } = &part.surface {
                hash.add_surface(surface);
            }
            (part.shell.name.clone(), hash.0)
        });
        shells
            .chain(layers)
            .chain(bezier)
            .chain(obstacles)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_values_of_the_function_are_met() {
        let of = |text: &str| {
            let mut hash = Fnv::new();
            hash.add(text.as_bytes());
            hash.0
        };
        assert_eq!(of(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(of("foobar"), 0x8594_4171_f739_67e8);
    }
}
