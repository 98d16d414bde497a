//! Discrete Shells: a spring on the angle of every hinge, DS(θ) and DS(tan) in one implementation.
//!
//! ```text
//! E = Σ_edges 4 k_B w · (g(θ/2) − g(θ̄/2))²,     k_B = C/2,     w = 3 ℓ² / (A + A'),     C = h³ (α + 2β) / 12
//! ```
//!
//! ℓ rest edge length [m], A, A' rest areas of the two faces [m²], θ, θ̄ deformed and rest hinge angle [rad], h
//! thickness [m], α, β plane-stress Lamé parameters [Pa], g the profile: identity (DS(θ)) or tan (DS(tan)), the same as
//! those of directors, at the half angle; other weights w and stiffnesses k_B: [`super::HingeSprings`]. Interior edges
//! only. Reference: "Better Bending" (2026), Eqs. (7), (8), after
//! Grinspun et al., "Discrete Shells" (2003), and Tamstorf and Grinspun, "Discrete Bending Forces and Their Jacobians"
//! (2013). Both agree to second order at a flat rest state.
//!
//! θ goes on beyond ±π: of all angles that differ by whole turns it is the one nearest to that at the start of the step,
//! as long as the energy is told of it ([`crate::assembly::RestMeasures::follow`]); rest angles may lie beyond π too.
//!
//! DS(θ) is the familiar baseline, cheap and robust: energy and force grow with the fold but stay bounded, so loads may
//! close a hinge (group III of the study). DS(tan) adds a barrier at |θ| = π, so that a hinge never closes on itself
//! (group IV). The energy of neither converges under refinement, not even on a regular mesh that is aligned with the
//! bending, where it is three times too large; on anisotropic meshes it is a hundred times. Choose a director model where
//! stiffness matters.

use std::f64::consts::TAU;
use std::marker::PhantomData;

use nalgebra::{SMatrix, SVector};

use super::hinge::{Hinge, WING_PLACES, angle, hinges, turning_angle, wings};
use super::hinge_weight::HingeSprings;
use super::profile::AngleProfile;
use super::quadratic_form::{Functional, QuadraticForm, WIDTH, WingFunctionals};
use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian};
use crate::geometry::{Real, Wing};
use crate::mesh::Surface;
use crate::rest::RestFrame;

/// Discrete Shells bending energy of one shell: DS(θ) with the profile [`super::Identity`], DS(tan) with
/// [`super::Tangent`].
pub struct DiscreteShells<P> {
    hinges: Vec<Hinge>,
    /// `4 k_B w` of every hinge [J].
    stiffness: Vec<f64>,
    /// θ̄ of every hinge.
    rest: Vec<f64>,
    /// g(θ̄/2) of every hinge.
    rest_profile: Vec<f64>,
    /// The angle of every hinge that θ is near to.
    near: Vec<f64>,
    profile: PhantomData<P>,
}

impl<P: AngleProfile> DiscreteShells<P> {
    /// `frames` are the rest frames of the faces of `rest`; rest angles are those of `rest` if `curved`, else zero.
    /// `flexural_rigidity` is `E h³ / (12 (1 − ν²))` of every face [N·m], which equals C; an edge takes the mean of its
    /// two faces, weighted by their areas.
    pub fn new(
        rest: &Surface,
        first_vertex: Dof,
        frames: &[RestFrame],
        curved: bool,
        flexural_rigidity: &[f64],
    ) -> Self {
        let springs = HingeSprings::default();
        Self::with_springs(
            rest,
            first_vertex,
            frames,
            curved,
            flexural_rigidity,
            springs,
        )
    }

    /// [`Self::new`] with other weights or a given stiffness.
    pub fn with_springs(
        rest: &Surface,
        first_vertex: Dof,
        frames: &[RestFrame],
        curved: bool,
        flexural_rigidity: &[f64],
        springs: HingeSprings,
    ) -> Self {
        let hinges = hinges(rest, first_vertex, frames, flexural_rigidity);
        let at_rest = |hinge: &Hinge| match curved {
            true => angle(&hinge.rest_wings()),
            false => 0.0,
        };
        let rest: Vec<f64> = hinges.iter().map(at_rest).collect();
        Self {
            stiffness: (springs.stiffnesses(&hinges).iter())
                .map(|k| 4.0 * k)
                .collect(),
            rest_profile: rest.iter().map(|theta| P::eval(0.5 * theta)[0]).collect(),
            rest,
            near: vec![0.0; hinges.len()],
            hinges,
            profile: PhantomData,
        }
    }

    /// θ of one hinge.
    fn angle(&self, stencil: usize, wings: &[Wing; 2]) -> f64 {
        let theta = angle(wings);
        theta + self.turns(stencil, theta)
    }

    /// Whole turns from an angle in (−π, π] to θ.
    fn turns(&self, stencil: usize, principal: f64) -> f64 {
        let turns = (self.near[stencil] - principal) / TAU;
        // Half a turn away both branches are as near: a closed hinge stays on its side.
        if turns.abs() <= 0.5 {
            return 0.0;
        }
        TAU * turns.round()
    }

    fn wings(q: &SVector<f64, 12>) -> [Wing; 2] {
        wings(&std::array::from_fn(|i| {
            Vec3::new(q[3 * i], q[3 * i + 1], q[3 * i + 2])
        }))
    }

    /// E of one hinge and its first and second derivative by θ.
    fn by_angle(&self, stencil: usize, theta: f64) -> [f64; 3] {
        let [g, g1, g2] = P::eval(0.5 * theta);
        let (k, offset) = (self.stiffness[stencil], g - self.rest_profile[stencil]);
        [
            k * offset * offset,
            k * offset * g1,
            0.5 * k * (g1 * g1 + offset * g2),
        ]
    }

    fn derivatives(&self, stencil: usize, q: &SVector<f64, 12>, kept: f64) -> LocalHessian<12> {
        let wings = Self::wings(q);
        let [value, moment, stiffness] = self.by_angle(stencil, self.angle(stencil, &wings));
        let functionals = [0, 1].map(|i| WingFunctionals::new(&wings[i], WING_PLACES[i]));
        let slope: Functional =
            std::array::from_fn(|i| -functionals[0].turning[i] - functionals[1].turning[i]);
        let mut form = QuadraticForm::zero(kept);
        form.add_square(stiffness, &slope);
        for wing in &functionals {
            wing.add_angle(moment, &mut form);
        }
        LocalHessian {
            value,
            gradient: SVector::from_fn(|i, _| moment * slope[i]),
            hessian: SMatrix::from_fn(|i, j| form.rows[i][j]),
        }
    }

    /// E of one hinge over any numbers: the oracle of the tests.
    pub fn formula<R: Real>(&self, stencil: usize, q: &[R; 12]) -> R {
        let x = |i: usize| [q[3 * i], q[3 * i + 1], q[3 * i + 2]];
        let theta = turning_angle(&[x(0), x(1), x(2), x(3)]);
        let theta = theta + self.turns(stencil, theta.value());
        let offset = P::formula(theta * 0.5) - self.rest_profile[stencil];
        offset * offset * self.stiffness[stencil]
    }
}

impl<P: AngleProfile> LocalEnergy<12, 4> for DiscreteShells<P> {
    const NODE_SIZES: [usize; 4] = [3; 4];
    const MEASURES: usize = 1;
    const HAS_BRANCHES: bool = true;

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
        self.by_angle(stencil, self.angle(stencil, &Self::wings(q)))[0]
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 12>) -> (f64, SVector<f64, 12>) {
        let wings = Self::wings(q);
        let [value, moment, _] = self.by_angle(stencil, self.angle(stencil, &wings));
        let mut gradient = SVector::<f64, 12>::zeros();
        for (wing, places) in wings.iter().zip(WING_PLACES) {
            for (v, p) in wing.turning().iter().zip(places) {
                let mut part = gradient.fixed_rows_mut::<3>(3 * p);
                part -= v * moment;
            }
        }
        (value, gradient)
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

    fn is_admissible(&self, stencil: usize, q: &SVector<f64, 12>) -> bool {
        P::MAX_TILT.is_infinite() || 0.5 * self.angle(stencil, &Self::wings(q)).abs() < P::MAX_TILT
    }

    fn measure(&self, stencil: usize, q: &SVector<f64, 12>, measures: &mut [f64]) {
        measures[0] = self.angle(stencil, &Self::wings(q));
    }

    fn rest(&self, stencil: usize, measures: &mut [f64]) {
        measures[0] = self.rest[stencil];
    }

    fn set_rest(&mut self, stencil: usize, measures: &[f64]) {
        self.rest[stencil] = measures[0];
        self.rest_profile[stencil] = P::eval(0.5 * measures[0])[0];
    }

    fn follow(&mut self, stencil: usize, measures: &[f64]) {
        self.near[stencil] = measures[0];
    }

    fn describe(&self, stencil: usize) -> String {
        self.hinges[stencil].describe()
    }
}

const _: () = assert!(WIDTH >= 12);
