//! An energy of the shape, by an expression.
//!
//! ```text
//! Φ(q) = Σ_s m_s f(quantities of s, parameters, t)
//! ```
//!
//! m_s is 1 where f is the energy of an element [J], or its rest area or rest length where f is a density [J/m² or J/m]. The
//! derivatives are those of f by dual numbers, exact for what is written. Where f is not defined (the root of a negative
//! number, a division by zero) it is NaN, and no line search goes there; that does not keep a step from ending close to it.

use super::elements::{Elements, MAX_QUANTITIES};
use super::program::Program;
use super::settings::Settings;
use crate::assembly::{Dof, ElementFunction};
use crate::geometry::Real;

/// What an expression is of: its program, what it is told, and whether it counts by measure.
#[derive(Clone, Debug)]
pub struct Potential<E> {
    name: String,
    elements: E,
    program: Program,
    settings: Settings,
    is_density: bool,
}

impl<E> Potential<E> {
    /// `program` is parsed with the names of these elements; `is_density`: its value is by rest area or rest length.
    pub fn new(
        name: String,
        elements: E,
        program: Program,
        settings: Settings,
        is_density: bool,
    ) -> Self {
        Self {
            name,
            elements,
            program,
            settings,
            is_density,
        }
    }

    pub(super) fn program(&self) -> &Program {
        &self.program
    }

    /// f for these quantities.
    pub(super) fn value_of<R: Real>(&self, quantities: &[R]) -> R {
        self.program.evaluate(quantities, self.settings.values())
    }

    /// Those quantities of an element that are used.
    pub(super) fn quantities<const N: usize, const K: usize, R: Real>(
        &self,
        element: usize,
        q: &[R; N],
    ) -> [R; MAX_QUANTITIES]
    where
        E: Elements<N, K>,
    {
        let mut quantities = [R::from(0.0); MAX_QUANTITIES];
        let used = self.program.used();
        self.elements.evaluate(element, q, used, &mut quantities);
        quantities
    }

    /// m of an element.
    pub(super) fn scale<const N: usize, const K: usize>(&self, element: usize) -> f64
    where
        E: Elements<N, K>,
    {
        match self.is_density {
            true => self.elements.measure(element),
            false => 1.0,
        }
    }
}

impl<const N: usize, const K: usize, E: Elements<N, K>> ElementFunction<N, K> for Potential<E> {
    fn name(&self) -> &str {
        &self.name
    }

    fn num_elements(&self) -> usize {
        self.elements.count()
    }

    fn nodes(&self, element: usize) -> [Option<Dof>; K] {
        self.elements.nodes(element).map(Some)
    }

    fn energy<R: Real>(&self, element: usize, q: &[R; N]) -> R {
        self.value_of(&self.quantities(element, q)) * self.scale(element)
    }

    fn set_time(&mut self, time: f64) {
        self.settings.set_time(time);
    }

    fn settings(&self) -> &[f64] {
        self.settings.told(&self.program)
    }

    fn describe(&self, element: usize) -> String {
        self.elements.describe(element)
    }
}
