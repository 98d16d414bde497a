//! Second-order discrete shells, DS(2nd): bending of the quadratic patches.
//!
//! ```text
//! E = Σ_faces (C/2) Ā Σ_n ω_n (tr Ī⁻¹ II(s_n, t_n) − f̄_n)²,    tr Ī⁻¹ II = w · n,    w = Σ_ab Ī⁻¹_ab ∂_a ∂_b r
//! ```
//!
//! r(s, t) the quadratic patch through the corners and the points of the edges, n its unit normal, C flexural rigidity
//! [N·m], Ā rest area [m²], Ī rest first fundamental form, ω = 1/3 at three points. Bending between patches is in
//! [`super::SecondOrderEdges`]. Reference: "Better Bending" (2026), Eqs. (18) to (21), after Le et al. (2023); the area is
//! missing in Eq. (21).
//!
//! As studied there, not as recommended: between its sampling points a patch bends for nothing, so where the points of the
//! edges are free the energy of a cylinder is a small fraction of the exact one, on any mesh. For flat rest shapes.
//!
//! w, `a = ∂_s r` and `b = ∂_t r` are linear in the nodes with scalar weights. With the dual vectors a*, b* of a, b in the
//! tangent plane, μ = n·δa, ν = n·δb, A = w·a*, B = w·b* and `α = a*·(δw − A δa − B δb)`, likewise β with b*:
//!
//! ```text
//! f = w·n    f' = n·δw − A μ − B ν    f'' = −2 μ α − 2 ν β − f |μ a* + ν b*|²
//! ```

use nalgebra::{SMatrix, SVector};

use super::quadratic_basis::{CURVATURES, SAMPLES, slopes};
use super::quadratic_form::{Functional, QuadraticForm};
use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian};
use crate::geometry::Real;
use crate::geometry::over_numbers::{cross, dot, norm};
use crate::mesh::TriMesh;
use crate::rest::RestFrame;

/// Bending of the quadratic patches of one shell.
pub struct SecondOrderFaces {
    /// Corners, then the points of the edges opposite to them.
    faces: Vec<[Dof; 6]>,
    frames: Vec<RestFrame>,
    /// C of every face.
    rigidities: Vec<f64>,
    /// f̄ at the samples of every face: 0 but for damping.
    rest: Vec<[f64; 3]>,
}

/// The numbers of a sample.
struct Sample {
    weights: [[f64; 2]; 6],
    normal: Vec3,
    /// a*, b*.
    dual: [Vec3; 2],
    /// A, B.
    along: [f64; 2],
    /// f.
    curvature: f64,
}

impl SecondOrderFaces {
    /// For vertices and points of edges of three unknowns each, from `first_vertex` and `first_point` on.
    pub fn new(
        mesh: &TriMesh,
        first_vertex: Dof,
        first_point: Dof,
        frames: Vec<RestFrame>,
        rigidities: Vec<f64>,
    ) -> Self {
        let nodes = |(face, edges): (&[u32; 3], &[crate::mesh::EdgeId; 3])| {
            let x = face.map(|v| first_vertex.0 + 3 * v);
            let m = edges.map(|e| first_point.0 + 3 * e.0);
            [x[0], x[1], x[2], m[0], m[1], m[2]].map(Dof)
        };
        Self {
            faces: mesh
                .faces()
                .iter()
                .zip(mesh.face_edges())
                .map(nodes)
                .collect(),
            rest: vec![[0.0; 3]; frames.len()],
            frames,
            rigidities,
        }
    }

    /// Weights of the nodes in w [1/m²].
    fn trace_weights(&self, face: usize) -> [f64; 6] {
        let [m11, m12, m22] = self.frames[face].inverse;
        CURVATURES.map(|[ss, st, tt]| {
            (m11 * m11 + m12 * m12) * ss + 2.0 * m12 * m22 * st + m22 * m22 * tt
        })
    }

    fn samples(&self, face: usize, q: &SVector<f64, 18>) -> [Sample; 3] {
        let sum = |weight: &dyn Fn(usize) -> f64| -> Vec3 {
            (0..6).map(|n| q.fixed_rows::<3>(3 * n) * weight(n)).sum()
        };
        let trace_weights = self.trace_weights(face);
        let w = sum(&|n| trace_weights[n]);
        SAMPLES.map(|point| {
            let weights = slopes(point);
            let [a, b] = [0, 1].map(|axis| sum(&|n| weights[n][axis]));
            let across = a.cross(&b);
            let normal = across.normalize();
            let dual = [b.cross(&normal), normal.cross(&a)].map(|v| v / across.norm());
            Sample {
                weights,
                normal,
                dual,
                along: dual.map(|v| w.dot(&v)),
                curvature: w.dot(&normal),
            }
        })
    }

    /// Factor of f² at every sample.
    fn stiffness(&self, face: usize) -> f64 {
        self.rigidities[face] * self.frames[face].area / 6.0
    }

    fn derivatives(&self, face: usize, q: &SVector<f64, 18>, kept: f64) -> LocalHessian<18> {
        let (stiffness, trace_weights) = (self.stiffness(face), self.trace_weights(face));
        let mut form = QuadraticForm::<18>::zero(kept);
        let mut local = LocalHessian::zero();
        for (sample, rest) in self.samples(face, q).into_iter().zip(self.rest[face]) {
            let f = sample.curvature - rest;
            let slope = sample.slope(&trace_weights);
            form.add_square(2.0 * stiffness, &slope);
            let moment = 2.0 * stiffness * f;
            let normals =
                [0, 1].map(|axis| sample.place(&|n| sample.normal * sample.weights[n][axis]));
            for axis in 0..2 {
                let tangential = sample.place(&|n| {
                    let [by_a, by_b] = sample.weights[n];
                    let [along_a, along_b] = sample.along;
                    sample.dual[axis] * (trace_weights[n] - along_a * by_a - along_b * by_b)
                });
                form.add_product(-2.0 * moment, &normals[axis], &tangential);
            }
            // |μ a* + ν b*|² by its components in the tangent plane.
            let first = sample.dual[0].normalize();
            for direction in [first, sample.normal.cross(&first)] {
                let [p, r] = sample.dual.map(|v| v.dot(&direction));
                let turning = std::array::from_fn(|i| p * normals[0][i] + r * normals[1][i]);
                form.add_square(-moment * sample.curvature, &turning);
            }
            local.value += stiffness * f * f;
            local.gradient += SVector::from(slope) * moment;
        }
        local.hessian = SMatrix::from_fn(|i, j| form.rows[i][j]);
        local
    }

    /// E of one face over any numbers: the oracle of the tests.
    pub fn formula<R: Real>(&self, face: usize, q: &[R; 18]) -> R {
        let sum = |weight: &dyn Fn(usize) -> f64| -> [R; 3] {
            std::array::from_fn(|axis| {
                (0..6).fold(R::from(0.0), |total, n| total + q[3 * n + axis] * weight(n))
            })
        };
        let [m11, m12, m22] = self.frames[face].inverse;
        let mut energy = R::from(0.0);
        for (point, rest) in SAMPLES.into_iter().zip(self.rest[face]) {
            let a = sum(&|n| slopes(point)[n][0]);
            let b = sum(&|n| slopes(point)[n][1]);
            let normal = cross(&a, &b);
            let length = norm(&normal);
            let form = |k: usize| dot(&sum(&|n| CURVATURES[n][k]), &normal) / length;
            let trace = form(0) * (m11 * m11 + m12 * m12)
                + form(1) * (2.0 * m12 * m22)
                + form(2) * (m22 * m22)
                - rest;
            energy = energy + trace * trace * self.stiffness(face);
        }
        energy
    }
}

impl Sample {
    /// A functional by its vector at every node.
    fn place(&self, vector: &dyn Fn(usize) -> Vec3) -> Functional<18> {
        let mut out = [0.0; 18];
        for n in 0..6 {
            out[3 * n..3 * n + 3].copy_from_slice(vector(n).as_slice());
        }
        out
    }

    /// f'.
    fn slope(&self, trace_weights: &[f64; 6]) -> Functional<18> {
        self.place(&|n| {
            let [by_a, by_b] = self.weights[n];
            self.normal * (trace_weights[n] - self.along[0] * by_a - self.along[1] * by_b)
        })
    }
}

impl LocalEnergy<18, 6> for SecondOrderFaces {
    const NODE_SIZES: [usize; 6] = [3; 6];
    const MEASURES: usize = 3;

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
        let samples = self.samples(stencil, q).into_iter().zip(self.rest[stencil]);
        let squares = samples.map(|(sample, rest)| (sample.curvature - rest).powi(2));
        self.stiffness(stencil) * squares.sum::<f64>()
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 18>) -> (f64, SVector<f64, 18>) {
        let (stiffness, trace_weights) = (self.stiffness(stencil), self.trace_weights(stencil));
        let (mut value, mut gradient) = (0.0, SVector::zeros());
        for (sample, rest) in self.samples(stencil, q).into_iter().zip(self.rest[stencil]) {
            let f = sample.curvature - rest;
            value += stiffness * f * f;
            gradient += SVector::from(sample.slope(&trace_weights)) * (2.0 * stiffness * f);
        }
        (value, gradient)
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

    fn measure(&self, stencil: usize, q: &SVector<f64, 18>, measures: &mut [f64]) {
        let samples = self.samples(stencil, q);
        measures.copy_from_slice(&samples.map(|sample| sample.curvature));
    }

    fn rest(&self, stencil: usize, measures: &mut [f64]) {
        measures.copy_from_slice(&self.rest[stencil]);
    }

    fn set_rest(&mut self, stencil: usize, measures: &[f64]) {
        self.rest[stencil].copy_from_slice(measures);
    }

    fn describe(&self, stencil: usize) -> String {
        format!("face {stencil}")
    }
}
