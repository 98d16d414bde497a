//! Springs on the areas of faces.
//!
//! ```text
//! E = k ((A − Ā)/Ā − ε̄)²,    k = k_A Ā
//! A' = ½ n·(δ₁ × e₂ + e₁ × δ₂)
//! A'' = n·(δ₁ × δ₂) + |w₁ e₂ − w₂ e₁|² / 4A,    w_i = n·δ_i
//! ```
//!
//! e₁, e₂ edges out of the first corner, δ₁, δ₂ their motions, n unit normal. The first part of A'' is that of motions in
//! the plane of the face, as often negative as positive; the second, out of the plane, is positive. Both are projected by
//! themselves, in 4 and 2 dimensions. ε̄, zero but in dampers, is a relative change of area that costs nothing.

use nalgebra::{Matrix2, Matrix4, SMatrix, SVector, Vector2, Vector4};

use super::{DiscreteStiffness, Stiffnesses, rest_lengths};
use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian, project_to_psd};
use crate::geometry::Real;
use crate::geometry::over_numbers::{cross, norm, point, sub};
use crate::material::Section;
use crate::mesh::TriMesh;
use crate::rest::RestFrame;

/// The springs of all faces of one shell.
pub struct FaceAreas {
    faces: Vec<[Dof; 3]>,
    /// Ā.
    areas: Vec<f64>,
    /// k [J].
    stiffness: Vec<f64>,
    /// ε̄.
    rest: Vec<f64>,
}

/// A deformed face.
struct Face {
    /// e₁, e₂.
    edges: [Vec3; 2],
    normal: Vec3,
    area: f64,
}

impl Face {
    fn new(q: &SVector<f64, 9>) -> Self {
        let corner = |c: usize| Vec3::new(q[3 * c], q[3 * c + 1], q[3 * c + 2]);
        let edges = [corner(1) - corner(0), corner(2) - corner(0)];
        let doubled = edges[0].cross(&edges[1]);
        let norm = doubled.norm();
        Self {
            edges,
            normal: doubled / norm,
            area: 0.5 * norm,
        }
    }

    /// ∂A by e₁ and e₂.
    fn slope(&self) -> [Vec3; 2] {
        let [e1, e2] = &self.edges;
        [e2.cross(&self.normal) * 0.5, self.normal.cross(e1) * 0.5]
    }

    /// Two orthonormal vectors in the plane.
    fn basis(&self) -> [Vec3; 2] {
        let along = self.edges[0].normalize();
        [along, self.normal.cross(&along)]
    }

    /// Second derivatives by the corners: `plane` by e₁ and e₂ in the basis, and `upright` times ∂²A out of the plane.
    fn by_corners(&self, plane: &Matrix4<f64>, upright: f64) -> SMatrix<f64, 9, 9> {
        let basis = self.basis();
        let [a, b] = (self.edges).map(|e| Vector2::new(basis[0].dot(&e), basis[1].dot(&e)));
        let squares = Matrix2::new(b.dot(&b), -a.dot(&b), -a.dot(&b), a.dot(&a));
        let normal = squares * (upright / (4.0 * self.area));
        by_corners(|p, r| {
            let mut block = self.normal * self.normal.transpose() * normal[(p, r)];
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                block += basis[i] * basis[j].transpose() * plane[(2 * p + i, 2 * r + j)];
            }
            block
        })
    }
}

impl FaceAreas {
    /// Vertices have three unknowns each from `first_vertex` on; what is not `given` is that of the section.
    pub fn new(
        mesh: &TriMesh,
        first_vertex: Dof,
        frames: &[RestFrame],
        section: &dyn Section,
        given: DiscreteStiffness,
    ) -> Self {
        let lengths = rest_lengths(mesh, frames);
        let stiffnesses = Stiffnesses::new(mesh, frames, &lengths, section, given).areas;
        let vertex = |v: u32| Dof(first_vertex.0 + 3 * v);
        Self {
            faces: mesh.faces().iter().map(|f| f.map(vertex)).collect(),
            areas: frames.iter().map(|frame| frame.area).collect(),
            stiffness: (stiffnesses.iter().zip(frames))
                .map(|(k, frame)| k * frame.area)
                .collect(),
            rest: vec![0.0; frames.len()],
        }
    }

    /// A/Ā − 1 − ε̄.
    fn offset(&self, face: usize, area: f64) -> f64 {
        (area - self.areas[face]) / self.areas[face] - self.rest[face]
    }

    fn derivatives(&self, face: usize, q: &SVector<f64, 9>, kept: f64) -> LocalHessian<9> {
        let at = Face::new(q);
        let (k, rest) = (self.stiffness[face], self.areas[face]);
        let offset = self.offset(face, at.area);
        let force = 2.0 * k * offset / rest;
        let slope = at.slope();
        let basis = at.basis();
        let in_plane = Vector4::from_fn(|i, _| basis[i % 2].dot(&slope[i / 2]));
        let mut plane: Matrix4<f64> = in_plane * in_plane.transpose() * (2.0 * k / (rest * rest));
        plane += in_plane_curvature(force);
        if kept < 1.0 {
            project_to_psd(&mut plane, kept);
        }
        let upright = if force < 0.0 { kept * force } else { force };
        LocalHessian {
            value: k * offset * offset,
            gradient: corners(&slope, force),
            hessian: at.by_corners(&plane, upright),
        }
    }

    /// E of one face over any numbers: the oracle of the tests.
    pub fn formula<R: Real>(&self, face: usize, q: &[R; 9]) -> R {
        let corners: [[R; 3]; 3] = std::array::from_fn(|c| point(q, c));
        let [e1, e2] = [1, 2].map(|c| sub(&corners[c], &corners[0]));
        let doubled = norm(&cross(&e1, &e2));
        let change = doubled * (0.5 / self.areas[face]) - 1.0 - self.rest[face];
        change * change * self.stiffness[face]
    }
}

/// `force` times ∂²A in the plane, n·(δ₁ × δ₂): the first component of δ₁ with the second of δ₂, less the other way round.
fn in_plane_curvature(force: f64) -> Matrix4<f64> {
    let mut plane = Matrix4::zeros();
    for (i, j, signed) in [(0, 3, 0.5), (1, 2, -0.5)] {
        plane[(i, j)] = force * signed;
        plane[(j, i)] = force * signed;
    }
    plane
}

/// What a change by the edges, times a factor, is by the corners.
fn corners([first, second]: &[Vec3; 2], factor: f64) -> SVector<f64, 9> {
    let by_corner = [-(first + second) * factor, first * factor, second * factor];
    SVector::from_fn(|i, _| by_corner[i / 3][i % 3])
}

/// What second derivatives by the edges are by the corners.
fn by_corners(by_edges: impl Fn(usize, usize) -> SMatrix<f64, 3, 3>) -> SMatrix<f64, 9, 9> {
    const WEIGHTS: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    let blocks = [0, 1].map(|p| [0, 1].map(|r| by_edges(p, r)));
    let mut hessian = SMatrix::<f64, 9, 9>::zeros();
    for (a, b) in (0..9).map(|k| (k / 3, k % 3)) {
        let mut part = hessian.fixed_view_mut::<3, 3>(3 * a, 3 * b);
        for (p, r) in (0..4).map(|k| (k / 2, k % 2)) {
            part += blocks[p][r] * (WEIGHTS[a][p] * WEIGHTS[b][r]);
        }
    }
    hessian
}

impl LocalEnergy<9, 3> for FaceAreas {
    const NODE_SIZES: [usize; 3] = [3; 3];
    const MEASURES: usize = 1;

    fn name(&self) -> &'static str {
        "membrane"
    }

    fn num_stencils(&self) -> usize {
        self.faces.len()
    }

    fn nodes(&self, face: usize) -> [Option<Dof>; 3] {
        self.faces[face].map(Some)
    }

    fn value(&self, face: usize, q: &SVector<f64, 9>) -> f64 {
        self.stiffness[face] * self.offset(face, Face::new(q).area).powi(2)
    }

    fn gradient(&self, face: usize, q: &SVector<f64, 9>) -> (f64, SVector<f64, 9>) {
        let at = Face::new(q);
        let (k, offset) = (self.stiffness[face], self.offset(face, at.area));
        let force = 2.0 * k * offset / self.areas[face];
        (k * offset * offset, corners(&at.slope(), force))
    }

    fn hessian(&self, face: usize, q: &SVector<f64, 9>) -> LocalHessian<9> {
        self.derivatives(face, q, 1.0)
    }

    fn projected_hessian(&self, face: usize, q: &SVector<f64, 9>, kept: f64) -> LocalHessian<9> {
        self.derivatives(face, q, kept)
    }

    fn measure(&self, face: usize, q: &SVector<f64, 9>, measures: &mut [f64]) {
        measures[0] = (Face::new(q).area - self.areas[face]) / self.areas[face];
    }

    fn rest(&self, face: usize, measures: &mut [f64]) {
        measures[0] = self.rest[face];
    }

    fn set_rest(&mut self, face: usize, measures: &[f64]) {
        self.rest[face] = measures[0];
    }

    fn stress_stiffness(
        &self,
        face: usize,
        q: &SVector<f64, 9>,
        motion: &SVector<f64, 9>,
    ) -> Option<SMatrix<f64, 9, 9>> {
        let at = Face::new(q);
        let larger = corners(&at.slope(), 1.0).dot(motion);
        let force = 2.0 * self.stiffness[face] * larger / self.areas[face].powi(2);
        Some(at.by_corners(&in_plane_curvature(force), force))
    }

    fn describe(&self, face: usize) -> String {
        format!("face {face}")
    }
}
