//! Strains of bending models that are written without rest values, and the squares of their differences.
//!
//! ```text
//! Φ = ½ Σ_s k_s |s(q) − s̄|²
//! ```
//!
//! With s̄ = 0 it is the model itself, up to what of it is no bending. As damping (s̄ the strains at the start of a step, see
//! [`crate::integrate::Damping`]) it follows the rate of strains that turn with the shell and have a sign, so neither rigid motions nor
//! the passage through the flat shape disturb it.

use crate::assembly::{Dof, ElementFunction, LocalEnergy};
use crate::geometry::Real;

/// Strains of an element at most.
const MOST: usize = 3;

/// A model of bending that is a sum of squares.
pub trait BendingStrains<const N: usize, const K: usize>: LocalEnergy<N, K> {
    /// Number of strains of an element, at most three.
    const STRAINS: usize;
    /// Writes them; rigid motions do not change them, and they are 0 when flat.
    fn strains<R: Real>(&self, stencil: usize, q: &[R; N], strains: &mut [R]);
    /// k: the energy of an element is ½ k Σ s² [J].
    fn strain_stiffness(&self, stencil: usize) -> f64;
}

/// Squares of differences of the strains of a model to rest values, all 0 at first.
pub struct StrainSquares<L> {
    model: L,
    rest: Vec<f64>,
}

impl<L> StrainSquares<L> {
    /// Of this model.
    pub fn new<const N: usize, const K: usize>(model: L) -> Self
    where
        L: BendingStrains<N, K>,
    {
        Self {
            rest: vec![0.0; model.num_stencils() * L::STRAINS],
            model,
        }
    }

    fn strains<const N: usize, const K: usize, R: Real>(
        &self,
        element: usize,
        q: &[R; N],
    ) -> [R; MOST]
    where
        L: BendingStrains<N, K>,
    {
        let mut strains = [R::from(0.0); MOST];
        self.model.strains(element, q, &mut strains[..L::STRAINS]);
        strains
    }
}

impl<const N: usize, const K: usize, L: BendingStrains<N, K>> ElementFunction<N, K>
    for StrainSquares<L>
{
    const NODE_SIZES: [usize; K] = L::NODE_SIZES;
    const MEASURES: usize = L::STRAINS;

    fn name(&self) -> &str {
        self.model.name()
    }

    fn num_elements(&self) -> usize {
        self.model.num_stencils()
    }

    fn nodes(&self, element: usize) -> [Option<Dof>; K] {
        self.model.nodes(element)
    }

    fn energy<R: Real>(&self, element: usize, q: &[R; N]) -> R {
        let rest = &self.rest[element * L::STRAINS..];
        let strains = self.strains(element, q);
        let differences = (strains.iter().zip(rest)).take(L::STRAINS);
        let squares = differences.fold(R::from(0.0), |sum, (strain, rest)| {
            let difference = *strain - *rest;
            sum + difference * difference
        });
        squares * (0.5 * self.model.strain_stiffness(element))
    }

    fn measure(&self, element: usize, q: &[f64; N], measures: &mut [f64]) {
        measures.copy_from_slice(&self.strains(element, q)[..L::STRAINS]);
    }

    fn rest(&self, element: usize, measures: &mut [f64]) {
        measures.copy_from_slice(&self.rest[element * L::STRAINS..][..L::STRAINS]);
    }

    fn set_rest(&mut self, element: usize, measures: &[f64]) {
        self.rest[element * L::STRAINS..][..L::STRAINS].copy_from_slice(measures);
    }

    fn describe(&self, element: usize) -> String {
        self.model.describe(element)
    }
}
