//! Discrete Kirchhoff triangle (DKT): unit directors at the vertices.
//!
//! ```text
//! E = Σ_faces [ Ā/3 Σ_n W(κ_n) + ½ K Σ_c (|d_c| − 1)² ],    κ_n = D⁻ᵀ II(s_n, t_n) D⁻¹ − b̄_n,    n = 1 … 3
//! ```
//!
//! Ā rest area [m²], W energy of bending per unit area of the [`Section`] [J/m²], D rest edges ([`RestFrame`]), II the
//! second fundamental form of [`super::kirchhoff_form`], b̄_n its rest value at the sample [1/m], d_c director of corner c.
//! Reference: "Better Bending" (2026), Eqs. (25) to (29), after Batoz, Bathe and Ho (1980). Converges on every mesh and
//! is accurate on coarse ones; its energy is not convex in the directors, and sharp folds have several minima.
//!
//! II depends on d/|d| only. So a director is three plain numbers, a straight step from a unit director is one of the
//! sphere with the usual retraction, and the Hessian within the tangent plane is that of the sphere; nothing else has to
//! know what a director is. The last term, with K [J] the flexural rigidity, holds the length at 1, where it vanishes: it
//! changes no equilibrium (`docs/decisions/0008`).
//!
//! The Hessian is `Jᵀ Q J + Σ σ_k ∂²y_k` over the nine numbers y. To project it, motions that shift the face or lengthen
//! directors are left out: twelve dimensions remain of eighteen.

use nalgebra::{Matrix3, Matrix3x2, SMatrix, SVector, Vector3};

use super::held_kirchhoff::HeldKirchhoff;
use super::kirchhoff_form::{BlockMatrix, ByVectors, FormMatrices, Kinematics, VECTORS};
use crate::Vec3;
use crate::assembly::{
    Assembled, Dof, DofLayout, Energy, LocalEnergy, LocalHessian, parallel_map, project_to_psd,
};
use crate::geometry::Real;
use crate::geometry::over_numbers::{cross, dot, norm, point, sub};
use crate::material::Section;
use crate::mesh::{Surface, TriMesh};
use crate::rest::RestFrame;

/// A director this short has lost its direction.
pub(super) const SHORTEST_DIRECTOR: f64 = 0.1;

/// DKT bending energy of one shell.
pub struct DiscreteKirchhoff<S> {
    /// The corners, then their directors.
    faces: Vec<[Dof; 6]>,
    frames: Vec<RestFrame>,
    rest_forms: Vec<[Vector3<f64>; 3]>,
    section: S,
    /// K of every face.
    length_stiffness: Vec<f64>,
    matrices: FormMatrices,
}

/// What the section answers to the nine numbers y of a face.
pub(super) struct Answer {
    pub(super) value: f64,
    /// ∂E/∂y.
    pub(super) moments: SVector<f64, 9>,
    /// ∂²E/∂y².
    pub(super) tangent: SMatrix<f64, 9, 9>,
}

impl<S: Section> DiscreteKirchhoff<S> {
    /// For vertices and directors of three unknowns each, from `first_vertex` and `first_director` on. `rest_forms` are
    /// b̄ at the three samples of every face, in its frame, components `11, 22, 12` [1/m].
    pub fn new(
        mesh: &TriMesh,
        first_vertex: Dof,
        first_director: Dof,
        frames: Vec<RestFrame>,
        rest_forms: Vec<[Vector3<f64>; 3]>,
        section: S,
    ) -> Self {
        let nodes = |face: &[u32; 3]| {
            let [x, d] = [first_vertex, first_director].map(|first| face.map(|v| first.0 + 3 * v));
            [x[0], x[1], x[2], d[0], d[1], d[2]].map(Dof)
        };
        Self {
            faces: mesh.faces().iter().map(nodes).collect(),
            length_stiffness: (0..mesh.num_faces())
                .map(|face| section.flexural_rigidity(face))
                .collect(),
            frames,
            rest_forms,
            section,
            matrices: FormMatrices::new(),
        }
    }

    /// Replaces b̄ of every face.
    pub fn set_rest_forms(&mut self, rest_forms: Vec<[Vector3<f64>; 3]>) {
        self.rest_forms = rest_forms;
    }

    /// The second fundamental forms at the three samples in the rest frame, components `11, 22, 12` [1/m].
    pub fn second_forms(&self, face: usize, q: &SVector<f64, 18>) -> [Vector3<f64>; 3] {
        let y = kinematics(q).y;
        let matrices = self.matrices.in_frame(&self.frames[face]);
        matrices.map(|matrix| matrix * y)
    }

    /// Of the face's numbers y and the lengths of its directors.
    pub(super) fn answer(&self, face: usize, y: &SVector<f64, 9>, lengths: &[f64; 3]) -> Answer {
        let weight = self.frames[face].area / 3.0;
        let mut answer = Answer {
            value: 0.0,
            moments: SVector::zeros(),
            tangent: SMatrix::zeros(),
        };
        let matrices = self.matrices.in_frame(&self.frames[face]);
        for (matrix, rest) in matrices.iter().zip(&self.rest_forms[face]) {
            let response = self.section.bend(face, &(matrix * y - rest)).scaled(weight);
            answer.value += response.density;
            answer.moments += matrix.tr_mul(&response.stress);
            answer.tangent += matrix.tr_mul(&(response.tangent * matrix));
        }
        for length in lengths {
            answer.value += 0.5 * self.length_stiffness[face] * (length - 1.0).powi(2);
        }
        answer
    }

    fn gradient_from(
        &self,
        face: usize,
        at: &Kinematics,
        by_vectors: &ByVectors,
    ) -> SVector<f64, 18> {
        let mut gradient = SVector::<f64, 18>::zeros();
        let mut add = |node: usize, v: Vec3| {
            let mut part = gradient.fixed_rows_mut::<3>(3 * node);
            part += v;
        };
        add(0, -by_vectors[0] - by_vectors[1]);
        add(1, by_vectors[0]);
        add(2, by_vectors[1]);
        for c in 0..3 {
            add(
                3 + c,
                self.director_gradient(face, &at.units[c], at.lengths[c], &by_vectors[2 + c]),
            );
        }
        gradient
    }

    /// By a director, from the derivative `w` by its unit vector.
    pub(super) fn director_gradient(
        &self,
        face: usize,
        unit: &Vec3,
        length: f64,
        w: &Vec3,
    ) -> Vec3 {
        let turning = w - unit * unit.dot(w);
        turning / length + unit * (self.length_stiffness[face] * (length - 1.0))
    }

    fn derivatives(&self, face: usize, q: &SVector<f64, 18>, kept: f64) -> LocalHessian<18> {
        let at = kinematics(q);
        let Answer {
            value,
            moments,
            tangent,
        } = self.answer(face, &at.y, &at.lengths);
        let slopes = at.slopes();
        let jacobian =
            SMatrix::<f64, 9, 15>::from_fn(|k, column| slopes[k][column / 3][column % 3]);
        let mut by_vectors: BlockMatrix = jacobian.tr_mul(&(tangent * jacobian));
        at.add_curvature(&moments, &mut by_vectors);
        let slope = weighted_sum(&slopes, &moments);
        let exact = self.exact_hessian(face, &at, &by_vectors, &slope);
        let hessian = if kept == 1.0 {
            exact
        } else {
            let clamped = self.clamped_hessian(face, &at, &by_vectors, &slope);
            clamped + (exact - clamped) * kept
        };
        LocalHessian {
            value,
            gradient: self.gradient_from(face, &at, &slope),
            hessian,
        }
    }

    /// With `d/|d|` for the directors: `P B P` and `w·∂²(d/|d|)`, w the derivative by the unit director.
    fn exact_hessian(
        &self,
        face: usize,
        at: &Kinematics,
        by_vectors: &BlockMatrix,
        slope: &ByVectors,
    ) -> SMatrix<f64, 18, 18> {
        let one = Matrix3::identity();
        let mut maps = [one; VECTORS];
        for c in 0..3 {
            maps[2 + c] = (one - at.units[c] * at.units[c].transpose()) / at.lengths[c];
        }
        let mut hessian = by_nodes(|u, v| maps[u].transpose() * block(by_vectors, u, v) * maps[v]);
        for c in 0..3 {
            let mut part = hessian.fixed_view_mut::<3, 3>(9 + 3 * c, 9 + 3 * c);
            part += self.director_curvature(face, &at.units[c], at.lengths[c], &slope[2 + c]);
        }
        hessian
    }

    /// `w·∂²(d/|d|)`, and the second derivative of what holds the length.
    pub(super) fn director_curvature(
        &self,
        face: usize,
        unit: &Vec3,
        length: f64,
        w: &Vec3,
    ) -> Matrix3<f64> {
        let one = Matrix3::identity();
        let along = unit.dot(w);
        let squared = unit * unit.transpose();
        let bending = (w * unit.transpose() + unit * w.transpose() + one * along
            - squared * (3.0 * along))
            / -length.powi(2);
        let holding = squared + (one - squared) * (1.0 - 1.0 / length);
        bending + holding * self.length_stiffness[face]
    }

    /// Positive semidefinite: directors turn within their tangent planes, in two dimensions each.
    fn clamped_hessian(
        &self,
        face: usize,
        at: &Kinematics,
        by_vectors: &BlockMatrix,
        slope: &ByVectors,
    ) -> SMatrix<f64, 18, 18> {
        let planes = at.units.map(|unit| tangent_plane(&unit));
        let mut to_vectors = SMatrix::<f64, 15, 12>::zeros();
        for i in 0..6 {
            to_vectors[(i, i)] = 1.0;
        }
        for c in 0..3 {
            let mut part = to_vectors.fixed_view_mut::<3, 2>(6 + 3 * c, 6 + 2 * c);
            part.copy_from(&planes[c]);
        }
        let mut reduced: SMatrix<f64, 12, 12> = to_vectors.tr_mul(&(by_vectors * to_vectors));
        for c in 0..3 {
            let along = at.units[c].dot(&slope[2 + c]);
            for i in 0..2 {
                reduced[(6 + 2 * c + i, 6 + 2 * c + i)] -= along;
            }
        }
        project_to_psd(&mut reduced, 0.0);
        let projected: BlockMatrix = to_vectors * reduced * to_vectors.transpose();
        let scale = |u: usize| if u < 2 { 1.0 } else { 1.0 / at.lengths[u - 2] };
        let mut hessian = by_nodes(|u, v| block(&projected, u, v) * (scale(u) * scale(v)));
        for c in 0..3 {
            let mut part = hessian.fixed_view_mut::<3, 3>(9 + 3 * c, 9 + 3 * c);
            part += self.clamped_holding(face, &at.units[c], at.lengths[c]);
        }
        hessian
    }

    /// The second derivative of what holds the length, without its negative part.
    pub(super) fn clamped_holding(&self, face: usize, unit: &Vec3, length: f64) -> Matrix3<f64> {
        let squared = unit * unit.transpose();
        let turning = (1.0 - 1.0 / length).max(0.0);
        (squared + (Matrix3::identity() - squared) * turning) * self.length_stiffness[face]
    }

    /// The directors of a face.
    pub(super) fn directors(&self, face: usize) -> [Dof; 3] {
        let [.., i, j, k] = self.faces[face];
        [i, j, k]
    }

    /// E of one face over any numbers, whose section has the density `density(κ)` [J/m²]: the oracle of the tests.
    pub fn formula<R: Real>(&self, face: usize, q: &[R; 18], density: impl Fn([R; 3]) -> R) -> R {
        let sum = |u: [R; 3], v: [R; 3]| [u[0] + v[0], u[1] + v[1], u[2] + v[2]];
        let times = |u: [R; 3], k: R| u.map(|x| x * k);
        let one = R::from(1.0);
        let lengths = [3, 4, 5].map(|i| norm(&point(q, i)));
        let d: [[R; 3]; 3] = std::array::from_fn(|c| times(point(q, 3 + c), one / lengths[c]));
        let edge = |from: usize, to: usize| sub(&point(q, to), &point(q, from));
        let middle = |u: usize, v: usize| {
            let along = edge(u, v);
            let across = cross(&along, &cross(&edge(0, 1), &edge(0, 2)));
            let ends = sum(d[u], d[v]);
            let part = |w: [R; 3], factor: f64| times(w, dot(&w, &ends) / dot(&w, &w) * factor);
            sum(part(across, 0.5), part(along, -0.25))
        };
        let p = [d[0], d[1], d[2], middle(1, 2), middle(2, 0), middle(0, 1)];
        let [m11, m12, m22] = self.frames[face].inverse;
        let mut energy = R::from(0.0);
        for (n, [s, t]) in [[1.0, 1.0], [4.0, 1.0], [1.0, 4.0]].into_iter().enumerate() {
            let (s, t) = (s / 6.0, t / 6.0);
            let [by_s, by_t] = shape_slopes(s, t);
            let zero = [R::from(0.0); 3];
            let along_s = (0..6).fold(zero, |v, n| sum(v, p[n].map(|x| x * by_s[n])));
            let along_t = (0..6).fold(zero, |v, n| sum(v, p[n].map(|x| x * by_t[n])));
            let a = dot(&along_s, &edge(0, 1));
            let b = (dot(&along_t, &edge(0, 1)) + dot(&along_s, &edge(0, 2))) * 0.5;
            let c = dot(&along_t, &edge(0, 2));
            let rest = self.rest_forms[face][n];
            let change = [
                a * (m11 * m11) - rest.x,
                a * (m12 * m12) + b * (2.0 * m12 * m22) + c * (m22 * m22) - rest.y,
                a * (m11 * m12) + b * (m11 * m22) - rest.z,
            ];
            energy = energy + density(change) * (self.frames[face].area / 3.0);
        }
        for length in lengths {
            let excess = length - 1.0;
            energy = energy + excess * excess * (0.5 * self.length_stiffness[face]);
        }
        energy
    }
}

/// Derivatives by s and t of the quadratic shape functions of the corners and of the middles of edges `jk`, `ki`, `ij`.
fn shape_slopes(s: f64, t: f64) -> [[f64; 6]; 2] {
    let corner = 4.0 * (s + t) - 3.0;
    [
        [
            corner,
            4.0 * s - 1.0,
            0.0,
            4.0 * t,
            -4.0 * t,
            4.0 - 8.0 * s - 4.0 * t,
        ],
        [
            corner,
            0.0,
            4.0 * t - 1.0,
            4.0 * s,
            4.0 - 4.0 * s - 8.0 * t,
            -4.0 * s,
        ],
    ]
}

/// Area-weighted unit normals of the vertices: where the search for directors starts.
pub fn vertex_normals(surface: &Surface) -> Vec<Vec3> {
    let mut sums = vec![Vec3::zeros(); surface.positions.len()];
    for (face, corners) in surface.mesh.faces().iter().enumerate() {
        let [a, b, c] = surface.corners(face);
        let normal = (b - a).cross(&(c - a));
        for v in corners {
            sums[*v as usize] += normal;
        }
    }
    // Normals that cancel, as at the tip of a closed fold, leave any direction.
    let unit = |sum: Vec3| sum.try_normalize(0.0).unwrap_or(Vec3::z());
    sums.into_iter().map(unit).collect()
}

pub(super) fn kinematics(q: &SVector<f64, 18>) -> Kinematics {
    let point = |i: usize| Vec3::new(q[3 * i], q[3 * i + 1], q[3 * i + 2]);
    let corners: [Vec3; 3] = std::array::from_fn(point);
    let directors: [Vec3; 3] = std::array::from_fn(|c| point(3 + c));
    Kinematics::new(&corners, &directors)
}

/// ∂E by e₁, e₂ and the unit directors.
fn weighted_sum(slopes: &[ByVectors; 9], moments: &SVector<f64, 9>) -> ByVectors {
    let mut sum = [Vec3::zeros(); VECTORS];
    for (slope, moment) in slopes.iter().zip(moments.iter()) {
        for (total, part) in sum.iter_mut().zip(slope) {
            *total += part * *moment;
        }
    }
    sum
}

fn block(matrix: &BlockMatrix, u: usize, v: usize) -> Matrix3<f64> {
    matrix.fixed_view::<3, 3>(3 * u, 3 * v).into_owned()
}

/// From blocks over e₁, e₂ and the directors to those over the nodes: `e₁ = x_j − x_i`, `e₂ = x_k − x_i`.
fn by_nodes(entry: impl Fn(usize, usize) -> Matrix3<f64>) -> SMatrix<f64, 18, 18> {
    let mut hessian = SMatrix::<f64, 18, 18>::zeros();
    for u in 0..VECTORS {
        for v in 0..VECTORS {
            let block = entry(u, v);
            let mut add = |row: usize, column: usize, sign: f64| {
                let mut part = hessian.fixed_view_mut::<3, 3>(3 * row, 3 * column);
                part += block * sign;
            };
            add(u + 1, v + 1, 1.0);
            if u < 2 {
                add(0, v + 1, -1.0);
            }
            if v < 2 {
                add(u + 1, 0, -1.0);
            }
            if u < 2 && v < 2 {
                add(0, 0, 1.0);
            }
        }
    }
    hessian
}

/// Two orthonormal vectors orthogonal to a unit vector.
pub(super) fn tangent_plane(unit: &Vec3) -> Matrix3x2<f64> {
    let least = Vec3::ith(unit.iamin(), 1.0);
    let first = unit.cross(&least).normalize();
    Matrix3x2::from_columns(&[first, unit.cross(&first)])
}

impl<S: Section> LocalEnergy<18, 6> for DiscreteKirchhoff<S> {
    const NODE_SIZES: [usize; 6] = [3; 6];
    const MEASURES: usize = 9;

    fn name(&self) -> &'static str {
        "bending"
    }

    fn num_stencils(&self) -> usize {
        self.faces.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 6] {
        self.faces[stencil].map(Some)
    }

    fn value(&self, stencil: usize, q: &SVector<f64, 18>) -> f64 {
        let at = kinematics(q);
        self.answer(stencil, &at.y, &at.lengths).value
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 18>) -> (f64, SVector<f64, 18>) {
        let at = kinematics(q);
        let answer = self.answer(stencil, &at.y, &at.lengths);
        let slope = weighted_sum(&at.slopes(), &answer.moments);
        (answer.value, self.gradient_from(stencil, &at, &slope))
    }

    fn hessian(&self, stencil: usize, q: &SVector<f64, 18>) -> LocalHessian<18> {
        self.derivatives(stencil, q, 1.0)
    }

    fn projected_hessian(
        &self,
        stencil: usize,
        q: &SVector<f64, 18>,
        kept: f64,
    ) -> LocalHessian<18> {
        self.derivatives(stencil, q, kept)
    }

    fn is_admissible(&self, _stencil: usize, q: &SVector<f64, 18>) -> bool {
        (3..6).all(|i| q.fixed_rows::<3>(3 * i).norm() > SHORTEST_DIRECTOR)
    }

    fn measure(&self, stencil: usize, q: &SVector<f64, 18>, measures: &mut [f64]) {
        for (part, form) in measures
            .chunks_exact_mut(3)
            .zip(self.second_forms(stencil, q))
        {
            part.copy_from_slice(form.as_slice());
        }
    }

    fn rest(&self, stencil: usize, measures: &mut [f64]) {
        for (part, form) in measures.chunks_exact_mut(3).zip(&self.rest_forms[stencil]) {
            part.copy_from_slice(form.as_slice());
        }
    }

    fn set_rest(&mut self, stencil: usize, measures: &[f64]) {
        let forms =
            std::array::from_fn(|n| Vector3::from_column_slice(&measures[3 * n..3 * n + 3]));
        self.rest_forms[stencil] = forms;
    }

    fn describe(&self, stencil: usize) -> String {
        format!("face {stencil}")
    }

    fn at_held_positions<'a>(
        &'a self,
        unknowns: &(dyn Fn(usize) -> SVector<f64, 18> + Sync),
        layout: &DofLayout,
    ) -> Option<Box<dyn Energy + 'a>> {
        let by_directors = parallel_map(self.faces.len(), |face| {
            let slopes = kinematics(&unknowns(face)).slopes();
            SMatrix::from_fn(|k, column| slopes[k][2 + column / 3][column % 3])
        });
        let held = HeldKirchhoff::new(self, by_directors);
        Some(Box::new(Assembled::new(held, layout)))
    }
}
