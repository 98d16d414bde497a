//! From one state to the next.

mod arc_length;
mod diagnostics;
mod implicit_euler;
mod linear;
mod linear_static;
mod load_pattern;
mod offset_surface;
mod quasi_static;
mod report;
mod rest_directors;
mod system;

pub use arc_length::{ArcLength, ArcLengthOptions, PathPoint};
pub use diagnostics::{Diagnostics, LargestForce};
pub use implicit_euler::ImplicitEuler;
pub use linear::{BucklingMode, LinearError, VibrationMode};
pub use linear_static::LinearStatic;
pub use load_pattern::LoadPattern;
pub use offset_surface::OffsetSurfaces;
pub use quasi_static::QuasiStatic;
pub use report::{StepError, StepReport};
pub use rest_directors::{relax_directors, relax_edge_points};
pub use system::{Prescribed, ShellPart, State, System};

/// Advances a state.
pub trait Integrator: Send {
    /// One step of size `dt` [s] towards the prescribed values at its end.
    ///
    /// # Errors
    /// See [`StepError`]; then `state` is as it was. Not converging is told in the report.
    fn step(
        &mut self,
        system: &mut System,
        state: &mut State,
        prescribed: &Prescribed,
        dt: f64,
    ) -> Result<StepReport, StepError>;
}
