//! Pairs that may come near each other, found once for a whole line search.

use super::boxes::Aabb;
use super::broad_phase::BoxTree;
use super::collision_mesh::CollisionMesh;
use super::neighbours::{Neighbours, mean};
use super::pair::{Pair, PairKind};
use crate::Vec3;
use crate::assembly::parallel_map;

/// Candidates a vertex, on average, before a step is searched in a shorter reach: bounds the time when a wild Newton step
/// sweeps the whole scene. A sheet folded to a stack has about 250.
const CANDIDATES_PER_VERTEX: usize = 1000;

/// Candidates that every scene may have: a coarse obstacle of long thin faces has many for each of its few vertices.
const CANDIDATES_AT_LEAST: usize = 20_000_000;

/// Pairs that may be active until the next search, and the trees that find them.
#[derive(Default)]
pub(super) struct Candidates {
    /// Vertex–face pairs, then edge–edge pairs.
    pub(super) pairs: Vec<Pair>,
    pub(super) neighbours: Neighbours,
    /// Times the trees were searched.
    pub(super) searches: usize,
    face_tree: SweptTree,
    edge_tree: SweptTree,
}

/// A tree whose leaf order is kept until it has become this much worse than when it was made.
#[derive(Default)]
struct SweptTree {
    tree: BoxTree,
    cost_when_built: f64,
}

impl SweptTree {
    fn update(&mut self, boxes: &[Aabb]) {
        if self.tree.len() == boxes.len() {
            self.tree.refit(boxes);
            if self.tree.cost() <= 1.5 * self.cost_when_built {
                return;
            }
        }
        self.tree.rebuild(boxes);
        self.cost_when_built = self.tree.cost();
    }
}

impl Candidates {
    /// What `check` makes of all pairs whose surfaces, by their boxes, come within `reach` of each other anywhere between
    /// `x` and `x + dx`; vertex–face pairs, then edge–edge pairs. `None` if there are too many.
    pub(super) fn find<T: Send>(
        &mut self,
        mesh: &CollisionMesh,
        reach: f64,
        x: &[Vec3],
        dx: Option<&[Vec3]>,
        check: impl Fn(Pair) -> Option<T> + Sync + Send,
    ) -> Option<Vec<T>> {
        let shared = dx.map_or(Vec3::zeros(), |dx| mean(dx.iter().copied()));
        let swept = |vertices: &[u32]| {
            let margin = mesh.offset(vertices[0]) + 0.5 * reach;
            let at = |v: &u32| x[*v as usize];
            match dx {
                None => Aabb::around(vertices.iter().map(at), margin),
                Some(dx) => Aabb::around(
                    vertices
                        .iter()
                        .flat_map(|v| [at(v), at(v) + (dx[*v as usize] - shared)]),
                    margin,
                ),
            }
        };
        let limit = CANDIDATES_AT_LEAST.max(CANDIDATES_PER_VERTEX * mesh.vertices.len());
        let vertex_boxes = parallel_map(mesh.vertices.len(), |v| swept(&[v as u32]));
        let edge_boxes = parallel_map(mesh.edges.len(), |e| swept(&mesh.edges[e]));
        let face_boxes = parallel_map(mesh.faces.len(), |f| swept(&mesh.faces[f]));
        self.searches += 1;
        self.face_tree.update(&face_boxes);
        self.edge_tree.update(&edge_boxes);
        let both_obstacles = |a: u32, b: u32| mesh.is_obstacle(a) && mesh.is_obstacle(b);
        let mut found = self.face_tree.tree.pairs(
            &vertex_boxes,
            limit,
            |v, f| {
                let face = &mesh.faces[f as usize];
                face.contains(&v) || both_obstacles(v, face[0]) || mesh.is_gone(v)
            },
            |v, f| {
                let [a, b, c] = mesh.faces[f as usize];
                check(Pair {
                    kind: PairKind::VertexFace,
                    vertices: [v, a, b, c],
                })
            },
        )?;
        found.extend(self.edge_tree.tree.self_pairs(
            limit,
            |a, b| {
                let (first, second) = (&mesh.edges[a as usize], &mesh.edges[b as usize]);
                second.contains(&first[0])
                    || second.contains(&first[1])
                    || both_obstacles(first[0], second[0])
            },
            |a, b| {
                let ([a0, a1], [b0, b1]) = (mesh.edges[a as usize], mesh.edges[b as usize]);
                check(Pair {
                    kind: PairKind::EdgeEdge,
                    vertices: [a0, a1, b0, b1],
                })
            },
        )?);
        Some(found)
    }
}
