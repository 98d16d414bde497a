//! Damping of an energy that is written as an expression: of the rates of the quantities it names, as it is stiff in them.
//!
//! ```text
//! D(q) = b/τ Σ_s m_s ½ dᵀ F_s d,    d = quantities of s − those without motion
//! ```
//!
//! F_s the positive part of ∇²f there, by the quantities that change with the shape ([`damped_part`]). For f quadratic in strains it
//! is the damping of a Kelvin–Voigt material, `−b ∂sᵀ ∇²f ṡ`. Quantities that turn with the shell leave rigid motions alone; of
//! positions and directions, which do not, it damps what f holds back. An f that is linear in them (a weight, a tension) has
//! none, nor has what of f is linear in a quantity each. Angles count as they are, in (−π, π]: around a closed hinge the damping
//! of a step is not what it should be.

use nalgebra::DMatrix;

use super::elements::{Elements, MAX_QUANTITIES, is_of_shape};
use super::potential::Potential;
use super::tangent::damped_part;
use crate::assembly::{Dof, ElementFunction};
use crate::geometry::{Jet, Real};

/// The rates of the quantities of a [`Potential`].
#[derive(Clone, Debug)]
pub struct PotentialDamping<E> {
    of: Potential<E>,
    /// The quantities that count, of those with names: what is used and not constant.
    used: Vec<usize>,
    /// The place of an angle among them: the nearest of its values counts.
    angle: Option<usize>,
    /// Quantities without motion, of every element.
    rest: Vec<f64>,
    /// F of every element by rows, over the used quantities.
    tangents: Vec<f64>,
}

impl<E> PotentialDamping<E> {
    /// Of this energy.
    pub fn new<const N: usize, const K: usize>(of: Potential<E>) -> Self
    where
        E: Elements<N, K>,
    {
        let used: Vec<usize> = (0..E::NAMES.len())
            .filter(|&i| of.program().used()[i] && is_of_shape(E::NAMES[i]))
            .collect();
        Self {
            angle: used.iter().position(|&i| E::NAMES[i] == "angle"),
            rest: vec![0.0; of.num_elements() * E::NAMES.len()],
            tangents: vec![0.0; of.num_elements() * used.len() * used.len()],
            used,
            of,
        }
    }

    /// F; 0 where f is not defined.
    fn tangent(&self, quantities: &[f64]) -> DMatrix<f64> {
        let count = self.used.len();
        let mut jets = [Jet::<MAX_QUANTITIES>::from(0.0); MAX_QUANTITIES];
        for (i, &value) in quantities.iter().enumerate() {
            jets[i] = Jet::variable(value, i);
        }
        let f = self.of.value_of(&jets);
        let tangent = DMatrix::from_fn(count, count, |i, j| f.hessian(self.used[i], self.used[j]));
        damped_part(&tangent)
    }
}

impl<const N: usize, const K: usize, E: Elements<N, K>> ElementFunction<N, K>
    for PotentialDamping<E>
{
    const MEASURES: usize = E::NAMES.len();

    fn name(&self) -> &str {
        self.of.name()
    }

    fn num_elements(&self) -> usize {
        self.of.num_elements()
    }

    fn nodes(&self, element: usize) -> [Option<Dof>; K] {
        self.of.nodes(element)
    }

    fn energy<R: Real>(&self, element: usize, q: &[R; N]) -> R {
        let quantities = self.of.quantities(element, q);
        let rest = &self.rest[element * E::NAMES.len()..];
        let count = self.used.len();
        let tangent = &self.tangents[element * count * count..];
        let mut differences = [R::from(0.0); MAX_QUANTITIES];
        for (difference, &i) in differences.iter_mut().zip(&self.used) {
            *difference = quantities[i] - rest[i];
        }
        if let Some(angle) = self.angle {
            let turns = (differences[angle].value() / std::f64::consts::TAU).round();
            differences[angle] = differences[angle] - turns * std::f64::consts::TAU;
        }
        let mut sum = R::from(0.0);
        for i in 0..count {
            for j in 0..count {
                sum = sum + differences[i] * differences[j] * (0.5 * tangent[i * count + j]);
            }
        }
        sum * self.of.scale(element)
    }

    fn set_time(&mut self, time: f64) {
        ElementFunction::set_time(&mut self.of, time);
    }

    fn measure(&self, element: usize, q: &[f64; N], measures: &mut [f64]) {
        measures.copy_from_slice(&self.of.quantities(element, q)[..E::NAMES.len()]);
    }

    fn rest(&self, element: usize, measures: &mut [f64]) {
        measures.copy_from_slice(&self.rest[element * E::NAMES.len()..][..E::NAMES.len()]);
    }

    fn set_rest(&mut self, element: usize, measures: &[f64]) {
        self.rest[element * E::NAMES.len()..][..E::NAMES.len()].copy_from_slice(measures);
        let tangent = self.tangent(measures);
        let size = tangent.len();
        self.tangents[element * size..][..size].copy_from_slice(tangent.as_slice());
    }

    fn describe(&self, element: usize) -> String {
        self.of.describe(element)
    }
}
