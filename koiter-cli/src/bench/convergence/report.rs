//! The study as a table and as JSON.

use std::fmt::Write;

use koiter::scene::measure::shapes::KnownShape;
use koiter::scene::model::BendingModel;
use serde_json::{Value, json};

use super::{Cell, Published, Study, refinement, smooth_energy};

/// Width of a column.
const COLUMN: usize = 11;

/// Two tables like the published one: energies of the finest meshes, and how errors fall.
pub(super) fn text(study: &Study, shapes: &[KnownShape], models: &[BendingModel]) -> String {
    let mut out = String::from("bending energy on the finest mesh [J]\n");
    grid(&mut out, shapes, models, |shape, model| {
        let cell = *study.of(shape, model).last()?;
        let mark = match Published::of(shape, model) {
            Some(published) if published.holds(cell.energy) => "✓",
            Some(_) => "✗",
            None => "",
        };
        Some(format!("{}{mark}", energy(cell.energy)))
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
        "✓ inside, ✗ outside of the tolerance for level 0 about the published figure (benchmarks/convergence/SOURCE.md)",
    );
    out.push_str("\nrelative error as a power of the number of vertices\n");
    grid(&mut out, shapes, models, |shape, model| {
        let cells = study.of(shape, model);
        let refinement = refinement(&cells);
        let verdict = if refinement.converges() {
            "conv"
        } else {
            "–"
        };
        let sign = match expected(shape, model) {
            Some(expected) if expected != refinement.converges() => "!",
            _ => "",
        };
        (cells.len() > 1).then(|| format!("{:.2} {verdict}{sign}", refinement.rate))
    });
    line(
        &mut out,
        "conv: the error falls as a power of the number of vertices; ! not as published",
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

/// A row a shape and a column a model.
fn grid(
    out: &mut String,
    shapes: &[KnownShape],
    models: &[BendingModel],
    entry: impl Fn(KnownShape, BendingModel) -> Option<String>,
) {
    let mut heading = format!("{:22}", "");
    for model in models {
        let _ = write!(heading, "{:>COLUMN$}", model.info().name);
    }
    line(out, &heading);
    for &shape in shapes {
        let mut row = format!("{:22}", shape.name());
        for &model in models {
            let _ = write!(row, "{:>COLUMN$}", entry(shape, model).unwrap_or_default());
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
                "converges": refinement.converges(),
                "published": Published::of(shape, model).map(|published| published.converges),
                "agrees": expected(shape, model).map(|expected| expected == refinement.converges()),
            })
        })
        .collect();
    let unsigned: Value = (study.unsigned_hinges.iter())
        .map(|(level, energy)| json!({ "level": level, "energy": energy, "published": 1.72e-1 }))
        .collect();
    json!({
        "bench": "convergence",
        "cells": cells,
        "refinements": refinements,
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
            koiter::scene::measure::shapes::SmoothEnergy::Koiter => "koiter",
            koiter::scene::measure::shapes::SmoothEnergy::SquaredCurvature => "squared-curvature",
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
        "within": published.map(|p| p.holds(cell.energy)),
    })
}
