//! An incision: elements along a path are divided, and the path's vertices doubled.
//!
//! Crossed edges are divided one after another; of the two elements at an edge each becomes two. When the next edge of the
//! path is divided, its part holds the vertex before, so the pieces of the path become edges by themselves. Then every
//! vertex of the path becomes one vertex for each fan of elements that the path leaves around it: two within, one at an end
//! inside the surface, two at an end on the boundary.

use std::collections::HashMap;
use std::sync::Arc;

use super::change::{Change, Origin, Parent};
use super::surface_path::{PathNode, SurfacePath};
use super::{BezierError, BezierShell};
use crate::mesh::{FaceId, TriMesh, VertexId};

/// Elements while edges are divided.
struct Pieces {
    faces: Vec<[u32; 3]>,
    parents: Vec<Parent>,
    origins: Vec<Origin>,
    /// Pieces at each old vertex and at each new one: those of an edge are at both of its ends.
    at_vertex: Vec<Vec<usize>>,
}

impl Pieces {
    fn new(mesh: &TriMesh) -> Self {
        let vertices = mesh.num_vertices();
        let mut pieces = Self {
            faces: mesh.faces().to_vec(),
            parents: (0..mesh.num_faces()).map(Parent::whole).collect(),
            origins: (0..vertices as u32).map(Origin::vertex).collect(),
            at_vertex: vec![Vec::new(); vertices],
        };
        for (index, face) in mesh.faces().iter().enumerate() {
            for &v in face {
                pieces.at_vertex[v as usize].push(index);
            }
        }
        pieces
    }

    fn at_edge(&self, [u, v]: [u32; 2]) -> Vec<usize> {
        let at_both = |index: &&usize| self.faces[**index].contains(&v);
        self.at_vertex[u as usize]
            .iter()
            .filter(at_both)
            .copied()
            .collect()
    }

    /// Divides an edge; returns the new vertex.
    fn divide(&mut self, edge: [u32; 2], fraction: f64) -> u32 {
        let middle = self.origins.len() as u32;
        self.origins.push(Origin {
            ends: edge,
            fraction,
        });
        self.at_vertex.push(Vec::new());
        for index in self.at_edge(edge) {
            let (face, parent) = (self.faces[index], self.parents[index]);
            let corner = |v: u32| {
                (0..3)
                    .find(|c| face[*c] == v)
                    .expect("the edge is of the face")
            };
            let [first, second] = edge.map(corner);
            let [a, b] = [first, second].map(|c| parent.corners[c]);
            let between = [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * fraction);
            let part = |replaced: usize| {
                let (mut face, mut parent) = (face, parent);
                face[replaced] = middle;
                parent.corners[replaced] = between;
                (face, parent)
            };
            // This piece keeps the first end, the other one the second.
            let (kept, added) = (part(second), part(first));
            (self.faces[index], self.parents[index]) = kept;
            let new = self.faces.len();
            self.faces.push(added.0);
            self.parents.push(added.1);
            self.at_vertex[edge[1] as usize].retain(|piece| *piece != index);
            self.at_vertex[edge[1] as usize].push(new);
            self.at_vertex[middle as usize].extend([index, new]);
            let opposite = face[3 - first - second];
            self.at_vertex[opposite as usize].push(new);
        }
        middle
    }
}

impl BezierShell {
    /// Cuts along a path.
    ///
    /// # Errors
    /// A path that opens nothing, or whose stops do not share elements.
    pub fn cut(&self, path: &SurfacePath) -> Result<Change, BezierError> {
        let stops = path.nodes.len();
        // A single edge opens if one of its ends is on the boundary.
        let opens = stops >= 3 || (stops == 2 && path.ends_on_boundary(self).contains(&true));
        if !opens {
            return Err(BezierError::PathTooShort { stops });
        }
        // A path of another shell, such as this one before a cut.
        let vertices = self.mesh().num_vertices() as u32;
        let is_of_another = |node: &PathNode| match *node {
            PathNode::Vertex(v) => v >= vertices,
            PathNode::Crossing { edge, fraction } => {
                edge.iter().any(|&v| v >= vertices) || !(fraction > 0.0 && fraction < 1.0)
            }
        };
        if let Some(at) = path.nodes.iter().position(is_of_another) {
            return Err(BezierError::PathBroken { from: at, to: at });
        }
        let mut pieces = Pieces::new(self.mesh());
        let vertices: Vec<u32> = (path.nodes.iter())
            .map(|node| match *node {
                PathNode::Vertex(v) => v,
                PathNode::Crossing { edge, fraction } => pieces.divide(edge, fraction),
            })
            .collect();
        for (from, pair) in vertices.windows(2).enumerate() {
            if pieces.at_edge([pair[0], pair[1]]).is_empty() {
                let to = from + 1;
                return Err(BezierError::PathBroken { from, to });
            }
        }
        let whole = TriMesh::new(pieces.origins.len(), pieces.faces.clone())?;
        let seam = double(&mut pieces, &whole, &vertices);
        self.changed(pieces.faces, pieces.origins, pieces.parents, seam)
    }

    /// The shell of other faces, whose rest states are parts of those of this one.
    fn changed(
        &self,
        faces: Vec<[u32; 3]>,
        origins: Vec<Origin>,
        parents: Vec<Parent>,
        seam: Vec<[u32; 2]>,
    ) -> Result<Change, BezierError> {
        let mesh = TriMesh::new(origins.len(), faces)?;
        let rest = (parents.iter())
            .map(|parent| match parent.is_whole() {
                true => self.rest()[parent.element].clone(),
                false => parent.rest(&self.rest()[parent.element]),
            })
            .collect();
        let known = |index: usize| {
            let parent: &Parent = &parents[index];
            (parent.is_whole()).then(|| Arc::clone(&self.elements()[parent.element]))
        };
        let vertices = self.mesh().num_vertices() as u32;
        Ok(Change {
            present: (0..vertices).collect(),
            shell: Self::of_elements(mesh, rest, *self.options(), known)?,
            origins,
            parents,
            seam,
        })
    }
}

/// Gives what is right of the path vertices of its own; returns the pairs left and right.
fn double(pieces: &mut Pieces, whole: &TriMesh, path: &[u32]) -> Vec<[u32; 2]> {
    let mut is_right: HashMap<(u32, u32), bool> = HashMap::new();
    for pair in path.windows(2) {
        is_right.insert((pair[0], pair[1]), false);
        is_right.insert((pair[1], pair[0]), true);
    }
    let mut seam = Vec::new();
    for &v in path {
        let right = right_of_path(whole, v, &is_right);
        let all = whole.vertex_faces(VertexId(v));
        if right.is_empty() || right.len() == all.len() {
            continue;
        }
        let copy = pieces.origins.len() as u32;
        pieces.origins.push(pieces.origins[v as usize]);
        seam.push([v, copy]);
        for face in right {
            for corner in &mut pieces.faces[face.0 as usize] {
                if *corner == v {
                    *corner = copy;
                }
            }
        }
    }
    seam
}

/// The faces around a vertex that can be reached from those right of the path without crossing it. At an end inside the
/// surface these are all of them.
fn right_of_path(mesh: &TriMesh, vertex: u32, is_right: &HashMap<(u32, u32), bool>) -> Vec<FaceId> {
    let half_edges = |face: FaceId| {
        let corners = mesh.faces()[face.0 as usize];
        (0..3).map(move |c| (c, (corners[(c + 1) % 3], corners[(c + 2) % 3])))
    };
    let at_vertex = |(a, b): (u32, u32)| a == vertex || b == vertex;
    let mut found: Vec<FaceId> = (mesh.vertex_faces(VertexId(vertex)).iter().copied())
        .filter(|face| {
            half_edges(*face).any(|(_, ends)| at_vertex(ends) && is_right.get(&ends) == Some(&true))
        })
        .collect();
    let mut next = 0;
    while next < found.len() {
        let face = found[next];
        next += 1;
        for (c, ends) in half_edges(face) {
            if !at_vertex(ends) || is_right.contains_key(&ends) {
                continue;
            }
            let edge = mesh.face_edges()[face.0 as usize][c];
            for neighbour in mesh.edge_faces()[edge.0 as usize].into_iter().flatten() {
                if !found.contains(&neighbour) {
                    found.push(neighbour);
                }
            }
        }
    }
    found
}
