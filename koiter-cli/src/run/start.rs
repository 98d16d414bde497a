//! From a model to a simulation.

use std::path::Path;

use koiter::scene::model::Model;
use koiter::scene::{BuildError, Simulation};

use crate::debug_mesh;
use crate::failure::Failure;

/// Sets the simulation up; a start that is refused is an error of the input.
pub(crate) fn start(model: &Model, debug_mesh: Option<&Path>) -> Result<Simulation, Failure> {
    Simulation::new(model.clone()).map_err(|error| {
        let help = match (&error, debug_mesh) {
            (BuildError::Start(start), Some(path)) => match debug_mesh::write(path, model, start) {
                Ok(()) => format!("the faces at fault are red in {}", path.display()),
                Err(refusal) => format!("cannot write {}: {refusal}", path.display()),
            },
            (BuildError::Start(_), None) => {
                "--debug-mesh FILE.ply writes the surfaces with the faces at fault in red"
                    .to_owned()
            }
            _ => return Failure::start(error),
        };
        Failure::start(error).with_help(help)
    })
}
