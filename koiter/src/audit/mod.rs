//! Is a result what it claims to be? Every frame tested anew, without the code that computed it.
//!
//! Looked for in the positions of a frame:
//! - *crossings*: edges that meet faces with which they share no vertex, decided with exact predicates. Two triangle
//!   meshes intersect if and only if an edge of one meets a face of the other;
//! - *penetrations* of half-spaces, balls and capsules, by distance from their exact shape;
//! - *enclosed* pieces of shells, which lie inside a closed obstacle without touching its surface;
//! - *collapsed* faces, of hardly any area, and *folded* edges, whose two faces lie on each other.
//!
//! Nothing of `contact` is used: this module stands before it, so it could not be. What a single frame cannot tell is
//! whether a surface passed through another one between two frames and came out whole on the other side.

mod bodies;
mod search;
mod shape;
mod solid;

pub use bodies::{Body, RestFace};
pub use shape::Smallest;
pub use solid::Solid;

use crate::Vec3;
use crate::assembly::parallel_map;
use bodies::Topology;
use search::BoxTree;
use shape::Shape;

/// A face of less than this share of its rest area counts as collapsed. Membranes that hold their shape keep far more;
/// one that is inverted in its plane has passed through zero.
pub const COLLAPSED: f64 = 0.01;

/// An edge whose faces meet at less than this angle [rad] counts as folded: they are closer to each other than a
/// millionth of their height, which no thickness that contact keeps apart allows.
pub const FOLDED: f64 = 1e-6;

/// An edge whose faces meet at less than this angle [rad], 30°, is sharp: where a model of bending lets folds close, there are
/// many. No fault.
pub const SHARP: f64 = std::f64::consts::FRAC_PI_6;

/// An edge that meets a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Crossing {
    /// Vertices of the edge.
    pub edge: [u32; 2],
    /// The face.
    pub face: u32,
}

/// A face that reaches into a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// The face.
    pub face: u32,
    /// The body that is a solid.
    pub body: usize,
    /// How deep [m].
    pub depth: f64,
}

/// A piece of a shell inside a closed obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Enclosed {
    /// A vertex of the piece.
    pub vertex: u32,
    /// The obstacle.
    pub body: usize,
}

/// What a frame looks like.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameAudit {
    /// Edges that meet faces, in order.
    pub crossings: Vec<Crossing>,
    /// Faces inside solids.
    pub penetrations: Vec<Penetration>,
    /// Pieces of shells inside closed obstacles.
    pub enclosed: Vec<Enclosed>,
    /// Faces with less than [`COLLAPSED`] of their rest area.
    pub collapsed: Vec<u32>,
    /// Edges whose faces meet at less than [`FOLDED`].
    pub folded: Vec<[u32; 2]>,
    /// Number of edges of shells whose faces meet at less than [`SHARP`].
    pub sharp: usize,
    /// The smallest area of a face of a shell over its rest area, and the face.
    pub area_ratio: Smallest,
    /// The smallest length of an edge of a shell over its rest length, and a face it belongs to.
    pub edge_ratio: Smallest,
    /// The smallest dihedral angle of a shell [rad] (π where it is flat), and a face it belongs to.
    pub dihedral_angle: Smallest,
}

impl FrameAudit {
    /// Whether nothing is wrong.
    pub fn is_clean(&self) -> bool {
        self.crossings.is_empty()
            && self.penetrations.is_empty()
            && self.enclosed.is_empty()
            && self.collapsed.is_empty()
            && self.folded.is_empty()
    }
}

/// What all frames of a result have in common.
#[derive(Clone, Debug)]
pub struct Audit {
    topology: Topology,
    shape: Shape,
    /// Positions to which the solids belong [m].
    start: Vec<Vec3>,
}

impl Audit {
    /// `faces` are those of all bodies by the vertex numbers of the whole, `rest` their rest shape (of obstacles too, where
    /// it is not used), `start` the positions [m] to which the solids belong.
    ///
    /// # Panics
    /// If bodies, faces, `rest` and `start` do not fit each other.
    pub fn new(bodies: Vec<Body>, faces: &[[u32; 3]], rest: &[RestFace], start: &[Vec3]) -> Self {
        assert_eq!(faces.len(), rest.len(), "every face has a rest shape");
        let topology = Topology::new(bodies, faces, start.len());
        Self {
            shape: Shape::new(&topology, rest),
            start: start.to_vec(),
            topology,
        }
    }

    /// The bodies.
    pub fn bodies(&self) -> &[Body] {
        &self.topology.bodies
    }

    /// A vertex in the user's terms: numbers are those of its body.
    pub fn describe_vertex(&self, vertex: u32) -> String {
        self.topology.describe("vertex", &[vertex])
    }

    /// An edge in the user's terms.
    pub fn describe_edge(&self, edge: [u32; 2]) -> String {
        self.topology.describe("edge", &edge)
    }

    /// A face in the user's terms.
    pub fn describe_face(&self, face: u32) -> String {
        self.topology
            .describe("face", &self.topology.faces[face as usize])
    }

    /// Tests positions [m].
    ///
    /// # Panics
    /// If they are not as many as those at the start.
    pub fn frame(&self, positions: &[Vec3]) -> FrameAudit {
        assert_eq!(
            positions.len(),
            self.start.len(),
            "every vertex has a position"
        );
        let mut found = self.shape.measure(&self.topology, positions);
        found.crossings = self.crossings(positions);
        found.penetrations = self.penetrations(positions);
        found.enclosed = self.topology.enclosed(positions);
        found
    }

    /// Edges that meet faces: of shells among each other, and of shells and mesh obstacles. Solids are drawn with faces
    /// that only come near their shape, so these are left out.
    fn crossings(&self, x: &[Vec3]) -> Vec<Crossing> {
        let topology = &self.topology;
        let tree = BoxTree::new(&topology.faces, &topology.surface_faces, x);
        const CHUNK: usize = 256;
        let edges = &topology.edges;
        let chunks = parallel_map(edges.len().div_ceil(CHUNK), |chunk| {
            let mut found = Vec::new();
            for edge in edges[chunk * CHUNK..].iter().take(CHUNK) {
                topology.edge_crossings(edge, &tree, x, &mut found);
            }
            found
        });
        let mut crossings: Vec<Crossing> = chunks.into_iter().flatten().collect();
        crossings.sort_unstable();
        crossings
    }

    fn penetrations(&self, x: &[Vec3]) -> Vec<Penetration> {
        let mut found = Vec::new();
        for (body, obstacle) in self.topology.bodies.iter().enumerate() {
            let Some(solid) = &obstacle.solid else {
                continue;
            };
            let solid = solid.carried(
                &self.start[obstacle.vertices.clone()],
                &x[obstacle.vertices.clone()],
            );
            let faces = &self.topology.shell_faces;
            let depths = parallel_map(faces.len(), |i| {
                solid.depth(&self.topology.faces[faces[i] as usize].map(|v| x[v as usize]))
            });
            let deep = faces.iter().zip(depths).filter(|(_, depth)| *depth > 0.0);
            found.extend(deep.map(|(&face, depth)| Penetration { face, body, depth }));
        }
        found.sort_by(|a, b| b.depth.total_cmp(&a.depth));
        found
    }
}

#[cfg(test)]
mod tests;
