//! From one state to the next.

mod arc_length;
mod backward_difference;
mod damping;
mod diagnostics;
mod energy_monitor;
mod linear;
mod linear_static;
mod load_pattern;
mod newmark;
mod offset_surface;
mod quasi_static;
mod report;
mod rest_directors;
mod shell_part;
mod stable_step;
mod state;
mod system;

pub use arc_length::{ArcLength, ArcLengthOptions, PathPoint};
pub use backward_difference::{Bdf2, ImplicitEuler};
pub use damping::{Damper, Damping};
pub use diagnostics::{Diagnostics, LargestForce};
pub use linear::{BucklingMode, LinearError, VibrationMode};
pub use linear_static::LinearStatic;
pub use load_pattern::LoadPattern;
pub use newmark::Newmark;
pub use offset_surface::OffsetSurfaces;
pub use quasi_static::QuasiStatic;
pub use report::{StepError, StepReport};
pub use rest_directors::{relax_directors, relax_edge_points};
pub use shell_part::ShellPart;
pub use state::{Memory, StableStep, State};
pub use system::{Prescribed, System};

/// Advances a state.
pub trait Integrator: Send + Sync {
    /// Called before a step of size `dt` [s] while loads, clamps and what is held are still as at its start: for what a method has to know
    /// of that state and does not remember.
    ///
    /// # Errors
    /// See [`StepError`].
    fn begin(
        &mut self,
        _system: &mut System,
        _state: &mut State,
        _is_fixed: &[bool],
        _dt: f64,
    ) -> Result<(), StepError> {
        Ok(())
    }

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
