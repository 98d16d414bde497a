//! Checks of schedules and motions.

use super::{Checked, check_direction, error, positive};
use crate::scene::error::SceneErrorKind as Kind;
use crate::scene::schedule::{MotionSpec, Schedule};

pub(super) fn check_motion(path: &str, motion: &MotionSpec) -> Checked {
    if let Some(translate) = &motion.translate {
        check_schedule(&format!("{path}.translate"), translate)?;
    }
    if let Some(rotate) = &motion.rotate {
        check_direction(&format!("{path}.rotate.axis"), rotate.axis)?;
        check_schedule(&format!("{path}.rotate.degrees"), &rotate.degrees)?;
    }
    if let Some(scale) = &motion.scale {
        let at = |key: &str| format!("{path}.scale.{key}");
        if let Some(along) = scale.along {
            check_direction(&at("along"), along)?;
        }
        check_schedule(&at("factor"), &scale.factor)?;
        for (key, factor) in scale.factor.values.iter().enumerate() {
            positive(&at(&format!("factor.{key}.1")), *factor, "")?;
        }
    }
    Ok(())
}

pub(in crate::scene::spec) fn check_schedule<T>(path: &str, schedule: &Schedule<T>) -> Checked {
    if schedule.times.is_empty() {
        return Err(
            error(Kind::OutOfRange, path, "the schedule has no keys".into())
                .with_help("write pairs [time, value], such as [[0.0, 0.0], [1.0, 1.0]]"),
        );
    }
    for (key, pair) in schedule.times.windows(2).enumerate() {
        if pair[1] <= pair[0] {
            let message = format!(
                "the times of a schedule must increase, but {} s is followed by {} s",
                pair[0], pair[1]
            );
            return Err(error(
                Kind::OutOfRange,
                &format!("{path}.{}", key + 1),
                message,
            ));
        }
    }
    Ok(())
}
