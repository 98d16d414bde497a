//! What a result shows: bodies with their faces, edges, and pieces.

use std::ops::Range;

use super::search::BoxTree;
use super::{Crossing, Enclosed, Solid};
use crate::Vec3;
use crate::geometry::segment_meets_triangle;

/// A shell or an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Name in the scene.
    pub name: String,
    /// Whether it is an obstacle: obstacles are not tested against each other.
    pub is_obstacle: bool,
    /// Its vertices.
    pub vertices: Range<usize>,
    /// Its faces.
    pub faces: Range<usize>,
    /// The exact shape of an obstacle whose faces only come near it.
    pub solid: Option<Solid>,
}

/// What a face is at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RestFace {
    /// Area [m²].
    pub area: f64,
    /// Lengths of the edges opposite to the corners [m].
    pub edges: [f64; 3],
}

impl RestFace {
    /// A face as it is in space.
    pub fn from_corners(x: &[Vec3; 3]) -> Self {
        Self {
            area: 0.5 * (x[1] - x[0]).cross(&(x[2] - x[0])).norm(),
            edges: [0, 1, 2].map(|k| (x[(k + 2) % 3] - x[(k + 1) % 3]).norm()),
        }
    }
}

/// An edge with the faces it belongs to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub(super) vertices: [u32; 2],
    /// The first two of its faces; the same one twice at a boundary.
    pub(super) faces: [u32; 2],
    /// How many there are.
    count: u32,
    body: u32,
}

#[derive(Clone, Debug)]
pub(super) struct Topology {
    pub(super) bodies: Vec<Body>,
    pub(super) faces: Vec<[u32; 3]>,
    face_body: Vec<u32>,
    /// Of all bodies that are no solids, by vertices.
    pub(super) edges: Vec<Edge>,
    /// Faces of all bodies that are no solids.
    pub(super) surface_faces: Vec<u32>,
    pub(super) shell_faces: Vec<u32>,
    /// A vertex of every connected piece of shells.
    pieces: Vec<u32>,
    /// Obstacles whose surface has an inside.
    closed: Vec<usize>,
}

impl Topology {
    pub(super) fn new(bodies: Vec<Body>, faces: &[[u32; 3]], num_vertices: usize) -> Self {
        let mut topology = Self {
            face_body: vec![0; faces.len()],
            faces: faces.to_vec(),
            edges: Vec::new(),
            surface_faces: Vec::new(),
            shell_faces: Vec::new(),
            pieces: Vec::new(),
            closed: Vec::new(),
            bodies,
        };
        for (index, body) in topology.bodies.iter().enumerate() {
            assert!(
                body.vertices.end <= num_vertices,
                "vertices of '{}'",
                body.name
            );
            topology.face_body[body.faces.clone()].fill(index as u32);
            let numbers = body.faces.start as u32..body.faces.end as u32;
            if !body.is_obstacle {
                topology.shell_faces.extend(numbers.clone());
            }
            if body.solid.is_none() {
                topology.surface_faces.extend(numbers);
            }
        }
        topology.edges = topology.find_edges();
        topology.pieces = topology.find_pieces(num_vertices);
        let is_closed = |&body: &usize| {
            let mut edges = topology
                .edges
                .iter()
                .filter(|e| e.body == body as u32)
                .peekable();
            topology.bodies[body].is_obstacle
                && edges.peek().is_some()
                && edges.all(|e| e.count == 2)
        };
        topology.closed = (0..topology.bodies.len()).filter(is_closed).collect();
        topology
    }

    fn find_edges(&self) -> Vec<Edge> {
        let sides = self.surface_faces.iter().flat_map(|&face| {
            let [a, b, c] = self.faces[face as usize];
            [[a, b], [b, c], [c, a]].map(|[u, v]| ([u.min(v), u.max(v)], face))
        });
        let mut sides: Vec<([u32; 2], u32)> = sides.collect();
        sides.sort_unstable();
        let edges = sides.chunk_by(|a, b| a.0 == b.0).map(|same| Edge {
            vertices: same[0].0,
            faces: [same[0].1, same[same.len().min(2) - 1].1],
            count: same.len() as u32,
            body: self.face_body[same[0].1 as usize],
        });
        edges.collect()
    }

    fn find_pieces(&self, num_vertices: usize) -> Vec<u32> {
        let mut root: Vec<u32> = (0..num_vertices as u32).collect();
        fn find(root: &mut [u32], mut v: u32) -> u32 {
            while root[v as usize] != v {
                root[v as usize] = root[root[v as usize] as usize];
                v = root[v as usize];
            }
            v
        }
        for edge in self.edges.iter().filter(|edge| self.is_of_shell(edge)) {
            let [a, b] = edge.vertices.map(|v| find(&mut root, v));
            root[a.max(b) as usize] = a.min(b);
        }
        let on_faces = self
            .shell_faces
            .iter()
            .flat_map(|&face| self.faces[face as usize]);
        let mut pieces: Vec<u32> = on_faces.map(|v| find(&mut root, v)).collect();
        pieces.sort_unstable();
        pieces.dedup();
        pieces
    }

    /// Whether an edge belongs to a shell.
    pub(super) fn is_of_shell(&self, edge: &Edge) -> bool {
        !self.bodies[edge.body as usize].is_obstacle
    }

    /// Vertices of one body by their numbers in it.
    pub(super) fn describe(&self, kind: &str, vertices: &[u32]) -> String {
        let holds = |body: &&Body| body.vertices.contains(&(vertices[0] as usize));
        let Some(body) = self.bodies.iter().find(holds) else {
            return format!("{kind} {vertices:?}");
        };
        let numbers = vertices.iter().map(|&v| v as usize - body.vertices.start);
        let numbers: Vec<String> = numbers.map(|v| v.to_string()).collect();
        match numbers.as_slice() {
            [one] => format!("{kind} {one} of '{}'", body.name),
            _ => format!("{kind} ({}) of '{}'", numbers.join(", "), body.name),
        }
    }

    /// Adds the faces that an edge meets.
    pub(super) fn edge_crossings(
        &self,
        edge: &Edge,
        tree: &BoxTree,
        x: &[Vec3],
        found: &mut Vec<Crossing>,
    ) {
        let [p, q] = edge.vertices.map(|v| &x[v as usize]);
        let is_of_shell = self.is_of_shell(edge);
        tree.visit(&[*p, *q], |face| {
            let corners = self.faces[face as usize];
            let body = &self.bodies[self.face_body[face as usize] as usize];
            let is_tested = (is_of_shell || !body.is_obstacle)
                && !edge.vertices.iter().any(|v| corners.contains(v));
            if is_tested
                && segment_meets_triangle(p, q, corners.each_ref().map(|&v| &x[v as usize]))
            {
                let edge = edge.vertices;
                found.push(Crossing { edge, face });
            }
        });
    }

    /// Pieces of shells inside closed obstacles: the way out of their first vertex meets an odd number of faces.
    pub(super) fn enclosed(&self, x: &[Vec3]) -> Vec<Enclosed> {
        let mut found = Vec::new();
        for &body in &self.closed {
            let obstacle = &self.bodies[body];
            let corners = &x[obstacle.vertices.clone()];
            let low = corners
                .iter()
                .fold(Vec3::repeat(f64::INFINITY), |low, p| low.inf(p));
            let high = corners
                .iter()
                .fold(Vec3::repeat(f64::NEG_INFINITY), |high, p| high.sup(p));
            for &vertex in &self.pieces {
                let start = x[vertex as usize];
                if start.inf(&low) != low || start.sup(&high) != high {
                    continue;
                }
                // In a direction in which no mesh is built, so that it misses edges and vertices.
                let way_out =
                    start + Vec3::new(0.4311, -0.6127, 0.6623) * (2.0 * (high - low).norm());
                let meets = |face: &&[u32; 3]| {
                    segment_meets_triangle(
                        &start,
                        &way_out,
                        face.each_ref().map(|&v| &x[v as usize]),
                    )
                };
                let hits = self.faces[obstacle.faces.clone()]
                    .iter()
                    .filter(meets)
                    .count();
                if hits % 2 == 1 {
                    found.push(Enclosed { vertex, body });
                }
            }
        }
        found
    }
}
