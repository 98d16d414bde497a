//! Quadratic bending with the Laplacian at vertices: QB(PL) and QB(int).
//!
//! ```text
//! E = ½ Σ_i (C_i / M_i) |((L + N) x)_i|²,     C = h³ (α + 2β) / 12
//! (L x)_i = ½ Σ_j (cot φ_ij + cot φ_ij') (x_j − x_i)
//! N: for every boundary edge j k of a face i j k, rows j and k each get ½ [cot_j (x_k − x_i) + cot_k (x_j − x_i)]
//! ```
//!
//! x positions [m], φ, φ' the rest angles opposite edge i j, cot_j cotangent of the rest angle at j, M_i a third of the
//! rest area around vertex i [m²], h thickness [m], α, β plane-stress Lamé parameters [Pa], C_i the mean of C over the faces
//! of the vertex, weighted by area. N is the outward derivative at the boundary: without it the boundary is pulled inwards,
//! with it L + N annihilates linear functions. Reference: "Better Bending" (2026), Eqs. (38)–(40), after
//! Bergou et al. (2006), Stein et al. (2018), and for the intrinsic Laplacian Sharp and Crane (2020).
//!
//! QB(int) takes L and N from the intrinsic Delaunay triangulation of the rest shape, and M from its faces as they are.
//!
//! The Hessian `(L + N)ᵀ C M⁻¹ (L + N)` is constant and positive semidefinite, and couples vertices at two edges' distance.
//! Far more accurate than QB(CR): exact in the limit on regular meshes. On irregular ones the energy does not converge,
//! since it squares a curvature that is right on average only: in the study QB(int) is 2 to 26 % too large, QB(PL) is up to
//! 27 times too large where the mesh is anisotropic and not Delaunay. The force against a fold weakens beyond a right angle
//! (group II), so folds collapse, and strips buckle too early. Both assume a flat rest shape and small stretch: curvature of
//! a rest shape is ignored.

use crate::Vec3;
use crate::assembly::{
    Dof, DofLayout, Energy, HessianBuilder, NodeId, Pattern, PatternBuilder, PsdProjection,
    WorstElement, ordered_sum, parallel_map,
};
use crate::mesh::Surface;
use crate::rest::{IntrinsicTriangulation, RestFrame};

/// Where the Laplacian comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LaplacianMesh {
    /// The faces as they are: QB(PL).
    Extrinsic,
    /// The intrinsic Delaunay triangulation of the rest shape: QB(int).
    IntrinsicDelaunay,
}

/// An entry of a sparse matrix: row, column, value.
type Entry = (u32, u32, f64);

/// QB(PL) or QB(int) bending energy of one shell.
pub struct QuadraticVertex {
    first_vertex: usize,
    first_node: u32,
    /// Row `i` of L + N without its diagonal, which is minus the sum of the others: columns and values.
    rows: Vec<Vec<(u32, f64)>>,
    /// C_i / M_i of every vertex [N/m].
    weights: Vec<f64>,
    /// Lower triangle of `(L + N)ᵀ C M⁻¹ (L + N)` by rows.
    hessian: Vec<Entry>,
    /// Positions of the blocks of `hessian` in the assembled matrix.
    slots: Vec<u32>,
}

impl QuadraticVertex {
    /// `frames` are the rest frames of the faces of `rest`, `flexural_rigidity` is `E h³ / (12 (1 − ν²))` of every face
    /// [N·m], which equals C. The vertices have three unknowns each from `first_vertex` on.
    pub fn new(
        rest: &Surface,
        first_vertex: Dof,
        layout: &DofLayout,
        frames: &[RestFrame],
        flexural_rigidity: &[f64],
        laplacian: LaplacianMesh,
    ) -> Self {
        let mut triangulation = IntrinsicTriangulation::of_surface(rest);
        if laplacian == LaplacianMesh::IntrinsicDelaunay {
            triangulation.make_delaunay();
        }
        let num_vertices = rest.mesh.num_vertices();
        let mut rows = vec![Vec::new(); num_vertices];
        for (row, column, value) in merged(laplacian_entries(&triangulation)) {
            rows[row as usize].push((column, value));
        }
        let mut area = vec![0.0; num_vertices];
        let mut rigidity = vec![0.0; num_vertices];
        for (face, frame) in frames.iter().enumerate() {
            for v in rest.mesh.faces()[face].map(|v| v as usize) {
                area[v] += frame.area;
                rigidity[v] += frame.area * flexural_rigidity[face];
            }
        }
        let weights: Vec<f64> = (0..num_vertices)
            .map(|v| 3.0 * rigidity[v] / (area[v] * area[v]))
            .collect();
        Self {
            first_vertex: first_vertex.0 as usize,
            first_node: layout.node(first_vertex).0,
            hessian: merged(squared(&rows, &weights)),
            rows,
            weights,
            slots: Vec::new(),
        }
    }

    /// The first unknown of a vertex.
    pub(super) fn dof(&self, vertex: u32) -> usize {
        self.first_vertex + 3 * vertex as usize
    }

    /// The three entries of a vertex in a vector over all unknowns.
    pub(super) fn entries(&self, q: &[f64], vertex: u32) -> Vec3 {
        let start = self.dof(vertex);
        Vec3::from_column_slice(&q[start..start + 3])
    }

    /// A row of L + N without its diagonal, which is minus the sum of the others: columns and values.
    pub(super) fn row(&self, vertex: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.rows[vertex].iter().copied()
    }

    /// C_i / M_i of a vertex [N/m].
    pub(super) fn weight(&self, vertex: usize) -> f64 {
        self.weights[vertex]
    }

    /// `((L + N) x)_i` by differences of positions: round-off does not grow with the distance from the origin.
    pub fn laplacian(&self, vertex: usize, q: &[f64]) -> Vec3 {
        let x = self.entries(q, vertex as u32);
        let row = self.rows[vertex].iter();
        row.fold(Vec3::zeros(), |sum, &(column, value)| {
            sum + (self.entries(q, column) - x) * value
        })
    }

    pub(super) fn node(&self, vertex: u32) -> NodeId {
        NodeId(self.first_node + vertex)
    }
}

/// Entries of L + N off the diagonal.
fn laplacian_entries(triangulation: &IntrinsicTriangulation) -> Vec<Entry> {
    let mut entries = Vec::new();
    let mut add = |row: u32, column: u32, value: f64| {
        // An edge that ends where it began: x_j − x_i = 0.
        if row != column {
            entries.push((row, column, value));
        }
    };
    for (face, vertices) in triangulation.faces().iter().enumerate() {
        let half_cot = triangulation.cotangents(face).map(|cot| 0.5 * cot);
        for corner in 0..3 {
            let at = [corner, (corner + 1) % 3, (corner + 2) % 3];
            let [i, j, k] = at.map(|c| vertices[c]);
            let [cot_i, cot_j, cot_k] = at.map(|c| half_cot[c]);
            add(j, k, cot_i);
            add(k, j, cot_i);
            if triangulation.is_boundary(face, corner) {
                // cot_j (x_k − x_i) + cot_k (x_j − x_i) by differences to x_j, then to x_k.
                add(j, k, cot_j);
                add(j, i, -cot_j - cot_k);
                add(k, j, cot_k);
                add(k, i, -cot_j - cot_k);
            }
        }
    }
    entries
}

/// Sorted by row and column, with entries of the same place added in their order.
fn merged(mut entries: Vec<Entry>) -> Vec<Entry> {
    entries.sort_by_key(|&(row, column, _)| (row, column));
    let mut out: Vec<Entry> = Vec::with_capacity(entries.len() / 2);
    for entry in entries {
        match out.last_mut() {
            Some(last) if (last.0, last.1) == (entry.0, entry.1) => last.2 += entry.2,
            _ => out.push(entry),
        }
    }
    out
}

/// Terms of the lower triangle of `Bᵀ W B` for the rows of B without their diagonals.
fn squared(rows: &[Vec<(u32, f64)>], weights: &[f64]) -> Vec<Entry> {
    let mut entries = Vec::new();
    for (i, (row, weight)) in rows.iter().zip(weights).enumerate() {
        let diagonal = -row.iter().map(|(_, value)| value).sum::<f64>();
        let full = || row.iter().copied().chain([(i as u32, diagonal)]);
        for (a, x) in full() {
            let below = full().filter(|&(b, _)| b <= a);
            entries.extend(below.map(|(b, y)| (a, b, weight * x * y)));
        }
    }
    entries
}

impl Energy for QuadraticVertex {
    fn name(&self) -> &'static str {
        "bending"
    }

    fn value(&self, q: &[f64]) -> f64 {
        ordered_sum(self.rows.len(), |v| {
            0.5 * self.weights[v] * self.laplacian(v, q).norm_squared()
        })
    }

    fn add_gradient(&self, q: &[f64], gradient: &mut [f64]) {
        let bends = parallel_map(self.rows.len(), |v| self.laplacian(v, q) * self.weights[v]);
        for (vertex, (row, bend)) in self.rows.iter().zip(&bends).enumerate() {
            let mut add = |vertex: usize, force: Vec3| {
                let start = self.dof(vertex as u32);
                for (g, f) in gradient[start..start + 3].iter_mut().zip(&force) {
                    *g += f;
                }
            };
            for &(column, value) in row {
                add(column as usize, bend * value);
                add(vertex, bend * -value);
            }
        }
    }

    /// The Hessian is a sum of squares, so nothing is negative.
    fn add_derivatives(
        &self,
        q: &[f64],
        _projection: PsdProjection,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        self.add_gradient(q, gradient);
        for (&(row, column, value), &slot) in self.hessian.iter().zip(&self.slots) {
            let (a, b) = (self.node(row), self.node(column));
            hessian.add_at(
                slot,
                a,
                b,
                row == column,
                |r, c| {
                    if r == c { value } else { 0.0 }
                },
            );
        }
    }

    fn add_to_pattern(&self, _q: &[f64], pattern: &mut PatternBuilder) {
        for &(row, column, _) in &self.hessian {
            pattern.couple([self.node(row), self.node(column)]);
        }
    }

    fn bind(&mut self, pattern: &Pattern) {
        self.slots = parallel_map(self.hessian.len(), |k| {
            let (row, column, _) = self.hessian[k];
            pattern
                .slot(self.node(row), self.node(column))
                .expect("the vertices are in the pattern")
        });
    }

    fn worst_element(&self, q: &[f64]) -> Option<WorstElement> {
        let mut gradient = vec![0.0; q.len()];
        self.add_gradient(q, &mut gradient);
        let norms: Vec<f64> = (0..self.rows.len() as u32)
            .map(|v| self.entries(&gradient, v).norm())
            .collect();
        let is_broken = |norm: &f64| !norm.is_finite();
        let worst = match norms.iter().position(is_broken) {
            Some(broken) => broken,
            None => (0..norms.len()).max_by(|&a, &b| norms[a].total_cmp(&norms[b]))?,
        };
        Some(WorstElement {
            description: format!("vertex {worst}"),
            unknown: Some(Dof(self.dof(worst as u32) as u32)),
            gradient_norm: norms[worst],
        })
    }
}
