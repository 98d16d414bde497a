//! Koiter membrane on constant-strain triangles.
//!
//! ```text
//! E = Ā W(ε),   ε = (Fᵀ F − 1) / 2,   F = [x_j − x_i, x_k − x_i] D⁻¹
//! ```
//!
//! Ā rest area [m²], W energy of stretching per unit area of the [`Section`] [J/m²], D the rest edges in an orthonormal
//! basis ([`RestFrame`]). For a St. Venant–Kirchhoff material of thickness h this is `(h/4) Ā (α/2 tr(S)² + β tr(S²))`, `S = Ī⁻¹(I − Ī)`. Reference:
//! "Better Bending" (2026), Eqs. (4) and (22); the factor there is printed h/2, the strain is S/2. From ε a rest strain ε̄ is
//! taken away, which is zero but in dampers.
//!
//! The Hessian splits exactly into motions in the plane of the face and out of it: out of the plane it is the stress
//! alone, a 2 × 2 matrix. Both parts are projected by themselves, in 4 and 2 dimensions.

use nalgebra::{Matrix4, Matrix6, SMatrix, SVector, Vector3};

use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian, project_to_psd};
use crate::geometry::Real;
use crate::geometry::over_numbers::dot;
use crate::material::{Response, Section};
use crate::mesh::TriMesh;
use crate::rest::RestFrame;

/// Membrane energy of one shell.
pub struct Membrane<S> {
    faces: Vec<[Dof; 3]>,
    frames: Vec<RestFrame>,
    section: S,
    /// ε̄ of every face.
    rest_strains: Vec<Vector3<f64>>,
}

impl<S: Section> Membrane<S> {
    /// `first_vertex` is the first unknown of the shell's vertex 0; vertices have three unknowns each, in order.
    pub fn new(mesh: &TriMesh, first_vertex: Dof, frames: Vec<RestFrame>, section: S) -> Self {
        let faces = mesh
            .faces()
            .iter()
            .map(|f| f.map(|v| Dof(first_vertex.0 + 3 * v)))
            .collect();
        Self {
            faces,
            rest_strains: vec![Vector3::zeros(); frames.len()],
            frames,
            section,
        }
    }

    /// Green strain `(ε₁₁, ε₂₂, ε₁₂)` of a face in its rest frame.
    pub fn strain(&self, face: usize, x: &[Vec3; 3]) -> Vector3<f64> {
        green_strain(&self.frames[face].deformation_gradient(&(x[1] - x[0]), &(x[2] - x[0])))
    }

    fn columns(&self, face: usize, q: &SVector<f64, 9>) -> [Vec3; 2] {
        let corner = |c: usize| Vec3::new(q[3 * c], q[3 * c + 1], q[3 * c + 2]);
        self.frames[face].deformation_gradient(&(corner(1) - corner(0)), &(corner(2) - corner(0)))
    }

    /// Energy, ∂E/∂ε and ∂²E/∂ε² of a face.
    fn response(&self, face: usize, columns: &[Vec3; 2]) -> Response {
        let strain = green_strain(columns) - self.rest_strains[face];
        let response = self.section.stretch(face, &strain);
        response.scaled(self.frames[face].area)
    }

    fn gradient_from(
        &self,
        face: usize,
        columns: &[Vec3; 2],
        stress: &Vector3<f64>,
    ) -> SVector<f64, 9> {
        let by_column = [
            columns[0] * stress.x + columns[1] * (0.5 * stress.z),
            columns[1] * stress.y + columns[0] * (0.5 * stress.z),
        ];
        let mut gradient = SVector::<f64, 9>::zeros();
        for (corner, weights) in self.frames[face].corner_weights().iter().enumerate() {
            let g = by_column[0] * weights[0] + by_column[1] * weights[1];
            gradient.fixed_rows_mut::<3>(3 * corner).copy_from(&g);
        }
        gradient
    }

    fn derivatives(&self, face: usize, q: &SVector<f64, 9>, kept: f64) -> LocalHessian<9> {
        let columns = self.columns(face, q);
        let response = self.response(face, &columns);
        let by_columns = hessian_by_columns(&columns, &response.stress, &response.tangent, kept);
        LocalHessian {
            value: response.density,
            gradient: self.gradient_from(face, &columns, &response.stress),
            hessian: self.by_corners(face, &by_columns),
        }
    }

    /// Second derivatives by the corners from those by the stacked columns of F.
    fn by_corners(&self, face: usize, by_columns: &Matrix6<f64>) -> SMatrix<f64, 9, 9> {
        let weights = self.frames[face].corner_weights();
        let mut hessian = SMatrix::<f64, 9, 9>::zeros();
        for a in 0..3 {
            for b in 0..3 {
                let mut block = SMatrix::<f64, 3, 3>::zeros();
                for p in 0..2 {
                    for r in 0..2 {
                        block += by_columns.fixed_view::<3, 3>(3 * p, 3 * r)
                            * (weights[a][p] * weights[b][r]);
                    }
                }
                hessian
                    .fixed_view_mut::<3, 3>(3 * a, 3 * b)
                    .copy_from(&block);
            }
        }
        hessian
    }
}

fn green_strain(columns: &[Vec3; 2]) -> Vector3<f64> {
    let [f1, f2] = columns;
    Vector3::new(
        0.5 * (f1.norm_squared() - 1.0),
        0.5 * (f2.norm_squared() - 1.0),
        0.5 * f1.dot(f2),
    )
}

/// ∂²w/∂F² over the stacked columns of F: `Jᵀ C J + G ⊗ 1` with `G = [[s₁₁, s₁₂/2], [s₁₂/2, s₂₂]]`.
fn hessian_by_columns(
    [f1, f2]: &[Vec3; 2],
    stress: &Vector3<f64>,
    tangent: &nalgebra::Matrix3<f64>,
    kept: f64,
) -> Matrix6<f64> {
    let mut geometric = stress_matrix(stress);
    let zero = Vec3::zeros();
    let jacobian = [(*f1, zero), (zero, *f2), (f2 * 0.5, f1 * 0.5)]
        .map(|(a, b)| SVector::<f64, 6>::from_column_slice(&[a.x, a.y, a.z, b.x, b.y, b.z]));
    if kept == 1.0 {
        let mut h = geometric_part(&geometric, &nalgebra::Matrix3::identity());
        for (s, row) in jacobian.iter().enumerate() {
            for (t, column) in jacobian.iter().enumerate() {
                h += row * column.transpose() * tangent[(s, t)];
            }
        }
        return h;
    }
    // In the plane of the face, by an orthonormal basis of it; out of the plane J vanishes.
    let normal = f1.cross(f2).normalize();
    let t1 = f1.normalize();
    let basis = [t1, normal.cross(&t1)];
    let in_plane = |v: &SVector<f64, 6>| {
        nalgebra::Vector4::from_fn(|i, _| {
            basis[i % 2].dot(&v.fixed_rows::<3>(3 * (i / 2)).into_owned())
        })
    };
    let reduced = jacobian.map(|row| in_plane(&row));
    let mut plane = Matrix4::zeros();
    for p in 0..2 {
        for r in 0..2 {
            for axis in 0..2 {
                plane[(2 * p + axis, 2 * r + axis)] = geometric[(p, r)];
            }
        }
    }
    for (s, row) in reduced.iter().enumerate() {
        for (t, column) in reduced.iter().enumerate() {
            plane += row * column.transpose() * tangent[(s, t)];
        }
    }
    project_to_psd(&mut plane, kept);
    project_to_psd(&mut geometric, kept);
    let mut h = geometric_part(&geometric, &(normal * normal.transpose()));
    for i in 0..4 {
        for j in 0..4 {
            let mut block = h.fixed_view_mut::<3, 3>(3 * (i / 2), 3 * (j / 2));
            block += basis[i % 2] * basis[j % 2].transpose() * plane[(i, j)];
        }
    }
    h
}

/// G.
fn stress_matrix(stress: &Vector3<f64>) -> nalgebra::Matrix2<f64> {
    nalgebra::Matrix2::new(stress.x, 0.5 * stress.z, 0.5 * stress.z, stress.y)
}

fn geometric_part(
    stress: &nalgebra::Matrix2<f64>,
    directions: &nalgebra::Matrix3<f64>,
) -> Matrix6<f64> {
    let mut h = Matrix6::zeros();
    for p in 0..2 {
        for r in 0..2 {
            h.fixed_view_mut::<3, 3>(3 * p, 3 * r)
                .copy_from(&(directions * stress[(p, r)]));
        }
    }
    h
}

impl<S: Section> LocalEnergy<9, 3> for Membrane<S> {
    const NODE_SIZES: [usize; 3] = [3; 3];
    const MEASURES: usize = 3;

    fn name(&self) -> &'static str {
        "membrane"
    }

    fn num_stencils(&self) -> usize {
        self.faces.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 3] {
        self.faces[stencil].map(Some)
    }

    fn value(&self, stencil: usize, q: &SVector<f64, 9>) -> f64 {
        self.response(stencil, &self.columns(stencil, q)).density
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 9>) -> (f64, SVector<f64, 9>) {
        let columns = self.columns(stencil, q);
        let response = self.response(stencil, &columns);
        (
            response.density,
            self.gradient_from(stencil, &columns, &response.stress),
        )
    }

    fn hessian(&self, stencil: usize, q: &SVector<f64, 9>) -> LocalHessian<9> {
        self.derivatives(stencil, q, 1.0)
    }

    fn projected_hessian(&self, stencil: usize, q: &SVector<f64, 9>, kept: f64) -> LocalHessian<9> {
        self.derivatives(stencil, q, kept)
    }

    fn is_admissible(&self, stencil: usize, q: &SVector<f64, 9>) -> bool {
        let strain = green_strain(&self.columns(stencil, q)) - self.rest_strains[stencil];
        self.section.is_admissible(stencil, &strain)
    }

    fn measure(&self, stencil: usize, q: &SVector<f64, 9>, measures: &mut [f64]) {
        measures.copy_from_slice(green_strain(&self.columns(stencil, q)).as_slice());
    }

    fn rest(&self, stencil: usize, measures: &mut [f64]) {
        measures.copy_from_slice(self.rest_strains[stencil].as_slice());
    }

    fn set_rest(&mut self, stencil: usize, measures: &[f64]) {
        self.rest_strains[stencil] = Vector3::from_column_slice(measures);
    }

    fn stress_stiffness(
        &self,
        stencil: usize,
        q: &SVector<f64, 9>,
        motion: &SVector<f64, 9>,
    ) -> Option<SMatrix<f64, 9, 9>> {
        // F is linear in the corners.
        let ([f1, f2], [d1, d2]) = (self.columns(stencil, q), self.columns(stencil, motion));
        let strain = Vector3::new(f1.dot(&d1), f2.dot(&d2), 0.5 * (f1.dot(&d2) + f2.dot(&d1)));
        let stress = self.response(stencil, &[f1, f2]).tangent * strain;
        let by_columns = geometric_part(&stress_matrix(&stress), &nalgebra::Matrix3::identity());
        Some(self.by_corners(stencil, &by_columns))
    }

    fn describe(&self, stencil: usize) -> String {
        format!("face {stencil}")
    }
}

/// The formula over any numbers: the oracle of the tests.
impl<S> Membrane<S> {
    /// E of one face whose section has the density `density(ε)` [J/m²].
    pub fn formula<R: Real>(&self, face: usize, q: &[R; 9], density: impl Fn([R; 3]) -> R) -> R {
        let [m11, m12, m22] = self.frames[face].inverse;
        let edge = |c: usize, axis: usize| q[3 * c + axis] - q[axis];
        let f1: [R; 3] = std::array::from_fn(|k| edge(1, k) * m11);
        let f2: [R; 3] = std::array::from_fn(|k| edge(1, k) * m12 + edge(2, k) * m22);
        let rest = &self.rest_strains[face];
        let strain = [
            (dot(&f1, &f1) - 1.0) * 0.5 - rest.x,
            (dot(&f2, &f2) - 1.0) * 0.5 - rest.y,
            dot(&f1, &f2) * 0.5 - rest.z,
        ];
        density(strain) * self.frames[face].area
    }
}
