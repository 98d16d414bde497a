//! The study as a table and as JSON.

use std::fmt::Write;

use koiter::scene::measure::shapes::{KnownShape, SmoothEnergy};
use koiter::scene::measure::{Refinement, Trend};
use koiter::scene::model::BendingModel;
use serde_json::{Value, json};

use super::{Cell, PUBLISHED_LEVEL, Published, Study, refinement, smooth_energy};

/// Width of a column, and of one with a published figure beside ours.
const COLUMN: usize = 11;
const WIDE_COLUMN: usize = 21;

/// Two tables like the published one: energies of the finest meshes, and how errors fall.
pub(super) fn text(study: &Study, shapes: &[KnownShape], models: &[BendingModel]) -> String {
    let is_comparable = study.cells.iter().any(|cell| cell.level == PUBLISHED_LEVEL);
    let (heading, column) = match is_comparable {
        true => (
            "bending energy on the finest mesh [J]: ours, and the published figure\n",
            WIDE_COLUMN,
        ),
        false => ("bending energy on the finest mesh [J]\n", COLUMN),
    };
    let mut out = String::from(heading);
    grid(&mut out, shapes, models, column, |shape, model| {
        let cell = *study.of(shape, model).last()?;
        let ours = energy(cell.energy);
        Some(match Published::of(shape, model) {
            Some(published) if cell.level == PUBLISHED_LEVEL => {
                let mark = if published.holds(cell.energy) {
                    "✓"
                } else {
                    "✗"
                };
                format!("{ours}{mark} {}", short(published.printed))
            }
            _ => ours,
        })
    });
    for (level, unsigned) in &study.unsigned_hinges {
        line(
            &mut out,
            &format!(
                "  cylinder-rest-curved with unsigned hinge angles, level {level}: {}",
                energy(*unsigned)
            ),
        );
    }
    line(
        &mut out,
        match is_comparable {
            true => {
                "✓ inside, ✗ outside of the tolerance for level 0 (benchmarks/convergence/SOURCE.md, which also corrects misprints)"
            }
            false => "published figures are for level 0, which is not among these levels",
        },
    );
    for (_, reason) in &study.left_out {
        line(&mut out, reason);
    }
    out.push_str("\nrelative error as a power of the number of vertices\n");
    grid(&mut out, shapes, models, COLUMN, |shape, model| {
        let cells = study.of(shape, model);
        let refinement = refinement(&cells);
        let verdict = match refinement.trend() {
            Trend::Converges => "conv",
            Trend::Open => "?",
            _ => "–",
        };
        let sign = match agrees(shape, model, refinement) {
            Some(false) => "!",
            _ => "",
        };
        (cells.len() > 1).then(|| format!("{:.2} {verdict}{sign}", refinement.rate))
    });
    line(
        &mut out,
        "conv: the error falls as a power of the number of vertices; –: it does not; ?: it does, and is still above 10 %, where \
         these levels do not tell its limit; ! not as published",
    );
    let _ = write!(out, "{:.0} s", study.seconds);
    out
}

fn line(out: &mut String, text: &str) {
    out.push_str(text);
    out.push('\n');
}

fn energy(value: f64) -> String {
    format!("{value:.3e}")
}

/// Three digits, as they are printed.
fn short(value: f64) -> String {
    format!("{value:.2e}")
}

/// A row a shape and a column a model.
fn grid(
    out: &mut String,
    shapes: &[KnownShape],
    models: &[BendingModel],
    column: usize,
    entry: impl Fn(KnownShape, BendingModel) -> Option<String>,
) {
    let mut heading = format!("{:22}", "");
    for model in models {
        let _ = write!(heading, "{:>column$}", model.info().name);
    }
    line(out, &heading);
    for &shape in shapes {
        let mut row = format!("{:22}", shape.name());
        for &model in models {
            let _ = write!(row, "{:>column$}", entry(shape, model).unwrap_or_default());
        }
        line(out, &row);
    }
}

fn expected(shape: KnownShape, model: BendingModel) -> Option<bool> {
    match Published::of(shape, model)?.converges {
        "yes" => Some(true),
        "no" => Some(false),
        _ => None,
    }
}

/// `None` where the levels do not tell.
fn converges(refinement: Refinement) -> Option<bool> {
    match refinement.trend() {
        Trend::Converges => Some(true),
        Trend::Stays => Some(false),
        _ => None,
    }
}

/// Whether that is as published, where both are known.
fn agrees(shape: KnownShape, model: BendingModel, refinement: Refinement) -> Option<bool> {
    Some(expected(shape, model)? == converges(refinement)?)
}

/// Every cell, and every model's refinement on every shape.
pub(super) fn json(study: &Study) -> Value {
    let cells: Value = study.cells.iter().map(cell_json).collect();
    let mut pairs: Vec<(KnownShape, BendingModel)> = Vec::new();
    for cell in &study.cells {
        if !pairs.contains(&(cell.shape, cell.model)) {
            pairs.push((cell.shape, cell.model));
        }
    }
    let refinements: Value = pairs
        .into_iter()
        .map(|(shape, model)| {
            let refinement = refinement(&study.of(shape, model));
            json!({
                "case": shape.name(),
                "model": model.info().name,
                "rate": refinement.rate,
                "error": refinement.error,
                "converges": converges(refinement),
                "published": Published::of(shape, model).map(|published| published.converges),
                "agrees": agrees(shape, model, refinement),
            })
        })
        .collect();
    let unsigned: Value = (study.unsigned_hinges.iter())
        .map(|(level, energy)| json!({ "level": level, "energy": energy, "published": 1.72e-1 }))
        .collect();
    let left_out: Value = (study.left_out.iter())
        .map(|(model, reason)| json!({ "model": model.info().name, "reason": reason }))
        .collect();
    json!({
        "bench": "convergence",
        "cells": cells,
        "refinements": refinements,
        "left_out": left_out,
        "rest_curved_with_unsigned_hinge_angles": unsigned,
        "seconds": study.seconds,
    })
}

fn cell_json(cell: &Cell) -> Value {
    let published = Published::of(cell.shape, cell.model);
    let published = published.as_ref();
    json!({
        "case": cell.shape.name(),
        "model": cell.model.info().name,
        "smooth_energy": match smooth_energy(cell.model) {
            SmoothEnergy::Koiter => "koiter",
            SmoothEnergy::SquaredCurvature => "squared-curvature",
        },
        "level": cell.level,
        "area": 4f64.powi(cell.level.into()) * 1e-8,
        "vertices": cell.vertices,
        "faces": cell.faces,
        "energy": cell.energy,
        "exact": cell.exact,
        "error": cell.error(),
        "seconds": cell.seconds,
        "published": published.map(|p| p.printed),
        "reference": published.map(|p| p.reference),
        "tolerance": published.map(|p| p.tolerance),
        "within": (published.filter(|_| cell.level == PUBLISHED_LEVEL)).map(|p| p.holds(cell.energy)),
    })
}
