//! Corotational hinge, face-based: CH(FS).
//!
//! ```text
//! E = Σ_faces (C/2) A (κ − κ̄)ᵀ D (κ − κ̄),     C = h³ (α + 2β) / 12,     D_cd = (e_c·e_d)²
//! κ_c = ℓ_c² n·(x_c' − x_c) / (2 A_c (A + A_c)) = −ℓ_c² a_c' sin θ_c / (2 A_c (A + A_c))
//! ```
//!
//! κ_c [1/m] belongs to the edge opposite corner c, of rest length ℓ_c [m] and unit rest direction e_c; x_c' is the vertex
//! across it, A, A_c rest areas of the face and of that neighbour [m²], n normal of the face, h thickness [m], α, β
//! plane-stress Lamé parameters [Pa]. The second form of κ_c has the neighbour's deformed altitude a_c' [m] and the hinge
//! angle θ_c: it is what is computed. κ_c = 0 on boundary edges. Reference: "Better Bending" (2026), Eqs. (13), (14),
//! after Liang (2025).
//!
//! Exact in the limit on regular meshes that are aligned with the bending; elsewhere its energy does not converge. The
//! sine has its maximum at θ = 90°: beyond it the force closes the fold (group I of the study), so keep it from sharp ones.

use nalgebra::{Matrix3, Vector3};

use super::bending_stencil::BendingStencil;
use super::face_bending::{FaceBending, FaceLaw, FaceResponse};
use super::hinge_function::{DeformedHinge, HingeFunction};
use crate::Vec3;
use crate::geometry::Real;
use crate::geometry::over_numbers::{cross, dot, sub};
use crate::mesh::Surface;
use crate::rest::RestFrame;

/// The law of CH(FS).
pub struct CorotationalFace {
    faces: Vec<Face>,
}

struct Face {
    /// C Ā [N·m³].
    stiffness: f64,
    /// D.
    metric: Matrix3<f64>,
    /// `ℓ_c² / (2 A_c (A + A_c))` [1/m²]; 0 on the boundary.
    scales: [f64; 3],
    /// −κ̄ [1/m].
    rest: Vector3<f64>,
}

impl FaceBending<CorotationalFace> {
    /// `frames` are the rest frames of the faces of `rest`, `stencils` those of its mesh; κ̄ is that of `rest` if
    /// `curved`, else zero. `flexural_rigidity` is `E h³ / (12 (1 − ν²))` of every face [N·m], which equals C.
    pub fn new(
        rest: &Surface,
        stencils: Vec<BendingStencil>,
        frames: &[RestFrame],
        curved: bool,
        flexural_rigidity: &[f64],
    ) -> Self {
        let faces = (0..rest.mesh.num_faces())
            .map(|face| Face::new(rest, face, frames, curved, flexural_rigidity[face]))
            .collect();
        Self::with_law(stencils, CorotationalFace { faces })
    }

    /// E of one face over any numbers, with its normal: the oracle of the tests.
    pub fn formula<R: Real>(&self, face: usize, q: &[R; 18]) -> R {
        let x = |i: usize| [q[3 * i], q[3 * i + 1], q[3 * i + 2]];
        let normal = cross(&sub(&x(1), &x(0)), &sub(&x(2), &x(0)));
        let length = dot(&normal, &normal).sqrt();
        let data = &self.law.faces[face];
        // Absent neighbours have the scale 0.
        let kappa: [R; 3] = std::array::from_fn(|c| {
            dot(&normal, &sub(&x(3 + c), &x(c))) / length * data.scales[c] + data.rest[c]
        });
        let mut sum = R::from(0.0);
        for (c, d) in (0..9).map(|k| (k / 3, k % 3)) {
            sum = sum + kappa[c] * kappa[d] * data.metric[(c, d)];
        }
        sum * (0.5 * data.stiffness)
    }
}

impl Face {
    fn new(rest: &Surface, face: usize, frames: &[RestFrame], curved: bool, rigidity: f64) -> Self {
        let (mesh, area) = (&rest.mesh, frames[face].area);
        let x = rest.corners(face);
        let edges: [Vec3; 3] = std::array::from_fn(|c| x[(c + 2) % 3] - x[(c + 1) % 3]);
        let mut data = Self {
            stiffness: rigidity * area,
            metric: Matrix3::from_fn(|c, d| {
                edges[c].normalize().dot(&edges[d].normalize()).powi(2)
            }),
            scales: [0.0; 3],
            rest: Vector3::zeros(),
        };
        for c in 0..3 {
            let edge = mesh.face_edges()[face][c];
            let sides = mesh.edge_faces()[edge.0 as usize];
            let own = usize::from(sides[0].is_none_or(|f| f.0 as usize != face));
            let Some(neighbor) = sides[1 - own] else {
                continue;
            };
            let other = frames[neighbor.0 as usize].area;
            data.scales[c] = edges[c].norm_squared() / (2.0 * other * (area + other));
            if curved {
                let apex = mesh
                    .opposite_vertex(edge, 1 - own)
                    .expect("the neighbour has an apex");
                let points = [
                    x[(c + 1) % 3],
                    x[(c + 2) % 3],
                    x[c],
                    rest.positions[apex.0 as usize],
                ];
                data.rest[c] = data.curvature(c, &DeformedHinge::new(&points)).value;
            }
        }
        data
    }

    /// −κ_c with its derivatives.
    fn curvature(&self, corner: usize, hinge: &DeformedHinge) -> HingeFunction {
        let scaled = self.scales[corner] * hinge.heights[1];
        let (sin, cos) = hinge.theta.sin_cos();
        let (value, turned) = (scaled * sin, scaled * cos);
        HingeFunction {
            value,
            slope: [0.0, value, turned],
            curvature: Matrix3::new(
                0.0, 0.0, 0.0, //
                0.0, 0.0, turned, //
                0.0, turned, -value,
            ),
        }
    }
}

impl FaceLaw for CorotationalFace {
    fn curvature(&self, face: usize, corner: usize, hinge: &DeformedHinge) -> HingeFunction {
        self.faces[face].curvature(corner, hinge)
    }

    fn response(&self, face: usize, curvatures: &Vector3<f64>) -> FaceResponse {
        let face = &self.faces[face];
        let tangent = face.metric * face.stiffness;
        let offset = curvatures - face.rest;
        let moments = tangent * offset;
        FaceResponse {
            value: 0.5 * moments.dot(&offset),
            moments,
            tangent,
        }
    }

    fn measure(&self, _face: usize, curvatures: &Vector3<f64>) -> Vector3<f64> {
        *curvatures
    }

    fn rest(&self, face: usize) -> Vector3<f64> {
        self.faces[face].rest
    }

    fn set_rest(&mut self, face: usize, rest: Vector3<f64>) {
        self.faces[face].rest = rest;
    }
}
