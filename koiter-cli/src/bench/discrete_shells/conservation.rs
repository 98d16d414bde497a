//! Momenta, energy, order in time and the longest explicit step, on a free V that turns and bends; and a flat beam whose
//! membrane is too stiff for its steps.

use koiter::Vec3;
use koiter::integrate::StepError;
use koiter::scene::{Scene, Simulation};

use super::run::{Trace, keep, shipped, written};
use crate::bench::gates::{Gate, Gates};
use crate::failure::Failure;

/// Of what is conserved exactly: round-off of some ten thousand steps.
const ROUND_OFF: f64 = 1e-10;
/// Of the ratio 4 of errors when steps halve.
const RATIO_TOLERANCE: f64 = 0.075;
/// Seconds of the drifts.
const SECONDS: f64 = 0.5;
/// 2/ω of the fastest vibration by the reference [s].
const LONGEST: f64 = 1.47e-4;
/// Explicit and implicit steps of the drifts [s].
const EXPLICIT: [f64; 3] = [8e-5, 4e-5, 2e-5];
const IMPLICIT: [f64; 3] = [2e-3, 1e-3, 5e-4];
/// From this step on [s] the change of angular momentum falls with its square: longer ones do not follow the fast vibrations.
const ASYMPTOTIC: f64 = 1e-3;

/// The V with β of Newmark's method.
fn plate(beta: f64, soft: bool, tolerance: f64) -> Result<Scene, Failure> {
    let text = include_str!("../../../../benchmarks/discrete-shells/plate.toml");
    let overrides = [
        format!("solver.newmark.beta={beta}"),
        format!("solver.velocity_tolerance={tolerance:e}"),
        format!("springs={}", if soft { "soft" } else { "stiff" }),
    ];
    let mut scene = written("plate.toml", text, &overrides)?;
    let shell = &mut scene.model.shells[0];
    for (x, v) in shell.surface.positions.iter().zip(&mut shell.velocities) {
        *v = Vec3::new(6.0, -4.0, 9.0).cross(x) + Vec3::new(0.02, 0.03, -0.01);
        v.z += 0.1 * (60.0 * x.x).sin();
    }
    Ok(scene)
}

/// Largest relative changes in a run.
struct Drifts {
    linear: f64,
    angular: f64,
    modified: f64,
    energy: f64,
    /// Change of the energy by its trend, a straight line in least squares.
    trend: f64,
    /// Steps that were taken in parts.
    cut: usize,
}

impl Drifts {
    fn of(beta: f64, dt: f64) -> Result<Self, Failure> {
        // Far below the errors that are measured: what Newton's method leaves adds up.
        let scene = plate(beta, false, 1e-11)?;
        let mut trace = Trace::new(scene.model)?;
        let mut first = None;
        let mut largest = [0.0f64; 3];
        for _ in 0..(SECONDS / dt).round() as usize {
            trace.step(dt)?;
            let [linear, modified] = trace.simulation.momenta(beta * dt * dt);
            let now = [linear, trace.simulation.momenta(0.0)[1], modified];
            // Accelerations are those of the equation of motion from the first step on.
            let first = *first.get_or_insert(now);
            for k in 0..3 {
                largest[k] = largest[k].max((now[k] - first[k]).norm() / first[k].norm());
            }
        }
        let [linear, angular, modified] = largest;
        Ok(Self {
            linear,
            angular,
            modified,
            energy: trace.largest_gain() / trace.start,
            trend: trend(&trace.gains).abs() / trace.start,
            cut: trace.cut,
        })
    }
}

/// By how much the straight line through equidistant values rises from the first to the last.
fn trend(values: &[f64]) -> f64 {
    let last = values.len() as f64 - 1.0;
    let (mut moment, mut square) = (0.0, 0.0);
    for (k, value) in values.iter().enumerate() {
        let place = k as f64 / last - 0.5;
        moment += place * value;
        square += place * place;
    }
    moment / square
}

pub(super) fn check(gates: &mut Gates) -> Result<(), Failure> {
    for (beta, steps, words) in [(0.0, EXPLICIT, "explicit"), (0.25, IMPLICIT, "implicit")] {
        let mut runs = Vec::new();
        for dt in steps {
            let drifts = Drifts::of(beta, dt)?;
            check_drifts(
                gates,
                &drifts,
                beta,
                &format!("conservation, {words}, {dt:e} s"),
            );
            runs.push(drifts);
        }
        let case = format!("conservation, {words}");
        for (pair, dt) in runs.windows(2).zip(steps) {
            let gate = Gate::Near(4.0, RATIO_TOLERANCE);
            let energy = pair[0].energy / pair[1].energy;
            let figure = "changes of energy when the step halves";
            gates.check(&case, figure, "", energy, gate);
            if beta > 0.0 {
                let angular = pair[0].angular / pair[1].angular;
                let gate = if dt > ASYMPTOTIC {
                    Gate::Beside(4.0)
                } else {
                    gate
                };
                gates.check(&case, "those of angular momentum", "", angular, gate);
            }
        }
        check_order(gates, beta, words)?;
    }
    // Up to the reference's 2/ω, and not far below.
    let gate = Gate::Between(0.9 * LONGEST, LONGEST);
    let figure = "longest step that is not refused";
    gates.check("conservation, explicit", figure, "s", longest_step()?, gate);
    check_gain(gates)
}

fn check_drifts(gates: &mut Gates, drifts: &Drifts, beta: f64, case: &str) {
    let exact = Gate::Below(ROUND_OFF);
    let angular = if beta == 0.0 { exact } else { Gate::Free };
    let trend = drifts.trend / drifts.energy;
    for (figure, value, gate) in [
        ("drift of momentum", drifts.linear, exact),
        ("of modified angular momentum", drifts.modified, exact),
        ("steps taken in parts", drifts.cut as f64, Gate::Below(1.0)),
        ("of angular momentum", drifts.angular, angular),
        ("largest change of energy", drifts.energy, Gate::Free),
        ("its trend by the largest", trend, Gate::Below(0.1)),
    ] {
        gates.check(case, figure, "", value, gate);
    }
}

/// Order in time of positions after 10 ms, by differences of runs whose steps halve.
fn check_order(gates: &mut Gates, beta: f64, words: &str) -> Result<(), Failure> {
    let largest = if beta == 0.0 { 8e-5 } else { 1e-4 };
    let mut runs = Vec::new();
    for k in 0..4 {
        let dt = largest * 0.5f64.powi(k);
        let mut trace = Trace::new(plate(beta, true, 1e-11)?.model)?;
        for _ in 0..(0.01 / dt).round() as usize {
            trace.step(dt)?;
        }
        runs.push(trace.surface().positions);
    }
    let difference = |pair: &[Vec<Vec3>]| {
        let distances = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).norm());
        distances.fold(0.0, f64::max)
    };
    let errors: Vec<f64> = runs.windows(2).map(difference).collect();
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        let case = format!("order, {words}");
        gates.check(&case, "order in time", "", order, Gate::Between(1.9, 2.1));
    }
    Ok(())
}

/// Where steps begin to be refused [s].
fn longest_step() -> Result<f64, Failure> {
    let (mut low, mut high) = (1e-4, 2e-4);
    while high - low > 1e-7 {
        let middle = 0.5 * (low + high);
        let mut simulation =
            Simulation::new(plate(0.0, false, 1e-9)?.model).map_err(Failure::start)?;
        match simulation.step(middle) {
            Ok(_) => low = middle,
            Err(StepError::Unstable { .. }) => high = middle,
            Err(error) => return Err(Failure::run(error)),
        }
    }
    Ok(low)
}

/// A flat beam with a membrane ten times as stiff: changes of energy, or gains where damping takes some, over the largest kinetic energy in 0.6 s, and what stops
/// them.
fn check_gain(gates: &mut Gates) -> Result<(), Failure> {
    let case = "gain, flat beam, k_L = 10 N";
    for (figure, dt, more, gate) in [
        ("steps of 1 ms", 1e-3, "", Gate::Below(2e-3)),
        (
            "steps of 2 ms: gains by multiples",
            2e-3,
            "",
            Gate::Above(0.1),
        ),
        (
            "watched",
            2e-3,
            "solver.newmark.energy_growth=1e-3",
            Gate::Below(0.02),
        ),
        (
            "damped",
            2e-3,
            "shell.flat_100.damping.stiffness=1e-3",
            Gate::Below(0.01),
        ),
    ] {
        let springs = "shell.flat_100.discrete_shells={ edge_stiffness = 10.0, area_stiffness = 1000.0, \
                       hinge_stiffness = 1e-5 }";
        let mut overrides = vec![springs, "solver.velocity_tolerance=1e-7"];
        overrides.extend((!more.is_empty()).then_some(more));
        let mut scene = shipped("beams", &overrides)?;
        keep(&mut scene.model, "flat_100")?;
        let mut simulation = Simulation::new(scene.model).map_err(Failure::start)?;
        let start = simulation.total_energy();
        let (mut gain, mut kinetic) = (0.0f64, 0.0f64);
        for _ in 0..(0.66f64 / dt).round() as usize {
            simulation.step(dt).map_err(Failure::step)?;
            let change = simulation.total_energy() - start;
            gain = gain.max(if more.is_empty() {
                change.abs()
            } else {
                change
            });
            kinetic = kinetic.max(super::run::energy(&simulation, "kinetic"));
        }
        gates.check(case, figure, "", gain / kinetic, gate);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_trend_of_a_line_is_its_rise_and_of_a_wave_next_to_nothing() {
        let line: Vec<f64> = (0..101).map(|k| 3.0 + 0.02 * f64::from(k)).collect();
        assert!((trend(&line) - 2.0).abs() < 1e-12);
        let wave: Vec<f64> = (0..1000).map(|k| (0.3 * f64::from(k)).cos()).collect();
        // Of the order of 12 / (1000 · 0.3): what the ends of a wave leave.
        assert!(trend(&wave).abs() < 0.05);
    }
}
