//! Flat beams and V-beams: Figure 2. How deep they sink, how fast they swing, and that energy is kept.

use std::f64::consts::TAU;

use koiter::Vec3;

use super::run::{Trace, keep, nearest, shipped};
use crate::bench::gates::{Gate, Gates};
use crate::bench::published::rows;
use crate::failure::Failure;

/// Of the reference, which is on the same mesh.
const TOLERANCE: f64 = 0.02;
/// Of the first frequency of a slender cantilever with the stiffness of these hinges.
const FORMULA_TOLERANCE: f64 = 0.03;
/// Of the largest kinetic energy.
const ENERGY_TOLERANCE: f64 = 2e-3;

/// A row of `beams.csv`; lengths in m.
struct Reference {
    version: &'static str,
    shape: &'static str,
    stiffness: &'static str,
    lowest: f64,
    amplitude: Option<f64>,
    frequency: Option<f64>,
}

fn references() -> Vec<Reference> {
    let table = include_str!("../../../../benchmarks/discrete-shells/beams.csv");
    let number = |field: &str| field.parse::<f64>().ok();
    let row = |row: Vec<&'static str>| Reference {
        version: row[0],
        shape: row[1],
        stiffness: row[2],
        lowest: 1e-2 * number(row[3]).expect("every row has a lowest point"),
        amplitude: number(row[4]).map(|value| 1e-2 * value),
        frequency: number(row[5]),
    };
    rows(table).map(row).collect()
}

/// What a beam does.
struct Swing {
    lowest: f64,
    amplitude: f64,
    frequency: f64,
    /// Largest change of energy over the largest kinetic energy.
    energy_error: f64,
}

pub(super) fn check(gates: &mut Gates) -> Result<(), Failure> {
    let mut swings = Vec::new();
    for reference in references() {
        let Reference {
            version,
            shape,
            stiffness,
            ..
        } = reference;
        let swing = swing(version, shape, stiffness)?;
        let case = format!("beams, {version}, {shape}, {stiffness} erg");
        let near = |value: Option<f64>| value.map_or(Gate::Free, |v| Gate::Near(v, TOLERANCE));
        let lowest = near(Some(reference.lowest));
        gates.check(&case, "lowest tip", "m", swing.lowest, lowest);
        let (amplitude, frequency) = (near(reference.amplitude), near(reference.frequency));
        gates.check(&case, "amplitude", "m", swing.amplitude, amplitude);
        gates.check(&case, "frequency", "Hz", swing.frequency, frequency);
        // The steps of the other versions are those of this one, and long for a soft membrane.
        let kept = match version {
            "reference" => Gate::Below(ENERGY_TOLERANCE),
            _ => Gate::Free,
        };
        let error = swing.energy_error;
        gates.check(&case, "energy error / largest kinetic", "", error, kept);
        if version == "reference" {
            swings.push(swing);
        }
    }
    check_trends(gates, &swings);
    Ok(())
}

/// The reference lists three flat beams and then three Vs, from soft to stiff.
fn check_trends(gates: &mut Gates, swings: &[Swing]) {
    let (flat, vee) = swings.split_at(swings.len() / 2);
    let largest_ratio = |values: Vec<f64>| {
        let ratios = values.windows(2).map(|pair| pair[1] / pair[0]);
        ratios.fold(f64::NEG_INFINITY, f64::max)
    };
    for (case, beams) in [("beams, flat", flat), ("beams, vee", vee)] {
        let amplitudes = largest_ratio(beams.iter().map(|beam| beam.amplitude).collect());
        gates.check(
            case,
            "amplitude by that of the softer",
            "",
            amplitudes,
            Gate::Below(1.0),
        );
        let periods = largest_ratio(beams.iter().map(|beam| 1.0 / beam.frequency).collect());
        gates.check(
            case,
            "period by that of the softer",
            "",
            periods,
            Gate::Below(1.0),
        );
    }
    let by_vee: Vec<f64> = (flat.iter().zip(vee))
        .map(|(flat, vee)| flat.lowest / vee.lowest)
        .collect();
    for (ratio, reference) in by_vee.iter().zip([34.0, 16.0, 2.2]) {
        gates.check(
            "beams",
            "flat tip by that of the V",
            "",
            *ratio,
            Gate::Beside(reference),
        );
    }
    gates.check(
        "beams",
        "that by that of the softer",
        "",
        largest_ratio(by_vee),
        Gate::Below(1.0),
    );
    // f = 0.5596 √(5 k_B / ρ L⁴), L from the middle of the clamped columns; 5 k_B is D of hinges in a released cantilever.
    let formula = 0.5596 * (5.0 * 1e-3 / (0.1 * 0.0975f64.powi(4))).sqrt();
    if let Some(stiffest) = flat.last() {
        let gate = Gate::Near(formula, FORMULA_TOLERANCE);
        gates.check(
            "beams, flat, 10000 erg",
            "frequency, by the formula",
            "Hz",
            stiffest.frequency,
            gate,
        );
    }
}

fn swing(version: &str, shape: &str, stiffness: &str) -> Result<Swing, Failure> {
    let mut scene = shipped("beams", &[&format!("version={version}")])?;
    let name = format!("{shape}_{stiffness}");
    keep(&mut scene.model, &name)?;
    let positions = &scene.model.shells[0].surface.positions;
    let middle = positions.iter().map(|x| x.y).sum::<f64>() / positions.len() as f64;
    let tip = nearest(positions, Vec3::new(0.1, middle, 0.0));
    let start = positions[tip].z;
    let mut trace = Trace::new(scene.model)?;
    let mut path = Vec::new();
    trace.run(&scene.timeline, f64::INFINITY, |trace, report| {
        path.push([
            report.time,
            trace.simulation.shell_positions(0)[tip].z - start,
        ]);
    })?;
    let heights = || path.iter().map(|point| point[1]);
    let lowest = heights().fold(f64::INFINITY, f64::min);
    let highest = heights().fold(f64::NEG_INFINITY, f64::max);
    Ok(Swing {
        lowest,
        amplitude: 0.5 * (highest - lowest),
        frequency: frequency(&path),
        energy_error: trace.largest_gain() / trace.kinetic,
    })
}

/// Where the periodogram about the mean is largest [Hz], up to a fortieth of the sampling rate.
fn frequency(path: &[[f64; 2]]) -> f64 {
    let mean = path.iter().map(|point| point[1]).sum::<f64>() / path.len() as f64;
    let power = |frequency: f64| {
        let (mut even, mut odd) = (0.0, 0.0);
        for [time, height] in path {
            let (sin, cos) = (TAU * frequency * time).sin_cos();
            even += (height - mean) * cos;
            odd += (height - mean) * sin;
        }
        even * even + odd * odd
    };
    let span = path[path.len() - 1][0];
    let finest = path.len() as f64 / span / 40.0;
    // A peak is as wide as two over the span: an eighth of it is found by steps, and refined by thirds.
    let step = 0.25 / span;
    let steps = 1..(finest / step) as usize;
    let all = steps.map(|k| k as f64 * step);
    let best = all.max_by(|a, b| power(*a).total_cmp(&power(*b)));
    let best = best.unwrap_or(step);
    let (mut low, mut high) = (best - step, best + step);
    for _ in 0..40 {
        let third = (high - low) / 3.0;
        if power(low + third) < power(high - third) {
            low += third;
        } else {
            high -= third;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frequency_of_a_swing_about_any_height_is_found() {
        let path: Vec<[f64; 2]> = (1..=1000)
            .map(|k| {
                let t = 1e-3 * f64::from(k);
                [
                    t,
                    (TAU * 13.2 * t).cos() - 1.0 + 0.1 * (TAU * 80.0 * t).sin(),
                ]
            })
            .collect();
        // Thirteen periods and a bit more: the mean is off by a percent, and leaks.
        assert!(
            (frequency(&path) - 13.2).abs() < 0.02,
            "{}",
            frequency(&path)
        );
    }

    #[test]
    fn every_beam_of_the_reference_is_in_the_scene() {
        for reference in references() {
            let mut scene = shipped("beams", &[&format!("version={}", reference.version)]).unwrap();
            let name = format!("{}_{}", reference.shape, reference.stiffness);
            keep(&mut scene.model, &name).unwrap();
            assert_eq!(scene.model.constraints.len(), 1);
            // Two columns of vertices are held.
            let shell = &scene.model.shells[0];
            let rows = shell
                .surface
                .positions
                .iter()
                .filter(|x| x.x > 0.0999)
                .count();
            assert_eq!(
                scene.model.constraints[0].vertices.len(),
                2 * rows,
                "{name}"
            );
        }
    }
}
