//! What can be wrong with a mesh: each message names the element, the value and what to do.

/// Why triangles (and positions) are not a mesh that can be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// There is no face.
    #[error("the mesh has no faces; give at least one triangle")]
    Empty,
    /// More elements than 32-bit indices can number.
    #[error(
        "the mesh has {count} {what}, more than the {limit} that 32-bit indices allow; split it"
    )]
    TooLarge {
        /// "vertices" or "faces".
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A face names a vertex that does not exist.
    #[error(
        "face {face} uses vertex {vertex}, but there are only {num_vertices} vertices \
         (numbered from 0); correct the index"
    )]
    IndexOutOfRange {
        /// Face index.
        face: usize,
        /// The index it uses.
        vertex: u32,
        /// Number of vertices.
        num_vertices: usize,
    },
    /// A face uses a vertex twice.
    #[error("face {face} uses vertex {vertex} more than once: {corners:?}; remove the face")]
    RepeatedIndex {
        /// Face index.
        face: usize,
        /// The repeated vertex.
        vertex: u32,
        /// All three corners.
        corners: [u32; 3],
    },
    /// Two faces have the same three vertices.
    #[error("faces {faces:?} have the same vertices {vertices:?}; remove one of them")]
    DuplicateFace {
        /// The two faces.
        faces: [usize; 2],
        /// Their vertices, sorted.
        vertices: [u32; 3],
    },
    /// More than two faces share an edge.
    #[error(
        "edge {edge:?} belongs to {} faces {faces:?}; a shell has at most two faces an edge: \
         remove the extra faces, or give each sheet its own copy of the edge's vertices",
        faces.len()
    )]
    NonManifoldEdge {
        /// End vertices of the edge.
        edge: [u32; 2],
        /// All faces at the edge.
        faces: Vec<usize>,
    },
    /// Two neighbours traverse their edge in the same direction.
    #[error(
        "faces {faces:?} both traverse edge {edge:?} in the same direction; reverse one of them, \
         or let the orientation be repaired"
    )]
    InconsistentOrientation {
        /// End vertices of the edge.
        edge: [u32; 2],
        /// The two faces.
        faces: [usize; 2],
    },
    /// No choice of orientations agrees, as on a Möbius strip.
    #[error(
        "the surface is one-sided: no orientation agrees across edge {edge:?} of faces {faces:?}; \
         cut it open along a line of edges by duplicating the vertices of that line"
    )]
    NotOrientable {
        /// End vertices of the edge where the contradiction shows.
        edge: [u32; 2],
        /// The two faces.
        faces: [usize; 2],
    },
    /// Fans of faces touch at a vertex without sharing an edge there.
    #[error(
        "vertex {vertex} joins separate fans of faces (faces {} and {} meet only at this point); \
         give each fan its own copy of the vertex",
        faces[0], faces[1]
    )]
    NonManifoldVertex {
        /// Vertex index.
        vertex: u32,
        /// One face of each of two fans.
        faces: [usize; 2],
    },
    /// Vertices that belong to no face.
    #[error(
        "{count} vertices belong to no face (the first is vertex {first}); remove them, or let \
         unreferenced vertices be dropped"
    )]
    Unreferenced {
        /// The first such vertex.
        first: u32,
        /// How many there are.
        count: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error(
        "vertex {vertex} has a coordinate that is not a finite number: {position:?}; correct it"
    )]
    NotFinite {
        /// Vertex index.
        vertex: u32,
        /// Its position [m].
        position: [f64; 3],
    },
    /// A triangle without area, relative to its size.
    #[error(
        "face {face} {corners:?} is degenerate: its height is {ratio:.1e} of its longest edge \
         ({longest_edge:.3e} m), at least {limit:.0e} is needed; collapse or remove the face"
    )]
    DegenerateFace {
        /// Face index.
        face: usize,
        /// Its vertices.
        corners: [u32; 3],
        /// Smallest height over longest edge.
        ratio: f64,
        /// Longest edge [m].
        longest_edge: f64,
        /// The smallest ratio accepted.
        limit: f64,
    },
    /// Positions and topology do not belong together.
    #[error("there are {positions} positions for {vertices} vertices; give one position a vertex")]
    PositionCount {
        /// Number of positions.
        positions: usize,
        /// Number of vertices.
        vertices: usize,
    },
}

impl MeshError {
    /// The face at fault, if the error is about one; the first one of several.
    pub fn face(&self) -> Option<usize> {
        match self {
            Self::IndexOutOfRange { face, .. }
            | Self::RepeatedIndex { face, .. }
            | Self::DegenerateFace { face, .. } => Some(*face),
            Self::DuplicateFace { faces, .. }
            | Self::InconsistentOrientation { faces, .. }
            | Self::NotOrientable { faces, .. }
            | Self::NonManifoldVertex { faces, .. } => Some(faces[0]),
            Self::NonManifoldEdge { faces, .. } => faces.first().copied(),
            _ => None,
        }
    }

    /// The same error about vertices that had other numbers before: `old_index[new]`.
    pub(super) fn renumbered(mut self, old_index: &[u32]) -> Self {
        self.for_each_number(|v| *v = old_index[*v as usize], |_| {});
        self
    }

    /// The same error for a reader who counts vertices and faces from `first` instead of 0; `None` if it names none, or
    /// says itself how it counts.
    pub(crate) fn counted_from(&self, first: u32) -> Option<Self> {
        let (mut error, mut names_any) = (self.clone(), false);
        error.for_each_number(
            |vertex| {
                names_any = true;
                *vertex += first;
            },
            |face| *face += first as usize,
        );
        names_any.then_some(error)
    }

    /// Goes through the numbers of vertices and faces in the message.
    fn for_each_number(
        &mut self,
        mut change_vertex: impl FnMut(&mut u32),
        change_face: impl FnMut(&mut usize),
    ) {
        match self {
            Self::RepeatedIndex {
                face,
                vertex,
                corners,
            } => {
                change_vertex(vertex);
                corners.iter_mut().for_each(change_vertex);
                std::iter::once(face).for_each(change_face);
            }
            Self::DuplicateFace { faces, vertices } => {
                vertices.iter_mut().for_each(change_vertex);
                faces.iter_mut().for_each(change_face);
            }
            Self::NonManifoldEdge { edge, faces } => {
                edge.iter_mut().for_each(change_vertex);
                faces.iter_mut().for_each(change_face);
            }
            Self::InconsistentOrientation { edge, faces } | Self::NotOrientable { edge, faces } => {
                edge.iter_mut().for_each(change_vertex);
                faces.iter_mut().for_each(change_face);
            }
            Self::NonManifoldVertex { vertex, faces } => {
                change_vertex(vertex);
                faces.iter_mut().for_each(change_face);
            }
            Self::DegenerateFace { face, corners, .. } => {
                corners.iter_mut().for_each(change_vertex);
                std::iter::once(face).for_each(change_face);
            }
            Self::NotFinite { vertex, .. } | Self::Unreferenced { first: vertex, .. } => {
                change_vertex(vertex);
            }
            // They name no vertex, or say how they count.
            Self::Empty
            | Self::TooLarge { .. }
            | Self::IndexOutOfRange { .. }
            | Self::PositionCount { .. } => {}
        }
    }
}

#[cfg(test)]
mod tests;
