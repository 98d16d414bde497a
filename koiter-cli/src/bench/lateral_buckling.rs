//! The lateral buckling of a heavy plate that stands on edge: "Better Bending", section 10.3, after Romero et al. 2021.
//!
//! The scene `lateral-buckling` with irregular meshes, for several widths w/L and bending models: the largest lateral
//! displacement over the load Γ* = 12 (1 − ν²) ρ g L³ / (E h²), and the load at which the plane plate becomes unstable,
//! found by bisection: below it the plate stays in its plane to round-off, above it the solver leaves the saddle. The
//! bisection does not follow the plate any further: near the critical load that takes thousands of iterations.

use std::path::Path;
use std::time::Instant;

use koiter::scene::Simulation;
use koiter::scene::model::BendingModel;
use koiter_render::{Chart, Panel, Series, Style};
use serde_json::{Value, json};

use super::table::{Cell, Table};
use crate::arguments::{LateralBucklingArguments, SceneArguments, bending_models};
use crate::failure::Failure;
use crate::scene_source::load_silently;
use crate::{model_style, output_path, plot};

/// Lateral displacement over L at which a plate counts as buckled: a plane one stays plane to 1e-12.
const BUCKLED: f64 = 1e-6;

/// Relative width of the bracket in which the bisection leaves the critical load.
const ONSET_ACCURACY: f64 = 2e-3;

/// Iterations after which a plate that has not left its plane counts as stable: a plane one converges in ten.
const ENOUGH_TO_LEAVE: usize = 40;

/// Poisson's ratio of the scene.
const POISSONS_RATIO: f64 = 0.3;

/// Critical loads by linear buckling analysis with converged Kirchhoff–Love plates
/// (benchmarks/lateral-buckling/SOURCE.md): w/L, Γ*.
const LINEAR_BUCKLING: [(f64, f64); 3] = [(0.1, 15.67), (0.5, 21.60), (0.9, 28.21)];

/// The line through the critical loads of Romero et al. 2021 ("Better Bending", Eq. 61).
fn master_curve(width: f64) -> f64 {
    18.2 * (1.0 - POISSONS_RATIO) * (1.0 + POISSONS_RATIO).sqrt() + 14.5 * width
}

fn linear_buckling(width: f64) -> Option<f64> {
    let known = LINEAR_BUCKLING
        .iter()
        .find(|(w, _)| (w - width).abs() < 1e-9);
    known.map(|(_, load)| *load)
}

/// One model on one plate.
struct Study {
    width: f64,
    bending: BendingModel,
    triangles: usize,
    /// Γ* and largest lateral displacement over L.
    curve: Vec<[f64; 2]>,
    /// The largest load known to be stable and the smallest known not to be; not finite where there is none.
    onset: [f64; 2],
    iterations: usize,
    unconverged: usize,
    seconds: f64,
}

pub(super) fn bench(options: &LateralBucklingArguments) -> Result<Table, Failure> {
    if !options.loads.is_sorted() {
        return Err(Failure::input("--loads must grow from one to the next"));
    }
    if let Some(folder) = &options.plot {
        output_path::make_folder(folder)?;
    }
    let mut table = Table::new(
        "lateral buckling of a heavy plate",
        &[
            ("width_to_length", "w/L"),
            ("bending", "bending"),
            ("triangles", "triangles"),
            ("onset", "onset Γ*"),
            ("linear_buckling", "linear buckling"),
            ("deviation", "deviation"),
            ("master_curve", "master curve"),
            ("largest_displacement", "d/L at the end"),
            ("iterations", "iterations"),
            ("unconverged", "unconverged"),
            ("seconds", "s"),
        ],
    );
    let mut studies = Vec::new();
    let models = bending_models(&options.models).map_err(Failure::input)?;
    let mut widths: Vec<f64> = Vec::new();
    for &width in &options.widths {
        if !widths.contains(&width) {
            widths.push(width);
        }
    }
    for &width in &widths {
        for &bending in &models {
            let study = Study::new(width, bending, options)?;
            table.push(study.row());
            studies.push(study);
        }
    }
    if let Some(folder) = &options.plot {
        plot_curves(&studies, &widths, options, folder)?;
    }
    table.details = Some(studies.iter().map(Study::json).collect());
    let failed = studies.iter().filter(|study| study.unconverged > 0);
    table.failures = failed.map(Study::failure).collect();
    Ok(table)
}

impl Study {
    fn new(
        width: f64,
        bending: BendingModel,
        options: &LateralBucklingArguments,
    ) -> Result<Self, Failure> {
        let start = Instant::now();
        let cells = usize::from(options.cells);
        let mut plate = Plate::new(width, bending, cells, &[])?;
        let mut study = Self {
            width,
            bending,
            triangles: plate.simulation.stats().faces,
            curve: Vec::new(),
            onset: [0.0, f64::INFINITY],
            iterations: 0,
            unconverged: 0,
            seconds: 0.0,
        };
        for &load in &options.loads {
            let displacement = plate.equilibrium(load)?;
            study.curve.push([load, displacement]);
            if displacement > BUCKLED {
                study.onset[1] = study.onset[1].min(load);
            } else if study.onset[1].is_infinite() {
                study.onset[0] = load;
            }
        }
        study.iterations = plate.iterations;
        study.unconverged = plate.unconverged;
        if study.onset[0] > 0.0 && study.onset[1].is_finite() {
            let brief = [
                format!("solver.max_iterations={ENOUGH_TO_LEAVE}"),
                "solver.smallest_step=1".into(),
            ];
            let mut trial = Plate::new(width, bending, cells, &brief)?;
            study.onset = trial.bisect(study.onset)?;
            study.iterations += trial.iterations;
        }
        study.seconds = start.elapsed().as_secs_f64();
        Ok(study)
    }

    /// The critical load, where it was bracketed from both sides.
    fn critical_load(&self) -> Option<f64> {
        let [stable, unstable] = self.onset;
        (stable > 0.0 && unstable.is_finite()).then_some(0.5 * (stable + unstable))
    }

    /// The curve, with the point where it leaves the axis.
    fn curve_with_onset(&self) -> Vec<[f64; 2]> {
        let mut curve = self.curve.clone();
        if let Some(load) = self.critical_load() {
            let place = curve.partition_point(|point| point[0] < load);
            curve.insert(place, [load, 0.0]);
        }
        curve
    }

    fn row(&self) -> Vec<Cell> {
        let none = || Cell::Text("–".into());
        let reference = linear_buckling(self.width);
        let [stable, unstable] = self.onset;
        let onset = match self.critical_load() {
            Some(load) => Cell::Figure(load),
            None if unstable.is_finite() => Cell::Text(format!("below {unstable}")),
            None => Cell::Text(format!("above {stable}")),
        };
        let deviation = (self.critical_load().zip(reference)).map(|(a, b)| a / b - 1.0);
        vec![
            self.width.into(),
            self.bending.info().name.into(),
            self.triangles.into(),
            onset,
            reference.map_or(none(), Cell::Figure),
            deviation.map_or(none(), Cell::Figure),
            master_curve(self.width).into(),
            self.curve.last().map_or(0.0, |point| point[1]).into(),
            self.iterations.into(),
            self.unconverged.into(),
            self.seconds.into(),
        ]
    }

    fn failure(&self) -> String {
        format!(
            "{} with w/L = {}: {} of {} loads did not converge",
            self.bending.info().name,
            self.width,
            self.unconverged,
            self.curve.len()
        )
    }

    fn json(&self) -> Value {
        let [stable, unstable] = self.onset;
        json!({
            "width_to_length": self.width,
            "bending": self.bending.info().name,
            "onset": self.critical_load(),
            "largest_stable_load": stable,
            "smallest_unstable_load": unstable.is_finite().then_some(unstable),
            "linear_buckling": linear_buckling(self.width),
            "master_curve": master_curve(self.width),
            "load_and_displacement": self.curve,
        })
    }
}

/// The plate and what its equilibria took.
struct Plate {
    simulation: Simulation,
    iterations: usize,
    unconverged: usize,
}

impl Plate {
    /// A plate of length 1 m with `cells` edges along it, with more settings of the scene.
    fn new(
        width: f64,
        bending: BendingModel,
        cells: usize,
        settings: &[String],
    ) -> Result<Self, Failure> {
        let columns = (cells as f64 * width + 1e-9).floor().max(1.0);
        let max_area = width / (2.0 * columns * cells as f64);
        let mut overrides = vec![
            format!("shell.plate.mesh.irregular.size=[{width},1.0]"),
            format!("shell.plate.mesh.irregular.max_area={max_area:e}"),
            format!("shell.plate.bending={}", bending.info().name),
        ];
        overrides.extend_from_slice(settings);
        // That the plate is thicker than a tenth of its edges is the benchmark's wish.
        let scene = load_silently(&SceneArguments {
            scene: "lateral-buckling".into(),
            overrides,
            memory: None,
        })?
        .scene;
        Ok(Self {
            simulation: Simulation::new(scene.model).map_err(Failure::start)?,
            iterations: 0,
            unconverged: 0,
        })
    }

    /// The largest lateral displacement over L at equilibrium under `load`; in the scene Γ* is the time.
    fn equilibrium(&mut self, load: f64) -> Result<f64, Failure> {
        let dt = load - self.simulation.time();
        let report = self.simulation.step(dt).map_err(Failure::step)?;
        self.iterations += report.newton_iterations;
        self.unconverged += usize::from(!report.converged);
        let lateral = self.simulation.shell_positions(0).into_iter();
        Ok(lateral.map(|x| x.z.abs()).fold(0.0, f64::max))
    }

    /// Narrows a bracket of loads, each put at once on the plate at rest.
    fn bisect(&mut self, [mut low, mut high]: [f64; 2]) -> Result<[f64; 2], Failure> {
        let at_rest = self.simulation.snapshot();
        while high - low > ONSET_ACCURACY * low {
            let middle = 0.5 * (low + high);
            self.simulation.restore(&at_rest).map_err(Failure::run)?;
            if self.equilibrium(middle)? > BUCKLED {
                high = middle;
            } else {
                low = middle;
            }
        }
        Ok([low, high])
    }
}

/// One panel a width, like Figure 26 of "Better Bending".
fn plot_curves(
    studies: &[Study],
    widths: &[f64],
    options: &LateralBucklingArguments,
    folder: &Path,
) -> Result<(), Failure> {
    let panels = widths.iter().map(|&width| {
        let of_width = studies.iter().filter(|study| study.width == width);
        let mut series: Vec<Series> = of_width
            .map(|study| model_style::series(study.bending, study.curve_with_onset()))
            .collect();
        let height = (series.iter().flat_map(|s| &s.points))
            .map(|p| p[1])
            .fold(0.0, f64::max);
        let critical = master_curve(width);
        series.push(Series {
            name: "master curve".into(),
            points: vec![[critical, 0.0], [critical, height]],
            color: Some([0; 3]),
            ..Series::default()
        });
        Panel {
            name: format!("lateral displacement, w/L = {width}"),
            unit: "L".into(),
            style: Style::Lines,
            series,
            weight: 1.0,
            if_empty: "no loads".into(),
            ..Panel::default()
        }
    });
    let largest = options.loads.iter().copied().fold(0.0, f64::max);
    let chart = Chart {
        title: "Lateral buckling of a plate under its own weight".into(),
        x_label: "load Γ*".into(),
        x_range: (0.0, largest),
        panels: panels.collect(),
        ..Chart::default()
    };
    for name in ["lateral-buckling.svg", "lateral-buckling.png"] {
        plot::write(&chart, (1000, 1100), &folder.join(name))?;
    }
    Ok(())
}
