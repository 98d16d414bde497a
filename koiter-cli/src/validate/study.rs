//! One case with one bending model, on all its meshes.

use std::time::Instant;

use koiter::scene::model::BendingModel;
use koiter::scene::{NoFiles, Scene, SceneFile, Simulation};
use serde_json::{Value, json};

use super::case::{Case, Quantity, Question, Side};
use super::convergence::extrapolate;
use crate::failure::Failure;
use crate::probes::values_by_column;

/// What was found for one quantity.
pub(super) struct Finding {
    pub(super) quantity: Quantity,
    /// A figure for every mesh; for a path the last.
    pub(super) figures: Vec<f64>,
    /// Load and figure along the path on the finest mesh.
    pub(super) curve: Vec<[f64; 2]>,
    /// Deviation on the finest mesh, relative; for a path the largest along it over the largest reference.
    pub(super) deviation: f64,
    /// Along a path the largest deviation relative to the reference at the same load, where that is not 0.
    pub(super) local_deviation: Option<f64>,
    /// Observed order, extrapolated figure and its relative deviation.
    pub(super) limit: Option<(f64, f64, f64)>,
    pub(super) verdict: Verdict,
}

/// Whether a figure is what is published.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// On the finest mesh.
    Within,
    /// Extrapolated.
    InTheLimit,
    Outside,
}

impl Verdict {
    pub(super) fn mark(self) -> &'static str {
        match self {
            Self::Within => "ok",
            Self::InTheLimit => "ok in the limit",
            Self::Outside => "outside",
        }
    }
}

/// A case with a model.
pub(super) struct Study {
    pub(super) model: BendingModel,
    pub(super) cells: Vec<&'static [usize]>,
    pub(super) findings: Vec<Finding>,
    pub(super) seconds: f64,
}

/// What a mesh gives: for every quantity its values along the path, or one.
type Measured = Vec<Vec<f64>>;

impl Study {
    /// Runs the case on its `levels` coarsest meshes.
    pub(super) fn new(case: &Case, model: BendingModel, levels: usize) -> Result<Self, Failure> {
        let start = Instant::now();
        let cells = case.levels[..levels.min(case.levels.len())].to_vec();
        let measured = (cells.iter())
            .map(|cells| measure(case, model, cells))
            .collect::<Result<Vec<Measured>, Failure>>()?;
        let quantities = case.quantities().into_iter().enumerate();
        let findings = quantities
            .map(|(k, quantity)| {
                let by_level = measured.iter().map(|level| level[k].clone()).collect();
                Finding::new(case, quantity, by_level)
            })
            .collect();
        Ok(Self {
            model,
            cells,
            findings,
            seconds: start.elapsed().as_secs_f64(),
        })
    }

    pub(super) fn json(&self, case: &Case) -> Value {
        let rows: Vec<Value> = (self.findings.iter())
            .map(|finding| {
                json!({
                    "quantity": finding.quantity.name,
                    "figures": finding.figures,
                    "reference": finding.quantity.reference,
                    "deviation": finding.deviation,
                    "largest_local_deviation": finding.local_deviation,
                    "observed_order": finding.limit.map(|limit| limit.0),
                    "extrapolated": finding.limit.map(|limit| limit.1),
                    "extrapolated_deviation": finding.limit.map(|limit| limit.2),
                    "mark": finding.verdict.mark(),
                    "curve": finding.curve,
                    "reference_curve": finding.quantity.curve,
                })
            })
            .collect();
        json!({
            "case": case.name,
            "title": case.title,
            "bending": self.model.info().name,
            "cells": self.cells,
            "tolerance": case.tolerance,
            "quantities": rows,
            "seconds": self.seconds,
        })
    }
}

impl Finding {
    fn new(case: &Case, mut quantity: Quantity, by_level: Vec<Vec<f64>>) -> Self {
        let figures: Vec<f64> = (by_level.iter())
            .map(|path| path.last().copied().unwrap_or(f64::NAN))
            .collect();
        let finest = by_level.last().cloned().unwrap_or_default();
        let curve: Vec<[f64; 2]> = (quantity.curve.iter().zip(&finest))
            .map(|(point, value)| [point[0], *value])
            .collect();
        // A table may go on beyond the scene.
        quantity.curve.truncate(curve.len());
        if let Some(last) = quantity.curve.last() {
            quantity.reference = last[1];
        }
        let references = quantity.curve.iter().map(|point| point[1].abs());
        let scale = references.fold(quantity.reference.abs(), f64::max);
        let off = |value: f64, reference: f64| (value - reference) / scale;
        let deviation = if curve.is_empty() {
            off(
                figures.last().copied().unwrap_or(f64::NAN),
                quantity.reference,
            )
        } else {
            (curve.iter().zip(&quantity.curve))
                .map(|(found, known)| off(found[1], known[1]))
                .fold(0.0, larger)
        };
        let local_deviation = (curve.iter().zip(&quantity.curve))
            .filter(|(_, known)| known[1] != 0.0)
            .map(|(found, known)| found[1] / known[1] - 1.0)
            .reduce(larger);
        let limit = extrapolate(&figures)
            .map(|(order, value)| (order, value, off(value, quantity.reference)));
        let is_within = |d: f64| d.abs() <= case.tolerance;
        let verdict = if is_within(deviation) {
            Verdict::Within
        } else if case.by_extrapolation && limit.is_some_and(|limit| is_within(limit.2)) {
            Verdict::InTheLimit
        } else {
            Verdict::Outside
        };
        Self {
            quantity,
            figures,
            curve,
            deviation,
            local_deviation,
            limit,
            verdict,
        }
    }
}

/// The one of larger size; NaN wins.
fn larger(worst: f64, deviation: f64) -> f64 {
    match deviation.abs() <= worst.abs() {
        true => worst,
        false => deviation,
    }
}

/// The scene of a case on a mesh.
pub(super) fn scene(case: &Case, model: BendingModel, cells: &[usize]) -> Result<Scene, Failure> {
    let mut set: Vec<String> = case.set.iter().map(|text| (*text).to_owned()).collect();
    set.push(match cells {
        [one] => format!("{}={one}", case.cells_key),
        several => format!("{}={several:?}", case.cells_key),
    });
    set.push(format!("{}.bending={}", case.shell(), model.info().name));
    let file = SceneFile::parse(case.name, case.scene, &set)?;
    Ok(Scene::build(&file, &NoFiles)?)
}

fn measure(case: &Case, model: BendingModel, cells: &[usize]) -> Result<Measured, Failure> {
    let scene = scene(case, model, cells)?;
    let mut simulation = Simulation::new(scene.model.clone()).map_err(Failure::start)?;
    match case.question {
        Question::Vibration { skipped, .. } => {
            let count = skipped + case.quantities().len();
            let modes = simulation.vibration_modes(count).map_err(Failure::run)?;
            Ok((modes[skipped.min(modes.len())..].iter())
                .map(|mode| vec![mode.omega_squared.max(0.0).sqrt()])
                .collect())
        }
        Question::Buckling(_) => {
            let modes = simulation.buckling_modes(0.0, 1).map_err(Failure::run)?;
            let factor = modes.first().map_or(f64::INFINITY, |mode| mode.load_factor);
            Ok(vec![vec![factor]])
        }
        Question::End(probes) => {
            let path = run(&scene, &mut simulation)?;
            let end = path.last().map_or(&[][..], Vec::as_slice);
            (probes.iter())
                .map(|(column, factor, _)| Ok(vec![factor * value(end, column)?]))
                .collect()
        }
        Question::Path { probes, .. } => {
            let path = run(&scene, &mut simulation)?;
            let along = |&(column, factor, offset, side, _): &(&str, f64, f64, Side, &str)| {
                let values: Result<Vec<f64>, Failure> = (path.iter())
                    .map(|row| Ok(offset + factor * value(row, column)?))
                    .collect();
                let mut values = values?;
                if side == Side::Either && values.last().is_some_and(|last| *last < 0.0) {
                    values.iter_mut().for_each(|value| *value = -*value);
                }
                Ok(values)
            };
            probes.iter().map(along).collect()
        }
    }
}

/// Columns of the probes with their values, after every step.
type Rows = Vec<Vec<(String, f64)>>;

fn run(scene: &Scene, simulation: &mut Simulation) -> Result<Rows, Failure> {
    let mut rows = Vec::new();
    for step in 1..=scene.timeline.num_steps() {
        let report = simulation
            .step(scene.timeline.dt(step))
            .map_err(Failure::step)?;
        if !report.converged {
            let reason = report.diagnosis.unwrap_or_default();
            return Err(Failure::run(format!(
                "step {step} did not converge: {reason}"
            )));
        }
        rows.push(values_by_column(&scene.probes, simulation));
    }
    Ok(rows)
}

fn value(row: &[(String, f64)], column: &str) -> Result<f64, Failure> {
    let found = row.iter().find(|(name, _)| name == column);
    let missing = || Failure::run(format!("the scene has no probe column '{column}'"));
    found.map(|(_, value)| *value).ok_or_else(missing)
}
