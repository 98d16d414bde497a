//! Strips whose top layer burns: how far they curl, beside what their layers say.
//!
//! A strip of thickness t whose top has shrunk to υ has the curvature `(1 − υ)/(υ t)` at its top, and 1/(R − t/2) is that of
//! a strip with a radius R in the middle. The strip is as wide as thick: it would curl across as well, and a wide one would
//! have to stretch for that.

use koiter::Vec3;
use koiter::scene::{NoFiles, Scene, SceneFile, Simulation};

use crate::bench::gates::{Gate, Gates};
use crate::bench::table::{Cell, Table};
use crate::failure::Failure;

const THICKNESS: f64 = 1e-3;
const DT: f64 = 0.02;
const STEPS: usize = 10;
const CELLS: usize = 40;

/// A quasi-static strip under a lamp, held so that it can shrink and curl.
const STRIP: &str = include_str!("../../../../benchmarks/burning-strip/strip.toml");

pub(super) fn table(gates: &mut Gates) -> Result<Table, Failure> {
    let mut table = Table::new(
        "strip, 20 x 1 x 1 mm, heated from above",
        &[
            ("bending", "bending"),
            ("kelvin", "lamp [K]"),
            ("mass_ratio", "υ of the top"),
            ("curvature", "curvature at the top [1/m]"),
            ("expected", "(1 − υ)/(υ t) [1/m]"),
            ("error_percent", "error [%]"),
        ],
    );
    let mut worst: f64 = 0.0;
    for bending in ["bac", "dkt", "ds-theta", "me-average"] {
        for kelvin in [700, 900] {
            let (ratio, curvature) = curl(bending, kelvin)?;
            let expected = (1.0 - ratio) / (ratio * THICKNESS);
            worst = worst.max((curvature / expected - 1.0).abs());
            table.push([
                bending.into(),
                kelvin.into(),
                Cell::Precise(ratio),
                Cell::Precise(curvature),
                Cell::Precise(expected),
                (100.0 * (curvature / expected - 1.0)).into(),
            ]);
        }
    }
    let figure = "largest error of a curvature";
    gates.check("strips", figure, "%", 100.0 * worst, Gate::Below(3.0));
    Ok(table)
}

/// υ of the top layer, and the curvature there [1/m].
fn curl(bending: &str, kelvin: usize) -> Result<(f64, f64), Failure> {
    let overrides = [
        format!("shell.strip.bending={bending}"),
        format!("heat_source.lamp.temperature={kelvin}"),
    ];
    let file = SceneFile::parse("strip", STRIP, &overrides).map_err(Failure::run)?;
    let scene = Scene::build(&file, &NoFiles).map_err(Failure::run)?;
    let mut simulation = Simulation::new(scene.model).map_err(Failure::run)?;
    for _ in 0..STEPS {
        simulation.step(DT).map_err(Failure::run)?;
    }
    let ratios = simulation
        .heated_shell(0)
        .map(|shell| &shell.state().mass_ratios);
    let ratio = ratios.map_or(f64::NAN, |ratios| ratios[ratios.len() / 2]);
    let positions = simulation.shell_positions(0);
    // Along the middle line, away from its ends.
    let on_line = |i: usize| positions[CELLS + 1 + i];
    let radius = radius_through([6, CELLS / 2, CELLS - 6].map(on_line));
    Ok((ratio, 1.0 / (radius - 0.5 * THICKNESS)))
}

fn radius_through([a, b, c]: [Vec3; 3]) -> f64 {
    let (ab, bc, ca) = (b - a, c - b, a - c);
    ab.norm() * bc.norm() * ca.norm() / (2.0 * ab.cross(&bc).norm())
}
