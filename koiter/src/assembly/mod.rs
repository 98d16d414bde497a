//! From local energies to one sum over all unknowns: the only gather and scatter.
//!
//! A model author writes a [`LocalEnergy`] over a few unknowns; [`Assembled`] makes it an [`Energy`], which is all that
//! the solver sees. Second derivatives go into a [`SymmetricMatrix`] of fixed pattern. Sums are formed in an order that
//! does not depend on the number of threads, so results are the same bits on one core and on many.

mod assembled;
mod dof;
mod element_function;
mod energy;
mod matrix;
mod parallel;
mod projection;
mod space;

pub use assembled::Assembled;
pub use dof::{Dof, DofLayout, NodeId};
pub use element_function::{Differentiated, ElementFunction};
pub use energy::{
    Energy, LocalEnergy, LocalHessian, LowRank, PsdProjection, RestMeasures, WorstElement,
    variables,
};
pub use matrix::{CoupledPairs, HessianBuilder, Pattern, PatternBuilder, SymmetricMatrix};
pub use parallel::{ordered_sum, parallel_map};
pub use projection::project_to_psd;
pub use space::ConfigurationSpace;
