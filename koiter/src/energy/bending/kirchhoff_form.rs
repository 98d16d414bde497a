//! The second fundamental form of the discrete Kirchhoff triangle, and its derivatives.
//!
//! ```text
//! II(s, t) = Σ_n [[∂_s b_n e₁·p_n, sym], [½ (∂_t b_n e₁·p_n + ∂_s b_n e₂·p_n), ∂_t b_n e₂·p_n]],    n = 1 … 6
//! p_jk = ½ t t·D − ¼ ê ê·D,    D = d_j + d_k
//! ```
//!
//! e₁ = x_j − x_i, e₂ = x_k − x_i edges [m], b_n the quadratic basis functions, p_n = d_i, d_j, d_k at the corners and, at
//! the middle of an edge along ê with in-plane normal t, what Kirchhoff's condition makes of the directors D at its ends.
//! Reference: "Better Bending" (2026), Eqs. (25) to (27), where the sum is printed from n = 0.
//!
//! Only e_a·p_n is needed, and e_a lies in the plane that ê and t span, so t drops out:
//! `e_a·p_jk = ½ e_a·D − ¾ (e_a·ê)(ê·D)`. All entries of II at every point are therefore sums, with constant weights, of
//! nine numbers y:
//!
//! ```text
//! m_ca = d_c · e_a  (six),    z = (e·e') (e·D) / e·e  (one an edge: e the edge, e' another one)
//! ```
//!
//! A director enters as d/|d|: its length is a coordinate without meaning.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::quadratic_basis::{SAMPLES, slopes};
use crate::Vec3;
use crate::rest::RestFrame;

/// The edge of a `z`: its weights in e₁, e₂; which of e₁, e₂ is e'; the directors at its ends.
struct EdgeTerm {
    edge: [f64; 2],
    other: usize,
    ends: [usize; 2],
}

/// The edges jk, ki, ij.
const EDGES: [EdgeTerm; 3] = [
    EdgeTerm {
        edge: [-1.0, 1.0],
        other: 0,
        ends: [1, 2],
    },
    EdgeTerm {
        edge: [0.0, 1.0],
        other: 0,
        ends: [2, 0],
    },
    EdgeTerm {
        edge: [1.0, 0.0],
        other: 1,
        ends: [0, 1],
    },
];

/// Number of the vectors a form depends on: e₁, e₂ and three unit directors.
pub(super) const VECTORS: usize = 5;

/// One vector for each of e₁, e₂, d_i, d_j, d_k: a derivative by them.
pub(super) type ByVectors = [Vec3; VECTORS];

/// A symmetric matrix of 3 × 3 blocks over e₁, e₂, d_i, d_j, d_k.
pub(super) type BlockMatrix = SMatrix<f64, 15, 15>;

/// The nine numbers y with what their derivatives need.
pub(super) struct Kinematics {
    edges: [Vec3; 2],
    pub(super) units: [Vec3; 3],
    pub(super) lengths: [f64; 3],
    /// m_i1, m_i2, m_j1, m_j2, m_k1, m_k2, z_jk, z_ki, z_ij.
    pub(super) y: SVector<f64, 9>,
}

impl Kinematics {
    /// From the corners and their directors, which need not have unit length.
    pub(super) fn new(corners: &[Vec3; 3], directors: &[Vec3; 3]) -> Self {
        let edges = [corners[1] - corners[0], corners[2] - corners[0]];
        let lengths = directors.map(|d| d.norm());
        let units: [Vec3; 3] = std::array::from_fn(|c| directors[c] / lengths[c]);
        let mut y = SVector::zeros();
        for c in 0..3 {
            for a in 0..2 {
                y[2 * c + a] = units[c].dot(&edges[a]);
            }
        }
        for (k, term) in EDGES.iter().enumerate() {
            let Projection { edge, other, sum } = Projection::new(term, &edges, &units);
            y[6 + k] = edge.dot(&other) * edge.dot(&sum) / edge.norm_squared();
        }
        Self {
            edges,
            units,
            lengths,
            y,
        }
    }

    /// ∂y.
    pub(super) fn slopes(&self) -> [ByVectors; 9] {
        let mut slopes = [[Vec3::zeros(); VECTORS]; 9];
        for c in 0..3 {
            for a in 0..2 {
                slopes[2 * c + a][a] = self.units[c];
                slopes[2 * c + a][2 + c] = self.edges[a];
            }
        }
        for (k, term) in EDGES.iter().enumerate() {
            let slope = Projection::new(term, &self.edges, &self.units).slope();
            for (p, part) in slope.iter().enumerate() {
                for (vector, weight) in term.places(p) {
                    slopes[6 + k][vector] += part * weight;
                }
            }
        }
        slopes
    }

    /// Adds `Σ_k moments_k ∂²y_k`.
    pub(super) fn add_curvature(&self, moments: &SVector<f64, 9>, matrix: &mut BlockMatrix) {
        let mut add = |row: usize, column: usize, block: &Matrix3<f64>| {
            let mut view = matrix.fixed_view_mut::<3, 3>(3 * row, 3 * column);
            view += block;
        };
        for c in 0..3 {
            for a in 0..2 {
                let block = Matrix3::from_diagonal_element(moments[2 * c + a]);
                add(a, 2 + c, &block);
                add(2 + c, a, &block);
            }
        }
        for (k, term) in EDGES.iter().enumerate() {
            let blocks = Projection::new(term, &self.edges, &self.units).curvature(moments[6 + k]);
            for (p, row) in blocks.iter().enumerate() {
                for (r, block) in row.iter().enumerate() {
                    for (u, weight_u) in term.places(p) {
                        for (v, weight_v) in term.places(r) {
                            add(u, v, &(block * (weight_u * weight_v)));
                        }
                    }
                }
            }
        }
    }
}

impl EdgeTerm {
    /// Vectors, with weights, whose sum is the edge (0), e' (1) or D (2).
    fn places(&self, part: usize) -> [(usize, f64); 2] {
        match part {
            0 => [(0, self.edge[0]), (1, self.edge[1])],
            1 => [(self.other, 1.0), (1 - self.other, 0.0)],
            _ => [(2 + self.ends[0], 1.0), (2 + self.ends[1], 1.0)],
        }
    }
}

/// The arguments of `z = (e·e') (e·D) / e·e`.
struct Projection {
    edge: Vec3,
    other: Vec3,
    sum: Vec3,
}

impl Projection {
    fn new(term: &EdgeTerm, edges: &[Vec3; 2], units: &[Vec3; 3]) -> Self {
        Self {
            edge: edges[0] * term.edge[0] + edges[1] * term.edge[1],
            other: edges[term.other],
            sum: units[term.ends[0]] + units[term.ends[1]],
        }
    }

    /// `e·e' / e·e`, `e·D / e·e` and `1 / e·e`.
    fn ratios(&self) -> [f64; 3] {
        let inverse = 1.0 / self.edge.norm_squared();
        [
            self.edge.dot(&self.other) * inverse,
            self.edge.dot(&self.sum) * inverse,
            inverse,
        ]
    }

    /// ∂z by e, e', D.
    fn slope(&self) -> [Vec3; 3] {
        let [along, tilt, _] = self.ratios();
        [
            self.other * tilt + self.sum * along - self.edge * (2.0 * along * tilt),
            self.edge * tilt,
            self.edge * along,
        ]
    }

    /// `k ∂²z` by e, e', D.
    fn curvature(&self, k: f64) -> [[Matrix3<f64>; 3]; 3] {
        let [along, tilt, inverse] = self.ratios();
        let (e, other, sum) = (&self.edge, &self.other, &self.sum);
        let one = Matrix3::identity();
        let symmetric = |u: &Vec3, v: &Vec3| u * v.transpose() + v * u.transpose();
        let by_edge = symmetric(other, sum) * inverse
            - symmetric(e, &(other * tilt + sum * along)) * (2.0 * inverse)
            + (e * e.transpose() * (4.0 * inverse) - one) * (2.0 * along * tilt);
        let by_other_edge =
            one * tilt + e * (sum * inverse - e * (2.0 * tilt * inverse)).transpose();
        let by_sum_edge =
            one * along + e * (other * inverse - e * (2.0 * along * inverse)).transpose();
        let by_other_sum = e * e.transpose() * (k * inverse);
        let zero = Matrix3::zeros();
        [
            [
                by_edge * k,
                by_other_edge.transpose() * k,
                by_sum_edge.transpose() * k,
            ],
            [by_other_edge * k, zero, by_other_sum],
            [by_sum_edge * k, by_other_sum, zero],
        ]
    }
}

/// The matrices that take y to the components `11, 22, 12` of II at the samples, in the basis of the edges.
#[derive(Clone, Copy)]
pub(super) struct FormMatrices([SMatrix<f64, 3, 9>; 3]);

impl FormMatrices {
    pub(super) fn new() -> Self {
        Self(SAMPLES.map(edge_form_matrix))
    }

    /// Those that take y to `D⁻ᵀ II D⁻¹`.
    pub(super) fn in_frame(&self, frame: &RestFrame) -> [SMatrix<f64, 3, 9>; 3] {
        let [m11, m12, m22] = frame.inverse;
        let to_frame = Matrix3::new(
            m11 * m11,
            0.0,
            0.0,
            m12 * m12,
            m22 * m22,
            2.0 * m12 * m22,
            m11 * m12,
            0.0,
            m11 * m22,
        );
        self.0.map(|matrix| to_frame * matrix)
    }
}

/// The matrix that takes y to the components `11, 22, 12` of II, in the basis of the edges, at a point.
fn edge_form_matrix(point: [f64; 2]) -> SMatrix<f64, 3, 9> {
    let mut matrix = SMatrix::zeros();
    for (node, [by_s, by_t]) in slopes(point).into_iter().enumerate() {
        let [by_1, by_2] = products(node);
        let rows = [by_1 * by_s, by_2 * by_t, (by_1 * by_t + by_2 * by_s) * 0.5];
        for (row, values) in rows.iter().enumerate() {
            for (column, value) in values.iter().enumerate() {
                matrix[(row, column)] += value;
            }
        }
    }
    matrix
}

/// `e₁·p_n` and `e₂·p_n` as weights of y.
fn products(node: usize) -> [SVector<f64, 9>; 2] {
    let mut weights = [SVector::zeros(); 2];
    if node < 3 {
        for a in 0..2 {
            weights[a][2 * node + a] = 1.0;
        }
        return weights;
    }
    // The projection of e' on the edge is z / (e·D), that of the edge itself 1; the third side is their sum or difference.
    let term = &EDGES[node - 3];
    let mut along_edge = SVector::<f64, 9>::zeros();
    for end in term.ends {
        for a in 0..2 {
            weights[a][2 * end + a] = 0.5;
            along_edge[2 * end + a] += term.edge[a];
        }
    }
    let mut along_other = SVector::<f64, 9>::zeros();
    along_other[6 + node - 3] = 1.0;
    let third = 1 - term.other;
    weights[term.other] -= along_other * 0.75;
    // e = w₁ e₁ + w₂ e₂, so the vector that is not e' is (e − w e') / w'.
    let rest = (along_edge - along_other * term.edge[term.other]) / term.edge[third];
    weights[third] -= rest * 0.75;
    weights
}

/// The second fundamental forms of a face at its three samples, in its rest frame, components `11, 22, 12` [1/m].
pub fn kirchhoff_forms(
    frame: &RestFrame,
    corners: &[Vec3; 3],
    directors: &[Vec3; 3],
) -> [Vector3<f64>; 3] {
    let y = Kinematics::new(corners, directors).y;
    FormMatrices::new().in_frame(frame).map(|matrix| matrix * y)
}
