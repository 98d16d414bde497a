//! Where the directors of a measured shape come from.

use crate::Vec3;
use crate::energy::bending::ExtraUnknowns;
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

/// Unit vectors along the sum of the area-weighted normals of the faces around every vertex.
fn vertex_normals(surface: &Surface) -> Vec<Vec3> {
    let mut sums = vec![Vec3::zeros(); surface.mesh.num_vertices()];
    for (f, face) in surface.mesh.faces().iter().enumerate() {
        let [a, b, c] = surface.corners(f);
        let normal = (b - a).cross(&(c - a));
        face.iter().for_each(|&v| sums[v as usize] += normal);
    }
    // Where normals cancel (a cone folded flat) any direction is as good.
    let direction = |sum: Vec3| sum.try_normalize(0.0).unwrap_or_else(Vec3::z);
    sums.into_iter().map(direction).collect()
}
