//! What changes the rest state of a shell while it moves: curvature that is prescribed over time, creases, plastic flow,
//! shrinkage by fire.
//!
//! An energy compares measures of strain with rest values ([`crate::assembly::RestMeasures`]); of bending these are hinge
//! angles or second fundamental forms. A [`RestState`] holds the rest values of one shell. Processes move it before every
//! step, from the shape at its start, and are the only ones to do so after a shell is made; the step then sees the new
//! values, and damping the rate at which they came.
//!
//! Rest frames stay what they are, and there is no plasticity of the membrane; shrinkage moves its rest strain.

mod crease;
mod curl;
mod shrinkage;
mod yielding;

pub use crease::{Crease, Fold};
pub use curl::{Curl, on_cylinder};
pub use shrinkage::{Bent, Shrinkage, Stretched};
pub use yielding::{Measure, Yielding};

/// The rest state of one shell, as far as processes change it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RestState {
    /// Rest values of the measures of bending, element by element: hinge angles [rad] or second fundamental forms [1/m].
    pub curvature: Vec<f64>,
    /// How far each measure of them has flowed in all, forwards and backwards: yielding hardens by it. Empty: nothing yields.
    pub flow: Vec<f64>,
    /// Rest values of the measures of the membranes, which shrinkage moves; empty: nothing shrinks.
    pub strain: Vec<f64>,
}

/// What a process sees of a step.
#[derive(Clone, Copy, Debug)]
pub struct Window<'a> {
    /// The measures of bending at the start of the step.
    pub measured: &'a [f64],
    /// The factor of the process at the start and the end of the step.
    pub factors: [f64; 2],
    /// Length of the step [s].
    pub dt: f64,
}

/// Changes a rest state over time.
pub trait Process: Send + Sync {
    /// Moves the rest state over one step.
    fn advance(&self, rest: &mut RestState, window: &Window<'_>);
}
