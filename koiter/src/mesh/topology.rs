//! The checked triangle mesh: what is connected to what.

use super::MeshError;

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
#[derive(Clone, Debug, PartialEq)]
pub struct TriMesh {
    num_vertices: usize,
    faces: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    edge_faces: Vec<[Option<FaceId>; 2]>,
    face_edges: Vec<[EdgeId; 3]>,
    /// Faces of vertex `v`: `vertex_face_list[vertex_face_starts[v]..vertex_face_starts[v + 1]]`.
    vertex_face_starts: Vec<u32>,
    vertex_face_list: Vec<FaceId>,
    on_boundary: Vec<bool>,
}

impl TriMesh {
    /// Builds the connectivity of `faces` and checks that it is an oriented manifold.
    ///
    /// # Errors
    /// No faces, an index that is out of range or repeated in a face, two equal faces, an edge of more than two faces,
    /// neighbours of opposite orientation, a vertex where separate fans meet, a vertex without faces. Repairs are in
    /// [`super::repair`].
    pub fn new(num_vertices: usize, faces: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        check_faces(num_vertices, &faces)?;
        let (edges, edge_faces, face_edges) = build_edges(&faces)?;
        let (vertex_face_starts, vertex_face_list) = build_vertex_faces(num_vertices, &faces)?;
        let mut on_boundary = vec![false; num_vertices];
        for (edge, sides) in edges.iter().zip(&edge_faces) {
            if sides.contains(&None) {
                on_boundary[edge[0] as usize] = true;
                on_boundary[edge[1] as usize] = true;
            }
        }
        let mesh = Self {
            num_vertices,
            faces,
            edges,
            edge_faces,
            face_edges,
            vertex_face_starts,
            vertex_face_list,
            on_boundary,
        };
        mesh.check_fans()?;
        Ok(mesh)
    }

    /// Number of vertices.
    pub fn num_vertices(&self) -> usize {
        self.num_vertices
    }

    /// Number of edges.
    pub fn num_edges(&self) -> usize {
        self.edges.len()
    }

    /// Number of faces.
    pub fn num_faces(&self) -> usize {
        self.faces.len()
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

    /// The faces of a vertex, in ascending order.
    pub fn vertex_faces(&self, vertex: VertexId) -> &[FaceId] {
        let v = vertex.0 as usize;
        let start = self.vertex_face_starts[v] as usize;
        let end = self.vertex_face_starts[v + 1] as usize;
        &self.vertex_face_list[start..end]
    }

    /// Number of edges at a vertex.
    pub fn valence(&self, vertex: VertexId) -> usize {
        self.vertex_faces(vertex).len() + usize::from(self.is_boundary_vertex(vertex))
    }

    /// Whether the vertex lies on the boundary.
    pub fn is_boundary_vertex(&self, vertex: VertexId) -> bool {
        self.on_boundary[vertex.0 as usize]
    }

    /// Whether the edge has one face only.
    pub fn is_boundary_edge(&self, edge: EdgeId) -> bool {
        self.edge_faces[edge.0 as usize].contains(&None)
    }

    /// +1 if the face traverses its edge `corner` from the smaller to the larger vertex index, else −1.
    pub fn edge_sign(&self, face: FaceId, corner: usize) -> f64 {
        let f = self.faces[face.0 as usize];
        if f[(corner + 1) % 3] < f[(corner + 2) % 3] {
            1.0
        } else {
            -1.0
        }
    }

    /// The vertex opposite the edge in its face of side 0 or 1 (see [`Self::edge_faces`]).
    pub fn opposite_vertex(&self, edge: EdgeId, side: usize) -> Option<VertexId> {
        let face = self.edge_faces[edge.0 as usize][side]?.0 as usize;
        let corner = (0..3).find(|&c| self.face_edges[face][c] == edge)?;
        Some(VertexId(self.faces[face][corner]))
    }

    /// The edge between two vertices, if there is one.
    pub fn find_edge(&self, a: VertexId, b: VertexId) -> Option<EdgeId> {
        let key = [a.0.min(b.0), a.0.max(b.0)];
        self.edges
            .binary_search(&key)
            .ok()
            .map(|e| EdgeId(e as u32))
    }

    /// The boundary as closed vertex loops: the surface lies to the left of each loop (seen with normals up).
    ///
    /// A loop starts at its smallest vertex; loops are ordered by it.
    pub fn boundary_loops(&self) -> Vec<Vec<VertexId>> {
        // Vertices are manifold, so each boundary vertex has exactly one outgoing boundary edge.
        let mut next = vec![u32::MAX; self.num_vertices];
        for (edge, sides) in self.edges.iter().zip(&self.edge_faces) {
            match sides {
                [Some(_), None] => next[edge[0] as usize] = edge[1],
                [None, Some(_)] => next[edge[1] as usize] = edge[0],
                _ => {}
            }
        }
        let mut loops = Vec::new();
        for start in 0..self.num_vertices {
            let mut vertex = start as u32;
            let mut vertices = Vec::new();
            while next[vertex as usize] != u32::MAX {
                vertices.push(VertexId(vertex));
                vertex = std::mem::replace(&mut next[vertex as usize], u32::MAX);
            }
            if !vertices.is_empty() {
                loops.push(vertices);
            }
        }
        loops
    }

    /// Number of connected components and the component of every vertex, numbered in the order of first vertices.
    pub fn components(&self) -> (usize, Vec<u32>) {
        let mut of_vertex = vec![u32::MAX; self.num_vertices];
        let mut count = 0;
        let mut stack = Vec::new();
        for start in 0..self.num_vertices as u32 {
            if of_vertex[start as usize] != u32::MAX {
                continue;
            }
            of_vertex[start as usize] = count;
            stack.push(start);
            while let Some(vertex) = stack.pop() {
                for face in self.vertex_faces(VertexId(vertex)) {
                    for neighbour in self.faces[face.0 as usize] {
                        if of_vertex[neighbour as usize] == u32::MAX {
                            of_vertex[neighbour as usize] = count;
                            stack.push(neighbour);
                        }
                    }
                }
            }
            count += 1;
        }
        (count as usize, of_vertex)
    }

    /// Vertices − edges + faces: 2 for a sphere, 1 for a disc, 0 for a torus or an open tube.
    pub fn euler_characteristic(&self) -> i64 {
        self.num_vertices as i64 - self.edges.len() as i64 + self.faces.len() as i64
    }

    /// Checks that the faces of each vertex form one fan.
    fn check_fans(&self) -> Result<(), MeshError> {
        for v in 0..self.num_vertices as u32 {
            let faces = self.vertex_faces(VertexId(v));
            let mut fan = vec![faces[0]];
            let mut next = 0;
            // Valences are small, so a linear search beats a table of visited faces.
            while next < fan.len() {
                let face = fan[next].0 as usize;
                next += 1;
                for c in (0..3).filter(|&c| self.faces[face][c] != v) {
                    let edge = self.face_edges[face][c].0 as usize;
                    for neighbour in self.edge_faces[edge].into_iter().flatten() {
                        if !fan.contains(&neighbour) {
                            fan.push(neighbour);
                        }
                    }
                }
            }
            if let Some(other) = faces.iter().find(|face| !fan.contains(face)) {
                let faces = [faces[0].0 as usize, other.0 as usize];
                return Err(MeshError::NonManifoldVertex { vertex: v, faces });
            }
        }
        Ok(())
    }
}

/// Checks each face by itself and that no two are equal.
fn check_faces(num_vertices: usize, faces: &[[u32; 3]]) -> Result<(), MeshError> {
    if faces.is_empty() {
        return Err(MeshError::Empty);
    }
    for (what, count, limit) in [
        ("vertices", num_vertices, u32::MAX as usize),
        ("faces", faces.len(), u32::MAX as usize / 3),
    ] {
        if count > limit {
            return Err(MeshError::TooLarge { what, count, limit });
        }
    }
    for (face, &corners) in faces.iter().enumerate() {
        let [a, b, c] = corners;
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= num_vertices) {
            return Err(MeshError::IndexOutOfRange {
                face,
                vertex,
                num_vertices,
            });
        }
        if a == b || b == c || c == a {
            let vertex = if b == c { b } else { a };
            return Err(MeshError::RepeatedIndex {
                face,
                vertex,
                corners,
            });
        }
    }
    let mut sorted: Vec<([u32; 3], usize)> = Vec::with_capacity(faces.len());
    for (face, &corners) in faces.iter().enumerate() {
        let mut vertices = corners;
        vertices.sort_unstable();
        sorted.push((vertices, face));
    }
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => {
            let faces = [pair[0].1, pair[1].1];
            Err(MeshError::DuplicateFace {
                faces,
                vertices: pair[0].0,
            })
        }
        None => Ok(()),
    }
}

type Edges = (Vec<[u32; 2]>, Vec<[Option<FaceId>; 2]>, Vec<[EdgeId; 3]>);

/// Sorts the half-edges, so that those of an edge stand together and edges come out in lexicographic order.
fn build_edges(faces: &[[u32; 3]]) -> Result<Edges, MeshError> {
    let mut half_edges = Vec::with_capacity(3 * faces.len());
    for (face, corners) in faces.iter().enumerate() {
        for c in 0..3 {
            let (u, v) = (corners[(c + 1) % 3], corners[(c + 2) % 3]);
            half_edges.push((u.min(v), u.max(v), face as u32, c as u32));
        }
    }
    half_edges.sort_unstable();

    let mut edges = Vec::with_capacity(half_edges.len() / 2 + 1);
    let mut edge_faces = Vec::with_capacity(edges.capacity());
    let mut face_edges = vec![[EdgeId(0); 3]; faces.len()];
    for group in half_edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let edge = [group[0].0, group[0].1];
        if group.len() > 2 {
            let faces = group.iter().map(|h| h.2 as usize).collect();
            return Err(MeshError::NonManifoldEdge { edge, faces });
        }
        let mut sides = [None; 2];
        for &(u, _, face, c) in group {
            let traverses_forward = faces[face as usize][(c as usize + 1) % 3] == u;
            let side = &mut sides[usize::from(!traverses_forward)];
            if side.replace(FaceId(face)).is_some() {
                let faces = [group[0].2 as usize, group[1].2 as usize];
                return Err(MeshError::InconsistentOrientation { edge, faces });
            }
            face_edges[face as usize][c as usize] = EdgeId(edges.len() as u32);
        }
        edges.push(edge);
        edge_faces.push(sides);
    }
    Ok((edges, edge_faces, face_edges))
}

/// The faces of each vertex in compressed rows; every vertex must have one.
fn build_vertex_faces(
    num_vertices: usize,
    faces: &[[u32; 3]],
) -> Result<(Vec<u32>, Vec<FaceId>), MeshError> {
    let mut starts = vec![0u32; num_vertices + 1];
    for &v in faces.iter().flatten() {
        starts[v as usize + 1] += 1;
    }
    if let Some(first) = starts[1..].iter().position(|&count| count == 0) {
        let count = starts[1..].iter().filter(|&&count| count == 0).count();
        return Err(MeshError::Unreferenced {
            first: first as u32,
            count,
        });
    }
    for v in 0..num_vertices {
        starts[v + 1] += starts[v];
    }
    let mut cursor = starts.clone();
    let mut list = vec![FaceId(0); 3 * faces.len()];
    for (face, corners) in faces.iter().enumerate() {
        for &v in corners {
            list[cursor[v as usize] as usize] = FaceId(face as u32);
            cursor[v as usize] += 1;
        }
    }
    Ok((starts, list))
}

#[cfg(test)]
mod tests;
