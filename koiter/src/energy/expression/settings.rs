//! What an expression is told from outside: the time, and its parameters.

use std::fmt;
use std::sync::Arc;

use super::program::Program;

/// A parameter: its value at a time [s].
pub type Parameter = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// The time and the values of parameters at that time.
#[derive(Clone)]
pub struct Settings {
    parameters: Vec<Parameter>,
    /// Time [s], then one value a parameter.
    values: Vec<f64>,
}

impl Settings {
    /// Parameters in the order of [`super::Names::parameters`], at time 0.
    pub fn new(parameters: Vec<Parameter>) -> Self {
        let mut settings = Self {
            values: vec![0.0; parameters.len() + 1],
            parameters,
        };
        settings.set_time(0.0);
        settings
    }

    /// Moves to a time [s].
    pub(super) fn set_time(&mut self, time: f64) {
        self.values[0] = time;
        for (value, parameter) in self.values[1..].iter_mut().zip(&self.parameters) {
            *value = parameter(time);
        }
    }

    /// Time, then parameters.
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Parameters, after the time where a program speaks of it.
    pub(super) fn told(&self, program: &Program) -> &[f64] {
        let first = usize::from(!program.uses_time());
        &self.values[first..]
    }
}

impl fmt::Debug for Settings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Settings").field(&self.values).finish()
    }
}
