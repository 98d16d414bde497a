//! Second-order discrete shells, DS(2nd): bending between the quadratic patches, and what keeps them from degenerating.
//!
//! ```text
//! E = Σ_edges Σ_n ω_n [ C · 3 ℓ² / (2 (A + A')) (θ(s_n) − θ̄_n)² + η C/2 Σ_sides ln² J(s_n) ],    J = |T × a| / 2A
//! ```
//!
//! θ angle [rad] between the normals of the two patches at a point of their common edge, T the edge's tangent there, a the
//! derivative of a patch into its face, ℓ, A rest length [m] and areas [m²], C flexural rigidity [N·m], two Gauss points
//! with ω = 1/2. Reference: "Better Bending" (2026), Eqs. (23), (24), after Le et al. (2023).
//!
//! The second term is ours. The points of the edges may slide in flat patches for nothing, and the energy drives patches to
//! where |∂_s r × ∂_t r| vanishes at their edges; the study kept them from it with a barrier as well (its Section 8.3).
//! J is 1 in a patch with straight edges and their middles, infinitely bad at 0. Without it the energy has no minimum: on a
//! cylinder with held vertices it falls nearly in proportion to η, of which relaxed points leave J near 10⁻³
//! (`tests/second_order.rs`).
//!
//! Both normals are orthogonal to T, so θ is the hinge angle of the points 0, T, a, b, each linear in the nodes with scalar
//! weights; [`Wing`] has its derivatives. With its functionals, S the stretching, Ψ the tilting, K the swinging, and
//! λ = T·δT / T·T: `(ln J)' = λ + S`, `(ln J)'' = Ψ² + K² − λ² + N² + M² − (M + K)² − S²`.

use nalgebra::{SMatrix, SVector};

use super::hinge::turning_angle;
use super::quadratic_form::{Functional, QuadraticForm, WingFunctionals, scaled_sum};
use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian};
use crate::geometry::over_numbers::{cross, norm};
use crate::geometry::{Real, Wing, hinge_angle};
use crate::mesh::{EdgeId, FaceId, Surface};
use crate::rest::RestFrame;

/// η: no value follows from the model, and the energy of relaxed points is nearly proportional to it. Points come to rest
/// within 250 iterations on the study's cylinder of 286, 1144 and 4770 triangles; with 10⁻⁶ it took 400, with 10⁻⁷ more.
/// At 10⁻² patches keep their shape, and 4/10 of the energy.
const AREA_STIFFNESS: f64 = 1e-5;

/// The nodes of an edge and of its two patches.
#[derive(Clone, Copy, Debug)]
struct EdgePatches {
    /// Ends of the edge, its point; then of each patch the apex and the points of its edges: of the patch that traverses
    /// the edge forwards from the end to the apex and from there to the beginning, of the other one from the beginning to
    /// the apex and from there to the end.
    nodes: [Option<Dof>; 9],
    /// `C · 3 ℓ² / (2 (A + A'))`, for interior edges [N·m].
    stiffness: f64,
    /// C of the edge [N·m].
    rigidity: f64,
    /// 2A of the two faces [m²].
    twice_areas: [f64; 2],
    /// The ends, for reports.
    vertices: [u32; 2],
}

/// Bending between the quadratic patches of one shell.
pub struct SecondOrderEdges {
    edges: Vec<EdgePatches>,
    /// η.
    area_stiffness: f64,
    /// θ̄ at the Gauss points of every edge: 0 but for damping.
    rest: Vec<[f64; 2]>,
}

/// The Gauss points of an edge, each with half of its length.
fn gauss_points() -> [f64; 2] {
    let offset = 0.5 / 3f64.sqrt();
    [0.5 - offset, 0.5 + offset]
}

/// Weights of the nodes in T, and in the derivatives a, b into the two patches, at a point of the edge.
fn point_weights(s: f64) -> [[f64; 9]; 3] {
    let (start, point) = (4.0 * s - 3.0, -4.0 * s);
    let (far, near) = (4.0 * s, 4.0 - 4.0 * s);
    [
        [
            start,
            4.0 * s - 1.0,
            4.0 - 8.0 * s,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
        ],
        [start, 0.0, point, -1.0, far, near, 0.0, 0.0, 0.0],
        [start, 0.0, point, 0.0, 0.0, 0.0, -1.0, near, far],
    ]
}

/// The wings of the hinge of a Gauss point, and the weights of the nodes in its points.
struct GaussPoint {
    weights: [[f64; 9]; 3],
    wings: [Option<Wing>; 2],
}

impl GaussPoint {
    fn angle(&self) -> f64 {
        match &self.wings {
            [Some(own), Some(other)] => hinge_angle(own, other),
            _ => 0.0,
        }
    }

    /// Writes a functional of the edge ends and the apex of a wing as one of the nodes; the origin of the hinge rests.
    fn place(&self, side: usize, f: [Vec3; 3]) -> Functional<27> {
        // The first wing runs from the origin to T, the second one back.
        let by_tangent = if side == 0 { f[1] } else { f[0] };
        let mut out = [0.0; 27];
        for n in 0..9 {
            let v = by_tangent * self.weights[0][n] + f[2] * self.weights[1 + side][n];
            out[3 * n..3 * n + 3].copy_from_slice(v.as_slice());
        }
        out
    }

    /// λ.
    fn lengthening(&self, side: usize, wing: &Wing) -> Functional<27> {
        // Of the wing's two ends one is T; it moves along the edge outwards.
        let along = wing.edge / wing.length;
        let f = if side == 0 {
            [Vec3::zeros(), along, Vec3::zeros()]
        } else {
            [-along, Vec3::zeros(), Vec3::zeros()]
        };
        self.place(side, f)
    }
}

impl SecondOrderEdges {
    /// For vertices and points of edges of three unknowns each, from `first_vertex` and `first_point` on; `frames` and
    /// `rigidities` are those of the faces of `rest`.
    pub fn new(
        rest: &Surface,
        first_vertex: Dof,
        first_point: Dof,
        frames: &[RestFrame],
        rigidities: &[f64],
    ) -> Self {
        let vertex = |v: u32| Dof(first_vertex.0 + 3 * v);
        let point = |e: EdgeId| Dof(first_point.0 + 3 * e.0);
        let mesh = &rest.mesh;
        let edges = mesh.edge_faces().iter().enumerate().map(|(edge, faces)| {
            let id = EdgeId(edge as u32);
            let [u, v] = mesh.edges()[edge];
            let mut nodes = [None; 9];
            nodes[..3].copy_from_slice(&[Some(vertex(u)), Some(vertex(v)), Some(point(id))]);
            for (side, face) in faces.iter().enumerate() {
                let Some(FaceId(face)) = *face else { continue };
                let own = mesh.face_edges()[face as usize];
                let corner = own
                    .iter()
                    .position(|e| *e == id)
                    .expect("the face has the edge");
                let patch = [
                    vertex(mesh.faces()[face as usize][corner]),
                    point(own[(corner + 1) % 3]),
                    point(own[(corner + 2) % 3]),
                ];
                nodes[3 + 3 * side..6 + 3 * side].copy_from_slice(&patch.map(Some));
            }
            let of_faces = |value: &dyn Fn(usize) -> f64| -> f64 {
                faces.iter().flatten().map(|f| value(f.0 as usize)).sum()
            };
            let count = faces.iter().flatten().count() as f64;
            let rigidity = of_faces(&|f| rigidities[f]) / count;
            let length = (rest.positions[v as usize] - rest.positions[u as usize]).norm();
            let area = of_faces(&|f| frames[f].area);
            EdgePatches {
                nodes,
                stiffness: if count == 2.0 {
                    rigidity * 1.5 * length * length / area
                } else {
                    0.0
                },
                rigidity,
                twice_areas: faces.map(|f| f.map_or(1.0, |f| 2.0 * frames[f.0 as usize].area)),
                vertices: [u, v],
            }
        });
        let edges: Vec<EdgePatches> = edges.collect();
        Self {
            rest: vec![[0.0; 2]; edges.len()],
            edges,
            area_stiffness: AREA_STIFFNESS,
        }
    }

    /// With another η: what the energy comes to without a barrier is seen as η falls.
    pub fn with_area_stiffness(self, area_stiffness: f64) -> Self {
        Self {
            area_stiffness,
            ..self
        }
    }

    fn gauss_points(&self, stencil: usize, q: &SVector<f64, 27>) -> [GaussPoint; 2] {
        gauss_points().map(|s| {
            let weights = point_weights(s);
            let [tangent, a, b] =
                weights.map(|w| -> Vec3 { (0..9).map(|n| q.fixed_rows::<3>(3 * n) * w[n]).sum() });
            let origin = Vec3::zeros();
            let nodes = &self.edges[stencil].nodes;
            GaussPoint {
                weights,
                wings: [
                    nodes[3].map(|_| Wing::new(&origin, &tangent, &a)),
                    nodes[6].map(|_| Wing::new(&tangent, &origin, &b)),
                ],
            }
        })
    }

    /// ln J of a side.
    fn stretch(&self, stencil: usize, side: usize, wing: &Wing) -> f64 {
        (wing.length * wing.height / self.edges[stencil].twice_areas[side]).ln()
    }

    fn value_at(&self, stencil: usize, point: &GaussPoint, rest: f64) -> f64 {
        let edge = &self.edges[stencil];
        let mut value = 0.5 * edge.stiffness * (point.angle() - rest).powi(2);
        for (side, wing) in point.wings.iter().enumerate() {
            if let Some(wing) = wing {
                let stretch = self.stretch(stencil, side, wing);
                value += 0.25 * self.area_stiffness * edge.rigidity * stretch * stretch;
            }
        }
        value
    }

    fn derivatives(&self, stencil: usize, q: &SVector<f64, 27>, kept: f64) -> LocalHessian<27> {
        let edge = &self.edges[stencil];
        let mut form = QuadraticForm::<27>::zero(kept);
        let mut local = LocalHessian::zero();
        for (point, rest) in self.gauss_points(stencil, q).iter().zip(self.rest[stencil]) {
            local.value += self.value_at(stencil, point, rest);
            let moment = edge.stiffness * (point.angle() - rest);
            let mut turning = [0.0; 27];
            for (side, wing) in point.wings.iter().enumerate() {
                let Some(wing) = wing else { continue };
                let functionals = WingFunctionals::placed(wing, |f| point.place(side, f));
                turning = scaled_sum(&turning, &functionals.turning, -1.0);
                functionals.add_angle(moment, &mut form);
                let stretch = self.stretch(stencil, side, wing);
                let stiffness = 0.5 * self.area_stiffness * edge.rigidity;
                let lengthening = point.lengthening(side, wing);
                let slope = scaled_sum(&lengthening, &functionals.stretching, 1.0);
                form.add_square(stiffness, &slope);
                functionals.add_area(stiffness * stretch, &lengthening, &mut form);
                local.gradient += SVector::from(slope) * (stiffness * stretch);
            }
            if edge.stiffness > 0.0 {
                form.add_square(edge.stiffness, &turning);
                local.gradient += SVector::from(turning) * moment;
            }
        }
        local.hessian = SMatrix::from_fn(|i, j| form.rows[i][j]);
        local
    }

    /// E of one edge over any numbers: the oracle of the tests.
    pub fn formula<R: Real>(&self, stencil: usize, q: &[R; 27]) -> R {
        let edge = &self.edges[stencil];
        let mut energy = R::from(0.0);
        for (s, rest) in gauss_points().into_iter().zip(self.rest[stencil]) {
            let [tangent, a, b] = point_weights(s).map(|w| -> [R; 3] {
                std::array::from_fn(|axis| {
                    (0..9).fold(R::from(0.0), |sum, n| sum + q[3 * n + axis] * w[n])
                })
            });
            if edge.stiffness > 0.0 {
                let angle = turning_angle(&[[R::from(0.0); 3], tangent, a, b]) - rest;
                energy = energy + angle * angle * (0.5 * edge.stiffness);
            }
            for (side, into) in [a, b].into_iter().enumerate() {
                if edge.nodes[3 + 3 * side].is_none() {
                    continue;
                }
                let twice_area = norm(&cross(&tangent, &into));
                let stretch = (twice_area * (1.0 / edge.twice_areas[side])).ln();
                energy = energy + stretch * stretch * (0.25 * self.area_stiffness * edge.rigidity);
            }
        }
        energy
    }
}

impl WingFunctionals<27> {
    /// Adds `k` times `(ln J)''`.
    fn add_area(&self, k: f64, lengthening: &Functional<27>, form: &mut QuadraticForm<27>) {
        form.add_square(k, &self.tilting);
        form.add_square(k, &self.swinging);
        form.add_square(-k, lengthening);
        self.add_altitude(k, form);
        form.add_square(-k, &self.stretching);
    }
}

impl LocalEnergy<27, 9> for SecondOrderEdges {
    const NODE_SIZES: [usize; 9] = [3; 9];
    const MEASURES: usize = 2;

    fn name(&self) -> &'static str {
        "bending"
    }

    fn num_stencils(&self) -> usize {
        self.edges.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 9] {
        self.edges[stencil].nodes
    }

    fn value(&self, stencil: usize, q: &SVector<f64, 27>) -> f64 {
        let points = self.gauss_points(stencil, q);
        (points.iter().zip(self.rest[stencil]))
            .map(|(point, rest)| self.value_at(stencil, point, rest))
            .sum()
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 27>) -> (f64, SVector<f64, 27>) {
        let edge = &self.edges[stencil];
        let mut value = 0.0;
        let mut gradient = SVector::zeros();
        for (point, rest) in self.gauss_points(stencil, q).iter().zip(self.rest[stencil]) {
            value += self.value_at(stencil, point, rest);
            let moment = edge.stiffness * (point.angle() - rest);
            for (side, wing) in point.wings.iter().enumerate() {
                let Some(wing) = wing else { continue };
                let force =
                    0.5 * self.area_stiffness * edge.rigidity * self.stretch(stencil, side, wing);
                let place = |f| SVector::from(point.place(side, f));
                gradient += place(wing.stretching()) * force - place(wing.turning()) * moment
                    + SVector::from(point.lengthening(side, wing)) * force;
            }
        }
        (value, gradient)
    }

    fn hessian(&self, stencil: usize, q: &SVector<f64, 27>) -> LocalHessian<27> {
        self.derivatives(stencil, q, 1.0)
    }

    fn projected_hessian(
        &self,
        stencil: usize,
        q: &SVector<f64, 27>,
        kept: f64,
    ) -> LocalHessian<27> {
        self.derivatives(stencil, q, kept)
    }

    fn measure(&self, stencil: usize, q: &SVector<f64, 27>, measures: &mut [f64]) {
        let points = self.gauss_points(stencil, q);
        measures.copy_from_slice(&points.map(|point| point.angle()));
    }

    fn rest(&self, stencil: usize, measures: &mut [f64]) {
        measures.copy_from_slice(&self.rest[stencil]);
    }

    fn set_rest(&mut self, stencil: usize, measures: &[f64]) {
        self.rest[stencil].copy_from_slice(measures);
    }

    fn describe(&self, stencil: usize) -> String {
        let [u, v] = self.edges[stencil].vertices;
        format!("edge {u}–{v}")
    }
}
