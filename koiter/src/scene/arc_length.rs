//! From a model to its path of loads: what can be followed by arc length.
//!
//! The time of the schedules is the load factor λ. It may pass 1, fall and become negative, so a schedule has to be a line
//! through zero, `[[0, 0], [T, s]]`, and goes on as that line: the load is λ s / T times what it is at a factor of 1. Loads
//! without a schedule are constant. The time of frames counts steps of `time.dt`, for λ need not grow.

use super::model::{Constraint, Model, Schedule};
use crate::integrate::{ArcLength, ArcLengthOptions, LoadPattern};

/// Why no path can be followed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ArcLengthError {
    /// Contact is on.
    #[error(
        "arc length follows equilibria without contact, but contact is on: set contact.enabled = false"
    )]
    Contact,
    /// There are phases.
    #[error("a path by arc length is a run of its own: it has no phases")]
    Phases,
    /// Nothing depends on the load factor.
    #[error(
        "arc length has no load to follow: give a load, or gravity_scale, a schedule such as [[0, 0], [1, 1]]"
    )]
    NoLoad,
    /// A schedule that is not proportional to its time.
    #[error(
        "with arc length the time of schedules is the load factor, which may pass the last key and become negative: write \
         the schedule of {of} as a line from zero, [[0, 0], [1, 1]], or none for a constant load"
    )]
    Schedule {
        /// Whose schedule.
        of: String,
        /// Index of the load; `None`: gravity.
        load: Option<usize>,
    },
    /// A constraint that moves or ends.
    #[error(
        "arc length follows loads only, but constraint {constraint} moves or ends: hold it still, or use integrator = \
         \"quasi-static\", which needs no arc length where motions are prescribed"
    )]
    Motion {
        /// Index of the constraint.
        constraint: usize,
    },
}

/// Where no first arc is given: this share of the smallest thickness, over which shallow shells hardly change stiffness.
const FIRST_BY_THICKNESS: f64 = 0.1;

/// Where no largest arc is given: this many first ones.
const LARGEST_BY_FIRST: f64 = 10.0;

/// What the load factor multiplies.
pub(super) fn load_pattern(model: &Model) -> Result<LoadPattern, ArcLengthError> {
    if !model.phases.is_empty() {
        return Err(ArcLengthError::Phases);
    }
    if model.contact.enabled {
        return Err(ArcLengthError::Contact);
    }
    let moves = |c: &Constraint| !c.motion.is_still() || c.from > 0.0 || c.until.is_finite();
    if let Some(constraint) = model.constraints.iter().position(moves) {
        return Err(ArcLengthError::Motion { constraint });
    }
    let rate = |scale: &Option<Schedule<f64>>, of: String, load| {
        let scale = scale.as_ref();
        let rate =
            scale.map(|scale| proportion(scale).ok_or(ArcLengthError::Schedule { of, load }));
        rate.transpose()
    };
    let loads = (model.loads.iter().enumerate())
        .map(|(index, load)| rate(&load.scale, format!("load '{}'", load.name), Some(index)))
        .collect::<Result<Vec<_>, _>>()?;
    let gravity = rate(&model.gravity_scale, "gravity".into(), None)?;
    let gravity = gravity.map(|rate| model.gravity * rate);
    match loads.iter().all(Option::is_none) && gravity.is_none_or(|g| g.norm() == 0.0) {
        true => Err(ArcLengthError::NoLoad),
        false => Ok(LoadPattern { loads, gravity }),
    }
}

/// The slope of a schedule that is one line through zero.
fn proportion(scale: &Schedule<f64>) -> Option<f64> {
    match (&scale.times[..], &scale.values[..]) {
        ([0.0, time], [0.0, value]) => Some(value / time),
        _ => None,
    }
}

/// The integrator of a model.
pub(super) fn integrator(model: &Model) -> Result<ArcLength, ArcLengthError> {
    let solver = &model.solver;
    let thicknesses = model.shells.iter().map(|shell| shell.thickness);
    let first = solver
        .first_arc_length
        .unwrap_or_else(|| FIRST_BY_THICKNESS * thicknesses.fold(f64::INFINITY, f64::min));
    let options = ArcLengthOptions {
        first,
        largest: (solver.largest_arc_length).unwrap_or(LARGEST_BY_FIRST * first),
        smallest_share: solver.smallest_step,
        last_load_factor: solver.last_load_factor,
        displacement_tolerance: solver.displacement_tolerance,
        max_iterations: solver.max_iterations,
    };
    Ok(ArcLength::new(options, load_pattern(model)?))
}
