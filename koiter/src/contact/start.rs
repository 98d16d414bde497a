//! What touches or intersects in a configuration, in terms a person can act on.

use super::active::Contact;
use super::audit::Intersection;
use super::boxes::Aabb;
use super::collision_mesh::CollisionMesh;
use super::pair::{Pair, PairKind};
use crate::Vec3;

/// Two primitives that touch or overlap.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchingPair {
    /// The primitives in the user's terms.
    pub description: String,
    /// Gap between the surfaces [m], not positive; of a crossing, how far the edge reaches through the face.
    pub gap: f64,
    /// Whether they cross, rather than being closer than their thickness.
    pub crosses: bool,
    /// Vertices in the collision mesh.
    pub vertices: Vec<u32>,
}

/// A start configuration that touches or intersects.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.message())]
pub struct StartError {
    /// What touches, worst first.
    pub pairs: Vec<TouchingPair>,
    /// Whether any of them intersect (rather than being closer than their thickness).
    pub intersects: bool,
}

impl StartError {
    fn message(&self) -> String {
        let verb = if self.intersects {
            "intersects"
        } else {
            "touches"
        };
        let mut text = format!(
            "the start configuration {verb} itself or an obstacle in {} places:",
            self.pairs.len()
        );
        for pair in self.pairs.iter().take(5) {
            text += &format!("\n  {} (gap {:.3e} m)", pair.description, pair.gap);
        }
        if self.pairs.len() > 5 {
            text += &format!("\n  … and {} more", self.pairs.len() - 5);
        }
        text + "\nmove the parts apart, or reduce the contact thickness"
    }
}

impl Contact {
    /// Everything that touches or intersects at `q`: meshes by exact predicates, independently of the contact code;
    /// thickness, balls, capsules and planes by their distances.
    pub fn touching(&mut self, q: &[f64]) -> Vec<TouchingPair> {
        let x = self.positions(q);
        let mut found = self.crossings(&x);
        let mut candidates = std::mem::take(&mut self.candidates);
        let overlap = |pair: Pair| self.overlap(&pair, &x);
        let overlaps = if self.neighbours_cover(&mut candidates, &x, &vec![Vec3::zeros(); x.len()])
        {
            Some(candidates.neighbours.checked(overlap))
        } else {
            candidates.find(&self.mesh, 0.0, &x, None, overlap)
        };
        self.candidates = candidates;
        if let Some(overlaps) = overlaps {
            found.extend(overlaps);
        } else {
            // So many boxes overlap only where thick surfaces lie within each other.
            let description = "more pairs of primitives than can be listed".to_owned();
            found.push(TouchingPair {
                description,
                gap: f64::NEG_INFINITY,
                crosses: false,
                vertices: vec![],
            });
        }
        for near in self.near_planes(q) {
            let gap = near.distance - self.mesh.offset(near.vertex);
            if gap <= 0.0 {
                let name = &self.planes[near.plane].name;
                let description = format!(
                    "{} is below '{name}'",
                    self.mesh.describe_vertex(near.vertex)
                );
                let crosses = near.distance < 0.0;
                found.push(TouchingPair {
                    description,
                    gap,
                    crosses,
                    vertices: vec![near.vertex],
                });
            }
        }
        found.sort_by(|a, b| a.gap.total_cmp(&b.gap));
        found
    }

    fn crossings(&self, x: &[Vec3]) -> Vec<TouchingPair> {
        let mesh = &self.mesh;
        let both_obstacles = |a: u32, b: u32| mesh.is_obstacle(a) && mesh.is_obstacle(b);
        let hits = super::intersections(x, &mesh.edges, &mesh.faces, both_obstacles);
        let describe = |hit: Intersection| {
            let (edge, face) = (mesh.edges[hit.edge as usize], mesh.faces[hit.face as usize]);
            let [a, b, c] = face.map(|v| x[v as usize]);
            let normal = (b - a)
                .cross(&(c - a))
                .try_normalize(0.0)
                .unwrap_or_default();
            let depth = edge.map(|v| normal.dot(&(x[v as usize] - a)).abs());
            TouchingPair {
                description: format!(
                    "{} crosses {}",
                    mesh.describe("edge", &edge),
                    mesh.describe("face", &face)
                ),
                gap: -depth[0].min(depth[1]),
                crosses: true,
                vertices: edge.into_iter().chain(face).collect(),
            }
        };
        let is_awake = |hit: &Intersection| {
            let (edge, face) = (mesh.edges[hit.edge as usize], mesh.faces[hit.face as usize]);
            !self.is_crossing_asleep(&edge, &face)
        };
        (hits.into_iter().filter(is_awake)).map(describe).collect()
    }

    /// The pair, if its surfaces are no further apart than nothing.
    fn overlap(&self, pair: &Pair, x: &[Vec3]) -> Option<TouchingPair> {
        let gap = self.gap(pair, x);
        if gap > 0.0 || self.is_asleep(pair) {
            return None;
        }
        let ([a, b, c, d], mesh) = (pair.vertices, &self.mesh);
        let names = match pair.kind {
            PairKind::VertexFace => [mesh.describe_vertex(a), mesh.describe("face", &[b, c, d])],
            PairKind::EdgeEdge => [
                mesh.describe("edge", &[a, b]),
                mesh.describe("edge", &[c, d]),
            ],
        };
        let description = names.join(" touches ");
        let vertices = pair.vertices.to_vec();
        Some(TouchingPair {
            description,
            gap,
            crosses: false,
            vertices,
        })
    }

    /// Pieces of shells that lie inside a closed obstacle without touching it: one vertex of each decides, by the parity
    /// of the obstacle's faces on a way out.
    fn enclosed(&self, x: &[Vec3]) -> Vec<TouchingPair> {
        let mesh = &self.mesh;
        let bodies = |obstacle: bool| {
            (0..mesh.bodies.len()).filter(move |&b| mesh.bodies[b].is_obstacle == obstacle)
        };
        let mut found = Vec::new();
        for obstacle in bodies(true) {
            let body = &mesh.bodies[obstacle];
            // Every edge of a closed surface has two faces.
            if body.faces.is_empty() || 2 * body.edges.len() != 3 * body.faces.len() {
                continue;
            }
            let first = mesh.body_starts[obstacle].0;
            let faces: Vec<[u32; 3]> = body.faces.iter().map(|f| f.map(|v| first + v)).collect();
            let corners = (first..first + body.num_vertices as u32).map(|v| x[v as usize]);
            let around = Aabb::around(corners, 0.0);
            for shell in bodies(false) {
                for vertex in one_vertex_of_each_piece(mesh, shell) {
                    let start = x[vertex as usize];
                    if !around.overlaps(&Aabb::around([start], 0.0)) {
                        continue;
                    }
                    // A way out in a direction in which no mesh is built, so that it misses edges and vertices.
                    let size: f64 = (0..3).map(|k| around.high[k] - around.low[k]).sum();
                    let way = [
                        start,
                        start + Vec3::new(0.5377, 0.3141, 0.7818) * (2.0 * size),
                    ];
                    let points: Vec<Vec3> = x.iter().copied().chain(way).collect();
                    let ends = [x.len() as u32, x.len() as u32 + 1];
                    let hits = super::intersections(&points, &[ends], &faces, |_, _| false);
                    if hits.len() % 2 == 1 {
                        let name = &body.name;
                        let description =
                            format!("{} lies inside '{name}'", mesh.describe_vertex(vertex));
                        let vertices = vec![vertex];
                        found.push(TouchingPair {
                            description,
                            gap: 0.0,
                            crosses: true,
                            vertices,
                        });
                    }
                }
            }
        }
        found
    }

    /// Refuses a start that touches or intersects.
    ///
    /// # Errors
    /// What touches.
    pub fn check_start(&mut self, q: &[f64]) -> Result<(), StartError> {
        let mut pairs = self.touching(q);
        if pairs.is_empty() {
            pairs = self.enclosed(&self.positions(q));
        }
        if pairs.is_empty() {
            return Ok(());
        }
        let intersects = pairs.iter().any(|p| p.crosses);
        Err(StartError { pairs, intersects })
    }
}

/// The first vertex of every connected piece of a body.
fn one_vertex_of_each_piece(mesh: &CollisionMesh, body: usize) -> Vec<u32> {
    let mut root: Vec<u32> = (0..mesh.bodies[body].num_vertices as u32).collect();
    fn find(root: &mut [u32], mut v: u32) -> u32 {
        while root[v as usize] != v {
            root[v as usize] = root[root[v as usize] as usize];
            v = root[v as usize];
        }
        v
    }
    for &[u, v] in &mesh.bodies[body].edges {
        let (a, b) = (find(&mut root, u), find(&mut root, v));
        root[a.max(b) as usize] = a.min(b);
    }
    let first = mesh.body_starts[body].0;
    (0..root.len() as u32)
        .filter(|&v| root[v as usize] == v)
        .map(|v| first + v)
        .collect()
}
