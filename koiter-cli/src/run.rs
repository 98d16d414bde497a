//! `koiter run`: from a scene to a result folder, figures, pictures and a film.

mod account;
mod beginning;
mod control;
mod playing;
mod progress;
mod refusals;
mod start;
mod told;

pub(crate) use start::start;

use crate::output::say;
use std::path::{Path, PathBuf};

use koiter::integrate::StepReport;
use koiter::io::record::Recorder;
use koiter::io::result::FolderLock;
use koiter::scene::model::Model;
use koiter::scene::spec::MAX_STEPS;
use koiter::scene::{Scene, Simulation, Timeline};

use crate::arguments::RunArguments;
use crate::failure::{Code, Failure};
use crate::interrupt::Interrupt;
use crate::memory;
use crate::pictures;
use crate::scene_source::load;
use account::Account;
use beginning::Beginning;
use control::Control;
use playing::{Playing, played_until};
use progress::Progress;

/// Runs a scene.
pub(crate) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    if let Some(threads) = arguments.threads {
        use_threads(threads)?;
    }
    let loaded = load(&arguments.scene)?;
    let played_until = (arguments.interactive).then(|| played_until(&loaded.scene.timeline));
    let num_steps = num_steps(&loaded.scene, arguments.until.or(played_until))?;
    let folder = arguments
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("results").join(&loaded.name));
    let (simulation, mut recorder) = match beginning::find(arguments, &folder, &loaded, num_steps)?
    {
        Beginning::Finished(summary) => {
            return beginning::say_finished(arguments, &folder, &loaded, &summary);
        }
        Beginning::Start(lock) => {
            let simulation = start(&loaded.scene.model, arguments.debug_mesh.as_deref())?;
            let lock = lock.map_or_else(|| FolderLock::create(&folder), Ok);
            let lock = lock.map_err(refusals::writing)?;
            let recorder =
                Recorder::create(lock, &loaded.scene, &loaded.text, &simulation, num_steps)
                    .map_err(refusals::writing)?;
            (simulation, recorder)
        }
        Beginning::Checkpoint(checkpoint, lock) => {
            let mut simulation = start(&loaded.scene.model, arguments.debug_mesh.as_deref())?;
            simulation
                .restore(&checkpoint.snapshot)
                .map_err(|error| beginning::not_resumed(error).with_help(beginning::BEGIN_AGAIN))?;
            // A run that went further than it is now to go is not cut back.
            let end = match simulation.has_ended() {
                true => simulation.step_count(),
                false => num_steps.max(simulation.step_count()),
            };
            let recorder = Recorder::resume(
                lock,
                &loaded.scene,
                &loaded.text,
                &simulation,
                end,
                &checkpoint.totals,
            )
            .map_err(refusals::damaged)?;
            (simulation, recorder)
        }
    };
    let interrupt = Interrupt::watch();
    let control = Control::new(&folder, &interrupt, arguments.quiet);
    let playing = (arguments.interactive)
        .then(|| Playing::begin(&folder, &simulation))
        .transpose()?;
    let mut progress = Progress::new(num_steps, simulation.step_count(), arguments.quiet);
    let end = advance(
        &loaded.scene.timeline,
        simulation,
        num_steps,
        &mut recorder,
        &mut progress,
        &control,
        playing,
    );
    progress.finish();
    let summary_written = (recorder.write_summary(memory::peak_bytes())).map_err(refusals::writing);
    let is_told = !arguments.json && !arguments.quiet;
    if let Err(failure) = end.and(summary_written) {
        if is_told {
            tell_account(&folder);
        }
        return Err(match recorder.has_checkpoint() {
            true => failure.with_help(beginning::how_to_go_on()),
            false => failure,
        });
    }
    // All is saved.
    interrupt.end_at_once(
        pictures::without_film(&folder),
        pictures::partial_files(&folder),
    );
    let made = match arguments.no_film || recorder.summary.interrupted {
        true => Vec::new(),
        false => pictures::after_run(&folder, &loaded.scene.output, arguments.quiet)?,
    };
    if arguments.json {
        let json = serde_json::to_string(&recorder.summary).map_err(Failure::run)?;
        say!("{json}");
    } else if is_told {
        told::print(&recorder.summary);
        tell_account(&folder);
        told::print_files(&folder, &made);
    }
    tell_of_cold(&recorder, &loaded.scene.model);
    judge(&recorder, &loaded.scene.model, num_steps)
}

/// Says that sources of heat have set fire to nothing.
fn tell_of_cold(recorder: &Recorder, model: &Model) {
    let has_sources = !model.heat_sources.is_empty();
    if let Some(hottest) = (recorder.summary.never_ignited()).filter(|_| has_sources) {
        log::warn!(
            target: "koiter",
            "nothing burnt: after no step was it warmer than {hottest:.0} K; does the source come near, is it hot enough, is its rate \
             high enough, does ignition_temperature lie below what it can reach?"
        );
    }
}

/// Says where the time went; figures that cannot be read back are no reason to fail.
fn tell_account(folder: &Path) {
    match Account::read(folder) {
        Ok(account) => account.print(),
        Err(error) => log::warn!(target: "koiter", "{error}"),
    }
}

/// Whether the run did what it was asked.
fn judge(recorder: &Recorder, model: &Model, num_steps: usize) -> Result<(), Failure> {
    if recorder.summary.interrupted {
        let message = format!(
            "interrupted after step {} of {num_steps}; the result up to there is whole",
            recorder.summary.steps
        );
        return Err(Failure::run(message)
            .with_code(Code::Interrupted)
            .with_help(beginning::how_to_go_on()));
    }
    if recorder.num_unconverged() > 0 {
        let message = format!(
            "{} of {} steps did not converge",
            recorder.num_unconverged(),
            recorder.summary.steps
        );
        let failure = Failure::run(message)
            .with_code(Code::NotConverged)
            .with_help(
                "the warning above says what to try; stats.jsonl has the diagnosis of each step",
            );
        return Err(tell_of_free_parts(failure, model));
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
        None => Ok(scene.timeline.num_steps()),
        Some(until) if scene.timeline.steps_until(until) > MAX_STEPS => {
            Err(Failure::input(format!(
                "--until {until} s would take more than {MAX_STEPS:e} steps of {} s",
                scene.timeline.dt(usize::MAX)
            )))
        }
        Some(until) if until.is_finite() && until > 0.0 => {
            Ok(scene.timeline.steps_until(until) as usize)
        }
        Some(until) => Err(Failure::input(format!(
            "--until must be a time larger than 0 s, but it is {until}"
        ))),
    }
}

fn advance(
    timeline: &Timeline,
    simulation: Simulation,
    num_steps: usize,
    recorder: &mut Recorder,
    progress: &mut Progress,
    control: &Control<'_>,
    playing: Option<Playing>,
) -> Result<(), Failure> {
    let (mut simulation, mut playing) = (simulation, playing);
    for step in simulation.step_count() + 1..=num_steps {
        if simulation.has_ended() {
            break;
        }
        control.wait_while_paused();
        if let Some(playing) = &mut playing {
            playing.before_step(&mut simulation);
        }
        let report = match simulation.step(timeline.dt(step)) {
            Ok(report) => StepReport {
                time: timeline.time(step),
                ..report
            },
            Err(error) => {
                recorder.note_error(&error);
                return Err(Failure::step(error));
            }
        };
        let stop = control.is_to_end();
        if simulation.has_ended() {
            // A path is over where its last load is reached, however many steps were planned.
            recorder.summary.planned_steps = step;
        }
        let ended = step == recorder.summary.planned_steps;
        (recorder.record(&simulation, &report, stop || ended)).map_err(refusals::writing)?;
        progress.show(&report);
        if stop {
            recorder.summary.interrupted = !ended;
            control.obeyed();
            break;
        }
    }
    Ok(())
}
