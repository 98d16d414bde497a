//! A mesh of quads with positions, checked to be one that a double layer can be made of.

use std::f64::consts::TAU;

use super::error::QuadMeshError;
use crate::Vec3;

/// Most edges at a vertex with which successive projections converge (Sect. 8.2 of the paper).
pub const MAX_VALENCE: usize = 6;
/// Particles, springs and render triangles are numbered in 32 bits: there are up to ten springs a quad.
pub(super) const MAX_QUADS: usize = 100_000_000;

/// Quads with positions, consistently oriented, at most two an edge.
#[derive(Clone, Debug, PartialEq)]
pub struct QuadMesh {
    positions: Vec<Vec3>,
    quads: Vec<[u32; 4]>,
    edges: Vec<QuadEdge>,
    texture_coordinates: Option<Vec<[f64; 2]>>,
}

/// An edge of a quad mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QuadEdge {
    /// Its ends, the smaller first.
    pub vertices: [u32; 2],
    /// Its quads, each with the corner at which the edge begins there; the second is absent on the boundary.
    pub sides: [Option<QuadSide>; 2],
}

/// A side of a quad: from corner `corner` to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QuadSide {
    /// The quad.
    pub quad: u32,
    /// The corner at which the side begins, 0 to 3.
    pub corner: u32,
}

impl QuadMesh {
    /// Checks the quads and finds their edges.
    ///
    /// # Errors
    /// See [`QuadMeshError`].
    pub fn new(positions: Vec<Vec3>, quads: Vec<[u32; 4]>) -> Result<Self, QuadMeshError> {
        check_indices(&positions, &quads)?;
        check_shapes(&positions, &quads)?;
        let edges = find_edges(&quads)?;
        check_valences(positions.len(), &edges)?;
        Ok(Self {
            positions,
            quads,
            edges,
            texture_coordinates: None,
        })
    }

    /// The same mesh with coordinates of its vertices in textures, 0 to 1 from left to right and from bottom to top.
    ///
    /// # Errors
    /// Another number of coordinates than vertices.
    pub fn with_texture_coordinates(
        self,
        coordinates: Vec<[f64; 2]>,
    ) -> Result<Self, QuadMeshError> {
        if coordinates.len() != self.positions.len() {
            return Err(QuadMeshError::TextureCoordinates {
                given: coordinates.len(),
                vertices: self.positions.len(),
            });
        }
        Ok(Self {
            texture_coordinates: Some(coordinates),
            ..self
        })
    }

    /// A rectangle of `size` [m] in the plane z = 0 about the origin, of `cells[0]` × `cells[1]` quads, normals along +z.
    ///
    /// Vertices run along x first. Texture coordinates are 0 at the smallest x and y.
    ///
    /// # Errors
    /// A size that is not positive, no cells, too many quads.
    pub fn grid(size: [f64; 2], cells: [usize; 2]) -> Result<Self, QuadMeshError> {
        check_positive("width of the grid", size[0])?;
        check_positive("depth of the grid", size[1])?;
        check_cells("number of cells of the grid along an axis", cells, 1)?;
        let [nx, ny] = cells;
        let (mut positions, mut coordinates) = (Vec::new(), Vec::new());
        for j in 0..=ny {
            for i in 0..=nx {
                let [u, v] = [i as f64 / nx as f64, j as f64 / ny as f64];
                positions.push(Vec3::new(size[0] * (u - 0.5), size[1] * (v - 0.5), 0.0));
                coordinates.push([u, v]);
            }
        }
        let at = |i: usize, j: usize| (j * (nx + 1) + i) as u32;
        let cells = (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j)));
        let quads = cells.map(|(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        Self::new(positions, quads.collect())?.with_texture_coordinates(coordinates)
    }

    /// A closed torus about the z axis, normals outward: `radius` [m] of its centre line, `tube` [m] that of its tube,
    /// `cells[0]` quads around the axis and `cells[1]` around the tube.
    ///
    /// # Errors
    /// A tube that is not thinner than the ring, fewer than three cells, too many quads.
    pub fn torus(radius: f64, tube: f64, cells: [usize; 2]) -> Result<Self, QuadMeshError> {
        check_positive("radius of the tube", tube)?;
        if !(radius > tube && radius.is_finite()) {
            return Err(QuadMeshError::Size {
                what: "radius of the torus",
                value: radius,
                expected: "larger than that of its tube",
            });
        }
        check_cells("number of cells of the torus around", cells, 3)?;
        let [n, m] = cells;
        let (mut positions, mut coordinates) = (Vec::new(), Vec::new());
        for j in 0..m {
            for i in 0..n {
                let [u, v] = [i as f64 / n as f64, j as f64 / m as f64];
                let (around, across) = (TAU * u, TAU * v);
                let r = radius + tube * across.cos();
                positions.push(Vec3::new(
                    r * around.cos(),
                    r * around.sin(),
                    tube * across.sin(),
                ));
                coordinates.push([u, v]);
            }
        }
        let at = |i: usize, j: usize| ((j % m) * n + i % n) as u32;
        let cells = (0..m).flat_map(|j| (0..n).map(move |i| (i, j)));
        let quads = cells.map(|(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        Self::new(positions, quads.collect())?.with_texture_coordinates(coordinates)
    }

    /// Vertex positions [m].
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Corners of the quads, in the sense of rotation about their normals.
    pub fn quads(&self) -> &[[u32; 4]] {
        &self.quads
    }

    /// Edges, by their ends.
    pub fn edges(&self) -> &[QuadEdge] {
        &self.edges
    }

    /// Coordinates of the vertices in textures.
    pub fn texture_coordinates(&self) -> Option<&[[f64; 2]]> {
        self.texture_coordinates.as_deref()
    }

    /// Checks again that positions are finite and quads are not folded, after a motion.
    ///
    /// # Errors
    /// The vertex or quad.
    pub fn check(&self) -> Result<(), QuadMeshError> {
        check_shapes(&self.positions, &self.quads)
    }

    /// Moves every vertex.
    pub fn move_by(&mut self, motion: impl Fn(Vec3) -> Vec3) {
        for x in &mut self.positions {
            *x = motion(*x);
        }
    }

    /// Mean of the corners of a quad [m].
    pub fn center(&self, quad: usize) -> Vec3 {
        0.25 * self.corners(quad).iter().sum::<Vec3>()
    }

    /// Unit normal of a quad, across its diagonals.
    pub fn normal(&self, quad: usize) -> Vec3 {
        let [a, b, c, d] = self.corners(quad);
        (c - a).cross(&(d - b)).normalize()
    }

    /// Area of a quad [m²]: half the cross product of its diagonals, exact for flat ones.
    pub fn area(&self, quad: usize) -> f64 {
        let [a, b, c, d] = self.corners(quad);
        0.5 * (c - a).cross(&(d - b)).norm()
    }

    /// Positions of the corners of a quad [m].
    pub fn corners(&self, quad: usize) -> [Vec3; 4] {
        self.quads[quad].map(|vertex| self.positions[vertex as usize])
    }
}

fn check_positive(what: &'static str, value: f64) -> Result<(), QuadMeshError> {
    match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(QuadMeshError::Size {
            what,
            value,
            expected: "larger than 0",
        }),
    }
}

fn check_cells(what: &'static str, cells: [usize; 2], least: usize) -> Result<(), QuadMeshError> {
    let count = cells[0].saturating_mul(cells[1]);
    if count > MAX_QUADS {
        let limit = MAX_QUADS;
        return Err(QuadMeshError::TooLarge { count, limit });
    }
    match cells.iter().find(|&&cells| cells < least) {
        None => Ok(()),
        Some(&cells) => Err(QuadMeshError::Size {
            what,
            value: cells as f64,
            expected: if least == 1 {
                "at least 1"
            } else {
                "at least 3"
            },
        }),
    }
}

fn check_indices(positions: &[Vec3], quads: &[[u32; 4]]) -> Result<(), QuadMeshError> {
    if quads.is_empty() {
        return Err(QuadMeshError::Empty);
    }
    if quads.len().max(positions.len()) > MAX_QUADS {
        let (count, limit) = (quads.len(), MAX_QUADS);
        return Err(QuadMeshError::TooLarge { count, limit });
    }
    let mut is_used = vec![false; positions.len()];
    for (quad, &corners) in quads.iter().enumerate() {
        for (k, &vertex) in corners.iter().enumerate() {
            let Some(used) = is_used.get_mut(vertex as usize) else {
                let num_vertices = positions.len();
                return Err(QuadMeshError::IndexOutOfRange {
                    quad,
                    vertex,
                    num_vertices,
                });
            };
            *used = true;
            if corners[..k].contains(&vertex) {
                return Err(QuadMeshError::RepeatedCorner { quad, corners });
            }
        }
    }
    match is_used.iter().position(|used| !used) {
        Some(vertex) => Err(QuadMeshError::Unused { vertex }),
        None => Ok(()),
    }
}

/// Every corner turns the way of the diagonals, by more than round-off.
fn check_shapes(positions: &[Vec3], quads: &[[u32; 4]]) -> Result<(), QuadMeshError> {
    if let Some(vertex) = (positions.iter()).position(|x| !x.iter().all(|value| value.is_finite()))
    {
        let position = positions[vertex].into();
        return Err(QuadMeshError::NotFinite { vertex, position });
    }
    for (quad, corners) in quads.iter().enumerate() {
        let x = corners.map(|vertex| positions[vertex as usize]);
        let across = (x[2] - x[0]).cross(&(x[3] - x[1]));
        for corner in 0..4 {
            let ahead = x[(corner + 1) % 4] - x[corner];
            let behind = x[(corner + 3) % 4] - x[corner];
            // A corner of a millionth of a right angle is as good as none: its spring could not be told from others.
            let least = 1e-6 * across.norm() * ahead.norm() * behind.norm();
            if !(ahead.cross(&behind).dot(&across) > least) {
                let vertex = corners[corner];
                return Err(QuadMeshError::Folded {
                    quad,
                    corner,
                    vertex,
                });
            }
        }
    }
    Ok(())
}

fn find_edges(quads: &[[u32; 4]]) -> Result<Vec<QuadEdge>, QuadMeshError> {
    let mut sides = Vec::with_capacity(4 * quads.len());
    for (quad, corners) in quads.iter().enumerate() {
        for corner in 0..4 {
            let (from, to) = (corners[corner], corners[(corner + 1) % 4]);
            let side = QuadSide {
                quad: quad as u32,
                corner: corner as u32,
            };
            sides.push(([from.min(to), from.max(to)], from < to, side));
        }
    }
    // Stable: of the quads of an edge the first in the list stays first.
    sides.sort_by_key(|&(vertices, _, _)| vertices);
    let same_edge = sides.chunk_by(|a, b| a.0 == b.0);
    let edge = |sides: &[([u32; 2], bool, QuadSide)]| match *sides {
        [(vertices, _, side)] => Ok(QuadEdge {
            vertices,
            sides: [Some(side), None],
        }),
        [(vertices, forward, a), (_, backward, b)] if forward != backward => Ok(QuadEdge {
            vertices,
            sides: [Some(a), Some(b)],
        }),
        [(vertices, _, a), (_, _, b)] => Err(QuadMeshError::InconsistentOrientation {
            quads: [a.quad, b.quad],
            vertices,
        }),
        _ => Err(QuadMeshError::CrowdedEdge {
            vertices: sides[0].0,
        }),
    };
    same_edge.map(edge).collect()
}

fn check_valences(num_vertices: usize, edges: &[QuadEdge]) -> Result<(), QuadMeshError> {
    let mut valence = vec![0; num_vertices];
    for vertex in edges.iter().flat_map(|edge| edge.vertices) {
        valence[vertex as usize] += 1;
    }
    match valence.iter().position(|&valence| valence > MAX_VALENCE) {
        None => Ok(()),
        Some(vertex) => Err(QuadMeshError::TooManyEdges {
            vertex,
            valence: valence[vertex],
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fan(blades: usize) -> Result<QuadMesh, QuadMeshError> {
        let ring = |k: usize, radius: f64| {
            let angle = TAU * k as f64 / (2 * blades) as f64;
            Vec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        };
        let mut positions = vec![Vec3::zeros()];
        positions.extend((0..2 * blades).map(|k| ring(k, 1.0 + 0.3 * (k % 2) as f64)));
        let at = |k: usize| 1 + (k % (2 * blades)) as u32;
        let quads = (0..blades).map(|k| [0, at(2 * k), at(2 * k + 1), at(2 * k + 2)]);
        QuadMesh::new(positions, quads.collect())
    }

    #[test]
    fn a_grid_has_its_vertices_and_edges() {
        let mesh = QuadMesh::grid([2.0, 1.0], [4, 3]).unwrap();
        assert_eq!(mesh.positions().len(), 20);
        assert_eq!(mesh.quads().len(), 12);
        assert_eq!(mesh.edges().len(), 4 * 4 + 3 * 5);
        assert!((0..12).all(|q| mesh.normal(q).z > 0.99));
        let area: f64 = (0..12).map(|q| mesh.area(q)).sum();
        assert!((area - 2.0).abs() < 1e-14);
    }

    #[test]
    fn a_torus_is_closed_and_points_outward() {
        let mesh = QuadMesh::torus(1.0, 0.35, [24, 12]).unwrap();
        assert_eq!(
            (mesh.quads().len(), mesh.edges().len()),
            (24 * 12, 2 * 24 * 12)
        );
        assert!(mesh.edges().iter().all(|edge| edge.sides[1].is_some()));
        let first = mesh.center(0);
        assert!(mesh.normal(0).dot(&Vec3::new(first.x, first.y, 0.0)) > 0.0);
    }

    #[test]
    fn six_edges_at_a_vertex_are_taken_and_seven_refused() {
        assert!(fan(6).is_ok());
        let expected = QuadMeshError::TooManyEdges {
            vertex: 0,
            valence: 7,
        };
        assert_eq!(fan(7).unwrap_err(), expected);
    }

    #[test]
    fn what_is_no_quad_mesh_is_refused_by_element() {
        let square = |x: [[f64; 2]; 4]| x.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec();
        let unit = square([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        let refused = |positions: &[Vec3], quads: &[[u32; 4]]| {
            QuadMesh::new(positions.to_vec(), quads.to_vec()).unwrap_err()
        };
        // Two corners change places: the quad crosses itself.
        let crossed = refused(&unit, &[[0, 1, 3, 2]]);
        assert!(matches!(crossed, QuadMeshError::Folded { quad: 0, .. }));
        let dart = square([[0.0, 0.0], [1.0, 0.0], [0.2, 0.2], [0.0, 1.0]]);
        let error = refused(&dart, &[[0, 1, 2, 3]]);
        assert!(matches!(error, QuadMeshError::Folded { corner: 2, .. }));
        assert!(matches!(
            refused(&unit, &[[0, 1, 1, 2]]),
            QuadMeshError::RepeatedCorner { .. }
        ));
        assert!(matches!(
            refused(&unit, &[[0, 1, 2, 9]]),
            QuadMeshError::IndexOutOfRange { vertex: 9, .. }
        ));
        assert_eq!(refused(&unit, &[]), QuadMeshError::Empty);
        let mut two = unit.clone();
        two.extend([Vec3::new(2.0, 0.0, 0.0), Vec3::new(2.0, 1.0, 0.0)]);
        let error = refused(&two, &[[0, 1, 2, 3], [1, 2, 5, 4]]);
        assert!(matches!(
            error,
            QuadMeshError::InconsistentOrientation { quads: [0, 1], .. }
        ));
        assert_eq!(
            refused(&two, &[[0, 1, 2, 3]]),
            QuadMeshError::Unused { vertex: 4 }
        );
        assert!(matches!(
            QuadMesh::grid([1.0, f64::NAN], [2, 2]).unwrap_err(),
            QuadMeshError::Size { .. }
        ));
        assert!(matches!(
            QuadMesh::grid([1.0, 1.0], [1 << 30, 1 << 30]).unwrap_err(),
            QuadMeshError::TooLarge { .. }
        ));
    }
}
