//! What a face bends by: its corners, the vertices across its edges, and the angles of directors; and how directors and
//! curvatures follow from these, for measuring and for display.

use crate::Vec3;
use crate::assembly::Dof;
use crate::geometry::{Wing, hinge_angle};
use crate::mesh::{FaceId, TriMesh};

/// The unknowns of one face.
#[derive(Clone, Copy, Debug)]
pub struct BendingStencil {
    /// The corners.
    pub corners: [Dof; 3],
    /// The vertex across each edge, if there is a neighbour.
    pub across: [Option<Dof>; 3],
    /// The angle of each edge.
    pub angles: [Dof; 3],
    /// ε of each edge.
    pub signs: [f64; 3],
}

/// Stencils of all faces, for vertices of three unknowns from `first_vertex` on and edge angles from `first_edge` on.
pub fn bending_stencils(mesh: &TriMesh, first_vertex: Dof, first_edge: Dof) -> Vec<BendingStencil> {
    let vertex = |v: u32| Dof(first_vertex.0 + 3 * v);
    (0..mesh.num_faces())
        .map(|face| {
            let edges = mesh.face_edges()[face];
            let signs: [f64; 3] = std::array::from_fn(|c| mesh.edge_sign(FaceId(face as u32), c));
            BendingStencil {
                corners: mesh.faces()[face].map(vertex),
                across: std::array::from_fn(|c| {
                    // The first side of an edge is the face with sign +1, so the neighbour is on the other one.
                    let side = if signs[c] > 0.0 { 1 } else { 0 };
                    mesh.opposite_vertex(edges[c], side).map(|v| vertex(v.0))
                }),
                angles: edges.map(|e| Dof(first_edge.0 + e.0)),
                signs,
            }
        })
        .collect()
}

/// How directors follow from tilts, as data: for measuring and for display.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DirectorShape {
    /// No directors: the bisector of the normals.
    #[default]
    Bisector,
    /// `d = cos ζ n + sin ζ t` (DCS, DSO).
    Unit,
    /// `d = n + tan ζ t` (BAC).
    Tangent,
}

/// Tilt and own wing of edge `c` of a face.
fn tilt_and_wing(stencil: &BendingStencil, c: usize, has_angle: bool, q: &[f64]) -> (f64, Wing) {
    let point = |dof: Dof| Vec3::from_column_slice(&q[dof.0 as usize..dof.0 as usize + 3]);
    let (a, b) = (
        point(stencil.corners[(c + 1) % 3]),
        point(stencil.corners[(c + 2) % 3]),
    );
    let wing = Wing::new(&a, &b, &point(stencil.corners[c]));
    let theta =
        stencil.across[c].map_or(0.0, |d| hinge_angle(&wing, &Wing::new(&b, &a, &point(d))));
    let angle = if has_angle {
        q[stencil.angles[c].0 as usize]
    } else {
        0.0
    };
    (0.5 * theta + stencil.signs[c] * angle, wing)
}

/// The directors of the three edges of a face, as seen from it ("Better Bending", Eqs. 65, 66).
pub fn directors(stencil: &BendingStencil, shape: DirectorShape, q: &[f64]) -> [Vec3; 3] {
    std::array::from_fn(|c| {
        let (tilt, wing) = tilt_and_wing(stencil, c, shape != DirectorShape::Bisector, q);
        // The outward in-plane normal of the edge is opposite to the altitude.
        match shape {
            DirectorShape::Tangent => wing.normal - wing.altitude * tilt.tan(),
            _ => wing.normal * tilt.cos() - wing.altitude * tilt.sin(),
        }
    })
}

/// The entries q_c of the second fundamental form of a face [m].
pub fn curvatures(stencil: &BendingStencil, shape: DirectorShape, q: &[f64]) -> [f64; 3] {
    std::array::from_fn(|c| {
        let (tilt, wing) = tilt_and_wing(stencil, c, shape != DirectorShape::Bisector, q);
        2.0 * wing.height
            * if shape == DirectorShape::Tangent {
                tilt.tan()
            } else {
                tilt.sin()
            }
    })
}
