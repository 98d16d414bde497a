//! The surface that is left: marching triangles on the render mesh.
//!
//! A node of the render mesh (corner, or centre of a quad with the level of its lattice particle) is there while its level
//! m' is at least 0. A triangle of which some nodes are there is cut where m' passes through 0 on its edges,
//!
//! ```text
//! x_mid = (1 − t) x_0 + t x_1,   t = m'_0 / (m'_0 − m'_1)                    (Eq. 7)
//! ```
//!
//! Every edge of the render mesh has one such point, whichever triangle asks for it: cuts have no gaps.

use super::double_layer::DoubleLayer;
use super::quad_mesh::QuadMesh;
use crate::Vec3;
use crate::mesh::TriMesh;

const NONE: u32 = u32::MAX;

/// A vertex of the surface: between two nodes of the render mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Between {
    /// The nodes; the same twice for a vertex on a node.
    pub nodes: [u32; 2],
    /// How far from the first to the second.
    pub share: f64,
}

impl Between {
    /// A value between those of the nodes.
    pub fn mix(&self, value: impl Fn(usize) -> f64) -> f64 {
        let [a, b] = self.nodes.map(|node| value(node as usize));
        a + self.share * (b - a)
    }

    /// A point between those of the nodes.
    pub fn point(&self, position: impl Fn(usize) -> Vec3) -> Vec3 {
        let [a, b] = self.nodes.map(|node| position(node as usize));
        a + self.share * (b - a)
    }
}

/// What is left of the render mesh.
#[derive(Clone, Debug)]
pub struct RenderSurface {
    /// Nodes of the triangles of the whole render mesh.
    triangles: Vec<[u32; 3]>,
    /// Edges of the triangles, opposite to their corners: blue ones first, then those to the centres.
    triangle_edges: Vec<[u32; 3]>,
    vertex_of_node: Vec<u32>,
    vertex_of_edge: Vec<u32>,
    /// Vertices.
    pub vertices: Vec<Between>,
    /// Faces.
    pub faces: Vec<[u32; 3]>,
    /// The triangle of the render mesh that each face is part of.
    pub face_triangles: Vec<u32>,
}

impl RenderSurface {
    /// The whole render mesh of a double layer.
    pub fn new(mesh: &QuadMesh) -> Self {
        let num_corners = mesh.positions().len();
        let (num_quads, num_edges) = (mesh.quads().len(), mesh.edges().len());
        let mut triangles = Vec::with_capacity(4 * num_quads);
        let mut triangle_edges = vec![[NONE; 3]; 4 * num_quads];
        for (quad, corners) in mesh.quads().iter().enumerate() {
            let center = (num_corners + quad) as u32;
            let spoke = |k: usize| (num_edges + 4 * quad + k % 4) as u32;
            for k in 0..4 {
                triangles.push([corners[k], corners[(k + 1) % 4], center]);
                triangle_edges[4 * quad + k] = [spoke(k + 1), spoke(k), NONE];
            }
        }
        for (index, edge) in mesh.edges().iter().enumerate() {
            for side in edge.sides.iter().flatten() {
                triangle_edges[4 * side.quad as usize + side.corner as usize][2] = index as u32;
            }
        }
        let num_nodes = num_corners + num_quads;
        Self::whole(
            triangles,
            triangle_edges,
            num_nodes,
            num_edges + 4 * num_quads,
        )
    }

    /// The whole of a mesh of triangles: its vertices are the nodes.
    pub fn of_mesh(mesh: &TriMesh) -> Self {
        let edges = mesh.face_edges().iter();
        Self::whole(
            mesh.faces().to_vec(),
            edges.map(|edges| edges.map(|edge| edge.0)).collect(),
            mesh.num_vertices(),
            mesh.num_edges(),
        )
    }

    fn whole(
        triangles: Vec<[u32; 3]>,
        triangle_edges: Vec<[u32; 3]>,
        num_nodes: usize,
        num_edges: usize,
    ) -> Self {
        let mut surface = Self {
            triangles,
            triangle_edges,
            vertex_of_node: vec![NONE; num_nodes],
            vertex_of_edge: vec![NONE; num_edges],
            vertices: Vec::new(),
            faces: Vec::new(),
            face_triangles: Vec::new(),
        };
        surface.rebuild(|_| 1.0);
        surface
    }

    /// Cuts the render mesh by the levels of its nodes.
    pub fn rebuild(&mut self, level: impl Fn(usize) -> f64) {
        self.rebuild_of(|_| true, level);
    }

    /// Cuts what is left of the render mesh where only some triangles are there.
    pub fn rebuild_of(&mut self, is_present: impl Fn(usize) -> bool, level: impl Fn(usize) -> f64) {
        self.vertices.clear();
        self.faces.clear();
        self.face_triangles.clear();
        self.vertex_of_node.fill(NONE);
        self.vertex_of_edge.fill(NONE);
        for triangle in (0..self.triangles.len()).filter(|&triangle| is_present(triangle)) {
            let levels = self.triangles[triangle].map(|node| level(node as usize));
            let is_there = levels.map(|level| level >= 0.0);
            // Turned so that a corner that is alone, here or gone, comes first.
            let count = is_there.iter().filter(|&&there| there).count();
            let alone = (0..3).find(|&k| is_there[k] == (count == 1)).unwrap_or(0);
            let [i, j, k] = [alone, (alone + 1) % 3, (alone + 2) % 3];
            match count {
                0 => {}
                1 => {
                    let face = [
                        self.node(triangle, i),
                        self.cut(triangle, k, levels),
                        self.cut(triangle, j, levels),
                    ];
                    self.push(triangle, face);
                }
                2 => {
                    let [cut_j, cut_k] =
                        [k, j].map(|opposite| self.cut(triangle, opposite, levels));
                    let [node_j, node_k] = [j, k].map(|corner| self.node(triangle, corner));
                    self.push(triangle, [cut_j, node_j, node_k]);
                    self.push(triangle, [cut_j, node_k, cut_k]);
                }
                _ => {
                    let face = [0, 1, 2].map(|corner| self.node(triangle, corner));
                    self.push(triangle, face);
                }
            }
        }
    }

    fn push(&mut self, triangle: usize, face: [u32; 3]) {
        self.faces.push(face);
        self.face_triangles.push(triangle as u32);
    }

    fn node(&mut self, triangle: usize, corner: usize) -> u32 {
        let node = self.triangles[triangle][corner];
        let vertex = &mut self.vertex_of_node[node as usize];
        if *vertex == NONE {
            *vertex = self.vertices.len() as u32;
            self.vertices.push(Between {
                nodes: [node; 2],
                share: 0.0,
            });
        }
        *vertex
    }

    /// The cut of the edge opposite a corner.
    fn cut(&mut self, triangle: usize, opposite: usize, levels: [f64; 3]) -> u32 {
        let vertex = &mut self.vertex_of_edge[self.triangle_edges[triangle][opposite] as usize];
        if *vertex == NONE {
            *vertex = self.vertices.len() as u32;
            let [a, b] = [(opposite + 1) % 3, (opposite + 2) % 3];
            let nodes = [a, b].map(|corner| self.triangles[triangle][corner]);
            let share = levels[a] / (levels[a] - levels[b]);
            self.vertices.push(Between { nodes, share });
        }
        *vertex
    }

    /// Whether something of each triangle of the render mesh is left.
    pub fn mark_triangles(&self, is_there: &mut [bool]) {
        is_there.fill(false);
        for &triangle in &self.face_triangles {
            is_there[triangle as usize] = true;
        }
    }

    /// Positions of the vertices [m], by those of the particles.
    pub fn positions(&self, shell: &DoubleLayer, particles: &[Vec3]) -> Vec<Vec3> {
        self.positions_by(|node| node_position(shell, particles, node))
    }

    /// Positions of the vertices [m], by those of the nodes.
    pub fn positions_by(&self, node: impl Fn(usize) -> Vec3) -> Vec<Vec3> {
        let vertices = self.vertices.iter();
        vertices.map(|vertex| vertex.point(&node)).collect()
    }

    /// Area of what is left [m²], by positions of the particles.
    pub fn area(&self, shell: &DoubleLayer, particles: &[Vec3]) -> f64 {
        self.area_by(|node| node_position(shell, particles, node))
    }

    /// Area of what is left [m²], by positions of the nodes.
    pub fn area_by(&self, node: impl Fn(usize) -> Vec3) -> f64 {
        let positions = self.positions_by(node);
        let area = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|vertex| positions[vertex as usize]);
            0.5 * (b - a).cross(&(c - a)).norm()
        };
        self.faces.iter().map(area).sum()
    }
}

/// Where a node of the render mesh is: a corner, or the mean of the corners of a quad.
fn node_position(shell: &DoubleLayer, particles: &[Vec3], node: usize) -> Vec3 {
    match node.checked_sub(shell.num_corners()) {
        None => particles[node],
        Some(quad) => {
            let corners = shell.mesh.quads()[quad];
            0.25 * corners
                .map(|corner| particles[corner as usize])
                .iter()
                .sum::<Vec3>()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn torus() -> DoubleLayer {
        DoubleLayer::new(QuadMesh::torus(1.0, 0.4, [16, 10]).unwrap(), 0.05)
    }

    /// How often each directed edge is used.
    fn directed_edges(surface: &RenderSurface) -> BTreeMap<[u32; 2], usize> {
        let mut edges = BTreeMap::new();
        for face in &surface.faces {
            for k in 0..3 {
                *edges.entry([face[k], face[(k + 1) % 3]]).or_insert(0) += 1;
            }
        }
        edges
    }

    #[test]
    fn cuts_are_watertight() {
        let shell = torus();
        let mut surface = RenderSurface::new(&shell.mesh);
        for phase in 0..20 {
            let level = |node: usize| (node as f64 * 0.61 + f64::from(phase)).sin() + 0.1;
            surface.rebuild(level);
            let edges = directed_edges(&surface);
            let is_cut = |vertex: u32| {
                let Between { nodes: [a, b], .. } = surface.vertices[vertex as usize];
                a != b
            };
            let mut cuts = 0;
            for (&[a, b], &count) in &edges {
                assert_eq!(count, 1, "two faces use an edge in the same direction");
                if !edges.contains_key(&[b, a]) {
                    // A closed surface opens only along the curve m' = 0.
                    assert!(is_cut(a) && is_cut(b));
                    cuts += 1;
                }
            }
            assert!(cuts > 20);
        }
    }

    #[test]
    fn cut_points_lie_where_the_level_is_zero_and_areas_add_up() {
        let shell = DoubleLayer::new(QuadMesh::grid([1.0, 1.0], [10, 10]).unwrap(), 0.02);
        let mut surface = RenderSurface::new(&shell.mesh);
        assert!((surface.area(&shell, &shell.particles) - 1.0).abs() < 1e-13);
        // A linear level is cut along a straight line, exactly.
        let x = |node: usize| node_position(&shell, &shell.particles, node).x;
        surface.rebuild(|node| 0.123 - x(node));
        let area = surface.area(&shell, &shell.particles);
        assert!((area - 0.623).abs() < 1e-13, "{area}");
        let positions = surface.positions(&shell, &shell.particles);
        assert!(positions.iter().all(|p| p.x < 0.123 + 1e-14));
        surface.rebuild(|_| 0.0);
        assert_eq!(surface.faces.len(), 400, "what is at the level is there");
        surface.rebuild(|_| -1e-300);
        assert!(surface.faces.is_empty() && surface.vertices.is_empty());
    }
}
