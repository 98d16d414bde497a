//! Discrete Shells hinge, quadratic in the hinge angle: DS(θ).
//!
//! ```text
//! E = Σ_edges C · 3 ℓ² / (2 (A + A')) · (θ − θ̄)²,     C = h³ (α + 2β) / 12
//! ```
//!
//! ℓ rest edge length [m], A, A' rest areas of the two faces [m²], θ, θ̄ deformed and rest hinge angle [rad], h
//! thickness [m], α, β plane-stress Lamé parameters [Pa]. Reference: "Better Bending" (2026), Eq. (7), after Grinspun et
//! al., "Discrete Shells" (2003). The familiar baseline: cheap and robust, but its energy does not converge under
//! refinement, on regular meshes it is up to three times too stiff.

use nalgebra::{SMatrix, SVector};

use super::quadratic_form::{Functional, QuadraticForm, WIDTH, WingFunctionals};
use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian};
use crate::geometry::{Real, Wing, hinge_angle};
use crate::mesh::Surface;
use crate::rest::RestFrame;

struct Hinge {
    /// Edge ends, apex of the face that traverses the edge from the first to the second, apex of the other face.
    vertices: [Dof; 4],
    stiffness: f64,
    rest_angle: f64,
}

/// DS(θ) bending energy of one shell.
pub struct DiscreteShellsHinge {
    hinges: Vec<Hinge>,
    edges: Vec<[u32; 2]>,
}

impl DiscreteShellsHinge {
    /// `frames` are the rest frames of the faces of `rest`; rest angles are those of `rest` if `curved`, else zero.
    /// `flexural_rigidity` is `E h³ / (12 (1 − ν²))` [N·m], which equals C.
    pub fn new(
        rest: &Surface,
        first_vertex: Dof,
        frames: &[RestFrame],
        curved: bool,
        flexural_rigidity: f64,
    ) -> Self {
        let mut hinges = Vec::new();
        let mut edges = Vec::new();
        for (edge, faces) in rest.mesh.edge_faces().iter().enumerate() {
            let [Some(f0), Some(f1)] = *faces else {
                continue;
            };
            let [u, v] = rest.mesh.edges()[edge];
            let id = crate::mesh::EdgeId(edge as u32);
            let apex = |side| {
                rest.mesh
                    .opposite_vertex(id, side)
                    .expect("an interior edge has two apexes")
                    .0
            };
            let corners = [u, v, apex(0), apex(1)];
            let [a, b, c, d] = corners.map(|i| rest.positions[i as usize]);
            let area = frames[f0.0 as usize].area + frames[f1.0 as usize].area;
            hinges.push(Hinge {
                vertices: corners.map(|i| Dof(first_vertex.0 + 3 * i)),
                stiffness: flexural_rigidity * 1.5 * (b - a).norm_squared() / area,
                rest_angle: if curved {
                    hinge_angle(&Wing::new(&a, &b, &c), &Wing::new(&b, &a, &d))
                } else {
                    0.0
                },
            });
            edges.push([u, v]);
        }
        Self { hinges, edges }
    }

    fn wings(q: &SVector<f64, 12>) -> [Wing; 2] {
        let x = |i: usize| Vec3::new(q[3 * i], q[3 * i + 1], q[3 * i + 2]);
        let (a, b) = (x(0), x(1));
        [Wing::new(&a, &b, &x(2)), Wing::new(&b, &a, &x(3))]
    }

    fn derivatives(&self, stencil: usize, q: &SVector<f64, 12>, kept: f64) -> LocalHessian<12> {
        let hinge = &self.hinges[stencil];
        let wings = Self::wings(q);
        let offset = hinge_angle(&wings[0], &wings[1]) - hinge.rest_angle;
        let functionals = [
            WingFunctionals::new(&wings[0], [0, 1, 2]),
            WingFunctionals::new(&wings[1], [1, 0, 3]),
        ];
        let slope: Functional =
            std::array::from_fn(|i| -functionals[0].turning[i] - functionals[1].turning[i]);
        let mut form = QuadraticForm::zero(kept);
        form.add_square(2.0 * hinge.stiffness, &slope);
        for wing in &functionals {
            wing.add_angle(2.0 * hinge.stiffness * offset, &mut form);
        }
        LocalHessian {
            value: hinge.stiffness * offset * offset,
            gradient: SVector::from_fn(|i, _| 2.0 * hinge.stiffness * offset * slope[i]),
            hessian: SMatrix::from_fn(|i, j| form.rows[i][j]),
        }
    }

    /// E of one hinge over any numbers: the oracle of the tests.
    pub fn formula<R: Real>(&self, stencil: usize, q: &[R; 12]) -> R {
        let hinge = &self.hinges[stencil];
        let x = |i: usize| [q[3 * i], q[3 * i + 1], q[3 * i + 2]];
        let offset = turning_angle(&[x(0), x(1), x(2), x(3)]) - hinge.rest_angle;
        offset * offset * hinge.stiffness
    }
}

/// Hinge angle of edge `x₀ x₁` with apexes `x₂` (face traversing `0 → 1`) and `x₃`, over any numbers.
pub(in crate::energy) fn turning_angle<R: Real>(x: &[[R; 3]; 4]) -> R {
    let sub = |p: &[R; 3], q: &[R; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let dot = |p: &[R; 3], q: &[R; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let cross = |p: &[R; 3], q: &[R; 3]| {
        [
            p[1] * q[2] - p[2] * q[1],
            p[2] * q[0] - p[0] * q[2],
            p[0] * q[1] - p[1] * q[0],
        ]
    };
    let edge = sub(&x[1], &x[0]);
    let n0 = cross(&edge, &sub(&x[2], &x[0]));
    let n1 = cross(&sub(&x[3], &x[0]), &edge);
    (dot(&cross(&n0, &n1), &edge) / dot(&edge, &edge).sqrt()).atan2(dot(&n0, &n1))
}

impl LocalEnergy<12, 4> for DiscreteShellsHinge {
    const NODE_SIZES: [usize; 4] = [3; 4];

    fn name(&self) -> &'static str {
        "bending"
    }

    fn num_stencils(&self) -> usize {
        self.hinges.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 4] {
        self.hinges[stencil].vertices.map(Some)
    }

    fn value(&self, stencil: usize, q: &SVector<f64, 12>) -> f64 {
        let hinge = &self.hinges[stencil];
        let [wing, neighbor] = Self::wings(q);
        hinge.stiffness * (hinge_angle(&wing, &neighbor) - hinge.rest_angle).powi(2)
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 12>) -> (f64, SVector<f64, 12>) {
        let hinge = &self.hinges[stencil];
        let wings = Self::wings(q);
        let offset = hinge_angle(&wings[0], &wings[1]) - hinge.rest_angle;
        let mut gradient = SVector::<f64, 12>::zeros();
        for (wing, points) in wings.iter().zip([[0, 1, 2], [1, 0, 3]]) {
            for (v, p) in wing.turning().iter().zip(points) {
                let mut part = gradient.fixed_rows_mut::<3>(3 * p);
                part -= v * (2.0 * hinge.stiffness * offset);
            }
        }
        (hinge.stiffness * offset * offset, gradient)
    }

    fn hessian(&self, stencil: usize, q: &SVector<f64, 12>) -> LocalHessian<12> {
        self.derivatives(stencil, q, 1.0)
    }

    fn projected_hessian(
        &self,
        stencil: usize,
        q: &SVector<f64, 12>,
        kept: f64,
    ) -> LocalHessian<12> {
        self.derivatives(stencil, q, kept)
    }

    fn describe(&self, stencil: usize) -> String {
        let [u, v] = self.edges[stencil];
        format!("edge {u}–{v}")
    }
}

const _: () = assert!(WIDTH >= 12);
