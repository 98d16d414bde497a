//! Checks of `time` and `[[phase]]`.

use super::{Checked, check_constraint_name, error, positive, unique};
use crate::scene::document::suggest;
use crate::scene::error::SceneErrorKind as Kind;
use crate::scene::spec::{PhaseSpec, SceneSpec};

/// More steps than this are a slip in `dt` or in the end.
pub const MAX_STEPS: f64 = 1e8;

pub(super) fn check_phases(spec: &SceneSpec) -> Checked {
    match (&spec.time, &spec.phase[..]) {
        (None, []) => {
            let message = "the key 'time' is missing".to_owned();
            return Err(error(Kind::MissingKey, "", message).with_help(
                "write time = { end = 1.0, dt = 0.01 }, or [[phase]] tables, each with its own",
            ));
        }
        (Some(time), []) => return check_window("time", [0.0, time.end, time.dt]),
        (Some(_), _) => {
            let message =
                "with [[phase]] tables there is no 'time': each phase has its own end and dt"
                    .to_owned();
            return Err(error(Kind::Conflict, "time", message));
        }
        (None, _) => {}
    }
    unique(
        "phase",
        spec.phase.iter().map(|phase| Some(phase.name.as_str())),
    )?;
    for (phase, window) in spec.phase.iter().zip(spec.windows()) {
        check_phase(phase, window, spec)?;
    }
    Ok(())
}

fn check_phase(phase: &PhaseSpec, window: [f64; 3], spec: &SceneSpec) -> Checked {
    let path = format!("phase.{}", phase.name);
    let at = |key: &str| format!("{path}.{key}");
    check_window(&path, window)?;
    for (index, name) in phase.constraints.iter().flatten().enumerate() {
        check_constraint_name(&at(&format!("constraints.{index}")), name, spec)?;
    }
    let names: Vec<&str> = spec.load.iter().map(|load| load.name.as_str()).collect();
    for (index, name) in phase.loads.iter().flatten().enumerate() {
        if !names.contains(&name.as_str()) {
            let message = format!("there is no load '{name}'");
            return Err(
                error(Kind::UnknownName, &at(&format!("loads.{index}")), message)
                    .with_help(suggest(name, &names)),
            );
        }
    }
    if phase.every_steps == Some(0) {
        let message = "every_steps must be at least 1".to_owned();
        return Err(error(Kind::OutOfRange, &at("every_steps"), message));
    }
    Ok(())
}

fn check_window(path: &str, [start, end, dt]: [f64; 3]) -> Checked {
    let at = |key: &str| format!("{path}.{key}");
    positive(&at("dt"), dt, "s")?;
    positive(&at("end"), end, "s")?;
    if end <= start {
        let message = format!("the phase ends at {end} s, but the one before ends at {start} s");
        return Err(error(Kind::OutOfRange, &at("end"), message)
            .with_help("ends are times of the run, not lengths of phases"));
    }
    let steps = (end - start) / dt;
    if steps > MAX_STEPS {
        let message = format!("these are {steps:.1e} time steps");
        return Err(
            error(Kind::OutOfRange, &at("dt"), message).with_help("make dt larger or end smaller")
        );
    }
    Ok(())
}
