//! A double layer of springs on a quad mesh, arranged as a body-centred square.
//!
//! ```text
//! corner particles   c_v = vertices of the mesh                            red     corner – lattice, 4 a quad
//! lattice particles  c_q = centre of quad q + t n_q                        green   lattice – lattice, across interior edges
//!                                                                          blue    corner – corner, along edges
//!                                                                          yellow  corner – corner, the diagonals of quads
//! ```
//!
//! t thickness, n_q unit normal. Blue and green are the two layers, red holds them together at their distance, yellow
//! resists shear. A shell bends when its layers differ in length. An N × N grid has 10 N² springs.
//!
//! What is shown and what collides is the layer of corners: four triangles a quad, about the mean of its corners. Triangle
//! `4 q + k` has corners k, k + 1 of quad q and its centre.
//!
//! Paper: "Shrinkage, wrinkling and ablation of burning cloth and paper", Sect. 3.

use super::quad_mesh::QuadMesh;
use super::springs::Springs;
use crate::Vec3;

/// No triangle, in [`DoubleLayer::supports`].
pub(super) const NO_TRIANGLE: u32 = u32::MAX;

/// The colours of springs, in the order in which they are projected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Color {
    /// Between the layers.
    Red,
    /// Of the lattice layer.
    Green,
    /// Of the corner layer.
    Blue,
    /// Diagonals of the corner layer.
    Yellow,
}

/// All colours, in the order in which they are projected.
pub const COLORS: [Color; 4] = [Color::Red, Color::Green, Color::Blue, Color::Yellow];

/// Particles and springs of a double layer, and what they are made from.
#[derive(Clone, Debug, PartialEq)]
pub struct DoubleLayer {
    /// The mesh, at rest.
    pub mesh: QuadMesh,
    /// Distance of the layers [m].
    pub thickness: f64,
    /// Initial positions of the particles [m]: corners, then lattice.
    pub particles: Vec<Vec3>,
    /// Springs by colour.
    pub springs: [Springs; 4],
    /// The render triangles that keep each spring, by colour: a spring goes when all of them have burnt.
    pub supports: [Vec<[u32; 4]>; 4],
}

impl DoubleLayer {
    /// Makes particles and springs; `thickness` [m] is positive.
    pub fn new(mesh: QuadMesh, thickness: f64) -> Self {
        let lattice = (0..mesh.quads().len()).map(|q| mesh.center(q) + thickness * mesh.normal(q));
        let particles: Vec<Vec3> = mesh.positions().iter().copied().chain(lattice).collect();
        let parts = [red(&mesh), green(&mesh), blue(&mesh), yellow(&mesh)].map(|springs| {
            let (ends, supports): (Vec<_>, Vec<[u32; 4]>) = springs.into_iter().unzip();
            let (springs, order) = Springs::along_lines(&ends, &particles);
            let supports = order.iter().map(|&old| supports[old as usize]).collect();
            (springs, supports)
        });
        let [red, green, blue, yellow] = parts;
        Self {
            thickness,
            springs: [red.0, green.0, blue.0, yellow.0],
            supports: [red.1, green.1, blue.1, yellow.1],
            particles,
            mesh,
        }
    }

    /// Number of corner particles; lattice particles follow them.
    pub fn num_corners(&self) -> usize {
        self.mesh.positions().len()
    }

    /// The lattice particle of a quad.
    pub fn lattice(&self, quad: usize) -> usize {
        self.num_corners() + quad
    }

    /// Number of springs of all colours.
    pub fn num_springs(&self) -> usize {
        self.springs.iter().map(Springs::len).sum()
    }

    /// Initial masses of the particles [kg], for a mass a unit of area [kg/m²]: each quad gives half of its mass to its
    /// lattice particle and an eighth to each corner, so that both layers of a large sheet weigh the same.
    pub fn masses(&self, area_density: f64) -> Vec<f64> {
        let mut masses = vec![0.0; self.particles.len()];
        for (quad, corners) in self.mesh.quads().iter().enumerate() {
            let mass = area_density * self.mesh.area(quad);
            masses[self.lattice(quad)] = 0.5 * mass;
            for &corner in corners {
                masses[corner as usize] += 0.125 * mass;
            }
        }
        masses
    }

    /// A value at vertices, carried to the lattice by the mean over the corners of each quad.
    pub fn on_particles(&self, at_vertices: &[f64]) -> Vec<f64> {
        let mean = |corners: &[u32; 4]| {
            0.25 * corners.map(|v| at_vertices[v as usize]).iter().sum::<f64>()
        };
        let lattice = self.mesh.quads().iter().map(mean);
        at_vertices.iter().copied().chain(lattice).collect()
    }

    /// Half of the longest diagonal of a quad [m]: how far the centre of a quad may be from its nearest corner.
    pub fn half_diagonal(&self) -> f64 {
        let diagonal = |quad: usize| {
            let [a, b, c, d] = self.mesh.corners(quad);
            (c - a).norm().max((d - b).norm())
        };
        0.5 * (0..self.mesh.quads().len())
            .map(diagonal)
            .fold(0.0, f64::max)
    }
}

type Supported = ([u32; 2], [u32; 4]);

fn triangle(quad: u32, corner: u32) -> u32 {
    4 * quad + corner % 4
}

fn lattice(mesh: &QuadMesh, quad: u32) -> u32 {
    mesh.positions().len() as u32 + quad
}

fn red(mesh: &QuadMesh) -> Vec<Supported> {
    let of_quad = |(quad, corners): (usize, &[u32; 4])| {
        let (quad, corners) = (quad as u32, *corners);
        let center = lattice(mesh, quad);
        (0..4u32).map(move |k| {
            let around = [
                triangle(quad, k),
                triangle(quad, k + 3),
                NO_TRIANGLE,
                NO_TRIANGLE,
            ];
            ([corners[k as usize], center], around)
        })
    };
    mesh.quads().iter().enumerate().flat_map(of_quad).collect()
}

fn green(mesh: &QuadMesh) -> Vec<Supported> {
    let across = mesh.edges().iter().filter_map(|edge| match edge.sides {
        [Some(a), Some(b)] => {
            let crossed = [triangle(a.quad, a.corner), triangle(b.quad, b.corner)];
            let ends = [lattice(mesh, a.quad), lattice(mesh, b.quad)];
            Some((ends, [crossed[0], crossed[1], NO_TRIANGLE, NO_TRIANGLE]))
        }
        _ => None,
    });
    across.collect()
}

fn blue(mesh: &QuadMesh) -> Vec<Supported> {
    let along = mesh.edges().iter().map(|edge| {
        let side =
            |k: usize| edge.sides[k].map_or(NO_TRIANGLE, |side| triangle(side.quad, side.corner));
        (edge.vertices, [side(0), side(1), NO_TRIANGLE, NO_TRIANGLE])
    });
    along.collect()
}

fn yellow(mesh: &QuadMesh) -> Vec<Supported> {
    let of_quad = |(quad, &[a, b, c, d]): (usize, &[u32; 4])| {
        let all = [0, 1, 2, 3].map(|k| triangle(quad as u32, k));
        [([a, c], all), ([b, d], all)]
    };
    mesh.quads().iter().enumerate().flat_map(of_quad).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_grid_has_ten_springs_a_cell() {
        for n in [1, 2, 6, 10, 100] {
            let shell = DoubleLayer::new(QuadMesh::grid([1.0, 1.0], [n, n]).unwrap(), 0.02);
            let counts = shell.springs.each_ref().map(Springs::len);
            let expected = [4 * n * n, 2 * n * (n - 1), 2 * n * (n + 1), 2 * n * n];
            assert_eq!(counts, expected);
            assert_eq!(shell.num_springs(), 10 * n * n);
        }
    }

    #[test]
    fn lengths_and_masses_are_those_of_the_formulas() {
        let (d, t) = (0.1, 0.025);
        let shell = DoubleLayer::new(QuadMesh::grid([0.6, 0.6], [6, 6]).unwrap(), t);
        let expected = [(d * d / 2.0 + t * t).sqrt(), d, d, d * 2.0_f64.sqrt()];
        for (springs, expected) in shell.springs.iter().zip(expected) {
            for length in &springs.initial_lengths {
                // Round-off of coordinates below 1.
                assert!((length - expected).abs() < 1e-15, "{length} for {expected}");
            }
        }
        let masses = shell.masses(2.0);
        assert!((masses.iter().sum::<f64>() - 2.0 * 0.36).abs() < 1e-14);
        assert!((masses[3 * 7 + 3] - masses[shell.lattice(14)]).abs() < 1e-15);
    }

    #[test]
    fn straight_lines_of_a_grid_are_numbered_through() {
        let shell = DoubleLayer::new(QuadMesh::grid([1.0, 1.0], [8, 8]).unwrap(), 0.01);
        // Blue: 9 lines of 8 springs each way; green: 8 lines of 7 each way.
        for (color, lines) in [(Color::Blue, 18), (Color::Green, 16)] {
            let springs = &shell.springs[color as usize];
            let ends = springs.is_continued.iter().filter(|&&c| !c).count();
            assert_eq!(ends, lines, "{color:?}");
        }
    }
}
