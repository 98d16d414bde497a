//! Checks of friction between pairs of bodies.

use super::{Checked, error, not_negative};
use crate::scene::document::suggest;
use crate::scene::error::SceneErrorKind as Kind;
use crate::scene::spec::SceneSpec;

pub(super) fn check_friction(spec: &SceneSpec) -> Checked {
    if spec.contact.friction_iterations == 0 {
        let message = "there must be at least 1 solve of a step".to_owned();
        let path = "contact.friction_iterations";
        return Err(error(Kind::OutOfRange, path, message));
    }
    let is_shell = |name: &String| spec.shell.iter().any(|shell| shell.name == *name);
    let shells = spec.shell.iter().map(|shell| shell.name.as_str());
    let obstacles = spec.obstacle.iter().map(|obstacle| obstacle.name.as_str());
    let names: Vec<&str> = shells.chain(obstacles).collect();
    for (index, pair) in spec.contact.pair.iter().enumerate() {
        let at = |key: &str| format!("contact.pair.{index}.{key}");
        for (number, name) in pair.bodies.iter().enumerate() {
            if !names.contains(&name.as_str()) {
                let message = format!("there is no shell or obstacle '{name}'");
                let path = at(&format!("bodies.{number}"));
                return Err(
                    error(Kind::UnknownName, &path, message).with_help(suggest(name, &names))
                );
            }
        }
        let [a, b] = &pair.bodies;
        if !pair.bodies.iter().any(is_shell) {
            let message = format!("'{a}' and '{b}' are obstacles, which do not touch each other");
            return Err(error(Kind::Conflict, &at("bodies"), message));
        }
        let mut before = spec.contact.pair[..index].iter().map(|pair| &pair.bodies);
        if before.any(|[c, d]| (c, d) == (a, b) || (c, d) == (b, a)) {
            let message = format!("the pair '{a}' and '{b}' has a coefficient already");
            return Err(error(Kind::Conflict, &at("bodies"), message));
        }
        not_negative(&at("friction"), pair.friction, "")?;
    }
    Ok(())
}
