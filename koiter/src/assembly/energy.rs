//! What a model author writes, and what the solver sees.

use nalgebra::{SMatrix, SVector};

use super::{Dof, DofLayout, HessianBuilder, Pattern, PatternBuilder, project_to_psd};
use crate::geometry::{Jet, Real};

/// What to do with negative curvature of an energy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PsdProjection {
    /// The exact Hessian.
    Exact,
    /// Keeps this share, between 0 and 1, of the negative curvature of every element.
    Partial(f64),
    /// A positive semidefinite approximation, element by element.
    #[default]
    Clamp,
}

impl PsdProjection {
    /// The share of negative curvature that is kept.
    pub fn kept(self) -> f64 {
        match self {
            Self::Exact => 1.0,
            Self::Partial(kept) => kept,
            Self::Clamp => 0.0,
        }
    }
}

/// Value, gradient and Hessian of one element.
#[derive(Clone, Copy, Debug)]
pub struct LocalHessian<const N: usize> {
    /// Energy [J].
    pub value: f64,
    /// Derivatives by the element's unknowns.
    pub gradient: SVector<f64, N>,
    /// Second derivatives; symmetric.
    pub hessian: SMatrix<f64, N, N>,
}

impl<const N: usize> LocalHessian<N> {
    /// All zero.
    pub fn zero() -> Self {
        Self {
            value: 0.0,
            gradient: SVector::zeros(),
            hessian: SMatrix::zeros(),
        }
    }
}

/// The derivatives of a formula over jets.
impl<const N: usize> From<Jet<N>> for LocalHessian<N> {
    fn from(jet: Jet<N>) -> Self {
        Self {
            value: jet.value(),
            gradient: SVector::from_fn(|i, _| jet.gradient()[i]),
            hessian: SMatrix::from_fn(|i, j| jet.hessian(i, j)),
        }
    }
}

/// The unknowns of an element as jets by which to differentiate.
pub fn variables<const N: usize>(q: &SVector<f64, N>) -> [Jet<N>; N] {
    std::array::from_fn(|i| Jet::variable(q[i], i))
}

/// An energy that is a sum over elements of a few unknowns each: Φ(q) = Σ_s φ_s(q_s).
///
/// `N` unknowns in `K` nodes of sizes [`Self::NODE_SIZES`]. A node may be absent (no neighbour across a boundary edge);
/// its entries of `q` are then 0 and its derivatives are ignored.
pub trait LocalEnergy<const N: usize, const K: usize>: Send + Sync {
    /// Unknowns of each local node; they sum to `N`.
    const NODE_SIZES: [usize; K];
    /// Whether [`Self::max_step`] says anything: most energies are spared the question.
    const BOUNDS_STEPS: bool = false;
    /// Measures of strain of an element, if φ_s depends on them and on their rest values alone: see [`RestMeasures`].
    const MEASURES: usize = 0;
    /// Whether measures are angles that are followed beyond half a turn.
    const HAS_BRANCHES: bool = false;
    /// Name in reports.
    fn name(&self) -> &str;
    /// Number of elements.
    fn num_stencils(&self) -> usize;
    /// First unknown of each node of an element.
    fn nodes(&self, stencil: usize) -> [Option<Dof>; K];
    /// See [`Energy::set_time`].
    fn set_time(&mut self, _time: f64) {}
    /// See [`Energy::settings`].
    fn settings(&self) -> &[f64] {
        &[]
    }
    /// φ_s [J].
    fn value(&self, stencil: usize, q: &SVector<f64, N>) -> f64;
    /// φ_s and its gradient.
    fn gradient(&self, stencil: usize, q: &SVector<f64, N>) -> (f64, SVector<f64, N>);
    /// φ_s with gradient and the true Hessian.
    fn hessian(&self, stencil: usize, q: &SVector<f64, N>) -> LocalHessian<N>;
    /// φ_s with gradient and a Hessian of whose negative curvature only the share `kept` is left; positive semidefinite
    /// for 0. Energies that know the small space in which their Hessian is indefinite override this; the default
    /// decomposes the whole matrix.
    fn projected_hessian(&self, stencil: usize, q: &SVector<f64, N>, kept: f64) -> LocalHessian<N> {
        let mut local = self.hessian(stencil, q);
        project_to_psd(&mut local.hessian, kept);
        local
    }
    /// The largest fraction of `direction` that may be taken from `q`, at most 1; φ_s is defined on all of it.
    fn max_step(&self, _stencil: usize, _q: &SVector<f64, N>, _direction: &SVector<f64, N>) -> f64 {
        1.0
    }
    /// Whether φ_s is defined at `q`.
    fn is_admissible(&self, _stencil: usize, _q: &SVector<f64, N>) -> bool {
        true
    }
    /// Writes the [`Self::MEASURES`] of an element.
    fn measure(&self, _stencil: usize, _q: &SVector<f64, N>, _measures: &mut [f64]) {}
    /// Writes their rest values.
    fn rest(&self, _stencil: usize, _measures: &mut [f64]) {}
    /// Replaces their rest values.
    fn set_rest(&mut self, _stencil: usize, _measures: &[f64]) {}
    /// See [`RestMeasures::follow`].
    fn follow(&mut self, _stencil: usize, _measures: &[f64]) {}
    /// Across which edges a face takes no notice of its neighbour, as at a boundary: see [`RestMeasures::set_present`].
    fn set_cut(&mut self, _stencil: usize, _edges: [bool; 3]) {}
    /// See [`Energy::add_stress_stiffness`]; `None` of energies without stress.
    fn stress_stiffness(
        &self,
        _stencil: usize,
        _q: &SVector<f64, N>,
        _motion: &SVector<f64, N>,
    ) -> Option<SMatrix<f64, N, N>> {
        None
    }
    /// The element in the user's terms.
    fn describe(&self, stencil: usize) -> String;
    /// See [`Energy::at_held_positions`]; `unknowns` gives those of an element.
    fn at_held_positions<'a>(
        &'a self,
        _unknowns: &(dyn Fn(usize) -> SVector<f64, N> + Sync),
        _layout: &DofLayout,
    ) -> Option<Box<dyn Energy + 'a>> {
        None
    }
}

/// The element of an energy that resists most, for reports.
#[derive(Clone, Debug)]
pub struct WorstElement {
    /// The element in the user's terms.
    pub description: String,
    /// One of its unknowns, which says what it is part of; `None` where the description says so.
    pub unknown: Option<Dof>,
    /// Norm of its gradient [N or N·m]; not finite if the energy is not.
    pub gradient_norm: f64,
}

/// What an energy compares: measures of strain `s(q)`, and the values `s̄` that they have at rest, Φ = Φ(s(q) − s̄).
///
/// Lists are those of all elements in order, each with its measures: strains, hinge angles [rad], second fundamental forms
/// [1/m]. None of them changes under rigid motions.
pub trait RestMeasures {
    /// s(q).
    fn measure(&self, q: &[f64]) -> Vec<f64>;
    /// s̄.
    fn rest(&self) -> Vec<f64>;
    /// Replaces s̄.
    fn set_rest(&mut self, rest: &[f64]);
    /// Whether measures are angles that are followed beyond half a turn.
    fn has_branches(&self) -> bool;
    /// Takes the branch of each angle that is nearest to these measures from now on.
    fn follow(&mut self, measures: &[f64]);
    /// Φ becomes this factor times what it was made as.
    fn set_factor(&mut self, factor: f64);
    /// Elements that are not there give nothing from now on; where elements are faces, `cuts` says across which of their
    /// edges a neighbour has gone: they end there as at a boundary. Energies of whole shells and of stars of vertices take no
    /// notice: shells that burn have none.
    fn set_present(&mut self, _is_there: &[bool], _cuts: &[[bool; 3]]) {}
}

/// The matrix `weight · vector vectorᵀ`.
#[derive(Clone, Debug)]
pub struct LowRank {
    /// Not zero; negative where the energy is concave, which a search for a minimum leaves out.
    pub weight: f64,
    /// One entry an unknown.
    pub vector: Vec<f64>,
}

/// An energy over all unknowns, as solver and integrator see it.
pub trait Energy: Send + Sync {
    /// Name in reports.
    fn name(&self) -> &str;
    /// Takes the time [s] at the end of the coming step: energies that depend on it change here.
    fn set_time(&mut self, _time: f64) {}
    /// What it is told from outside, as it is at this time: where that changes, so may its stiffness.
    fn settings(&self) -> &[f64] {
        &[]
    }
    /// Called before a minimisation starts at `q`: contact finds its candidates here.
    fn prepare(&mut self, _q: &[f64]) {}
    /// Called before derivatives are asked for at `q`: contact collects its active pairs here.
    fn begin_iteration(&mut self, _q: &[f64]) {}
    /// Φ(q) [J].
    fn value(&self, q: &[f64]) -> f64;
    /// Adds ∇Φ(q).
    fn add_gradient(&self, q: &[f64], gradient: &mut [f64]);
    /// Adds ∇Φ(q) and returns Φ(q), where one evaluation gives both.
    fn add_value_and_gradient(&self, q: &[f64], gradient: &mut [f64]) -> f64 {
        self.add_gradient(q, gradient);
        self.value(q)
    }
    /// Adds ∇Φ(q) and ∇²Φ(q). `q` is that of the last [`Energy::begin_iteration`].
    fn add_derivatives(
        &self,
        q: &[f64],
        projection: PsdProjection,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    );
    /// What belongs to ∇²Φ but couples too much with too much to be stored: matrices of rank one.
    /// [`Energy::add_derivatives`] leaves it out.
    fn low_rank(&self, _q: &[f64]) -> Vec<LowRank> {
        Vec::new()
    }
    /// Registers the pairs of nodes that the Hessian couples at `q`.
    fn add_to_pattern(&self, _q: &[f64], _pattern: &mut PatternBuilder) {}
    /// Whether the pairs of nodes depend on `q`.
    fn has_changing_pattern(&self) -> bool {
        false
    }
    /// Looks up the positions of its entries in a new pattern.
    fn bind(&mut self, _pattern: &Pattern) {}
    /// The largest fraction of `direction` that may be taken from `q`, at most 1. What lies between stays valid: contact
    /// keeps the candidates of the whole way for the evaluations of the line search.
    fn max_step(&mut self, _q: &[f64], _direction: &[f64]) -> f64 {
        1.0
    }
    /// Measures of strain and their rest values, if Φ depends on them alone.
    fn rest_measures(&self) -> Option<&dyn RestMeasures> {
        None
    }
    /// [`Self::rest_measures`], to change the rest values.
    fn rest_measures_mut(&mut self) -> Option<&mut dyn RestMeasures> {
        None
    }
    /// Whether Φ is defined at `q`.
    fn is_admissible(&self, _q: &[f64]) -> bool {
        true
    }
    /// An element that is not defined at `q`, in the user's terms.
    fn undefined_element(&self, _q: &[f64]) -> Option<String> {
        None
    }
    /// The element that resists most at `q`.
    fn worst_element(&self, _q: &[f64]) -> Option<WorstElement> {
        None
    }
    /// What limited the last step, in the user's terms.
    fn step_limiter(&self) -> Option<String> {
        None
    }
    /// Adds the stiffness that the stresses of a small motion from `q` lend, `δσ : ∂²ε` with `δσ = C δε`: of the change of
    /// the Hessian along the motion the part that is not due to the change of shape.
    fn add_stress_stiffness(&self, _q: &[f64], _motion: &[f64], _hessian: &mut HessianBuilder<'_>) {
    }
    /// The same energy over its directors alone, with positions held at those of `q`; `None` of energies that have no
    /// directors, or no cheaper form.
    fn at_held_positions<'a>(
        &'a self,
        _q: &[f64],
        _layout: &DofLayout,
    ) -> Option<Box<dyn Energy + 'a>> {
        None
    }
}
