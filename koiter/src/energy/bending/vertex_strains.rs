//! Strains of QB(PL) and QB(int): mean curvatures at vertices, and the squares of their differences.
//!
//! ```text
//! Φ = ½ Σ_i w_i (s_i − s̄_i)²,    s_i = ((L + N) x)_i · n_i / |n_i|,    n_i = Σ_faces at i (x_b − x_a) × (x_c − x_a)
//! ```
//!
//! w and L + N are those of [`super::QuadraticVertex`]; s has the sign of the curvature and turns with the shell, as those of
//! [`super::HingeStrains`] do. It is there for damping: second derivatives are those of Gauss and Newton, `w ∇s ∇sᵀ`, which are
//! the true ones where s = s̄ and never negative.

use super::quadratic_vertex::QuadraticVertex;
use crate::Vec3;
use crate::assembly::{
    Energy, HessianBuilder, PatternBuilder, PsdProjection, RestMeasures, ordered_sum, parallel_map,
};
use crate::mesh::TriMesh;

/// Squares of differences of mean curvatures to rest values, all 0 at first.
pub struct VertexStrains {
    model: QuadraticVertex,
    /// Corners of the faces around every vertex, from the vertex on.
    faces: Vec<Vec<[u32; 3]>>,
    /// The vertices on which each strain depends, increasing.
    stencils: Vec<Vec<u32>>,
    rest: Vec<f64>,
    factor: f64,
}

/// A strain and its derivatives by the vertices of its stencil.
struct Strain {
    value: f64,
    slope: Vec<Vec3>,
}

impl VertexStrains {
    /// Of the model of a shell with this mesh.
    pub fn new(model: QuadraticVertex, mesh: &TriMesh) -> Self {
        let mut faces = vec![Vec::new(); mesh.num_vertices()];
        for &[a, b, c] in mesh.faces() {
            for corners in [[a, b, c], [b, c, a], [c, a, b]] {
                faces[corners[0] as usize].push(corners);
            }
        }
        let stencil = |(vertex, faces): (usize, &Vec<[u32; 3]>)| {
            let around = faces.iter().flatten().copied();
            let mut all: Vec<u32> = around.chain(model.row(vertex).map(|(v, _)| v)).collect();
            all.push(vertex as u32);
            all.sort_unstable();
            all.dedup();
            all
        };
        Self {
            stencils: faces.iter().enumerate().map(stencil).collect(),
            rest: vec![0.0; faces.len()],
            faces,
            model,
            factor: 1.0,
        }
    }

    /// n of a vertex [m²].
    fn normal(&self, vertex: usize, q: &[f64]) -> Vec3 {
        let x = |v: u32| self.model.entries(q, v);
        let of_face = |&[a, b, c]: &[u32; 3]| (x(b) - x(a)).cross(&(x(c) - x(a)));
        self.faces[vertex].iter().map(of_face).sum()
    }

    fn value_at(&self, vertex: usize, q: &[f64]) -> f64 {
        let normal = self.normal(vertex, q);
        match normal.norm() {
            length if length > 0.0 => self.model.laplacian(vertex, q).dot(&normal) / length,
            _ => 0.0,
        }
    }

    fn strain(&self, vertex: usize, q: &[f64]) -> Strain {
        let stencil = &self.stencils[vertex];
        let mut slope = vec![Vec3::zeros(); stencil.len()];
        let normal = self.normal(vertex, q);
        let length = normal.norm();
        if !(length > 0.0) {
            return Strain { value: 0.0, slope };
        }
        let (unit, bend) = (normal / length, self.model.laplacian(vertex, q));
        let value = bend.dot(&unit);
        let place = |v: u32| stencil.binary_search(&v).expect("the stencil has it");
        let own = place(vertex as u32);
        for (column, entry) in self.model.row(vertex) {
            slope[place(column)] += unit * entry;
            slope[own] -= unit * entry;
        }
        // t · δn, and δn = Σ δa × (b − c) + … of every face.
        let turning = (bend - unit * value) / length;
        let x = |v: u32| self.model.entries(q, v);
        for &[a, b, c] in &self.faces[vertex] {
            for [at, from, to] in [[a, c, b], [b, a, c], [c, b, a]] {
                slope[place(at)] += (x(to) - x(from)).cross(&turning);
            }
        }
        Strain { value, slope }
    }

    fn weight(&self, vertex: usize) -> f64 {
        self.factor * self.model.weight(vertex)
    }

    fn add_slopes(&self, q: &[f64], strains: &[Strain], gradient: &mut [f64]) {
        debug_assert_eq!(q.len(), gradient.len());
        for (vertex, strain) in strains.iter().enumerate() {
            let force = self.weight(vertex) * (strain.value - self.rest[vertex]);
            for (&v, slope) in self.stencils[vertex].iter().zip(&strain.slope) {
                let start = self.model.dof(v);
                for (g, s) in gradient[start..start + 3].iter_mut().zip(slope) {
                    *g += force * s;
                }
            }
        }
    }
}

impl Energy for VertexStrains {
    fn name(&self) -> &'static str {
        "bending"
    }

    fn value(&self, q: &[f64]) -> f64 {
        if self.factor == 0.0 {
            return 0.0;
        }
        ordered_sum(self.rest.len(), |vertex| {
            let difference = self.value_at(vertex, q) - self.rest[vertex];
            0.5 * self.weight(vertex) * difference * difference
        })
    }

    fn add_gradient(&self, q: &[f64], gradient: &mut [f64]) {
        if self.factor != 0.0 {
            let strains = parallel_map(self.rest.len(), |vertex| self.strain(vertex, q));
            self.add_slopes(q, &strains, gradient);
        }
    }

    fn add_derivatives(
        &self,
        q: &[f64],
        _projection: PsdProjection,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        if self.factor == 0.0 {
            return;
        }
        let strains = parallel_map(self.rest.len(), |vertex| self.strain(vertex, q));
        self.add_slopes(q, &strains, gradient);
        for (vertex, strain) in strains.iter().enumerate() {
            let (weight, stencil) = (self.weight(vertex), &self.stencils[vertex]);
            for (i, (&a, first)) in stencil.iter().zip(&strain.slope).enumerate() {
                for (j, (&b, second)) in stencil[..=i].iter().zip(&strain.slope).enumerate() {
                    let nodes = [a, b].map(|v| self.model.node(v));
                    let entry = |r: usize, c: usize| weight * first[r] * second[c];
                    hessian.add(nodes[0], nodes[1], i == j, entry);
                }
            }
        }
    }

    fn add_to_pattern(&self, _q: &[f64], pattern: &mut PatternBuilder) {
        for stencil in &self.stencils {
            pattern.couple(stencil.iter().map(|&v| self.model.node(v)));
        }
    }

    fn rest_measures(&self) -> Option<&dyn RestMeasures> {
        Some(self)
    }

    fn rest_measures_mut(&mut self) -> Option<&mut dyn RestMeasures> {
        Some(self)
    }
}

impl RestMeasures for VertexStrains {
    fn measure(&self, q: &[f64]) -> Vec<f64> {
        parallel_map(self.rest.len(), |vertex| self.value_at(vertex, q))
    }

    fn rest(&self) -> Vec<f64> {
        self.rest.clone()
    }

    fn set_rest(&mut self, rest: &[f64]) {
        self.rest.copy_from_slice(rest);
    }

    fn has_branches(&self) -> bool {
        false
    }

    fn follow(&mut self, _measures: &[f64]) {}

    fn set_factor(&mut self, factor: f64) {
        self.factor = factor;
    }
}
