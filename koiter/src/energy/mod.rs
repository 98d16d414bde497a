//! Local energies: one file, one model. Each opens with its formula, symbols, units, source and limits.

mod discrete_membrane;
mod gravity;
mod inertia;
mod membrane;
mod strain_limit;

pub mod bending;
pub mod expression;
pub mod loads;

pub use discrete_membrane::{
    DiscreteStiffness, EdgeLengths, FaceAreas, rest_lengths as edge_rest_lengths,
};
pub use gravity::Gravity;
pub use inertia::Inertia;
pub use membrane::Membrane;
pub use strain_limit::{StrainLimit, StretchLimit};
