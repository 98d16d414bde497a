//! The checked triangle mesh.

/// Index of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct VertexId(pub u32);

/// Index of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EdgeId(pub u32);

/// Index of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FaceId(pub u32);

/// An oriented manifold triangle mesh, with or without boundary.
#[derive(Clone, Debug)]
pub struct TriMesh {
    num_vertices: usize,
    faces: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    edge_faces: Vec<[Option<FaceId>; 2]>,
    face_edges: Vec<[EdgeId; 3]>,
}

impl TriMesh {
    /// Number of vertices.
    pub fn num_vertices(&self) -> usize {
        self.num_vertices
    }
    /// Vertex indices of every face, counter-clockwise.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }
    /// End vertices of every edge, smaller index first; sorted lexicographically.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }
    /// The face that traverses the edge from its smaller to its larger vertex, then the other one.
    pub fn edge_faces(&self) -> &[[Option<FaceId>; 2]] {
        &self.edge_faces
    }
    /// The edge opposite each corner of a face.
    pub fn face_edges(&self) -> &[[EdgeId; 3]] {
        &self.face_edges
    }
}
