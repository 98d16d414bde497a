//! What touches or intersects in a configuration, in terms a person can act on.

use super::energy::Contact;
use super::pair::PairKind;

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
    /// Everything that touches or intersects at `q`: by exact predicates for meshes, by distance for thickness, balls,
    /// capsules and planes.
    pub fn touching(&mut self, q: &[f64]) -> Vec<TouchingPair> {
        let x = self.positions(q);
        let mesh = &self.mesh;
        let both_obstacles = |a: u32, b: u32| mesh.is_obstacle(a) && mesh.is_obstacle(b);
        let mut found: Vec<TouchingPair> =
            super::intersections(&x, &mesh.edges, &mesh.faces, both_obstacles)
                .into_iter()
                .map(|hit| {
                    let (edge, face) =
                        (mesh.edges[hit.edge as usize], mesh.faces[hit.face as usize]);
                    let description = format!(
                        "{} crosses {}",
                        mesh.describe("edge", &edge),
                        mesh.describe("face", &face)
                    );
                    let [a, b, c] = face.map(|v| x[v as usize]);
                    let normal = (b - a).cross(&(c - a)).normalize();
                    let depth = edge.map(|v| normal.dot(&(x[v as usize] - a)).abs());
                    let vertices = edge.into_iter().chain(face).collect();
                    TouchingPair {
                        description,
                        gap: -depth[0].min(depth[1]),
                        crosses: true,
                        vertices,
                    }
                })
                .collect();
        if !self.candidates.find(&self.mesh, self.d_hat, &x, None) {
            return found;
        }
        let mesh = &self.mesh;
        for pair in &self.candidates.pairs {
            let positions = pair.vertices.map(|v| x[v as usize]);
            let gap =
                pair.closest(&positions).distance_squared.sqrt() - self.touching_distance(pair);
            if gap <= 0.0 {
                let [a, b, c, d] = pair.vertices;
                let description = match pair.kind {
                    PairKind::VertexFace => {
                        format!(
                            "{} touches {}",
                            mesh.describe_vertex(a),
                            mesh.describe("face", &[b, c, d])
                        )
                    }
                    PairKind::EdgeEdge => {
                        format!(
                            "{} touches {}",
                            mesh.describe("edge", &[a, b]),
                            mesh.describe("edge", &[c, d])
                        )
                    }
                };
                found.push(TouchingPair {
                    description,
                    gap,
                    crosses: false,
                    vertices: pair.vertices.to_vec(),
                });
            }
        }
        for near in self.near_planes(q) {
            let gap = near.distance - mesh.offset(near.vertex);
            if gap <= 0.0 {
                let name = &self.planes[near.plane].name;
                let description =
                    format!("{} is below '{name}'", mesh.describe_vertex(near.vertex));
                found.push(TouchingPair {
                    description,
                    gap,
                    crosses: near.distance < 0.0,
                    vertices: vec![near.vertex],
                });
            }
        }
        found.sort_by(|a, b| a.gap.total_cmp(&b.gap));
        found
    }

    /// Refuses a start that touches or intersects.
    ///
    /// # Errors
    /// What touches.
    pub fn check_start(&mut self, q: &[f64]) -> Result<(), StartError> {
        let pairs = self.touching(q);
        if pairs.is_empty() {
            return Ok(());
        }
        let intersects = pairs.iter().any(|p| p.crosses);
        Err(StartError { pairs, intersects })
    }
}
