//! Where the directors of a measured shape come from.

use crate::Vec3;
use crate::energy::bending::{ExtraUnknowns, vertex_normals};
use crate::mesh::Surface;

/// How the unknowns that a bending model adds are found.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Directors {
    /// Those of least bending energy.
    #[default]
    Minimise,
    /// [`natural_directors`].
    Zero,
    /// These values, node by node.
    Given(Vec<f64>),
}

/// Unknowns of a surface that is left to itself: edge angles of zero, at which directors bisect the normals of their
/// faces; vertex directors along the sum of the area-weighted normals; points in the middle of edges.
pub fn natural_directors(unknowns: ExtraUnknowns, surface: &Surface) -> Vec<f64> {
    let points: Vec<Vec3> = match unknowns {
        ExtraUnknowns::None => Vec::new(),
        ExtraUnknowns::EdgeAngles => return vec![0.0; surface.mesh.num_edges()],
        ExtraUnknowns::VertexDirectors => vertex_normals(surface),
        ExtraUnknowns::EdgePoints => {
            let point = |v: u32| surface.positions[v as usize];
            let edges = surface.mesh.edges().iter();
            edges.map(|&[u, v]| (point(u) + point(v)) * 0.5).collect()
        }
    };
    points.iter().flat_map(|x| [x.x, x.y, x.z]).collect()
}
