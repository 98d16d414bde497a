//! Holds the directors of clamped edges.
//!
//! ```text
//! E = Σ ½ K ψ²,    ψ = β + ζ,    ζ = θ/2 + ε α
//! ```
//!
//! ψ [rad] is the angle from the prescribed direction r to the director, about the edge: β turns r into the normal of the
//! edge's face, ζ the normal into the director. An edge angle alone cannot be held instead: it is measured from the
//! normals, which turn. The ends of the edge are prescribed, so ψ depends on the apexes c, d and on α only, with the wings
//! of [`crate::geometry::Wing`]: ψ' = (N_c − N_d)/2 + ε α', ψ'' = −N_c T_c + N_d T_d.
//!
//! K is a penalty; ψ is wrong by the bending moment over K.

use nalgebra::{SMatrix, SVector};

use super::quadratic_form::{Functional, QuadraticForm, WingFunctionals, scaled_sum};
use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian};
use crate::geometry::over_numbers::{angle_about, constant, cross, point, sub};
use crate::geometry::{Real, Wing, hinge_angle};

/// A clamped edge, seen from one of its faces.
#[derive(Clone, Copy, Debug)]
pub struct ClampedEdge {
    /// Apex of the face that sees the edge.
    pub apex: Dof,
    /// Apex of the other face.
    pub across: Option<Dof>,
    /// The edge angle; a model without directors has none: there it is the normal of the face that is held.
    pub angle: Option<Dof>,
    /// ε of the edge in the face.
    pub sign: f64,
    /// Prescribed positions of the ends, in the face's traversal [m].
    pub ends: [Vec3; 2],
    /// Prescribed director: a unit vector orthogonal to the edge.
    pub director: Vec3,
    /// K [J/rad²]; 0 while the clamp is off.
    pub stiffness: f64,
    /// The edge by its vertices, for reports.
    pub vertices: [u32; 2],
}

/// The clamped edges of one shell.
#[derive(Clone, Debug, Default)]
pub struct DirectorClamp {
    /// The edges; ends and directors are moved from step to step.
    pub edges: Vec<ClampedEdge>,
}

/// Places of the unknowns (apex, opposite apex, angle) among those of a hinge.
const PLACES: [usize; 7] = [6, 7, 8, 9, 10, 11, 12];

struct Kinematics {
    psi: f64,
    wing: Wing,
    neighbor: Option<Wing>,
}

impl DirectorClamp {
    fn kinematics(&self, stencil: usize, q: &SVector<f64, 7>) -> Kinematics {
        let edge = &self.edges[stencil];
        let [a, b] = edge.ends;
        let wing = Wing::new(&a, &b, &Vec3::new(q[0], q[1], q[2]));
        let neighbor = edge
            .across
            .map(|_| Wing::new(&b, &a, &Vec3::new(q[3], q[4], q[5])));
        let theta = neighbor
            .as_ref()
            .map_or(0.0, |other| hinge_angle(&wing, other));
        let beta = edge
            .director
            .cross(&wing.normal)
            .dot(&wing.edge)
            .atan2(edge.director.dot(&wing.normal));
        Kinematics {
            psi: beta + 0.5 * theta + edge.sign * q[6],
            wing,
            neighbor,
        }
    }

    /// ∂ψ over the unknowns of a hinge, with the functionals of the wings.
    fn slope(
        &self,
        stencil: usize,
        at: &Kinematics,
    ) -> (Functional, WingFunctionals, Option<WingFunctionals>) {
        let own = WingFunctionals::new(&at.wing, [0, 1, 2]);
        let other = at
            .neighbor
            .as_ref()
            .map(|wing| WingFunctionals::new(wing, [1, 0, 3]));
        let mut slope = match &other {
            Some(other) => scaled_sum(&own.turning, &other.turning, -1.0).map(|x| 0.5 * x),
            None => own.turning,
        };
        slope[12] = self.edges[stencil].sign;
        (slope, own, other)
    }

    fn derivatives(&self, stencil: usize, q: &SVector<f64, 7>, kept: f64) -> LocalHessian<7> {
        let stiffness = self.edges[stencil].stiffness;
        let at = self.kinematics(stencil, q);
        let (slope, own, other) = self.slope(stencil, &at);
        let mut form = QuadraticForm::zero(kept);
        form.add_square(stiffness, &slope);
        let moment = stiffness * at.psi;
        let share = if other.is_some() { 1.0 } else { 2.0 };
        form.add_product(-share * moment, &own.turning, &own.stretching);
        if let Some(other) = &other {
            form.add_product(moment, &other.turning, &other.stretching);
        }
        LocalHessian {
            value: 0.5 * moment * at.psi,
            gradient: SVector::from_fn(|i, _| moment * slope[PLACES[i]]),
            hessian: SMatrix::from_fn(|i, j| form.rows[PLACES[i]][PLACES[j]]),
        }
    }

    /// E of one edge over any numbers: the oracle of the tests.
    pub fn formula<R: Real>(&self, stencil: usize, q: &[R; 7]) -> R {
        let edge = &self.edges[stencil];
        let [a, b] = [0, 1].map(|end| constant(&edge.ends[end]));
        let (c, d) = (point(q, 0), point(q, 1));
        let along = sub(&b, &a);
        let normal = cross(&along, &sub(&c, &a));
        let beta = angle_about(&along, &constant(&edge.director), &normal);
        let theta = match edge.across {
            Some(_) => super::hinge::turning_angle(&[a, b, c, d]),
            None => R::from(0.0),
        };
        let psi = beta + theta * 0.5 + q[6] * edge.sign;
        psi * psi * (0.5 * edge.stiffness)
    }
}

impl LocalEnergy<7, 3> for DirectorClamp {
    const NODE_SIZES: [usize; 3] = [3, 3, 1];

    fn name(&self) -> &'static str {
        "clamps"
    }

    fn num_stencils(&self) -> usize {
        self.edges.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 3] {
        let edge = &self.edges[stencil];
        [Some(edge.apex), edge.across, edge.angle]
    }

    fn value(&self, stencil: usize, q: &SVector<f64, 7>) -> f64 {
        0.5 * self.edges[stencil].stiffness * self.kinematics(stencil, q).psi.powi(2)
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 7>) -> (f64, SVector<f64, 7>) {
        let at = self.kinematics(stencil, q);
        let (slope, ..) = self.slope(stencil, &at);
        let moment = self.edges[stencil].stiffness * at.psi;
        (
            0.5 * moment * at.psi,
            SVector::from_fn(|i, _| moment * slope[PLACES[i]]),
        )
    }

    fn hessian(&self, stencil: usize, q: &SVector<f64, 7>) -> LocalHessian<7> {
        self.derivatives(stencil, q, 1.0)
    }

    fn projected_hessian(&self, stencil: usize, q: &SVector<f64, 7>, kept: f64) -> LocalHessian<7> {
        self.derivatives(stencil, q, kept)
    }

    fn describe(&self, stencil: usize) -> String {
        let [u, v] = self.edges[stencil].vertices;
        format!("edge {u}–{v}")
    }
}
