//! A path on the surface from one point to another, as mesh vertices and crossings of edges.
//!
//! The path follows the plane through both points that holds the normal at the first: from face to face across the edge
//! whose ends lie on different sides. Crossings near an end of their edge are moved there, and the ends of the path to the
//! next vertex, so that no sliver is cut off.

use super::map::SurfacePoint;
use super::{BezierError, BezierShell};
use crate::Vec3;
use crate::mesh::{FaceId, VertexId};

/// A stop of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathNode {
    /// A vertex of the mesh.
    Vertex(u32),
    /// The point `x_0 + t (x_1 − x_0)` of an edge.
    Crossing {
        /// The ends of the edge, the smaller index first.
        edge: [u32; 2],
        /// t, between [`NEAR_END`] and 1 − [`NEAR_END`].
        fraction: f64,
    },
}

/// A path along which a shell can be cut: neighbours share a face, nothing comes twice.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfacePath {
    /// Its stops.
    pub nodes: Vec<PathNode>,
    /// How far the ends were moved [m].
    pub moved_ends: [f64; 2],
}

/// A crossing nearer than this fraction of its edge to an end is moved there: halves of an angle keep about this fraction.
pub const NEAR_END: f64 = 0.2;

/// Ends are moved this far into their faces, so that a plane through an end crosses the face.
const INTO_FACE: f64 = 2e-3;

struct Walk<'a> {
    shell: &'a BezierShell,
    positions: &'a [Vec3],
    /// Signed distance from the plane times something positive; zero counts as positive.
    side: Box<dyn Fn(u32) -> f64 + 'a>,
}

impl Walk<'_> {
    /// The point where the plane meets an edge, if its ends lie on different sides.
    fn crossing(&self, a: u32, b: u32) -> Option<([u32; 2], f64, Vec3)> {
        let edge = [a.min(b), a.max(b)];
        let (s, t) = ((self.side)(edge[0]), (self.side)(edge[1]));
        if (s >= 0.0) == (t >= 0.0) {
            return None;
        }
        let fraction = s / (s - t);
        let [x, y] = edge.map(|v| self.positions[v as usize]);
        Some((edge, fraction, x + (y - x) * fraction))
    }
}

impl SurfacePath {
    /// The path between two points of a shell whose vertices are at `positions` [m].
    ///
    /// # Errors
    /// A point of no element; a path that reaches the boundary, or that does not arrive.
    pub fn between(
        shell: &BezierShell,
        positions: &[Vec3],
        from: &SurfacePoint,
        to: &SurfacePoint,
    ) -> Result<Self, BezierError> {
        let mesh = shell.mesh();
        for point in [from, to] {
            if point.element >= mesh.num_faces() {
                let (element, elements) = (point.element, mesh.num_faces());
                return Err(BezierError::NoSuchElement { element, elements });
            }
        }
        let inside = |point: &SurfacePoint| -> Vec3 {
            let corners = mesh.faces()[point.element].map(|v| positions[v as usize]);
            (0..3)
                .map(|c| corners[c] * ((1.0 - INTO_FACE) * point.barycentric[c] + INTO_FACE / 3.0))
                .sum()
        };
        let (start, end) = (inside(from), inside(to));
        let [a, b, c] = mesh.faces()[from.element].map(|v| positions[v as usize]);
        let plane = (b - a).cross(&(c - a)).cross(&(end - start));
        let walk = Walk {
            shell,
            positions,
            side: Box::new(move |v| plane.dot(&(positions[v as usize] - start))),
        };
        let mut path = Self {
            nodes: Vec::new(),
            moved_ends: [0.0; 2],
        };
        path.moved_ends[0] = path.push_nearest(&walk, from, &start);
        if from.element != to.element {
            path.cross(&walk, from.element, to.element, start, end)?;
        }
        path.moved_ends[1] = path.push_nearest(&walk, to, &end);
        Ok(path)
    }

    /// The path from point to point, of which there are two or more.
    ///
    /// # Errors
    /// As [`Self::between`]; a single point.
    pub fn through(
        shell: &BezierShell,
        positions: &[Vec3],
        points: &[SurfacePoint],
    ) -> Result<Self, BezierError> {
        let mut whole: Option<Self> = None;
        for pair in points.windows(2) {
            let next = Self::between(shell, positions, &pair[0], &pair[1])?;
            whole = Some(match whole {
                None => next,
                Some(path) => path.then(&next),
            });
        }
        let stops = points.len();
        whole.ok_or(BezierError::PathTooShort { stops })
    }

    /// Adds the crossings from one face to another.
    fn cross(
        &mut self,
        walk: &Walk<'_>,
        from: usize,
        to: usize,
        start: Vec3,
        end: Vec3,
    ) -> Result<(), BezierError> {
        let mesh = walk.shell.mesh();
        let (mut face, mut entry) = (from, None);
        for _ in 0..mesh.num_faces() {
            let corners = mesh.faces()[face];
            let exits = (0..3).filter_map(|c| {
                let (a, b) = (corners[(c + 1) % 3], corners[(c + 2) % 3]);
                let edge = mesh.face_edges()[face][c];
                let crossing = walk.crossing(a, b).filter(|_| Some(edge) != entry)?;
                Some((edge, crossing))
            });
            // Of the first face the exit towards the end; of any other there is one.
            let ahead = |point: &Vec3| (point - start).dot(&(end - start));
            let exit = exits.max_by(|a, b| ahead(&a.1.2).total_cmp(&ahead(&b.1.2)));
            let Some((edge, (ends, fraction, point))) = exit else {
                return Err(BezierError::PathLost { face });
            };
            let sides = mesh.edge_faces()[edge.0 as usize];
            let beyond = sides
                .into_iter()
                .flatten()
                .find(|f| *f != FaceId(face as u32));
            let Some(beyond) = beyond else {
                let at = point.into();
                return Err(BezierError::PathLeavesSurface { at });
            };
            self.push(match fraction {
                t if t < NEAR_END => PathNode::Vertex(ends[0]),
                t if t > 1.0 - NEAR_END => PathNode::Vertex(ends[1]),
                fraction => PathNode::Crossing {
                    edge: ends,
                    fraction,
                },
            });
            face = beyond.0 as usize;
            entry = Some(edge);
            if face == to {
                return Ok(());
            }
        }
        Err(BezierError::PathLost { face })
    }

    /// Adds the corner nearest to a point of a face; returns how far it is.
    fn push_nearest(&mut self, walk: &Walk<'_>, point: &SurfacePoint, at: &Vec3) -> f64 {
        let distance = |v: &u32| (walk.positions[*v as usize] - at).norm();
        let corners = walk.shell.mesh().faces()[point.element];
        let nearest = (corners.into_iter())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .expect("a face has corners");
        self.push(PathNode::Vertex(nearest));
        distance(&nearest)
    }

    /// Adds a stop; a loop that it closes is left out.
    fn push(&mut self, node: PathNode) {
        if let Some(earlier) = self.nodes.iter().position(|n| *n == node) {
            self.nodes.truncate(earlier);
        }
        self.nodes.push(node);
    }

    /// Goes on along another path that begins where this one ends.
    pub fn then(mut self, next: &Self) -> Self {
        for node in &next.nodes {
            self.push(*node);
        }
        self.moved_ends[1] = next.moved_ends[1];
        self
    }

    /// Whether a vertex is a boundary one: a cut that ends there opens.
    pub(super) fn ends_on_boundary(&self, shell: &BezierShell) -> [bool; 2] {
        [self.nodes.first(), self.nodes.last()].map(|node| match node {
            Some(PathNode::Vertex(v)) => shell.mesh().is_boundary_vertex(VertexId(*v)),
            _ => false,
        })
    }
}
