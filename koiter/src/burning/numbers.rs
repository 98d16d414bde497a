//! Ranges of numbers, by the names that scenes give them.

use super::error::BurningError;

pub(super) fn positive(what: &'static str, value: f64) -> Result<(), BurningError> {
    check(
        what,
        value,
        value.is_finite() && value > 0.0,
        "larger than 0",
    )
}

pub(super) fn not_negative(what: &'static str, value: f64) -> Result<(), BurningError> {
    check(
        what,
        value,
        value.is_finite() && value >= 0.0,
        "0 or larger",
    )
}

pub(super) fn share(what: &'static str, value: f64) -> Result<(), BurningError> {
    let expected = "above 0 and at most 1";
    check(what, value, value > 0.0 && value <= 1.0, expected)
}

pub(super) fn within(
    what: &'static str,
    value: f64,
    [least, most]: [f64; 2],
    expected: &'static str,
) -> Result<(), BurningError> {
    check(what, value, value >= least && value <= most, expected)
}

fn check(
    what: &'static str,
    value: f64,
    is_allowed: bool,
    expected: &'static str,
) -> Result<(), BurningError> {
    match is_allowed {
        true => Ok(()),
        false => Err(BurningError::Value {
            what,
            value,
            expected,
        }),
    }
}
