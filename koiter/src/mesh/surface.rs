//! A triangle mesh with positions, checked to be one that can be simulated.

use super::{MeshError, TriMesh, repair};
use crate::Vec3;

/// A triangle mesh with positions.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Topology.
    pub mesh: TriMesh,
    /// Vertex positions [m].
    pub positions: Vec<Vec3>,
}

/// What to do about faults that can be repaired.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SurfaceOptions {
    /// Neighbours of opposite orientation.
    pub orientation: OrientationPolicy,
    /// Vertices without faces.
    pub unreferenced: UnreferencedPolicy,
}

/// What to do when neighbouring faces disagree in orientation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OrientationPolicy {
    /// Reverse faces so that all agree with the first face of their component, and log a warning with the count.
    Repair,
    /// Return an error.
    #[default]
    Refuse,
}

/// What to do about vertices that belong to no face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UnreferencedPolicy {
    /// Drop them, renumber the others in order, and log a warning with the count.
    #[default]
    Drop,
    /// Return an error.
    Refuse,
}

/// Smallest height over longest edge of a face.
///
/// The determinant of the first fundamental form is `a00 a11 − a01² = (2A)²` beside terms of size `L⁴` (`A` area,
/// `L` longest edge). At `2A/L² = 1.5e-8` the difference drowns in the round-off `2.2e-16 L⁴` and the form has no
/// usable inverse; a factor of about ten is kept from that.
pub const MIN_HEIGHT_RATIO: f64 = 1e-7;

impl Surface {
    /// Checks positions and faces and builds the topology.
    ///
    /// # Errors
    /// Those of [`TriMesh::new`]; also a coordinate that is NaN or infinite, and a face whose height is less than
    /// [`MIN_HEIGHT_RATIO`] of its longest edge.
    pub fn new(
        positions: Vec<Vec3>,
        faces: Vec<[u32; 3]>,
        options: SurfaceOptions,
    ) -> Result<Self, MeshError> {
        if options.unreferenced == UnreferencedPolicy::Refuse {
            return Self::with_all_vertices(positions, faces, options.orientation);
        }
        let all = positions.len();
        let (positions, faces, kept) = repair::drop_unreferenced(positions, faces)?;
        let dropped = all - positions.len();
        if dropped > 0 {
            log::warn!(
                "dropped {dropped} vertices that belong to no face; the others are renumbered"
            );
        }
        Self::with_all_vertices(positions, faces, options.orientation)
            .map_err(|error| error.renumbered(&kept))
    }

    fn with_all_vertices(
        positions: Vec<Vec3>,
        mut faces: Vec<[u32; 3]>,
        orientation: OrientationPolicy,
    ) -> Result<Self, MeshError> {
        if orientation == OrientationPolicy::Repair {
            let flipped;
            (faces, flipped) = repair::orient_consistently(faces)?;
            if flipped > 0 {
                log::warn!("reversed {flipped} faces to make the orientation consistent");
            }
        }
        let mesh = TriMesh::new(positions.len(), faces)?;
        Self::from_mesh(mesh, positions)
    }

    /// Joins a checked topology with positions, with the same checks of the positions as [`Self::new`].
    ///
    /// # Errors
    /// Wrong number of positions, a coordinate that is not finite, a degenerate face.
    pub fn from_mesh(mesh: TriMesh, positions: Vec<Vec3>) -> Result<Self, MeshError> {
        let surface = Self { mesh, positions };
        surface.check_positions()?;
        Ok(surface)
    }

    /// Corner positions of a face [m].
    pub fn corners(&self, face: usize) -> [Vec3; 3] {
        self.mesh.faces()[face].map(|v| self.positions[v as usize])
    }

    /// Area of a face [m²].
    pub fn face_area(&self, face: usize) -> f64 {
        let [a, b, c] = self.corners(face);
        0.5 * (b - a).cross(&(c - a)).norm()
    }

    /// Total area [m²].
    pub fn area(&self) -> f64 {
        (0..self.mesh.num_faces()).map(|f| self.face_area(f)).sum()
    }

    /// Enclosed volume [m³] of a closed surface: positive if the normals point outward.
    pub fn signed_volume(&self) -> f64 {
        // Relative to a vertex rather than the origin, to keep the terms as small as the body.
        let origin = self.positions[0];
        let mut volume = 0.0;
        for f in 0..self.mesh.num_faces() {
            let [a, b, c] = self.corners(f).map(|x| x - origin);
            volume += a.dot(&b.cross(&c)) / 6.0;
        }
        volume
    }

    /// Smallest and largest coordinates [m].
    pub fn bounding_box(&self) -> (Vec3, Vec3) {
        let first = self.positions[0];
        self.positions
            .iter()
            .fold((first, first), |(low, high), x| (low.inf(x), high.sup(x)))
    }

    /// Length of an edge [m].
    pub fn edge_length(&self, edge: usize) -> f64 {
        let [u, v] = self.mesh.edges()[edge];
        (self.positions[v as usize] - self.positions[u as usize]).norm()
    }

    /// Mean edge length [m].
    pub fn mean_edge_length(&self) -> f64 {
        let total: f64 = (0..self.mesh.num_edges())
            .map(|e| self.edge_length(e))
            .sum();
        total / self.mesh.num_edges() as f64
    }

    /// Length of the shortest edge [m].
    pub fn shortest_edge_length(&self) -> f64 {
        (0..self.mesh.num_edges())
            .map(|e| self.edge_length(e))
            .fold(f64::INFINITY, f64::min)
    }

    /// Smallest angle of all faces [rad].
    pub fn min_angle(&self) -> f64 {
        let mut smallest = f64::INFINITY;
        for f in 0..self.mesh.num_faces() {
            let x = self.corners(f);
            for c in 0..3 {
                let (a, b) = (x[(c + 1) % 3] - x[c], x[(c + 2) % 3] - x[c]);
                smallest = smallest.min(a.cross(&b).norm().atan2(a.dot(&b)));
            }
        }
        smallest
    }

    fn check_positions(&self) -> Result<(), MeshError> {
        if self.positions.len() != self.mesh.num_vertices() {
            let (positions, vertices) = (self.positions.len(), self.mesh.num_vertices());
            return Err(MeshError::PositionCount {
                positions,
                vertices,
            });
        }
        for (vertex, x) in self.positions.iter().enumerate() {
            if !x.iter().all(|value| value.is_finite()) {
                return Err(MeshError::NotFinite {
                    vertex: vertex as u32,
                    position: (*x).into(),
                });
            }
        }
        for face in 0..self.mesh.num_faces() {
            let [a, b, c] = self.corners(face);
            let edges = [b - a, c - b, a - c];
            // Scaled first, so that squares of very small or large lengths neither vanish nor overflow.
            let scale = edges
                .map(|e| e.amax())
                .into_iter()
                .fold(f64::MIN_POSITIVE, f64::max);
            let [e0, e1, e2] = edges.map(|e| e / scale);
            let longest = e0.norm().max(e1.norm()).max(e2.norm());
            let ratio = e0.cross(&e1).norm() / (longest * longest);
            let longest_edge = longest * scale;
            if ratio.is_nan() || ratio < MIN_HEIGHT_RATIO {
                let corners = self.mesh.faces()[face];
                let limit = MIN_HEIGHT_RATIO;
                return Err(MeshError::DegenerateFace {
                    face,
                    corners,
                    ratio,
                    longest_edge,
                    limit,
                });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Vec3> {
        [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]
            .map(|[x, y]| Vec3::new(x, y, 0.0))
            .to_vec()
    }
    const FACES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

    fn build(positions: Vec<Vec3>, faces: &[[u32; 3]]) -> Result<Surface, MeshError> {
        Surface::new(positions, faces.to_vec(), SurfaceOptions::default())
    }

    #[test]
    fn measures_of_a_rectangle_are_exact() {
        let surface = build(square(), &FACES).unwrap();
        assert_eq!(surface.area(), 2.0);
        assert_eq!(
            surface.bounding_box(),
            (Vec3::zeros(), Vec3::new(2.0, 1.0, 0.0))
        );
        assert_eq!(surface.shortest_edge_length(), 1.0);
        assert!((surface.mean_edge_length() - (6.0 + 5f64.sqrt()) / 5.0).abs() < 1e-15);
        assert!((surface.min_angle() - 0.5f64.atan()).abs() < 1e-15);
    }

    #[test]
    fn coordinates_that_are_not_finite_are_refused() {
        let mut positions = square();
        positions[2].y = f64::NAN;
        let text = build(positions, &FACES).unwrap_err().to_string();
        assert!(text.contains("vertex 2") && text.contains("NaN"), "{text}");
    }

    #[test]
    fn degenerate_faces_are_refused_at_any_scale() {
        for scale in [1e-200, 1e-6, 1.0, 1e6, 1e200] {
            let good = square().iter().map(|x| x * scale).collect();
            assert!(build(good, &FACES).is_ok(), "scale {scale}");
            let mut flat: Vec<Vec3> = square().iter().map(|x| x * scale).collect();
            flat[1] = (flat[0] + flat[2]) / 2.0;
            let error = build(flat, &FACES).unwrap_err();
            assert!(
                matches!(error, MeshError::DegenerateFace { face: 0, .. }),
                "{error}"
            );
        }
        let error = build(vec![Vec3::zeros(); 4], &FACES).unwrap_err();
        assert!(
            matches!(error, MeshError::DegenerateFace { face: 0, .. }),
            "{error}"
        );
    }

    #[test]
    fn unreferenced_vertices_are_dropped_or_refused_as_asked() {
        let mut positions = square();
        positions.insert(1, Vec3::new(9.0, 9.0, 9.0));
        let faces = vec![[0, 2, 3], [0, 3, 4]];
        let surface = build(positions.clone(), &faces).unwrap();
        assert_eq!(surface.positions, square());
        assert_eq!(surface.mesh.faces(), FACES);
        let refuse = SurfaceOptions {
            unreferenced: UnreferencedPolicy::Refuse,
            ..Default::default()
        };
        let error = Surface::new(positions, faces, refuse).unwrap_err();
        assert_eq!(error, MeshError::Unreferenced { first: 1, count: 1 });
    }

    #[test]
    fn errors_name_vertices_by_their_number_before_dropping() {
        let mut positions = square();
        positions.insert(0, Vec3::zeros());
        let error = build(positions.clone(), &[[1, 2, 3], [2, 1, 3]]).unwrap_err();
        assert_eq!(
            error,
            MeshError::DuplicateFace {
                faces: [0, 1],
                vertices: [1, 2, 3]
            }
        );
        positions[3].x = f64::INFINITY;
        let error = build(positions, &[[1, 2, 3], [1, 3, 4]]).unwrap_err();
        assert!(
            matches!(error, MeshError::NotFinite { vertex: 3, .. }),
            "{error}"
        );
    }

    #[test]
    fn orientation_is_repaired_or_refused_as_asked() {
        let faces = vec![[0, 1, 2], [2, 0, 3], [4, 3, 0]];
        let mut positions = square();
        positions.push(Vec3::new(-1.0, 0.5, 0.0));
        let wrong = vec![faces[0], [0, 2, 3], [3, 4, 0], [0, 4, 5]];
        assert!(build(positions.clone(), &faces).is_err());
        let repair = SurfaceOptions {
            orientation: OrientationPolicy::Repair,
            ..Default::default()
        };
        let surface = Surface::new(positions.clone(), faces, repair).unwrap();
        assert!((0..3).all(|f| {
            let [a, b, c] = surface.corners(f);
            (b - a).cross(&(c - a)).z > 0.0
        }));
        // Repair does not hide other faults.
        let error = Surface::new(positions, wrong, repair).unwrap_err();
        assert!(
            matches!(
                error,
                MeshError::IndexOutOfRange {
                    face: 3,
                    vertex: 5,
                    ..
                }
            ),
            "{error}"
        );
    }

    #[test]
    fn wrong_number_of_positions_is_refused() {
        let mesh = TriMesh::new(4, FACES.to_vec()).unwrap();
        let error = Surface::from_mesh(mesh, square()[..3].to_vec()).unwrap_err();
        assert_eq!(
            error,
            MeshError::PositionCount {
                positions: 3,
                vertices: 4
            }
        );
    }
}
