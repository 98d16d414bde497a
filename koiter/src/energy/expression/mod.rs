//! Energies as text: what a user writes into a scene, parsed once and evaluated over numbers that carry derivatives.
//!
//! ```text
//! text     := { name '=' sum ';' } sum            names stand for what was written before
//! sum      := product { ('+' | '-') product }
//! product  := signed { ('*' | '/') signed }
//! signed   := [ '+' | '-' ] signed | power        −a^b is −(a^b)
//! power    := atom [ '^' signed ]                 a^b^c is a^(b^c)
//! atom     := number | name | function '(' sum { ',' sum } ')' | '(' sum ')'
//! ```
//!
//! Names are quantities of an element ([`Elements::NAMES`]), parameters, `time` [s] and `pi`; functions are those of
//! [`FUNCTIONS`]. A [`Program`] is a list of instructions for a stack: no allocation, no recursion. It gives
//!
//! - a [`Potential`]: Φ = Σ φ over elements, which depends on the shape alone, and is stored energy;
//! - a [`RatePotential`]: a dissipation function R(v) [W] of the velocities of elements, whose force is −∂R/∂v: drag, wind,
//!   and with R = −F·v any force F that follows the shape at the start of the step;
//! - a [`WholePotential`]: a function of the volume and the area of a whole shell.
//!
//! Input is bounded ([`MAX_TEXT`] and the like), so that no text can exhaust time or memory.

mod elements;
mod error;
mod functions;
mod kind;
mod parse;
mod potential;
mod potential_damping;
mod program;
mod rate_potential;
mod settings;
mod tangent;
mod tokens;
mod whole_potential;
mod whole_shell;

pub(crate) use elements::is_of_shape;
pub use elements::{
    EdgeElement, Edges, Elements, FaceElement, Faces, HingeElement, Hinges, VertexElement, Vertices,
};
pub use error::ExpressionError;
pub use functions::{FUNCTIONS, FunctionInfo};
pub use kind::ElementKind;
pub use parse::{MAX_INSTRUCTIONS, MAX_NESTING, MAX_PARAMETERS, MAX_TEXT, Names};
pub use potential::Potential;
pub use potential_damping::PotentialDamping;
pub use program::Program;
pub use rate_potential::{RateEnergy, RatePotential};
pub use settings::{Parameter, Settings};
pub use whole_potential::{WholeDamping, WholePotential};

#[cfg(test)]
mod tests;
