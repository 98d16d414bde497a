//! What can be wrong with the input of a burning shell.

/// Why quads are not a mesh that a double layer can be made of.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QuadMeshError {
    /// There is no quad.
    #[error("the mesh has no quads; a double layer needs at least one face of four corners")]
    Empty,
    /// More elements than 32-bit indices can number.
    #[error(
        "the mesh would have {count} quads, more than the {limit} that can be numbered; make it coarser"
    )]
    TooLarge {
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A face has another number of corners.
    #[error(
        "face {face} has {corners} corners; a double layer is made of quads only: convert the mesh to quads"
    )]
    NotAQuad {
        /// Face index.
        face: usize,
        /// Its corners.
        corners: usize,
    },
    /// A quad names a vertex that does not exist.
    #[error(
        "quad {quad} uses vertex {vertex}, but there are only {num_vertices} vertices (numbered from 0)"
    )]
    IndexOutOfRange {
        /// Quad index.
        quad: usize,
        /// The index it uses.
        vertex: u32,
        /// Number of vertices.
        num_vertices: usize,
    },
    /// A quad uses a vertex twice.
    #[error("quad {quad} uses a vertex more than once: {corners:?}; remove it or split it")]
    RepeatedCorner {
        /// Quad index.
        quad: usize,
        /// Its corners.
        corners: [u32; 4],
    },
    /// A position is not finite.
    #[error("vertex {vertex} is at ({}, {}, {}); positions must be finite", position[0], position[1], position[2])]
    NotFinite {
        /// Vertex index.
        vertex: usize,
        /// Where it is.
        position: [f64; 3],
    },
    /// A quad whose diagonals do not span its corners: it is folded over itself, or has no area.
    #[error(
        "quad {quad} is folded or flat at its corner {corner}, vertex {vertex}: the corner does not turn the way of the \
         quad's diagonals; move its vertices apart"
    )]
    Folded {
        /// Quad index.
        quad: usize,
        /// Which of its corners, 0 to 3.
        corner: usize,
        /// The vertex there.
        vertex: u32,
    },
    /// More than two quads share an edge.
    #[error(
        "the edge between vertices {vertices:?} belongs to more than two quads; a shell has at most two"
    )]
    CrowdedEdge {
        /// Its ends.
        vertices: [u32; 2],
    },
    /// Neighbours run along their common edge in the same direction.
    #[error(
        "quads {quads:?} disagree in orientation at the edge between vertices {vertices:?}: reverse the corners of one \
         of them, so that all normals lie on one side"
    )]
    InconsistentOrientation {
        /// The two quads.
        quads: [u32; 2],
        /// Ends of their edge.
        vertices: [u32; 2],
    },
    /// A vertex with too many edges: successive projections do not converge there.
    #[error(
        "vertex {vertex} has {valence} edges, more than the 6 with which successive projections converge; change the \
         mesh around it"
    )]
    TooManyEdges {
        /// Vertex index.
        vertex: usize,
        /// Its edges.
        valence: usize,
    },
    /// A vertex without quads.
    #[error("vertex {vertex} belongs to no quad; remove it")]
    Unused {
        /// Vertex index.
        vertex: usize,
    },
    /// A size of a generated mesh.
    #[error("the {what} is {value}, but it must be {expected}")]
    Size {
        /// What.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// Texture coordinates of another number of vertices.
    #[error("there are {given} texture coordinates for {vertices} vertices")]
    TextureCoordinates {
        /// How many there are.
        given: usize,
        /// How many vertices.
        vertices: usize,
    },
}

/// Why an image does not serve as a texture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TextureError {
    /// Another number of values than pixels.
    #[error("a texture of {width} x {height} pixels has {values} values")]
    Size {
        /// Pixels a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Values given.
        values: usize,
    },
    /// The mesh has no texture coordinates.
    #[error(
        "the mesh has no texture coordinates, so a texture has no place on it; a grid and a torus have them, an OBJ file needs `vt` lines"
    )]
    NoCoordinates,
}

/// Why a burning shell cannot be set up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BurningError {
    /// The mesh.
    #[error(transparent)]
    Mesh(#[from] QuadMeshError),
    /// A texture.
    #[error(transparent)]
    Texture(#[from] TextureError),
    /// A number.
    #[error("{what} is {value}, but it must be {expected}")]
    Value {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// A shell that is to keep out of itself begins crossed.
    #[error(
        "the start shape crosses itself: quad {} meets quad {}; a shell with self_collision has to begin apart", quads[0], quads[1]
    )]
    CrossesItself {
        /// Two quads that do.
        quads: [u32; 2],
    },
    /// A step led to a value that is not finite.
    #[error(
        "particle {particle} of a double layer has a place, a velocity or a temperature that is not finite after the step to t = {time} s; make dt smaller"
    )]
    NotFinite {
        /// The particle.
        particle: usize,
        /// End of the step [s].
        time: f64,
    },
    /// A linear system of the global solve could not be factorised.
    #[error(
        "the global solve of a double layer met a matrix that is not positive definite in the step to t = {time} s; make dt smaller or the compliance larger"
    )]
    NotPositiveDefinite {
        /// End of the step [s].
        time: f64,
    },
}
