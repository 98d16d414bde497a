//! `koiter bench burning`: what a step of a double layer costs, how its projections converge, how far burning strips curl.

mod errors;
mod formulas;
mod heat;
mod scenes;
mod strips;

use koiter::Vec3;
use koiter::burning::{
    BurningOptions, BurningSetup, BurningShell, DoubleLayer, ProjectionOptions, QuadMesh,
    Surroundings,
};
use serde_json::json;

use super::gates::{Gate, Gates};
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

/// Springs from which time is to grow in proportion to them.
const LINEAR_FROM: usize = 4000;
/// Steps before the clock runs.
const WARM_UP: usize = 3;
const DT: f64 = 0.002;

pub(super) fn bench(arguments: &BurningArguments, json: bool) -> Result<(), Failure> {
    if arguments.scenes {
        return tell(&[scenes::gates()?.table], json);
    }
    let mut gates = Gates::new("what is to hold");
    formulas::check(&mut gates);
    heat::check(&mut gates);
    let timing = timing(arguments, &mut gates)?;
    let [competing, sweeps] = [errors::competing_springs(), errors::sweeps()];
    let strips = strips::table(&mut gates)?;
    tell(&[timing, competing, sweeps, strips, gates.table], json)
}

fn tell(tables: &[Table], json: bool) -> Result<(), Failure> {
    if json {
        let tables: Vec<_> = tables.iter().map(Table::json).collect();
        say!("{}", json!({ "bench": "burning", "tables": tables }));
    } else {
        let texts: Vec<String> = tables.iter().map(ToString::to_string).collect();
        say!("{}", texts.join("\n\n"));
    }
    let failures = tables.iter().flat_map(|table| table.failures.clone());
    match failures.collect::<Vec<_>>() {
        failures if failures.is_empty() => Ok(()),
        failures => Err(Failure::run(failures.join("\n"))),
    }
}

fn timing(arguments: &BurningArguments, gates: &mut Gates) -> Result<Table, Failure> {
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
    let (mut a_spring, mut times_faster) = (Vec::new(), Vec::new());
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
        if springs >= LINEAR_FROM {
            a_spring.push(fixed_ms / springs as f64);
        }
        times_faster.extend(published.map(|row| row.2 / fixed_ms));
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
    let most = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
    if !a_spring.is_empty() {
        let spread = most(&a_spring) / least(&a_spring);
        let figure = "time a spring, slowest over fastest from 4000 springs";
        gates.check("Table 2", figure, "", spread, Gate::Below(2.0));
    }
    if !times_faster.is_empty() {
        let figure = "times faster than printed, at least";
        gates.check(
            "Table 2",
            figure,
            "",
            least(&times_faster),
            Gate::Above(20.0),
        );
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
        self_collision: None,
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
