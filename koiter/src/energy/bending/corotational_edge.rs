//! Corotational hinge, edge-based: CH(ES).
//!
//! ```text
//! E = Σ_edges C (A + A')/2 (κ − κ̄)²,     C = h³ (α + 2β) / 12
//! κ = ℓ² / (A + A') · ( n·(x_c − x_a) / 2A + n·(x_d − x_a) / 2A' ) = −ℓ² / (A + A') · sin(θ/2) (a / 2A + a' / 2A')
//! ```
//!
//! Edge a b of rest length ℓ [m] with apexes c, d; n bisector of the two unit normals, A, A' rest areas [m²], κ, κ̄
//! deformed and rest curvature [1/m], h thickness [m], α, β plane-stress Lamé parameters [Pa]. The second form of κ has the
//! deformed altitudes a, a' [m] and the hinge angle θ: it is what is computed. Interior edges only. Reference: "Better
//! Bending" (2026), Eqs. (9)–(12), after Liang (2025).
//!
//! Nearly as cheap as DS(θ), and exact in the limit on regular meshes that are aligned with the bending; elsewhere its
//! energy does not converge, since it squares the curvature of single edges: a third of that of DS(θ), too large on
//! irregular sheets and too small on a sphere. The force against a fold weakens beyond a right angle (group II of the study), so
//! folds collapse.

use nalgebra::{Matrix3, SMatrix, SVector};

use super::hinge::{Hinge, hinges};
use super::hinge_function::{DeformedHinge, HingeFunction};
use super::quadratic_form::QuadraticForm;
use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian};
use crate::geometry::Real;
use crate::geometry::over_numbers::{cross, dot, sub};
use crate::mesh::Surface;
use crate::rest::RestFrame;

/// CH(ES) bending energy of one shell.
pub struct CorotationalEdge {
    hinges: Vec<Hinge>,
    /// −κ̄ of every hinge [1/m].
    rest: Vec<f64>,
}

impl CorotationalEdge {
    /// `frames` are the rest frames of the faces of `rest`; κ̄ is that of `rest` if `curved`, else zero.
    /// `flexural_rigidity` is `E h³ / (12 (1 − ν²))` of every face [N·m], which equals C; an edge takes the mean of its
    /// two faces, weighted by their areas.
    pub fn new(
        rest: &Surface,
        first_vertex: Dof,
        frames: &[RestFrame],
        curved: bool,
        flexural_rigidity: &[f64],
    ) -> Self {
        let hinges = hinges(rest, first_vertex, frames, flexural_rigidity);
        let at_rest = |hinge: &Hinge| match curved {
            true => curvature(hinge, &DeformedHinge::new(&hinge.rest)).value,
            false => 0.0,
        };
        Self {
            rest: hinges.iter().map(at_rest).collect(),
            hinges,
        }
    }

    /// The hinge, −κ, and ∂E/∂κ with E.
    fn at(&self, stencil: usize, q: &SVector<f64, 12>) -> (DeformedHinge, HingeFunction, [f64; 2]) {
        let hinge = &self.hinges[stencil];
        let deformed = DeformedHinge::new(&std::array::from_fn(|i| {
            Vec3::new(q[3 * i], q[3 * i + 1], q[3 * i + 2])
        }));
        let kappa = curvature(hinge, &deformed);
        let offset = kappa.value - self.rest[stencil];
        let moment = stiffness(hinge) * offset;
        (deformed, kappa, [0.5 * moment * offset, moment])
    }

    fn derivatives(&self, stencil: usize, q: &SVector<f64, 12>, kept: f64) -> LocalHessian<12> {
        let (deformed, kappa, [value, moment]) = self.at(stencil, q);
        let mut form = QuadraticForm::zero(kept);
        let slope = kappa.add_to(moment, &deformed, &mut form);
        form.add_square(stiffness(&self.hinges[stencil]), &slope);
        LocalHessian {
            value,
            gradient: SVector::from_fn(|i, _| moment * slope[i]),
            hessian: SMatrix::from_fn(|i, j| form.rows[i][j]),
        }
    }

    /// E of one hinge over any numbers, with the bisector of the normals: the oracle of the tests.
    pub fn formula<R: Real>(&self, stencil: usize, q: &[R; 12]) -> R {
        let hinge = &self.hinges[stencil];
        let x: [[R; 3]; 4] = std::array::from_fn(|i| std::array::from_fn(|axis| q[3 * i + axis]));
        let unit = |v: [R; 3]| v.map(|entry| entry / dot(&v, &v).sqrt());
        let edge = sub(&x[1], &x[0]);
        let arms = [sub(&x[2], &x[0]), sub(&x[3], &x[0])];
        let n0 = unit(cross(&edge, &arms[0]));
        let n1 = unit(cross(&arms[1], &edge));
        let normal = unit(std::array::from_fn(|axis| n0[axis] + n1[axis]));
        let [a0, a1] = hinge.areas;
        let kappa = (dot(&normal, &arms[0]) * (0.5 / a0) + dot(&normal, &arms[1]) * (0.5 / a1))
            * (hinge.length_squared() / hinge.area());
        let offset = kappa + self.rest[stencil];
        offset * offset * (0.5 * stiffness(hinge))
    }
}

/// `C (A + A')` [N·m³].
fn stiffness(hinge: &Hinge) -> f64 {
    hinge.rigidity * hinge.area()
}

/// −κ with its derivatives.
fn curvature(hinge: &Hinge, deformed: &DeformedHinge) -> HingeFunction {
    let scale = hinge.length_squared() / hinge.area();
    let (sin, cos) = (0.5 * deformed.theta).sin_cos();
    let [a0, a1] = [0, 1].map(|i| scale * deformed.heights[i] / (2.0 * hinge.areas[i]));
    let [x0, x1] = [a0, a1].map(|a| 0.5 * cos * a);
    HingeFunction {
        value: sin * (a0 + a1),
        slope: [sin * a0, sin * a1, x0 + x1],
        curvature: Matrix3::new(
            0.0,
            0.0,
            x0, //
            0.0,
            0.0,
            x1, //
            x0,
            x1,
            -0.25 * sin * (a0 + a1),
        ),
    }
}

impl LocalEnergy<12, 4> for CorotationalEdge {
    const NODE_SIZES: [usize; 4] = [3; 4];
    const MEASURES: usize = 1;

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
        self.at(stencil, q).2[0]
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 12>) -> (f64, SVector<f64, 12>) {
        let (deformed, kappa, [value, moment]) = self.at(stencil, q);
        let slope = kappa.gradient(&deformed);
        (value, SVector::from_fn(|i, _| moment * slope[i / 3][i % 3]))
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

    fn measure(&self, stencil: usize, q: &SVector<f64, 12>, measures: &mut [f64]) {
        measures[0] = self.at(stencil, q).1.value;
    }

    fn rest(&self, stencil: usize, measures: &mut [f64]) {
        measures[0] = self.rest[stencil];
    }

    fn set_rest(&mut self, stencil: usize, measures: &[f64]) {
        self.rest[stencil] = measures[0];
    }

    fn describe(&self, stencil: usize) -> String {
        self.hinges[stencil].describe()
    }
}
