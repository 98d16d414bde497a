//! Everything that can touch, as vertices, edges and faces with offsets.

use std::collections::{HashMap, HashSet};

use crate::Vec3;
use crate::assembly::Dof;

/// A surface, ball or capsule to be added to a [`CollisionMesh`].
#[derive(Clone, Debug)]
pub struct CollisionBody {
    /// Name for reports.
    pub name: String,
    /// First unknown of vertex 0; vertices follow in order, three unknowns each.
    pub first_dof: Dof,
    /// Number of vertices.
    pub num_vertices: usize,
    /// Edges: those of the faces, or the axis of a capsule.
    pub edges: Vec<[u32; 2]>,
    /// Faces.
    pub faces: Vec<[u32; 3]>,
    /// Rest positions [m]: areas that weigh the barrier, lengths that scale the mollifier.
    pub rest_positions: Vec<Vec3>,
    /// Half the thickness of a shell, the radius of a ball or capsule [m].
    pub offset: f64,
    /// Whether the body follows a schedule: two such bodies do not touch each other.
    pub is_obstacle: bool,
    /// Friction coefficient.
    pub friction: f64,
}

/// All bodies in one numbering.
#[derive(Clone, Debug, Default)]
pub struct CollisionMesh {
    /// First unknown of each vertex.
    pub vertices: Vec<Dof>,
    /// Edges.
    pub edges: Vec<[u32; 2]>,
    /// Faces.
    pub faces: Vec<[u32; 3]>,
    /// Body of each vertex.
    pub body: Vec<u32>,
    /// Area a vertex stands for: a third of its rest star [m²].
    pub vertex_areas: Vec<f64>,
    /// Rest position of each vertex [m].
    pub rest_positions: Vec<Vec3>,
    /// Area each edge stands for: a third of its rest faces [m²]; by `[u, v]` with `u < v`.
    edge_areas: HashMap<[u32; 2], f64>,
    /// The bodies.
    pub bodies: Vec<CollisionBody>,
    /// First vertex and first face of each body.
    pub body_starts: Vec<(u32, u32)>,
    /// Of each vertex, whether it belongs to nothing that can touch any more.
    is_gone: Vec<bool>,
    /// Faces that are there, of bodies that lose some; `None`: all.
    present: Vec<Option<Vec<bool>>>,
}

impl CollisionMesh {
    /// Joins bodies.
    pub fn new(bodies: Vec<CollisionBody>) -> Self {
        let mut mesh = Self::default();
        for (index, body) in bodies.iter().enumerate() {
            let first = mesh.vertices.len() as u32;
            mesh.body_starts.push((first, mesh.faces.len() as u32));
            mesh.vertices
                .extend((0..body.num_vertices as u32).map(|v| Dof(body.first_dof.0 + 3 * v)));
            mesh.body
                .extend(std::iter::repeat_n(index as u32, body.num_vertices));
            mesh.rest_positions.extend_from_slice(&body.rest_positions);
            mesh.vertex_areas.resize(mesh.vertices.len(), 0.0);
            mesh.edges
                .extend(body.edges.iter().map(|[u, v]| [first + u, first + v]));
            for face in &body.faces {
                let face = face.map(|v| first + v);
                mesh.faces.push(face);
                let third = mesh.face_area(&face) / 3.0;
                for k in 0..3 {
                    mesh.vertex_areas[face[k] as usize] += third;
                    let (u, v) = (face[k], face[(k + 1) % 3]);
                    *mesh.edge_areas.entry([u.min(v), u.max(v)]).or_default() += third;
                }
            }
        }
        mesh.is_gone = vec![false; mesh.vertices.len()];
        mesh.present = vec![None; bodies.len()];
        mesh.bodies = bodies;
        mesh
    }

    /// Leaves of a body only these of its faces, with their edges and vertices; areas and rest lengths stay.
    pub fn set_present(&mut self, body: usize, is_there: &[bool]) {
        self.present[body] = Some(is_there.to_vec());
        self.edges.clear();
        self.faces.clear();
        for (index, body) in self.bodies.iter().enumerate() {
            let (first, _) = self.body_starts[index];
            let Some(present) = &self.present[index] else {
                (self.edges).extend(body.edges.iter().map(|edge| edge.map(|v| first + v)));
                (self.faces).extend(body.faces.iter().map(|face| face.map(|v| first + v)));
                continue;
            };
            let kept = body.faces.iter().zip(present);
            let kept = kept
                .filter(|(_, is_there)| **is_there)
                .map(|(face, _)| face);
            let mut sides = HashSet::new();
            let is_gone = &mut self.is_gone[first as usize..][..body.num_vertices];
            is_gone.fill(true);
            for face in kept {
                self.faces.push(face.map(|v| first + v));
                for k in 0..3 {
                    is_gone[face[k] as usize] = false;
                    let (u, v) = (face[k], face[(k + 1) % 3]);
                    sides.insert([u.min(v), u.max(v)]);
                }
            }
            let edges = body.edges.iter();
            let edges = edges.filter(|[u, v]| sides.contains(&[*u.min(v), *u.max(v)]));
            self.edges.extend(edges.map(|edge| edge.map(|v| first + v)));
        }
    }

    /// Whether a vertex belongs to no face any more.
    #[inline]
    pub fn is_gone(&self, vertex: u32) -> bool {
        self.is_gone[vertex as usize]
    }

    /// Rest area of a face, by its vertices [m²].
    pub fn face_area(&self, face: &[u32; 3]) -> f64 {
        let [a, b, c] = face.map(|v| self.rest_positions[v as usize]);
        0.5 * (b - a).cross(&(c - a)).norm()
    }

    /// Area an edge stands for [m²].
    pub fn edge_area(&self, a: u32, b: u32) -> f64 {
        self.edge_areas
            .get(&[a.min(b), a.max(b)])
            .copied()
            .unwrap_or(0.0)
    }

    /// Squared rest length of an edge [m²].
    pub fn rest_length_squared(&self, a: u32, b: u32) -> f64 {
        (self.rest_positions[b as usize] - self.rest_positions[a as usize]).norm_squared()
    }

    /// Position of a vertex in `q`.
    #[inline]
    pub fn position(&self, vertex: u32, q: &[f64]) -> Vec3 {
        let start = self.vertices[vertex as usize].0 as usize;
        Vec3::new(q[start], q[start + 1], q[start + 2])
    }

    /// Offset of a vertex and of everything it belongs to [m].
    #[inline]
    pub fn offset(&self, vertex: u32) -> f64 {
        self.bodies[self.body[vertex as usize] as usize].offset
    }

    /// Whether a vertex belongs to an obstacle.
    #[inline]
    pub fn is_obstacle(&self, vertex: u32) -> bool {
        self.bodies[self.body[vertex as usize] as usize].is_obstacle
    }

    /// A vertex in the user's terms.
    pub fn describe_vertex(&self, vertex: u32) -> String {
        let body = self.body[vertex as usize] as usize;
        if self.bodies[body].faces.is_empty() {
            return format!("'{}'", self.bodies[body].name);
        }
        format!(
            "vertex {} of '{}'",
            vertex - self.body_starts[body].0,
            self.bodies[body].name
        )
    }

    /// A face or edge, by its vertices, in the user's terms.
    pub fn describe(&self, kind: &str, vertices: &[u32]) -> String {
        let body = self.body[vertices[0] as usize] as usize;
        if self.bodies[body].faces.is_empty() {
            return format!("'{}'", self.bodies[body].name);
        }
        let local: Vec<String> = vertices
            .iter()
            .map(|v| (v - self.body_starts[body].0).to_string())
            .collect();
        format!(
            "{kind} ({}) of '{}'",
            local.join(", "),
            self.bodies[body].name
        )
    }
}
