//! What goes wrong, as exceptions with the text of the command line.

use std::fmt::Write;

use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    koiter,
    SceneError,
    PyValueError,
    "The scene, a mesh or another input is wrong; the text says what, where and what to do."
);
create_exception!(
    koiter,
    RunError,
    PyRuntimeError,
    "A step failed: it found no equilibrium, or surfaces would cross."
);

/// A mistake in a scene: its message, the key where it stands, and what to do.
pub(crate) fn of_scene(error: &koiter::scene::SceneError) -> PyErr {
    let mut text = error.message.clone();
    // A `String` takes everything that is written to it.
    if !error.path.is_empty() {
        let _ = write!(text, "\n  at {}", error.path);
    }
    if let Some(location) = error.location.as_ref().filter(|place| is_file(place)) {
        let (name, line) = (&location.source.name, location.line());
        let _ = write!(text, "\n  in {name}, line {line}");
    }
    if let Some(help) = &error.help {
        let _ = write!(text, "\n  help: {help}");
    }
    let _ = write!(text, "\n  code: {}", error.kind.code());
    SceneError::new_err(text)
}

/// The text of a scene that was made in Python is nothing that a person has seen.
fn is_file(location: &koiter::scene::Location) -> bool {
    !location.source.name.starts_with('<')
}

/// Another input that is wrong.
pub(crate) fn of_input(error: impl std::fmt::Display) -> PyErr {
    SceneError::new_err(error.to_string())
}

/// A step that failed.
pub(crate) fn of_run(error: impl std::fmt::Display) -> PyErr {
    RunError::new_err(error.to_string())
}
