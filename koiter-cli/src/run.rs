//! `koiter run`: from a scene to a result folder, figures, pictures and a film.

mod progress;
mod record;
mod start;

pub(crate) use start::start;

use crate::output::{say, say_error};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use koiter::integrate::{StepError, StepReport};
use koiter::io::result::{Field, Frame, ResultError, ResultWriter};
use koiter::scene::Scene;
use koiter::scene::Simulation;
use koiter::scene::spec::MAX_STEPS;

use crate::arguments::RunArguments;
use crate::failure::Failure;
use crate::pictures;
use crate::probes::ProbeWriter;
use crate::scene_source::{LoadedScene, load};
use progress::Progress;
use record::{StatsLine, Summary, decimal_time};

/// Runs a scene.
pub(crate) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    if let Some(threads) = arguments.threads {
        use_threads(threads)?;
    }
    let loaded = load(&arguments.scene)?;
    let num_steps = num_steps(&loaded.scene, arguments.until)?;
    let folder = arguments
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("results").join(&loaded.name));
    let simulation = start(&loaded.scene.model, arguments.debug_mesh.as_deref())?;
    let interrupted = watch_for_interrupt();
    let mut recorder = Recorder::create(&folder, &loaded, &simulation, num_steps)?;
    let mut progress = Progress::new(num_steps, arguments.quiet);
    let end = advance(
        simulation,
        num_steps,
        &mut recorder,
        &mut progress,
        &interrupted,
    );
    progress.finish();
    recorder.write_summary()?;
    let made = match arguments.no_film {
        true => Vec::new(),
        false => pictures::after_run(&folder, &loaded.scene.output, arguments.quiet)?,
    };
    if arguments.json {
        let json = serde_json::to_string(&recorder.summary).map_err(Failure::run)?;
        say!("{json}");
    } else if !arguments.quiet {
        recorder.summary.print(&folder, &made);
    }
    end?;
    if recorder.summary.interrupted {
        let message = format!(
            "interrupted after step {}; the result up to there is whole",
            recorder.summary.steps
        );
        return Err(Failure::run(message));
    }
    if recorder.unconverged > 0 {
        let message = format!(
            "{} of {} steps did not converge",
            recorder.unconverged, recorder.summary.steps
        );
        return Err(Failure::run(message)
            .with_help("stats.jsonl has the diagnosis of each; try a smaller time.dt, or a larger solver.max_iterations"));
    }
    Ok(())
}

/// Threads beyond a few a core only cost memory, and thousands exhaust the machine.
fn use_threads(threads: usize) -> Result<(), Failure> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let most = (4 * cores).max(64);
    if threads > most {
        let message =
            format!("--threads {threads}: at most {most} on this machine of {cores} cores");
        return Err(Failure::input(message));
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .map_err(|error| Failure::run(format!("cannot start {threads} threads: {error}")))
}

fn num_steps(scene: &Scene, until: Option<f64>) -> Result<usize, Failure> {
    match until {
        None => Ok(scene.num_steps),
        Some(until) if until / scene.dt > MAX_STEPS => Err(Failure::input(format!(
            "--until {until} s would take more than {MAX_STEPS:e} steps of {} s",
            scene.dt
        ))),
        Some(until) if until.is_finite() && until > 0.0 => {
            Ok(((until / scene.dt - 1e-9).ceil() as usize).max(1))
        }
        Some(until) => Err(Failure::input(format!(
            "--until must be a time larger than 0 s, but it is {until}"
        ))),
    }
}

/// The first Ctrl-C asks the run to end after the present step; the second ends the program.
fn watch_for_interrupt() -> Arc<AtomicBool> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = interrupted.clone();
    // Without a handler Ctrl-C ends the program at once, which leaves whole frames too.
    let _ = ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(1);
        }
        say_error!("ending after this step; Ctrl-C again ends at once");
    });
    interrupted
}

fn advance(
    simulation: Simulation,
    num_steps: usize,
    recorder: &mut Recorder<'_>,
    progress: &mut Progress,
    interrupted: &AtomicBool,
) -> Result<(), Failure> {
    let mut simulation = simulation;
    for step in 1..=num_steps {
        let report = match simulation.step(recorder.scene.dt) {
            Ok(report) => StepReport {
                time: decimal_time(report.step, recorder.scene.dt),
                ..report
            },
            Err(error) => {
                recorder.note_error(&error);
                return Err(Failure::run(error));
            }
        };
        let stop = interrupted.load(Ordering::Relaxed);
        recorder.record(&simulation, &report, stop || step == num_steps)?;
        progress.show(&report);
        if stop {
            recorder.summary.interrupted = step < num_steps;
            break;
        }
    }
    Ok(())
}

/// Writes what a run yields.
struct Recorder<'a> {
    scene: &'a Scene,
    writer: ResultWriter,
    probes: ProbeWriter<'a>,
    summary: Summary,
    unconverged: usize,
    started: Instant,
}

impl<'a> Recorder<'a> {
    fn create(
        folder: &std::path::Path,
        loaded: &'a LoadedScene,
        simulation: &Simulation,
        num_steps: usize,
    ) -> Result<Self, Failure> {
        let (manifest, faces) = start::manifest(loaded, simulation);
        let writer = ResultWriter::create(folder, &manifest, &faces).map_err(writing)?;
        let scene = &loaded.scene;
        let cannot_write = |error: std::io::Error| {
            Failure::run(format!(
                "cannot write {}: {error}",
                folder.join("probes.csv").display()
            ))
        };
        let probes = ProbeWriter::create(folder, &scene.probes).map_err(cannot_write)?;
        let summary = Summary::new(&simulation.stats(), num_steps, scene.model.contact.enabled);
        let started = Instant::now();
        let mut recorder = Self {
            scene,
            writer,
            probes,
            summary,
            unconverged: 0,
            started,
        };
        recorder.write_frame(simulation)?;
        recorder.write_probes(simulation)?;
        Ok(recorder)
    }

    /// Writes a step's figures, and its frame if it is due.
    fn record(
        &mut self,
        simulation: &Simulation,
        report: &StepReport,
        is_last: bool,
    ) -> Result<(), Failure> {
        self.writer
            .append_stats(&StatsLine::new(report))
            .map_err(writing)?;
        self.write_probes(simulation)?;
        if is_last || report.step.is_multiple_of(self.scene.frame_steps) {
            self.write_frame(simulation)?;
        }
        self.summary.add(report);
        if !report.converged {
            self.unconverged += 1;
            // Once a run: the others are counted at its end, and told one by one in stats.jsonl.
            if self.unconverged == 1 {
                let diagnosis = report.diagnosis.as_deref().unwrap_or("no diagnosis");
                log::warn!(target: "koiter", "step {} did not converge: {diagnosis}", report.step);
            }
        }
        Ok(())
    }

    fn write_frame(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let wanted = |name: &str| self.scene.output.fields.iter().any(|field| field == name);
        let fields = simulation
            .face_fields()
            .into_iter()
            .filter(|(name, _)| wanted(name));
        let frame = Frame {
            step: simulation.step_count() as u64,
            time: decimal_time(simulation.step_count(), self.scene.dt),
            positions: simulation.display_positions(),
            vertex_fields: Vec::new(),
            face_fields: fields
                .map(|(name, values)| Field {
                    name: name.to_owned(),
                    values,
                })
                .collect(),
        };
        self.writer.write_frame(&frame).map_err(writing)
    }

    fn write_probes(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let time = decimal_time(simulation.step_count(), self.scene.dt);
        self.probes
            .write(simulation, time)
            .map_err(|error| Failure::run(format!("cannot write probes.csv: {error}")))
    }

    fn note_error(&mut self, error: &StepError) {
        self.summary.converged = false;
        if matches!(error, StepError::Intersection { .. }) {
            self.summary.intersections = self.summary.intersections.map(|count| count + 1);
        }
    }

    fn write_summary(&mut self) -> Result<(), Failure> {
        self.summary
            .finish(self.started.elapsed(), self.probes.last_values());
        self.writer.write_summary(&self.summary).map_err(writing)
    }
}

fn writing(error: ResultError) -> Failure {
    match error {
        ResultError::NotEmpty { .. } => {
            Failure::input(error).with_help("choose another folder with --out")
        }
        error => Failure::run(error),
    }
}
