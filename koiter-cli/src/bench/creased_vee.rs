//! `koiter bench creased-vee`: bending energies of a crease that the mesh does not resolve, beside the published ones.

use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

use koiter::scene::measure::shapes::{SmoothEnergy, creased_vee};
use koiter::scene::model::BendingModel;
use koiter_render::{Arrangement, Chart, Panel, Style};
use serde_json::{Value, json};

use super::convergence::bending_energy;
use super::published::{number, rows};
use crate::arguments::{CreasedVeeArguments, bending_models};
use crate::failure::Failure;
use crate::model_style::series;
use crate::output::say;
use crate::{output_path, plot};

/// Dihedral angles over π: those of the table …
const ANGLES: [f64; 6] = [0.75, 0.5, 0.25, 0.125, 0.0625, 0.03125];
/// … and more for the curves.
const MORE_ANGLES: [f64; 4] = [0.9375, 0.875, 0.625, 0.375];

const WHY_NOT_DS_2ND: &str =
    "ds-2nd is not measured here, nor in the paper: its minimisation needs a smooth surface";

/// One energy.
struct Cell {
    /// Dihedral angle over π.
    angle: f64,
    model: BendingModel,
    energy: f64,
    seconds: f64,
}

/// What the paper prints.
struct Published {
    energy: f64,
    tolerance: f64,
}

impl Published {
    fn of(angle: f64, model: BendingModel) -> Option<Self> {
        let table = include_str!("../../../benchmarks/creased-vee/table5.csv");
        let is_this = |row: &Vec<&str>| number(row[0]) == angle && row[1] == model.info().name;
        let row = rows(table).find(is_this)?;
        Some(Self {
            energy: number(row[2]),
            tolerance: number(row[3]),
        })
    }

    fn holds(&self, energy: f64) -> bool {
        (energy / self.energy - 1.0).abs() <= self.tolerance
    }
}

/// Measures, and prints and draws what was measured.
pub(super) fn bench(options: &CreasedVeeArguments, as_json: bool) -> Result<(), Failure> {
    let mut models = bending_models(&options.models).map_err(Failure::input)?;
    let asked = models.len();
    models.retain(|model| *model != BendingModel::Ds2nd);
    if models.is_empty() {
        return Err(Failure::input(format!(
            "there is nothing to measure: {WHY_NOT_DS_2ND}"
        )));
    }
    let left_out = (models.len() < asked).then_some(WHY_NOT_DS_2ND);
    let mut angles = ANGLES.to_vec();
    if let Some(folder) = &options.plot {
        output_path::make_folder(folder)?;
        angles.extend(MORE_ANGLES);
        angles.sort_by(|a, b| b.total_cmp(a));
    }
    let start = Instant::now();
    let mut cells = Vec::new();
    let mut vertices = 0;
    for &angle in &angles {
        let area = 4f64.powi(options.level.into()) * 1e-8;
        let surface = creased_vee(angle * PI, area).map_err(Failure::run)?;
        vertices = surface.deformed.mesh.num_vertices();
        for &model in &models {
            let clock = Instant::now();
            cells.push(Cell {
                angle,
                model,
                energy: bending_energy(&surface, model),
                seconds: clock.elapsed().as_secs_f64(),
            });
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    if let Some(folder) = &options.plot {
        draw(&cells, &models, folder)?;
    }
    if as_json {
        let cells: Value = (cells.iter())
            .map(|cell| cell_json(cell, options.level))
            .collect();
        say!(
            "{}",
            json!({
                "bench": "creased-vee",
                "vertices": vertices,
                "cells": cells,
                "left_out": left_out,
                "seconds": seconds,
            })
        );
    } else {
        say!("{}", text(&cells, &models, vertices, options.level));
        if let Some(reason) = left_out {
            say!("{reason}");
        }
        say!("{seconds:.0} s");
    }
    Ok(())
}

fn cell_json(cell: &Cell, level: u8) -> Value {
    let published = Published::of(cell.angle, cell.model);
    let published = published.as_ref();
    json!({
        "dihedral_angle": cell.angle * PI,
        "angle_over_pi": cell.angle,
        "model": cell.model.info().name,
        "energy": cell.energy,
        "published": published.map(|p| p.energy),
        "tolerance": published.map(|p| p.tolerance),
        "within": published.filter(|_| level == 0).map(|p| p.holds(cell.energy)),
        "seconds": cell.seconds,
    })
}

/// A row a model, two columns an angle: ours and the paper's.
fn text(cells: &[Cell], models: &[BendingModel], vertices: usize, level: u8) -> String {
    let columns = match level {
        0 => ": ours, and the published figure",
        _ => "",
    };
    let mut out = format!(
        "bending energy [J] over the dihedral angle, {vertices} vertices{columns}\n{:10}",
        ""
    );
    for angle in ANGLES {
        let _ = write!(out, "{:>20}", format!("{angle} π"));
    }
    for &model in models {
        let _ = write!(out, "\n{:10}", model.info().name);
        for angle in ANGLES {
            let here = |cell: &&Cell| cell.angle == angle && cell.model == model;
            let Some(cell) = cells.iter().find(here) else {
                continue;
            };
            let entry = match Published::of(angle, model) {
                Some(p) if level == 0 => {
                    let mark = if p.holds(cell.energy) { "✓" } else { "✗" };
                    format!("{}{mark} {:>7}", short(cell.energy), short(p.energy))
                }
                _ => short(cell.energy),
            };
            let _ = write!(out, "{entry:>20}");
        }
    }
    out.push_str(match level {
        0 => "\n✓ inside, ✗ outside of the tolerance of benchmarks/creased-vee/SOURCE.md. ",
        _ => "\nPublished figures are for level 0. ",
    });
    out.push_str(
        "Directors start in the bisecting plane; unstable ones are turned off it to either side at random, the same each time.",
    );
    out
}

/// Four digits.
fn short(value: f64) -> String {
    match value {
        large if large >= 1e4 => format!("{large:.3e}"),
        value => {
            let digits = 3 - value.abs().max(1e-9).log10().floor() as i32;
            format!("{value:.*}", digits.max(0) as usize)
        }
    }
}

/// Figures 13 and 14: a logarithmic and a linear axis.
fn draw(cells: &[Cell], models: &[BendingModel], folder: &Path) -> Result<(), Failure> {
    let kinds = [
        ("log", Style::LogLines, f64::INFINITY),
        ("linear", Style::Lines, LINEAR_TOP),
    ];
    for (name, style, top) in kinds {
        let panel = |title: &str, smooth: SmoothEnergy| {
            let shown = models
                .iter()
                .filter(|model| SmoothEnergy::of(**model) == Some(smooth));
            let curve = |model: &BendingModel| {
                let points = cells.iter().filter(|cell| cell.model == *model);
                let mut points: Vec<[f64; 2]> = points
                    .map(|cell| [cell.angle * 180.0, cell.energy])
                    .filter(|point| point[1] <= top)
                    .collect();
                points.sort_by(|a, b| a[0].total_cmp(&b[0]));
                series(*model, points)
            };
            Panel {
                name: format!("bending energy, {title} models"),
                unit: "J".to_owned(),
                style,
                series: shown.map(curve).collect(),
                weight: 1.0,
                if_empty: "no models of this energy".to_owned(),
                ..Panel::default()
            }
        };
        let chart = Chart {
            title: "Creased vee: energy over the dihedral angle on a fixed mesh".to_owned(),
            x_label: "dihedral angle [°], 0 folded, 180 flat".to_owned(),
            x_range: (0.0, 180.0),
            arrangement: Arrangement::Beside,
            panels: vec![
                panel("Squared Curvature", SmoothEnergy::SquaredCurvature),
                panel("Koiter", SmoothEnergy::Koiter),
            ],
            ..Chart::default()
        };
        for extension in ["svg", "png"] {
            let path = folder.join(format!("creased-vee-{name}.{extension}"));
            plot::write(&chart, (1400, 640), &path)?;
        }
    }
    Ok(())
}

/// The models that diverge leave the linear figure here [J], as in the paper.
const LINEAR_TOP: f64 = 100.0;
