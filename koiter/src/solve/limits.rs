//! What keeps line searches from taking whole steps.

/// What ended a line search before the whole step.
#[derive(Clone, Debug, PartialEq)]
pub struct Limiter {
    /// The energy that bounds the step or is not defined further on; [`DECREASE`] where the sum of energies does not fall.
    pub by: String,
    /// What stands in the way, in the user's terms; may be empty.
    pub place: String,
}

/// The name under which steps are listed that were cut because the sum of energies does not fall enough further on.
pub const DECREASE: &str = "decrease";

/// All line searches that one cause ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// As [`Limiter::by`].
    pub by: String,
    /// How many.
    pub count: usize,
    /// The smallest fraction of a step that was left.
    pub smallest_fraction: f64,
    /// What stood in the way then.
    pub place: String,
}

impl Limit {
    /// Joins another list to one; each cause has one entry.
    pub fn join(all: &mut Vec<Self>, more: impl IntoIterator<Item = Self>) {
        for limit in more {
            match all.iter_mut().find(|known| known.by == limit.by) {
                None => all.push(limit),
                Some(known) => {
                    known.count += limit.count;
                    if limit.smallest_fraction < known.smallest_fraction {
                        known.smallest_fraction = limit.smallest_fraction;
                        known.place = limit.place;
                    }
                }
            }
        }
    }
}
