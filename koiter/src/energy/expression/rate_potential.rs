//! A force that depends on velocity, by an expression for its dissipation function.
//!
//! ```text
//! D(q) = τ Σ_s m_s R(v_s; shape of s at the start of the step, parameters, t)      v_s = Σ_k w_k (x_k − x̂_k)/τ
//! ```
//!
//! R is a power [W], or a power by rest area or length that is multiplied by it, m_s; the force on an element is −∂R/∂v. v_s is
//! the velocity of its position at the end of the step, as the method of integration has it ([`crate::integrate::Damping`]:
//! x̂ and τ), w_k the weights of its points. Velocity is implicit and shape is explicit: the force follows the shape a step
//! late, an error of first order in the step. In exchange D is a potential, so that a step stays one minimisation whatever the
//! force is, and it is convex where R is: drag of any strength takes any step. A force F that does not depend on velocity is
//! R = −F·v.
//!
//! Three derivatives by v are all that is needed: ∂D/∂x_k = m w_k ∂R/∂v, ∂²D/∂x_k∂x_l = m w_k w_l ∂²R/∂v² / τ.

use nalgebra::{Matrix3, SMatrix, SVector};

use super::elements::{Elements, MAX_QUANTITIES};
use super::program::Program;
use super::settings::Settings;
use crate::assembly::{Assembled, Dof, Energy, LocalEnergy, LocalHessian, project_to_psd};
use crate::geometry::{Dual, Jet, Real};

/// Names of the velocity of an element [m/s], after its other quantities.
pub(super) const VELOCITY: [&str; 3] = ["vx", "vy", "vz"];

/// An energy of velocities, which is told every step where it begins.
pub trait RateEnergy: Energy {
    /// A step begins at the shape `start`; velocities at its end are `(q − base)/reach` [s].
    fn begin(&mut self, start: &[f64], base: &[f64], reach: f64);
    /// There are no velocities, as in statics.
    fn rest(&mut self);
}

/// A dissipation function of elements of one kind.
#[derive(Clone, Debug)]
pub struct RatePotential<E> {
    name: String,
    elements: E,
    program: Program,
    settings: Settings,
    is_density: bool,
    num_quantities: usize,
    /// Quantities of each element at the start of the step.
    shape: Vec<f64>,
    /// Σ w_k x̂_k of each element.
    base: Vec<[f64; 3]>,
    /// τ; `None` where nothing moves.
    reach: Option<f64>,
}

impl<E> RatePotential<E> {
    /// `program` is parsed with [`super::ElementKind::rate_names`]; `is_density`: its value is by rest area or rest length.
    /// Nothing moves until a step begins.
    pub fn new<const N: usize, const K: usize>(
        name: String,
        elements: E,
        program: Program,
        settings: Settings,
        is_density: bool,
    ) -> Self
    where
        E: Elements<N, K>,
    {
        Self {
            name,
            num_quantities: E::NAMES.len(),
            shape: vec![0.0; elements.count() * E::NAMES.len()],
            base: vec![[0.0; 3]; elements.count()],
            elements,
            program,
            settings,
            is_density,
            reach: None,
        }
    }

    /// The shape and x̂ of every element.
    fn start<const N: usize, const K: usize>(&mut self, start: &[f64], base: &[f64])
    where
        E: Elements<N, K>,
    {
        let used = &self.program.used()[..self.num_quantities];
        let shapes = self.shape.chunks_exact_mut(self.num_quantities);
        for (element, (shape, point)) in shapes.zip(&mut self.base).enumerate() {
            let nodes = self.elements.nodes(element).map(|dof| dof.0 as usize);
            let q = std::array::from_fn(|i| start[nodes[i / 3] + i % 3]);
            self.elements.evaluate(element, &q, used, shape);
            *point = std::array::from_fn(|axis| {
                let ends = nodes.iter().zip(E::WEIGHTS);
                ends.map(|(node, weight)| weight * base[node + axis]).sum()
            });
        }
    }

    /// m R at a velocity.
    fn power<const N: usize, const K: usize, R: Real>(&self, element: usize, velocity: [R; 3]) -> R
    where
        E: Elements<N, K>,
    {
        let mut quantities = [R::from(0.0); MAX_QUANTITIES];
        let first = element * self.num_quantities;
        let shape = &self.shape[first..first + self.num_quantities];
        for (slot, &value) in quantities.iter_mut().zip(shape) {
            *slot = R::from(value);
        }
        quantities[self.num_quantities..][..3].copy_from_slice(&velocity);
        let value = self.program.evaluate(&quantities, self.settings.values());
        match self.is_density {
            true => value * self.elements.measure(element),
            false => value,
        }
    }

    /// v for the unknowns of an element.
    fn velocity<const N: usize, const K: usize, R: Real>(
        &self,
        element: usize,
        q: &[R],
        reach: f64,
    ) -> [R; 3]
    where
        E: Elements<N, K>,
    {
        std::array::from_fn(|axis| {
            let moved = (0..K).fold(R::from(-self.base[element][axis]), |sum, k| {
                sum + q[3 * k + axis] * E::WEIGHTS[k]
            });
            moved * (1.0 / reach)
        })
    }

    /// D of one element over any numbers: the oracle of the tests.
    pub fn formula<const N: usize, const K: usize, R: Real>(&self, element: usize, q: &[R; N]) -> R
    where
        E: Elements<N, K>,
    {
        let Some(reach) = self.reach else {
            return R::from(0.0);
        };
        self.power(element, self.velocity(element, q, reach)) * reach
    }

    fn derivatives<const N: usize, const K: usize>(
        &self,
        element: usize,
        q: &SVector<f64, N>,
        kept: f64,
    ) -> LocalHessian<N>
    where
        E: Elements<N, K>,
    {
        let Some(reach) = self.reach else {
            return LocalHessian::zero();
        };
        let v = self.velocity(element, q.as_slice(), reach);
        let power = self.power(
            element,
            std::array::from_fn(|i| Jet::<3>::variable(v[i], i)),
        );
        let mut second = Matrix3::from_fn(|i, j| power.hessian(i, j) / reach);
        if kept < 1.0 {
            project_to_psd(&mut second, kept);
        }
        let weight = |i: usize| E::WEIGHTS[i / 3];
        LocalHessian {
            value: power.value() * reach,
            gradient: SVector::from_fn(|i, _| weight(i) * power.gradient()[i % 3]),
            hessian: SMatrix::from_fn(|i, j| weight(i) * weight(j) * second[(i % 3, j % 3)]),
        }
    }
}

impl<const N: usize, const K: usize, E: Elements<N, K>> LocalEnergy<N, K> for RatePotential<E> {
    const NODE_SIZES: [usize; K] = [3; K];

    fn name(&self) -> &str {
        &self.name
    }

    fn num_stencils(&self) -> usize {
        self.elements.count()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; K] {
        self.elements.nodes(stencil).map(Some)
    }

    fn set_time(&mut self, time: f64) {
        self.settings.set_time(time);
    }

    fn settings(&self) -> &[f64] {
        self.settings.told(&self.program)
    }

    fn value(&self, stencil: usize, q: &SVector<f64, N>) -> f64 {
        self.formula(stencil, &std::array::from_fn(|i| q[i]))
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, N>) -> (f64, SVector<f64, N>) {
        let Some(reach) = self.reach else {
            return (0.0, SVector::zeros());
        };
        let v = self.velocity(stencil, q.as_slice(), reach);
        let power = self.power(
            stencil,
            std::array::from_fn(|i| Dual::<3>::variable(v[i], i)),
        );
        let on_point = |i: usize| E::WEIGHTS[i / 3] * power.gradient()[i % 3];
        (power.value() * reach, SVector::from_fn(|i, _| on_point(i)))
    }

    fn hessian(&self, stencil: usize, q: &SVector<f64, N>) -> LocalHessian<N> {
        self.derivatives(stencil, q, 1.0)
    }

    fn projected_hessian(&self, stencil: usize, q: &SVector<f64, N>, kept: f64) -> LocalHessian<N> {
        self.derivatives(stencil, q, kept)
    }

    fn describe(&self, stencil: usize) -> String {
        self.elements.describe(stencil)
    }
}

impl<const N: usize, const K: usize, E: Elements<N, K>> RateEnergy
    for Assembled<RatePotential<E>, N, K>
{
    fn begin(&mut self, start: &[f64], base: &[f64], reach: f64) {
        let local = self.local_mut();
        local.start(start, base);
        local.reach = Some(reach);
    }

    fn rest(&mut self) {
        self.local_mut().reach = None;
    }
}
