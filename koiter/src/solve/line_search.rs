//! How far to go along a Newton step.
//!
//! First as far as contact allows ([`Energy::max_step`]), then half of it while an energy is not defined there, then half
//! while the sum of energies does not decrease enough (Armijo). Where progress is slow the search also looks beyond the
//! Newton step: clamped curvature makes steps too short by a constant factor. Near a minimum, where values differ by round-off
//! alone, slopes decide (W. Hager, H. Zhang, "A new conjugate gradient method with guaranteed descent and an efficient line
//! search", 2005).

use std::time::Instant;

use super::limits::{DECREASE, Limiter};
use super::newton::{NewtonReport, Problem};
use crate::assembly::Energy;

/// Halvings before a line search gives up: 2⁻⁶⁰ of a step is below round-off of any position.
const MAX_HALVINGS: usize = 60;

/// Armijo's fraction of the predicted decrease.
const SUFFICIENT_DECREASE: f64 = 1e-4;

/// Where less than this share of the energies is to be gained, their values do not tell whether it is: a length over its rest
/// length loses as many digits as the strain is small. Slopes do, since a gradient is small where its terms cancel.
const UNTOLD: f64 = 1e-11;

/// What is left of the slope at the end of a step that is taken for it: nothing, but for round-off, if the step is Newton's.
const FLAT: f64 = 0.5;

/// What to search along.
pub(super) struct SearchLine<'a> {
    /// The Newton step.
    pub(super) direction: &'a [f64],
    /// Its product with the gradient.
    pub(super) slope: f64,
    /// The furthest to go, in Newton steps; at least 1.
    pub(super) reach: f64,
    /// Whether prescribed motions are under way: the sum of energies may then grow.
    pub(super) moving: bool,
}

/// How far a line search went.
pub(super) struct Taken {
    /// Newton steps: 0 if no fraction will do.
    pub(super) steps: f64,
    /// What kept it from going further, if that was an energy and not a bound such as contact.
    pub(super) stopped_by: Option<Limiter>,
}

/// Sum of the energies, and of their absolute values.
fn total(energies: &[&mut dyn Energy], q: &[f64]) -> (f64, f64) {
    energies
        .iter()
        .map(|e| e.value(q))
        .fold((0.0, 0.0), |(sum, size), v| (sum + v, size + v.abs()))
}

/// Moves `q` along the line.
pub(super) fn line_search(
    problem: &mut Problem<'_>,
    q: &mut [f64],
    line: &SearchLine<'_>,
    report: &mut NewtonReport,
) -> Taken {
    let start = Instant::now();
    report.limiter = None;
    let mut bound: f64 = 1.0;
    // Contact comes last: a search for pairs costs most, and the less the shorter the way is that the others leave.
    for is_contact in [false, true] {
        let way: Vec<f64> = (line.direction.iter())
            .map(|d| d * (line.reach * bound))
            .collect();
        let asked =
            (problem.energies.iter_mut()).filter(|e| e.has_changing_pattern() == is_contact);
        let so_far = bound;
        for energy in asked {
            let allowed = so_far * energy.max_step(q, &way);
            if allowed < bound {
                bound = allowed;
                report.limiter = Some(Limiter {
                    by: energy.name().into(),
                    place: energy.step_limiter().unwrap_or_default(),
                });
            }
        }
    }
    if bound * line.reach >= 1.0 {
        report.limiter = None;
    }
    report.spend("collision_detection", start);
    let start = Instant::now();
    let taken = search(problem, q, line, bound * line.reach, report);
    report.limiter = taken.stopped_by.clone().or(report.limiter.take());
    report.spend("line_search", start);
    taken
}

fn search(
    problem: &Problem<'_>,
    q: &mut [f64],
    line: &SearchLine<'_>,
    longest: f64,
    report: &mut NewtonReport,
) -> Taken {
    let (before, magnitude) = total(&problem.energies, q);
    // Round-off of a sum of that magnitude: differences below it say nothing.
    let noise = 1e-14 * magnitude;
    let point = |steps: f64| {
        let scaled: Vec<f64> = line.direction.iter().map(|d| d * steps).collect();
        let mut out = vec![0.0; q.len()];
        problem.space.retract(q, &scaled, &mut out);
        out
    };
    let mut value_at = |trial: &[f64]| {
        report.line_search_steps += 1;
        match problem.energies.iter().find(|e| !e.is_admissible(trial)) {
            Some(energy) => Err(&**energy as &dyn Energy),
            None => Ok(total(&problem.energies, trial).0),
        }
    };
    let mut steps = longest.min(1.0);
    let mut by_energy = false;
    // The energy that is not defined at the last point that was refused, if that is why.
    let mut undefined: Option<(&dyn Energy, Vec<f64>)> = None;
    for _ in 0..MAX_HALVINGS {
        let trial = point(steps);
        match value_at(&trial) {
            Ok(value) if decreases(value, before + noise, steps, line) => {
                let mut best = (steps, value, trial);
                while 2.0 * best.0 <= longest {
                    let further = point(2.0 * best.0);
                    match value_at(&further) {
                        Ok(value) if value < best.1 - noise => {
                            best = (2.0 * best.0, value, further)
                        }
                        _ => break,
                    }
                }
                q.copy_from_slice(&best.2);
                return Taken {
                    steps: best.0,
                    stopped_by: by_energy.then(|| stopped_by(undefined)),
                };
            }
            Ok(value)
                if is_untold(value, before, magnitude, steps, line)
                    && flattens(problem, line, &trial) =>
            {
                q.copy_from_slice(&trial);
                return Taken {
                    steps,
                    stopped_by: by_energy.then(|| stopped_by(undefined)),
                };
            }
            Ok(_) => undefined = None,
            Err(energy) => undefined = Some((energy, trial)),
        }
        by_energy = true;
        steps *= 0.5;
    }
    Taken {
        steps: 0.0,
        stopped_by: Some(stopped_by(undefined)),
    }
}

fn stopped_by(undefined: Option<(&dyn Energy, Vec<f64>)>) -> Limiter {
    match undefined {
        Some((energy, trial)) => Limiter {
            by: energy.name().into(),
            place: energy.undefined_element(&trial).unwrap_or_default(),
        },
        None => Limiter {
            by: DECREASE.into(),
            place: String::new(),
        },
    }
}

/// Whether the values of the energies say nothing about this part of a step.
fn is_untold(value: f64, before: f64, magnitude: f64, steps: f64, line: &SearchLine<'_>) -> bool {
    let least = UNTOLD * magnitude;
    let expected = -steps * line.slope;
    !line.moving && (0.0..least).contains(&expected) && (value - before).abs() < least
}

/// Whether the energies rise and fall much less along the line at a point of it than at its start.
fn flattens(problem: &Problem<'_>, line: &SearchLine<'_>, trial: &[f64]) -> bool {
    let mut gradient = vec![0.0; trial.len()];
    for energy in &problem.energies {
        energy.add_gradient(trial, &mut gradient);
    }
    let slope: f64 = gradient
        .iter()
        .zip(line.direction)
        .map(|(g, d)| g * d)
        .sum();
    slope.abs() <= FLAT * line.slope.abs()
}

fn decreases(value: f64, before: f64, steps: f64, line: &SearchLine<'_>) -> bool {
    value.is_finite()
        && (line.moving || value <= before + SUFFICIENT_DECREASE * steps * line.slope.min(0.0))
}
