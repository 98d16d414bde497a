//! From one state to the next.

mod report;

pub use report::{StepError, StepReport};
