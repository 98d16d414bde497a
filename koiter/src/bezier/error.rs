//! What can be wrong with a Bézier shell or with what is asked of it.

use crate::contact::{StartError, TouchingPair};

/// Why a Bézier shell cannot be made, moved or cut.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BezierError {
    /// A number of the material or the thickness is out of its range.
    #[error("{what} is {value}, but must be {range}")]
    Section {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// Normals that are not one a vertex.
    #[error("there are {normals} normals for {vertices} vertices")]
    NormalCount {
        /// Number of normals.
        normals: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A normal without direction.
    #[error("the normal of vertex {vertex} is zero or not a number")]
    NoNormal {
        /// Which vertex.
        vertex: usize,
    },
    /// A normal on the wrong side of its element.
    #[error(
        "element {element} is inverted: the normal of its corner {corner} points to its back; turn the normal or the \
         element round"
    )]
    Inverted {
        /// Which element.
        element: usize,
        /// Which of its corners.
        corner: usize,
    },
    /// An element without area.
    #[error("element {element} has no area")]
    NoArea {
        /// Which element.
        element: usize,
    },
    /// The matrix is singular: the supports leave a motion free.
    #[error("the stiffness is singular at vertex {vertex}: do the supports hold the whole shell?")]
    Singular {
        /// The vertex whose unknown has no stiffness.
        vertex: usize,
    },
    /// The energy is not a number at the start.
    #[error(
        "the shell cannot be solved from here: an element has collapsed or a number is not finite"
    )]
    Undefined,
    /// A fine surface that is not that of the shell.
    #[error(
        "vertex {vertex} of the fine surface is {distance:.3e} m from the shell, more than {limit:.3e} m: bring the two meshes to one \
         place and scale, or allow a larger reach (surface.reach)"
    )]
    FarFromShell {
        /// Which vertex.
        vertex: usize,
        /// Its distance from the nearest element [m].
        distance: f64,
        /// The largest distance allowed [m].
        limit: f64,
    },
    /// A point of an element that there is not.
    #[error("there is no element {element}: the shell has {elements}")]
    NoSuchElement {
        /// Which element.
        element: usize,
        /// How many there are.
        elements: usize,
    },
    /// A point of a path that is not on the shell.
    #[error(
        "the point ({:.4}, {:.4}, {:.4}) m of the path is {distance:.3e} m from the shell, more than {limit:.3e} m",
        at[0], at[1], at[2]
    )]
    PathFar {
        /// The point [m].
        at: [f64; 3],
        /// Its distance from the nearest element [m].
        distance: f64,
        /// The largest distance allowed [m].
        limit: f64,
    },
    /// A vertex that finds none to be sewn to.
    #[error(
        "vertex {vertex} of the first row has no vertex of the second within {limit:.3e} m: the nearest is {distance:.3e} m away"
    )]
    Unpaired {
        /// Which vertex.
        vertex: u32,
        /// How far the nearest is [m].
        distance: f64,
        /// The reach [m].
        limit: f64,
    },
    /// A path that reaches the boundary before its end.
    #[error("the path leaves the surface at ({:.4}, {:.4}, {:.4}) m", at[0], at[1], at[2])]
    PathLeavesSurface {
        /// Where [m].
        at: [f64; 3],
    },
    /// A path that does not arrive.
    #[error(
        "the path is lost at element {face}: its ends are too far apart for a plane through both to join them; give points between"
    )]
    PathLost {
        /// The element after which it does not go on.
        face: usize,
    },
    /// A path that separates nothing.
    #[error(
        "the path opens nothing: {stops} of its stops are left where loops are left out, and both ends are inside the surface; make it \
         longer, and let it not come back to where it was"
    )]
    PathTooShort {
        /// Number of stops.
        stops: usize,
    },
    /// A patch for a cut that is open at an end.
    #[error(
        "a patch fits a cut whose ends are both inside the surface: this one ends at the boundary"
    )]
    OpenEnd,
    /// A patch for a cut that is closed.
    #[error("the lips of the cut lie on each other: open it before a patch is sewn in")]
    ClosedLips,
    /// A path whose neighbouring stops do not share an element.
    #[error("stops {from} and {to} of the path share no element")]
    PathBroken {
        /// Number of the first.
        from: usize,
        /// Number of the second.
        to: usize,
    },
    /// Two shells of which one cannot be made a piece of the other.
    #[error("the other shell is of another element: sew shells of one kind")]
    OtherShell,
    /// A pair of vertices that cannot be sewn together.
    #[error("vertices {} and {} cannot be sewn together: there are {} vertices, and a vertex is not sewn to itself", pair[0], pair[1], vertices)]
    NoSuchPair {
        /// The pair.
        pair: [u32; 2],
        /// How many vertices there are.
        vertices: usize,
    },
    /// A surface that touches something after a cut or a suture.
    #[error("{}", touching(pairs))]
    Touches {
        /// What touches, worst first.
        pairs: Vec<TouchingPair>,
    },
    /// The mesh that comes of a change is not one that can be simulated.
    #[error(transparent)]
    Mesh(#[from] crate::mesh::MeshError),
}

impl From<StartError> for BezierError {
    fn from(error: StartError) -> Self {
        Self::Touches { pairs: error.pairs }
    }
}

/// The worst place, how many more there are, and what helps.
fn touching(pairs: &[TouchingPair]) -> String {
    let worst = pairs.first().map_or("", |pair| &pair.description);
    let more = match pairs.len() {
        0 | 1 => String::new(),
        places => format!(", and in {} more places", places - 1),
    };
    format!(
        "the fine surface then touches: {worst}{more}; cut and sew away from obstacles and where parts are apart, or with finer \
         elements, which change their shape less when they are divided"
    )
}
