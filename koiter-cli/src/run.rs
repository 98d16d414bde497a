//! `koiter run`: from a scene to a result folder, figures, pictures and a film.

mod beginning;
mod progress;
mod record;
mod recorder;
mod start;

pub(crate) use start::start;

use crate::output::{say, say_error};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use koiter::integrate::StepReport;
use koiter::scene::Scene;
use koiter::scene::Simulation;
use koiter::scene::model::Model;
use koiter::scene::spec::MAX_STEPS;

use crate::arguments::RunArguments;
use crate::failure::Failure;
use crate::pictures;
use crate::scene_source::load;
use beginning::Beginning;
use progress::Progress;
use record::decimal_time;
use recorder::Recorder;

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
    let beginning = beginning::find(arguments, &folder, &loaded, num_steps)?;
    if let Beginning::Finished(summary) = beginning {
        return beginning::say_finished(arguments, &folder, &summary);
    }
    let mut simulation = start(&loaded.scene.model, arguments.debug_mesh.as_deref())?;
    let interrupted = watch_for_interrupt();
    let mut recorder = match beginning {
        Beginning::Checkpoint(checkpoint) => {
            simulation
                .restore(&checkpoint.snapshot)
                .map_err(|error| Failure::input(error).with_help(beginning::BEGIN_AGAIN))?;
            // A run that went further than it is now to go is not cut back.
            let num_steps = num_steps.max(simulation.step_count());
            Recorder::resume(&folder, &loaded, &simulation, num_steps, &checkpoint.totals)?
        }
        _ => Recorder::create(&folder, &loaded, &simulation, num_steps)?,
    };
    let mut progress = Progress::new(num_steps, simulation.step_count(), arguments.quiet);
    let end = advance(
        simulation,
        num_steps,
        &mut recorder,
        &mut progress,
        &interrupted,
    );
    progress.finish();
    let summary_written = recorder.write_summary();
    if let Err(failure) = end.and(summary_written) {
        return Err(match recorder.has_checkpoint() {
            true => failure.with_help(beginning::how_to_go_on()),
            false => failure,
        });
    }
    // All is saved: Ctrl-C now ends the program at once.
    let interrupted = interrupted.swap(true, Ordering::Relaxed) && recorder.summary.interrupted;
    let made = match arguments.no_film || interrupted {
        true => Vec::new(),
        false => pictures::after_run(&folder, &loaded.scene.output, arguments.quiet)?,
    };
    if arguments.json {
        let json = serde_json::to_string(&recorder.summary).map_err(Failure::run)?;
        say!("{json}");
    } else if !arguments.quiet {
        recorder.summary.print(&folder, &made);
    }
    if recorder.summary.interrupted {
        let message = format!(
            "interrupted after step {} of {num_steps}; the result up to there is whole",
            recorder.summary.steps
        );
        return Err(Failure::run(message).with_help(beginning::how_to_go_on()));
    }
    if recorder.unconverged > 0 {
        let message = format!(
            "{} of {} steps did not converge",
            recorder.unconverged, recorder.summary.steps
        );
        let failure = Failure::run(message)
            .with_help("stats.jsonl has the diagnosis of each; try a smaller time.dt, or a larger solver.max_iterations");
        return Err(tell_of_free_parts(failure, &loaded.scene.model));
    }
    Ok(())
}

/// A static run in which a shell can move without being deformed fails for this reason more often than for another.
fn tell_of_free_parts(failure: Failure, model: &Model) -> Failure {
    match model.free_parts().first() {
        Some(part) => failure.with_help(format!(
            "nothing but contact holds {part}; pin some vertices, or use integrator = \"implicit-euler\""
        )),
        None => failure,
    }
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
        say_error!("ending after this step, which saves the run; Ctrl-C again ends at once");
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
    for step in simulation.step_count() + 1..=num_steps {
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
