//! A limit of stretch: an isotropic barrier on the singular values of the deformation gradient.
//!
//! ```text
//! E = κ Ā h Σ_i b((s − σ_i) / (s − ŝ)),    b(r) = −(r − 1)² ln r   for r < 1, else 0
//! ```
//!
//! σ₁ ≥ σ₂ singular values of F (3 × 2, see [`super::Membrane`]): the largest and the smallest stretch of any line in the
//! face; s the stretch that is never reached, ŝ ≥ 1 the stretch at which the barrier begins, κ its stiffness [Pa], Ā rest
//! area [m²], h thickness [m], b of [`log_barrier`]. Up to ŝ the material is what it is; compression is not limited.
//! Reference: the isotropic strain limit of "Codimensional IPC" (2021), scaled to a range of 1.
//!
//! With F = Σ_i σ_i u_i v_iᵀ, n = u₁ × u₂ and E_i = ∂E/∂σ_i the Hessian by F has the eigenmatrices
//!
//! ```text
//! u_i v_iᵀ                      E_ii
//! (u₁ v₂ᵀ + u₂ v₁ᵀ) / √2        (E₁ − E₂) / (σ₁ − σ₂)
//! (u₁ v₂ᵀ − u₂ v₁ᵀ) / √2        (E₁ + E₂) / (σ₁ + σ₂)
//! n v_iᵀ                        E_i / σ_i
//! ```
//!
//! E is convex and grows with σ, so none of them is negative: E is convex in F and its Hessian needs no projection. Where
//! σ₁ = σ₂ the quotient of differences is the second derivative ([`log_barrier_slope_quotient`]), and the choice of v_i
//! does not matter. σ₁ is convex in F too: on a line to an admissible end every point is admissible, so collision of a face
//! with its limit is one root.

use nalgebra::{Matrix6, SMatrix, SVector};

use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian};
use crate::geometry::over_numbers::dot;
use crate::geometry::{Real, log_barrier, log_barrier_slope_quotient};
use crate::mesh::TriMesh;
use crate::rest::RestFrame;

/// How far a material may be stretched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StretchLimit {
    /// s: length over rest length that is never reached; larger than `begin`.
    pub stretch: f64,
    /// ŝ: length over rest length at which the barrier begins; at least 1.
    pub begin: f64,
    /// κ [Pa].
    pub stiffness: f64,
}

impl StretchLimit {
    /// What is left of the range at a stretch: 1 or more below the barrier, 0 at the limit.
    fn ratio(&self, stretch: f64) -> f64 {
        (self.stretch - stretch) / (self.stretch - self.begin)
    }
}

/// The barriers of all faces of one shell.
pub struct StrainLimit {
    faces: Vec<[Dof; 3]>,
    frames: Vec<RestFrame>,
    limit: StretchLimit,
    /// κ Ā h [J].
    weights: Vec<f64>,
}

/// One step takes at most this share of what is left to the limit, so that the barrier can answer before it is reached.
const LARGEST_SHARE: f64 = 0.9;

/// Newton's method for the root ends within this share of what is left; LARGEST_SHARE and it stay below 1.
const ROOT_TOLERANCE: f64 = 0.01;

/// Newton's method on a convex function doubles its digits; the bound by the chord is taken if that takes longer.
const MAX_ROOT_ITERATIONS: usize = 30;

/// Below this σ₂ / σ₁ the normal of a face has lost six digits.
const COLLAPSED: f64 = 1e-10;

impl StrainLimit {
    /// `first_vertex` is the first unknown of the shell's vertex 0; `volumes` are rest areas times thicknesses [m³].
    pub fn new(
        mesh: &TriMesh,
        first_vertex: Dof,
        frames: Vec<RestFrame>,
        limit: StretchLimit,
        volumes: &[f64],
    ) -> Self {
        let vertex = |v: u32| Dof(first_vertex.0 + 3 * v);
        let faces = mesh.faces().iter().map(|f| f.map(vertex)).collect();
        let weights = volumes.iter().map(|volume| limit.stiffness * volume);
        Self {
            faces,
            frames,
            limit,
            weights: weights.collect(),
        }
    }

    /// The first face that is stretched to the limit or beyond it, and its stretch.
    pub fn first_beyond(&self, corners: impl Fn(usize) -> [Vec3; 3]) -> Option<(usize, f64)> {
        let stretch = |face: usize| {
            let x = corners(face);
            Stretches::new(&self.frames[face].deformation_gradient(&(x[1] - x[0]), &(x[2] - x[0])))
                .values[0]
        };
        let mut stretches = (0..self.faces.len()).map(|face| (face, stretch(face)));
        stretches.find(|(_, stretch)| !(*stretch < self.limit.stretch))
    }

    fn columns(&self, face: usize, q: &SVector<f64, 9>) -> [Vec3; 2] {
        let corner = |c: usize| Vec3::new(q[3 * c], q[3 * c + 1], q[3 * c + 2]);
        self.frames[face].deformation_gradient(&(corner(1) - corner(0)), &(corner(2) - corner(0)))
    }

    /// What a change by the columns of F is by the corners.
    fn to_corners(&self, face: usize, by_column: &[Vec3; 2]) -> SVector<f64, 9> {
        let mut out = SVector::<f64, 9>::zeros();
        for (corner, weights) in self.frames[face].corner_weights().iter().enumerate() {
            let g = by_column[0] * weights[0] + by_column[1] * weights[1];
            out.fixed_rows_mut::<3>(3 * corner).copy_from(&g);
        }
        out
    }

    /// Energies of both stretches with first and second derivatives; `None` where both are below the barrier.
    fn barriers(&self, face: usize, stretches: &Stretches) -> Option<[[f64; 3]; 2]> {
        if stretches.values[0] <= self.limit.begin {
            return None;
        }
        let range = self.limit.stretch - self.limit.begin;
        let scales = [1.0, -1.0 / range, 1.0 / (range * range)];
        Some(stretches.values.map(|stretch| {
            let barrier = log_barrier(self.limit.ratio(stretch));
            std::array::from_fn(|k| self.weights[face] * scales[k] * barrier[k])
        }))
    }

    /// (E₁ − E₂) / (σ₁ − σ₂).
    fn slope_quotient(&self, face: usize, stretches: &Stretches, slopes: [f64; 2]) -> f64 {
        let StretchLimit { stretch, begin, .. } = self.limit;
        if stretches.values[1] <= begin {
            return slopes[0] / stretches.difference;
        }
        let range = stretch - begin;
        let ratios = stretches.values.map(|value| self.limit.ratio(value));
        let quotient = log_barrier_slope_quotient(ratios, -stretches.difference / range);
        self.weights[face] / (range * range) * quotient
    }

    /// ∂²E/∂F² over the stacked columns of F.
    fn hessian_by_columns(
        &self,
        face: usize,
        stretches: &Stretches,
        barriers: &[[f64; 3]; 2],
    ) -> Matrix6<f64> {
        let [s1, s2] = stretches.values;
        let [u1, u2, normal] = stretches.left;
        let [v1, v2] = stretches.right;
        let slopes = barriers.map(|barrier| barrier[1]);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let outer = |u: &Vec3, v: &[f64; 2]| SVector::<f64, 6>::from_fn(|i, _| u[i % 3] * v[i / 3]);
        let (across, back) = (outer(&u1, &v2), outer(&u2, &v1));
        let modes = [
            (outer(&u1, &v1), barriers[0][2]),
            (outer(&u2, &v2), barriers[1][2]),
            (
                (across + back) * half,
                self.slope_quotient(face, stretches, slopes),
            ),
            ((across - back) * half, (slopes[0] + slopes[1]) / (s1 + s2)),
            (outer(&normal, &v1), slopes[0] / s1),
            (
                outer(&normal, &v2),
                if slopes[1] > 0.0 { slopes[1] / s2 } else { 0.0 },
            ),
        ];
        let mut hessian = Matrix6::zeros();
        for (mode, eigenvalue) in modes {
            hessian += mode * mode.transpose() * eigenvalue;
        }
        hessian
    }
}

/// F = Σ_i σ_i u_i v_iᵀ.
struct Stretches {
    /// σ₁ ≥ σ₂.
    values: [f64; 2],
    /// σ₁ − σ₂, to round-off of itself.
    difference: f64,
    /// u₁, u₂, u₁ × u₂.
    left: [Vec3; 3],
    /// v₁, v₂.
    right: [[f64; 2]; 2],
}

impl Stretches {
    fn new([f1, f2]: &[Vec3; 2]) -> Self {
        let (a, b, c) = (f1.norm_squared(), f2.norm_squared(), f1.dot(f2));
        let half_gap = (0.5 * (a - b)).hypot(c);
        let first = (0.5 * (a + b) + half_gap).sqrt();
        let area = f1.cross(f2);
        // By the area, not by the difference of two large numbers.
        let second = area.norm() / first;
        let (sin, cos) = (0.5 * (2.0 * c).atan2(a - b)).sin_cos();
        let u1 = (f1 * cos + f2 * sin) / first;
        // Of a face that collapsed to a line only round-off knows the normal, and nothing depends on it: any will do.
        let across = match second > COLLAPSED * first {
            true => area,
            false => {
                let mut axis = Vec3::zeros();
                axis[u1.iamin()] = 1.0;
                axis
            }
        };
        let normal = (across - u1 * u1.dot(&across)).normalize();
        Self {
            values: [first, second],
            difference: 2.0 * half_gap / (first + second),
            left: [u1, normal.cross(&u1), normal],
            right: [[cos, sin], [-sin, cos]],
        }
    }
}

impl LocalEnergy<9, 3> for StrainLimit {
    const NODE_SIZES: [usize; 3] = [3; 3];
    const BOUNDS_STEPS: bool = true;

    fn name(&self) -> &'static str {
        "strain_limit"
    }

    fn num_stencils(&self) -> usize {
        self.faces.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 3] {
        self.faces[stencil].map(Some)
    }

    fn value(&self, stencil: usize, q: &SVector<f64, 9>) -> f64 {
        let stretches = Stretches::new(&self.columns(stencil, q));
        let barriers = self.barriers(stencil, &stretches);
        barriers.map_or(0.0, |[first, second]| first[0] + second[0])
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 9>) -> (f64, SVector<f64, 9>) {
        let stretches = Stretches::new(&self.columns(stencil, q));
        let Some([first, second]) = self.barriers(stencil, &stretches) else {
            return (0.0, SVector::zeros());
        };
        (
            first[0] + second[0],
            self.to_corners(stencil, &stretches.gradient([first[1], second[1]])),
        )
    }

    fn hessian(&self, stencil: usize, q: &SVector<f64, 9>) -> LocalHessian<9> {
        let stretches = Stretches::new(&self.columns(stencil, q));
        let Some(barriers) = self.barriers(stencil, &stretches) else {
            return LocalHessian::zero();
        };
        let by_columns = self.hessian_by_columns(stencil, &stretches, &barriers);
        let weights = self.frames[stencil].corner_weights();
        // ∂(columns)/∂(corners).
        let corners = SMatrix::<f64, 6, 9>::from_fn(|row, column| {
            let is_same_axis = row % 3 == column % 3;
            if is_same_axis {
                weights[column / 3][row / 3]
            } else {
                0.0
            }
        });
        LocalHessian {
            value: barriers[0][0] + barriers[1][0],
            gradient: self.to_corners(
                stencil,
                &stretches.gradient(barriers.map(|barrier| barrier[1])),
            ),
            hessian: corners.transpose() * by_columns * corners,
        }
    }

    /// The energy is convex.
    fn projected_hessian(&self, stencil: usize, q: &SVector<f64, 9>, _: f64) -> LocalHessian<9> {
        self.hessian(stencil, q)
    }

    fn max_step(&self, stencil: usize, q: &SVector<f64, 9>, direction: &SVector<f64, 9>) -> f64 {
        let (start, change) = (self.columns(stencil, q), self.columns(stencil, direction));
        let at = |t: f64| Stretches::new(&[start[0] + change[0] * t, start[1] + change[1] * t]);
        let before = at(0.0).values[0];
        let left = self.limit.stretch - before;
        let target = before + LARGEST_SHARE * left;
        let mut t = 1.0;
        let mut stretches = at(t);
        if stretches.values[0] <= target {
            return 1.0;
        }
        let chord = LARGEST_SHARE * left / (stretches.values[0] - before);
        // σ₁ is convex along the line: Newton's method comes from beyond and never passes the root, but for round-off. Where
        // next to nothing is left that can be more than the way to the root itself; the chord then tells how far is safe.
        for _ in 0..MAX_ROOT_ITERATIONS {
            let excess = stretches.values[0] - target;
            if excess <= ROOT_TOLERANCE * left {
                return t;
            }
            t -= excess / stretches.slope(&change);
            if !(t >= chord) {
                break;
            }
            stretches = at(t);
        }
        chord
    }

    fn is_admissible(&self, stencil: usize, q: &SVector<f64, 9>) -> bool {
        Stretches::new(&self.columns(stencil, q)).values[0] < self.limit.stretch
    }

    fn describe(&self, stencil: usize) -> String {
        format!("face {stencil}")
    }
}

impl Stretches {
    /// Σ_i E_i ∂σ_i/∂F, by the columns of F.
    fn gradient(&self, slopes: [f64; 2]) -> [Vec3; 2] {
        let [u1, u2, _] = self.left;
        std::array::from_fn(|k| {
            u1 * (slopes[0] * self.right[0][k]) + u2 * (slopes[1] * self.right[1][k])
        })
    }

    /// dσ₁ along a change of F.
    fn slope(&self, [c1, c2]: &[Vec3; 2]) -> f64 {
        let [cos, sin] = self.right[0];
        self.left[0].dot(&(c1 * cos + c2 * sin))
    }
}

/// The formula over any numbers: the oracle of the tests.
impl StrainLimit {
    /// E of one face whose stretches differ.
    pub fn formula<R: Real>(&self, face: usize, q: &[R; 9]) -> R {
        let [m11, m12, m22] = self.frames[face].inverse;
        let edge = |c: usize, axis: usize| q[3 * c + axis] - q[axis];
        let f1: [R; 3] = std::array::from_fn(|k| edge(1, k) * m11);
        let f2: [R; 3] = std::array::from_fn(|k| edge(1, k) * m12 + edge(2, k) * m22);
        let (a, b, c) = (dot(&f1, &f1), dot(&f2, &f2), dot(&f1, &f2));
        let gap = ((a - b) * (a - b) * 0.25 + c * c).sqrt();
        let StretchLimit { stretch, begin, .. } = self.limit;
        let mut sum = R::from(0.0);
        for square in [(a + b) * 0.5 + gap, (a + b) * 0.5 - gap] {
            let left = R::from(stretch) - square.sqrt();
            let ratio = left * (1.0 / (stretch - begin));
            if ratio.value() < 1.0 {
                sum = sum - (ratio - R::from(1.0)) * (ratio - R::from(1.0)) * ratio.ln();
            }
        }
        sum * self.weights[face]
    }
}

#[cfg(test)]
mod tests;
