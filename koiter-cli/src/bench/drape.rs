//! The scene `drape-n`: whole steps, for several sizes, bending models and numbers of threads.

use std::collections::BTreeMap;
use std::time::Instant;

use koiter::scene::Simulation;

use super::table::{Cell, Table};
use super::{on_threads, thread_counts};
use crate::arguments::{DrapeArguments, SceneArguments, bending_models};
use crate::failure::Failure;
use crate::scene_source::load;

/// Seconds by part that have columns of their own.
const PARTS: [&str; 6] = [
    "assembly",
    "linear_solve",
    "analysis",
    "contact",
    "collision_detection",
    "line_search",
];

pub(super) fn bench(options: &DrapeArguments) -> Result<Table, Failure> {
    let mut table = Table::new(
        "the scene drape-n",
        &[
            ("n", "n"),
            ("faces", "triangles"),
            ("bending", "bending"),
            ("threads", "threads"),
            ("steps", "steps"),
            ("iterations", "iterations"),
            ("seconds", "s"),
            ("milliseconds_per_iteration", "ms an iteration"),
            ("assembly_seconds", "assembly, s"),
            ("linear_solve_seconds", "linear solve, s"),
            ("analysis_seconds", "analysis, s"),
            ("contact_seconds", "contact, s"),
            ("collision_detection_seconds", "CCD, s"),
            ("line_search_seconds", "line search, s"),
            ("mean_height", "mean height, m"),
            ("lowest", "lowest, m"),
            ("unconverged", "unconverged"),
        ],
    );
    let threads = match &options.threads[..] {
        [] => thread_counts(),
        given => given.to_vec(),
    };
    for model in bending_models(&options.bending).map_err(Failure::input)? {
        let bending = model.info().name;
        for &n in &options.n {
            for &count in &threads {
                let run = on_threads(count, || Run::new(n, bending, options.steps))??;
                table.push(run.row(n, bending, count));
            }
        }
    }
    Ok(table)
}

struct Run {
    faces: usize,
    steps: usize,
    iterations: usize,
    unconverged: usize,
    seconds: f64,
    parts: BTreeMap<&'static str, f64>,
    mean_height: f64,
    lowest: f64,
}

impl Run {
    fn new(n: usize, bending: &str, steps: usize) -> Result<Self, Failure> {
        let scene = load(&SceneArguments {
            scene: "drape-n".into(),
            overrides: vec![
                format!("shell.cloth.mesh.grid.cells=[{n},{n}]"),
                format!("shell.cloth.bending={bending}"),
            ],
            memory: None,
        })?
        .scene;
        let dt = scene.timeline.dt(1);
        let mut simulation = Simulation::new(scene.model).map_err(Failure::start)?;
        let mut run = Self {
            faces: simulation.stats().faces,
            steps,
            iterations: 0,
            unconverged: 0,
            seconds: 0.0,
            parts: BTreeMap::new(),
            mean_height: 0.0,
            lowest: 0.0,
        };
        let start = Instant::now();
        for _ in 0..steps {
            let report = simulation.step(dt).map_err(Failure::step)?;
            run.iterations += report.newton_iterations;
            run.unconverged += usize::from(!report.converged);
            for (part, seconds) in report.seconds {
                *run.parts.entry(part).or_default() += seconds;
            }
        }
        run.seconds = start.elapsed().as_secs_f64();
        let heights: Vec<f64> = (simulation.shell_positions(0).iter())
            .map(|x| x.z)
            .collect();
        run.mean_height = heights.iter().sum::<f64>() / heights.len() as f64;
        run.lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
        Ok(run)
    }

    fn row(&self, n: usize, bending: &str, threads: usize) -> Vec<Cell> {
        let mut row: Vec<Cell> = vec![
            n.into(),
            self.faces.into(),
            bending.into(),
            threads.into(),
            self.steps.into(),
            self.iterations.into(),
            self.seconds.into(),
            (1e3 * self.seconds / self.iterations.max(1) as f64).into(),
        ];
        let spent = |part: &&str| self.parts.get(part).copied().unwrap_or(0.0);
        row.extend(PARTS.iter().map(|part| Cell::Figure(spent(part))));
        row.extend([
            self.mean_height.into(),
            self.lowest.into(),
            self.unconverged.into(),
        ]);
        row
    }
}
