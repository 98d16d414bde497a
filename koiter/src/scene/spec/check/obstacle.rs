//! Checks of obstacles.

use super::motion::check_motion;
use super::{
    Checked, check_direction, check_mesh, check_rotation, error, exactly_one, not_negative,
    optional_positive, positive,
};
use crate::scene::error::SceneErrorKind as Kind;
use crate::scene::spec::ObstacleSpec;

pub(super) fn check_obstacle(path: &str, obstacle: &ObstacleSpec) -> Checked {
    let at = |key: &str| format!("{path}.{key}");
    let shapes = [
        ("plane", obstacle.plane.is_some()),
        ("sphere", obstacle.sphere.is_some()),
        ("capsule", obstacle.capsule.is_some()),
        ("box", obstacle.cuboid.is_some()),
        ("cylinder", obstacle.cylinder.is_some()),
        ("mesh", obstacle.mesh.is_some()),
    ];
    let given: Vec<&str> = shapes
        .into_iter()
        .filter_map(|(name, given)| given.then_some(name))
        .collect();
    exactly_one(path, &given, "plane, sphere, capsule, box, cylinder, mesh")?;
    if let Some(plane) = &obstacle.plane {
        check_direction(&at("plane.normal"), plane.normal)?;
    }
    optional_positive(
        &at("sphere.radius"),
        obstacle.sphere.as_ref().map(|s| s.radius),
        "m",
    )?;
    if let Some(capsule) = &obstacle.capsule {
        positive(&at("capsule.radius"), capsule.radius, "m")?;
        if capsule.ends[0] == capsule.ends[1] {
            let message = "the two ends are the same point".to_owned();
            return Err(
                error(Kind::OutOfRange, &at("capsule.ends"), message).with_help("use a sphere")
            );
        }
    }
    if let Some(mesh) = &obstacle.mesh {
        check_mesh(&at("mesh"), mesh)?;
    }
    check_deform(&at("deform"), obstacle)?;
    check_animation(&at("animation"), obstacle)?;
    if let Some(rotate) = &obstacle.rotate {
        check_rotation(&at("rotate"), rotate)?;
    }
    not_negative(&at("friction"), obstacle.friction, "")?;
    check_motion(&at("motion"), &obstacle.motion)?;
    let shape = given[0];
    if obstacle.motion.scale.is_some() && ["plane", "sphere", "capsule"].contains(&shape) {
        let message = format!("a {shape} cannot be scaled");
        return Err(error(Kind::Conflict, &at("motion.scale"), message)
            .with_help("use a mesh, such as mesh.icosphere"));
    }
    Ok(())
}

fn check_deform(path: &str, obstacle: &ObstacleSpec) -> Checked {
    if !obstacle.deform.is_empty() && obstacle.mesh.is_none() {
        let message = "only an obstacle with the key 'mesh' deforms".to_owned();
        return Err(error(Kind::Conflict, path, message));
    }
    let mut before = 0.0;
    for (number, shape) in obstacle.deform.iter().enumerate() {
        let at = |key: &str| format!("{path}.{number}.{key}");
        if shape.time.is_nan() || shape.time <= before {
            let message = format!(
                "times of shapes must increase from 0, but {before} s is followed by {} s",
                shape.time
            );
            return Err(error(Kind::OutOfRange, &at("time"), message));
        }
        check_mesh(&at("mesh"), &shape.mesh)?;
        before = shape.time;
    }
    Ok(())
}

fn check_animation(path: &str, obstacle: &ObstacleSpec) -> Checked {
    let Some(animation) = &obstacle.animation else {
        return Ok(());
    };
    let conflict = |message: &str| error(Kind::Conflict, path, message.to_owned());
    if obstacle.mesh.is_none() {
        return Err(conflict("only an obstacle with the key 'mesh' is animated"));
    }
    if !obstacle.deform.is_empty() {
        let both = conflict("the shapes over time are given twice, by 'animation' and by 'deform'");
        return Err(both.with_help("keep one of them"));
    }
    optional_positive(&format!("{path}.fps"), animation.fps, "frames a second")
}
