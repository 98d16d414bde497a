//! Energies whose derivatives nobody writes: one formula over any numbers.
//!
//! ```
//! use koiter::assembly::{Assembled, Differentiated, Dof, DofLayout, ElementFunction, Energy};
//! use koiter::geometry::{Real, over_numbers::{norm, point, sub}};
//!
//! /// A rubber band between two points: k/2 (ℓ − ℓ̄)².
//! struct Band {
//!     ends: [Dof; 2],
//!     stiffness: f64,
//!     rest_length: f64,
//! }
//!
//! impl ElementFunction<6, 2> for Band {
//!     fn name(&self) -> &str {
//!         "band"
//!     }
//!     fn num_elements(&self) -> usize {
//!         1
//!     }
//!     fn nodes(&self, _: usize) -> [Option<Dof>; 2] {
//!         self.ends.map(Some)
//!     }
//!     fn energy<R: Real>(&self, _: usize, q: &[R; 6]) -> R {
//!         let longer = norm(&sub(&point(q, 1), &point(q, 0))) - self.rest_length;
//!         longer * longer * (0.5 * self.stiffness)
//!     }
//! }
//!
//! let mut layout = DofLayout::new();
//! let first = layout.push_nodes(2, 3, true);
//! let band = Band { ends: [first, Dof(first.0 + 3)], stiffness: 10.0, rest_length: 1.0 };
//! let energy = Assembled::new(Differentiated(band), &layout);
//! let stretched = energy.value(&[0.0, 0.0, 0.0, 1.2, 0.0, 0.0]);
//! assert!((stretched - 0.5 * 10.0 * 0.2 * 0.2).abs() < 1e-15);
//! ```

use nalgebra::SVector;

use super::{Dof, LocalEnergy, LocalHessian, variables};
use crate::geometry::{Dual, Real};

/// An energy that is a sum over elements, as one formula; its gradient and Hessian follow by dual numbers.
///
/// `N` unknowns in `K` nodes, as in [`LocalEnergy`]. It costs several times as much as derivatives by hand, and negative
/// curvature is found in the whole matrix of an element; that is the price of a page less to write and to get wrong.
pub trait ElementFunction<const N: usize, const K: usize>: Send + Sync {
    /// Unknowns of each node; they sum to `N`. Points have three, as by default.
    const NODE_SIZES: [usize; K] = [3; K];
    /// See [`LocalEnergy::MEASURES`].
    const MEASURES: usize = 0;
    /// Name in reports.
    fn name(&self) -> &str;
    /// Number of elements.
    fn num_elements(&self) -> usize;
    /// First unknown of each node of an element; `None` where there is none, whose entries of `q` are then 0.
    fn nodes(&self, element: usize) -> [Option<Dof>; K];
    /// Energy of an element [J].
    fn energy<R: Real>(&self, element: usize, q: &[R; N]) -> R;
    /// See [`super::Energy::set_time`].
    fn set_time(&mut self, _time: f64) {}
    /// See [`super::Energy::settings`].
    fn settings(&self) -> &[f64] {
        &[]
    }
    /// Writes the [`Self::MEASURES`] of an element.
    fn measure(&self, _element: usize, _q: &[f64; N], _measures: &mut [f64]) {}
    /// Writes their rest values.
    fn rest(&self, _element: usize, _measures: &mut [f64]) {}
    /// Replaces their rest values.
    fn set_rest(&mut self, _element: usize, _measures: &[f64]) {}
    /// The element in the user's terms.
    fn describe(&self, element: usize) -> String {
        format!("element {element}")
    }
}

/// An [`ElementFunction`] with its derivatives.
#[derive(Clone, Debug)]
pub struct Differentiated<F>(pub F);

impl<const N: usize, const K: usize, F: ElementFunction<N, K>> LocalEnergy<N, K>
    for Differentiated<F>
{
    const NODE_SIZES: [usize; K] = F::NODE_SIZES;
    const MEASURES: usize = F::MEASURES;

    fn name(&self) -> &str {
        self.0.name()
    }

    fn num_stencils(&self) -> usize {
        self.0.num_elements()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; K] {
        self.0.nodes(stencil)
    }

    fn set_time(&mut self, time: f64) {
        self.0.set_time(time);
    }

    fn settings(&self) -> &[f64] {
        self.0.settings()
    }

    fn value(&self, stencil: usize, q: &SVector<f64, N>) -> f64 {
        self.0.energy(stencil, &std::array::from_fn(|i| q[i]))
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, N>) -> (f64, SVector<f64, N>) {
        let q: [Dual<N>; N] = std::array::from_fn(|i| Dual::variable(q[i], i));
        let energy = self.0.energy(stencil, &q);
        (energy.value(), SVector::from(*energy.gradient()))
    }

    fn hessian(&self, stencil: usize, q: &SVector<f64, N>) -> LocalHessian<N> {
        self.0.energy(stencil, &variables(q)).into()
    }

    fn measure(&self, stencil: usize, q: &SVector<f64, N>, measures: &mut [f64]) {
        (self.0).measure(stencil, &std::array::from_fn(|i| q[i]), measures);
    }

    fn rest(&self, stencil: usize, measures: &mut [f64]) {
        self.0.rest(stencil, measures);
    }

    fn set_rest(&mut self, stencil: usize, measures: &[f64]) {
        self.0.set_rest(stencil, measures);
    }

    fn describe(&self, stencil: usize) -> String {
        self.0.describe(stencil)
    }
}
