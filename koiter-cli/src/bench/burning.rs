//! `koiter bench burning`: what a step of a double layer costs, how its projections converge, how far burning strips curl.

mod errors;
mod strips;

use koiter::Vec3;
use koiter::burning::{
    BurningOptions, BurningSetup, BurningShell, DoubleLayer, ProjectionOptions, QuadMesh,
    Surroundings,
};
use serde_json::json;

use super::table::{Cell, Table};
use crate::arguments::BurningArguments;
use crate::failure::Failure;
use crate::output::say;

/// Table 2 of "Shrinkage, wrinkling and ablation of burning cloth and paper": cells a side, ms a step with convergence
/// conditions and without, on four cores. (It prints 10,000 springs in its last row; its own quotient says 100,000.)
const PUBLISHED: [(usize, f64, f64); 5] = [
    (10, 6.50, 142.46),
    (20, 27.93, 362.69),
    (40, 159.17, 1268.00),
    (50, 211.67, 1877.92),
    (100, 1045.02, 7412.92),
];

/// Steps before the clock runs.
const WARM_UP: usize = 3;
const DT: f64 = 0.002;

pub(super) fn bench(arguments: &BurningArguments, json: bool) -> Result<(), Failure> {
    let timing = timing(arguments)?;
    let [competing, sweeps] = [errors::competing_springs(), errors::sweeps()];
    let strips = strips::table()?;
    if json {
        let tables = [&timing, &competing, &sweeps, &strips].map(Table::json);
        say!("{}", json!({ "bench": "burning", "tables": tables }));
    } else {
        say!("{timing}\n\n{competing}\n\n{sweeps}\n\n{strips}");
    }
    Ok(())
}

fn timing(arguments: &BurningArguments) -> Result<Table, Failure> {
    let mut table = Table::new(
        "motion of a hanging sheet, 7 sweeps a step, one thread",
        &[
            ("springs", "springs"),
            ("converging_ms", "to 1e-7 [ms/step]"),
            ("gradient_iterations", "CG a solve"),
            ("fixed_ms", "all iterations [ms/step]"),
            ("fixed_us_a_spring", "[µs/spring]"),
            ("published_converging_ms", "paper [ms]"),
            ("published_fixed_ms", "paper, all [ms]"),
            ("times_faster", "times faster, all"),
        ],
    );
    let [iterations, steps] = [arguments.iterations, arguments.steps].map(usize::from);
    for cells in arguments.cells.iter().copied().map(usize::from) {
        let springs = 10 * cells * cells;
        let converging = ProjectionOptions::default();
        let fixed = ProjectionOptions {
            tolerance: 0.0,
            gradient_iterations: iterations,
            ..converging.clone()
        };
        let (converging_ms, taken) = step_cost(cells, converging, steps)?;
        let (fixed_ms, _) = step_cost(cells, fixed, steps)?;
        let published = PUBLISHED.iter().find(|row| row.0 == cells);
        let cell = |value: Option<f64>| value.map_or(Cell::from("-"), Cell::from);
        table.push([
            springs.into(),
            converging_ms.into(),
            taken.into(),
            fixed_ms.into(),
            (1e3 * fixed_ms / springs as f64).into(),
            cell(published.map(|row| row.1)),
            cell(published.map(|row| row.2)),
            cell(published.map(|row| row.2 / fixed_ms)),
        ]);
    }
    Ok(table)
}

/// Milliseconds of the motion in the fastest of `steps` steps, and mean iterations a solve.
fn step_cost(
    cells: usize,
    projection: ProjectionOptions,
    steps: usize,
) -> Result<(f64, f64), Failure> {
    let mut mesh = QuadMesh::grid([1.0; 2], [cells; 2]).map_err(Failure::input)?;
    mesh.move_by(|x| Vec3::new(x.x, 0.02 * (9.0 * x.x).sin() * (7.0 * x.y).cos(), x.y));
    let shell = DoubleLayer::new(mesh, 0.25 / cells as f64);
    let is_held = |v: &usize| shell.particles[*v].z > 0.499 && shell.particles[*v].x.abs() > 0.499;
    let held = (0..shell.num_corners()).filter(is_held);
    let mut around = Surroundings {
        gravity: Vec3::new(0.0, 0.0, -9.81),
        held: held.map(|v| (v as u32, shell.particles[v])).collect(),
        ..Surroundings::default()
    };
    let setup = BurningSetup {
        shell,
        area_density: 0.1,
        temperature: 293.0,
        ambient_temperature: 293.0,
        cooling_rate: 0.0,
        diffusivity: 0.0,
        diffusivity_factors: Vec::new(),
        burning: BurningOptions::default(),
        loss_factors: Vec::new(),
        projection,
        damping: 0.0,
    };
    let mut burning = BurningShell::new(setup).map_err(Failure::input)?;
    let (mut fastest, mut solves, mut iterations) = (f64::INFINITY, 0, 0);
    for step in 0..WARM_UP + steps.max(1) {
        let time = step as f64 * DT;
        let report = burning
            .step(time, DT, &mut |_, _| (), &mut around)
            .map_err(Failure::run)?;
        if step >= WARM_UP {
            fastest = fastest.min(report.seconds[2]);
            solves += 4 * report.sweeps;
            iterations += report.gradient_iterations;
        }
    }
    Ok((1e3 * fastest, iterations as f64 / solves as f64))
}
