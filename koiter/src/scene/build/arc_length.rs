//! Where in a scene it is said what arc length cannot follow.

use crate::scene::arc_length::{ArcLengthError, load_pattern};
use crate::scene::error::{SceneError, SceneErrorKind as Kind};
use crate::scene::model::Model;
use crate::scene::spec::SceneSpec;

/// Refuses a model whose loads cannot be followed, with the key at fault.
pub(super) fn check_arc_length(model: &Model, spec: &SceneSpec) -> Result<(), SceneError> {
    if !model.follows_path() {
        return Ok(());
    }
    let refused = load_pattern(model).err().map(|error| {
        let key = match &error {
            ArcLengthError::Phases => "phase".into(),
            ArcLengthError::Contact => "contact.enabled".into(),
            ArcLengthError::NoLoad => "integrator".into(),
            ArcLengthError::Schedule { load: None, .. } => "gravity_scale".into(),
            ArcLengthError::Schedule {
                load: Some(index), ..
            } => format!("load.{}.scale", model.loads[*index].name),
            ArcLengthError::Motion { constraint } => spec.constraint[*constraint].path(*constraint),
        };
        SceneError::new(Kind::Conflict, error.to_string()).inside(&key)
    });
    refused.map_or(Ok(()), Err)
}
