//! The render mesh as what collides: the nodes, edges and faces of it that are left, and which of them come near each other.
//!
//! Nodes are the corners, then the centres of quads, each the mean of four corners. Faces are numbered as in
//! [`DoubleLayer`]: triangle `4 q + k` has corners k, k + 1 of quad q and its centre. The surface that is shown is cut out
//! of these triangles: if they do not cross, it does not.

use super::double_layer::DoubleLayer;
use crate::Vec3;
use crate::contact::{Aabb, BoxTree, Pair, PairKind};

/// How nodes follow from particles.
#[derive(Clone, Debug)]
pub(super) struct Nodes {
    num_corners: usize,
    quads: Vec<[u32; 4]>,
}

/// What collides.
#[derive(Clone, Debug)]
pub(super) struct CollisionSurface {
    faces: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    /// The faces of each edge; the same twice on the boundary.
    edge_faces: Vec<[u32; 2]>,
    is_node_there: Vec<bool>,
    is_face_there: Vec<bool>,
    node_boxes: Vec<Aabb>,
    edge_boxes: Vec<Aabb>,
    face_boxes: Vec<Aabb>,
    edge_tree: BoxTree,
    face_tree: BoxTree,
}

/// Particles that a pair of primitives is made of, and how much each counts in the separation of its closest points.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Carriers {
    particles: [u32; 16],
    shares: [f64; 16],
    len: usize,
}

impl Nodes {
    pub(super) fn new(shell: &DoubleLayer) -> Self {
        Self {
            num_corners: shell.num_corners(),
            quads: shell.mesh.quads().to_vec(),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.num_corners + self.quads.len()
    }

    /// Corners of each quad.
    pub(super) fn quads(&self) -> &[[u32; 4]] {
        &self.quads
    }

    /// A value of a node: that of a corner, or the mean of those of four.
    pub(super) fn value<T>(&self, node: u32, at_corner: impl Fn(usize) -> T) -> T
    where
        T: std::iter::Sum + std::ops::Mul<f64, Output = T>,
    {
        match (node as usize).checked_sub(self.num_corners) {
            None => at_corner(node as usize),
            Some(quad) => {
                let corners = self.quads[quad].iter();
                corners.map(|&c| at_corner(c as usize)).sum::<T>() * 0.25
            }
        }
    }

    /// The positions of four nodes [m], by those of the particles.
    pub(super) fn positions(&self, nodes: [u32; 4], x: &[Vec3]) -> [Vec3; 4] {
        nodes.map(|node| self.value(node, |corner| x[corner]))
    }

    /// The particles of a pair with closest points of these weights.
    pub(super) fn carriers(&self, pair: &Pair, weights: &[f64; 4]) -> Carriers {
        let mut carriers = Carriers::default();
        for (&node, &weight) in pair.vertices.iter().zip(weights) {
            match (node as usize).checked_sub(self.num_corners) {
                None => carriers.add(node, weight),
                Some(quad) => {
                    for &corner in &self.quads[quad] {
                        carriers.add(corner, 0.25 * weight);
                    }
                }
            }
        }
        carriers
    }
}

impl CollisionSurface {
    pub(super) fn new(shell: &DoubleLayer) -> Self {
        let (num_corners, quads) = (shell.num_corners(), shell.mesh.quads());
        let center = |quad: usize| (num_corners + quad) as u32;
        let (mut faces, mut edges, mut edge_faces) = (Vec::new(), Vec::new(), Vec::new());
        for edge in shell.mesh.edges() {
            let sides = edge.sides.iter().flatten();
            let mut at_edge = sides.map(|side| 4 * side.quad + side.corner);
            let first = at_edge.next().expect("an edge belongs to a quad");
            edges.push(edge.vertices);
            edge_faces.push([first, at_edge.next().unwrap_or(first)]);
        }
        for (quad, corners) in quads.iter().enumerate() {
            for k in 0..4 {
                let face = |k: usize| (4 * quad + k % 4) as u32;
                faces.push([corners[k], corners[(k + 1) % 4], center(quad)]);
                edges.push([corners[k], center(quad)]);
                edge_faces.push([face(k), face(k + 3)]);
            }
        }
        Self {
            is_node_there: vec![true; num_corners + quads.len()],
            is_face_there: vec![true; faces.len()],
            node_boxes: vec![Aabb::EMPTY; num_corners + quads.len()],
            edge_boxes: vec![Aabb::EMPTY; edges.len()],
            face_boxes: vec![Aabb::EMPTY; faces.len()],
            edge_tree: BoxTree::default(),
            face_tree: BoxTree::default(),
            faces,
            edges,
            edge_faces,
        }
    }

    pub(super) fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    pub(super) fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The quads of an edge.
    pub(super) fn quads_of_edge(&self, edge: usize) -> [u32; 2] {
        self.edge_faces[edge].map(|face| face / 4)
    }

    /// Says which faces are left.
    pub(super) fn set_present(&mut self, is_face_there: &[bool]) {
        self.is_face_there.copy_from_slice(is_face_there);
        self.is_node_there.fill(false);
        for (face, _) in (self.faces.iter().zip(is_face_there)).filter(|(_, is)| **is) {
            for &node in face {
                self.is_node_there[node as usize] = true;
            }
        }
    }

    /// What `check` makes of all vertex–face and edge–edge pairs without a common node whose boxes overlap, in an order that
    /// does not depend on the number of threads. `corner_box` holds a corner wherever it may be, grown by its margin: so
    /// the mean of four holds a centre wherever each of them is.
    pub(super) fn pairs<T: Send>(
        &mut self,
        nodes: &Nodes,
        corner_box: impl Fn(usize) -> Aabb,
        check: impl Fn(Pair) -> Option<T> + Sync + Send,
    ) -> Vec<T> {
        self.fit(nodes, corner_box);
        let (faces, edges) = (&self.faces, &self.edges);
        let touches_face = |node: u32, face: u32| faces[face as usize].contains(&node);
        let vertex_face = |node: u32, face: u32| {
            let [a, b, c] = faces[face as usize];
            check(Pair {
                kind: PairKind::VertexFace,
                vertices: [node, a, b, c],
            })
        };
        let share_node = |a: u32, b: u32| {
            let [c, d] = edges[b as usize];
            edges[a as usize].iter().any(|&node| node == c || node == d)
        };
        let edge_edge = |a: u32, b: u32| {
            let ([a, b], [c, d]) = (edges[a as usize], edges[b as usize]);
            check(Pair {
                kind: PairKind::EdgeEdge,
                vertices: [a, b, c, d],
            })
        };
        let mut found = (self.face_tree)
            .pairs(&self.node_boxes, usize::MAX, touches_face, vertex_face)
            .unwrap_or_default();
        let of_edges = (self.edge_tree).self_pairs(usize::MAX, share_node, edge_edge);
        found.extend(of_edges.unwrap_or_default());
        found
    }

    /// Boxes and trees of what is there.
    fn fit(&mut self, nodes: &Nodes, corner_box: impl Fn(usize) -> Aabb) {
        for (corner, of_corner) in self.node_boxes[..nodes.num_corners].iter_mut().enumerate() {
            *of_corner = corner_box(corner);
        }
        let (corners, centers) = self.node_boxes.split_at_mut(nodes.num_corners);
        for (of_center, quad) in centers.iter_mut().zip(&nodes.quads) {
            let boxes = quad.map(|corner| corners[corner as usize]);
            let mean = |end: fn(&Aabb) -> &[f64; 3]| {
                std::array::from_fn(|k| 0.25 * boxes.iter().map(|b| end(b)[k]).sum::<f64>())
            };
            *of_center = Aabb {
                low: mean(|b| &b.low),
                high: mean(|b| &b.high),
            };
        }
        let union = |nodes: &[u32]| {
            let boxes = nodes.iter().map(|&node| &self.node_boxes[node as usize]);
            boxes.fold(Aabb::EMPTY, |all, of_node| all.union(of_node))
        };
        for (index, face) in self.faces.iter().enumerate() {
            self.face_boxes[index] = match self.is_face_there[index] {
                true => union(face),
                false => Aabb::EMPTY,
            };
        }
        for (index, edge) in self.edges.iter().enumerate() {
            let mut faces = self.edge_faces[index].iter();
            let is_there = faces.any(|&face| self.is_face_there[face as usize]);
            self.edge_boxes[index] = if is_there { union(edge) } else { Aabb::EMPTY };
        }
        for (of_node, is_there) in self.node_boxes.iter_mut().zip(&self.is_node_there) {
            if !is_there {
                *of_node = Aabb::EMPTY;
            }
        }
        self.edge_tree.rebuild(&self.edge_boxes);
        self.face_tree.rebuild(&self.face_boxes);
    }
}

impl Carriers {
    fn add(&mut self, particle: u32, share: f64) {
        let mut known = self.particles[..self.len].iter();
        match known.position(|&other| other == particle) {
            Some(place) => self.shares[place] += share,
            None => {
                self.particles[self.len] = particle;
                self.shares[self.len] = share;
                self.len += 1;
            }
        }
    }

    /// The particles.
    pub(super) fn particles(&self) -> impl Iterator<Item = u32> {
        self.particles.into_iter().take(self.len)
    }

    /// Moves particles by as little as changes the separation by `change` [m], heavier ones less; momentum is kept where
    /// none is held.
    pub(super) fn shift(&self, x: &mut [Vec3], inverse_masses: &[f64], change: Vec3) {
        let pairs = || self.particles().zip(self.shares);
        let ease: f64 = pairs()
            .map(|(particle, share)| inverse_masses[particle as usize] * share * share)
            .sum();
        if !(ease > 0.0) {
            return;
        }
        for (particle, share) in pairs() {
            let particle = particle as usize;
            x[particle] += inverse_masses[particle] * share / ease * change;
        }
    }
}
