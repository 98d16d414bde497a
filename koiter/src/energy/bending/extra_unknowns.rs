//! Unknowns of a shell beside the positions of its vertices.

use crate::mesh::TriMesh;

/// What a bending model has as unknowns beside the positions of the vertices; each edge or vertex has one node of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExtraUnknowns {
    /// Nothing.
    #[default]
    None,
    /// The angle of the director of every edge [rad].
    EdgeAngles,
    /// The director of every vertex, by its three components.
    VertexDirectors,
    /// A point on every edge [m].
    EdgePoints,
}

impl ExtraUnknowns {
    /// In a few words, for lists of models.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::EdgeAngles => "edge angles",
            Self::VertexDirectors => "vertex directors",
            Self::EdgePoints => "edge points",
        }
    }

    /// Unknowns of a node.
    pub fn node_size(self) -> usize {
        match self {
            Self::None => 0,
            Self::EdgeAngles => 1,
            Self::VertexDirectors | Self::EdgePoints => 3,
        }
    }

    /// Number of nodes on a mesh.
    pub fn num_nodes(self, mesh: &TriMesh) -> usize {
        match self {
            Self::None => 0,
            Self::EdgeAngles | Self::EdgePoints => mesh.num_edges(),
            Self::VertexDirectors => mesh.num_vertices(),
        }
    }
}
