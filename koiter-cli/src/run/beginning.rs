//! Where a run begins: at the start, at a checkpoint, or nowhere because it is finished.

use std::fmt::Display;
use std::path::Path;

use koiter::io::Checkpoint;
use koiter::io::result::{FolderLock, ResultReader};
use koiter::scene::{Difference, Document, KEYS_OF_NO_STEP};
use serde_json::Value;

use super::refusals::writing;
use crate::arguments::RunArguments;
use crate::failure::{Code, Failure};
use crate::interrupt::Interrupt;
use crate::output::{quoted, say, say_error};
use crate::pictures;
use crate::scene_source::LoadedScene;

/// What a refused checkpoint leaves to do.
pub(super) const BEGIN_AGAIN: &str =
    "--restart runs the scene from the beginning and replaces this result";

/// Where a run begins, with the lock of its folder if that is there.
pub(super) enum Beginning {
    /// At time 0.
    Start(Option<FolderLock>),
    /// Where an earlier run stopped.
    Checkpoint(Box<Checkpoint>, FolderLock),
    /// The result is complete: its summary.
    Finished(Value),
}

/// Looks for what an earlier run left in the folder.
pub(super) fn find(
    arguments: &RunArguments,
    folder: &Path,
    loaded: &LoadedScene,
    num_steps: usize,
) -> Result<Beginning, Failure> {
    if !folder.is_dir() {
        if arguments.resume {
            begin_without_checkpoint(folder, arguments.quiet)?;
        }
        return Ok(Beginning::Start(None));
    }
    // Nothing is read while another run writes.
    let lock = FolderLock::take(folder).map_err(writing)?;
    let checkpoint = Checkpoint::read(folder);
    if !arguments.resume {
        if let Ok(Some(checkpoint)) = &checkpoint
            && !arguments.restart
        {
            refuse_to_replace(folder, loaded, checkpoint)?;
        }
        // What cannot be resumed is replaced like any other result.
        return Ok(Beginning::Start(Some(lock)));
    }
    let checkpoint = match checkpoint {
        Ok(Some(checkpoint)) => checkpoint,
        Ok(None) => {
            begin_without_checkpoint(folder, arguments.quiet)?;
            return Ok(Beginning::Start(Some(lock)));
        }
        Err(error) => return Err(not_resumed(error).with_help(BEGIN_AGAIN)),
    };
    if let Some(reason) = difference(loaded, &checkpoint) {
        let path = folder.join("checkpoint.bin");
        let message = format!("cannot resume from {}: {reason}", path.display());
        return Err(not_resumed(message).with_help(
            "resume with the scene and the --set values of the interrupted run, or choose another folder with --out",
        ));
    }
    let summary = summary(folder).filter(|_| checkpoint.snapshot.state.step >= num_steps);
    Ok(match summary {
        Some(summary) => Beginning::Finished(summary),
        None => Beginning::Checkpoint(Box::new(checkpoint), lock),
    })
}

/// A checkpoint that is not gone on with.
pub(super) fn not_resumed(reason: impl Display) -> Failure {
    Failure::input(reason).with_code(Code::Resume)
}

/// A run that was killed before its first checkpoint begins again, and says so; one that ended had a checkpoint, and its
/// result is not replaced because that was lost.
fn begin_without_checkpoint(folder: &Path, quiet: bool) -> Result<(), Failure> {
    let shown = folder.display();
    let reader = ResultReader::open(folder).ok();
    let summary = reader.as_ref().and_then(|reader| reader.summary().ok()?);
    let had_checkpoint = summary.is_some_and(|summary| {
        summary["interrupted"] == true || summary["steps"] == summary["planned_steps"]
    });
    if had_checkpoint {
        let message = format!("{shown} holds a result, but its checkpoint.bin is missing");
        return Err(not_resumed(message).with_help(BEGIN_AGAIN));
    }
    match reader.map_or(0, |reader| reader.len()) {
        0 if quiet => {}
        0 => say_error!("{shown} has no checkpoint to resume from: beginning at the start"),
        frames => log::warn!(
            target: "koiter",
            "{shown} has no checkpoint to resume from: beginning at the start, which replaces its {frames} frames"
        ),
    }
    Ok(())
}

/// Hours of work are not replaced because `--resume` or a `--set` was forgotten.
fn refuse_to_replace(
    folder: &Path,
    loaded: &LoadedScene,
    checkpoint: &Checkpoint,
) -> Result<(), Failure> {
    let interrupted = summary(folder).is_none_or(|summary| summary["interrupted"] == true);
    if !interrupted {
        return Ok(());
    }
    let (folder, step) = (folder.display(), checkpoint.snapshot.state.step);
    Err(match difference(loaded, checkpoint) {
        None => not_resumed(format!(
            "{folder} holds an interrupted run of this scene, saved after step {step}"
        ))
        .with_help("--resume goes on with it, --restart begins again and replaces it"),
        Some(reason) => not_resumed(format!(
            "{folder} holds an interrupted run, saved after step {step}, and not of this scene as it is: {reason}"
        ))
        .with_help("--resume with the scene and the --set values of that run goes on with it; --restart replaces it"),
    })
}

fn summary(folder: &Path) -> Option<Value> {
    ResultReader::open(folder).ok()?.summary().ok()?
}

/// Why steps of this scene would not be those of the checkpoint.
fn difference(loaded: &LoadedScene, checkpoint: &Checkpoint) -> Option<String> {
    if checkpoint.version != koiter::VERSION {
        return Some(format!(
            "it was written by Koiter {}, this is {}, which may round differently",
            checkpoint.version,
            koiter::VERSION
        ));
    }
    let Ok(saved) = Document::parse("checkpoint.bin", &checkpoint.scene_text, &[]) else {
        return Some("its scene cannot be read".to_owned());
    };
    if let Some(difference) = loaded.document.first_difference(&saved, &KEYS_OF_NO_STEP) {
        return Some(describe(&difference));
    }
    let bodies = loaded.scene.model.fingerprints();
    let changed = bodies
        .iter()
        .zip(&checkpoint.bodies)
        .find(|(now, then)| now != then);
    changed.map(|((name, _), _)| {
        format!("the mesh of '{name}' is another one: was its file changed since?")
    })
}

fn describe(difference: &Difference) -> String {
    let path = &difference.path;
    let shorten = |value: &str| match value.char_indices().nth(60) {
        Some((end, _)) => format!("{}…", &value[..end]),
        None => value.to_owned(),
    };
    match (&difference.here, &difference.there) {
        (Some(here), Some(there)) => {
            let (here, there) = (shorten(here), shorten(there));
            format!("{path} is {here} in this scene, but {there} in the checkpoint")
        }
        (Some(here), None) => {
            let here = shorten(here);
            format!("{path} is {here} in this scene, but not set in the checkpoint")
        }
        (None, there) => {
            let there = shorten(there.as_deref().unwrap_or_default());
            format!("{path} is not set in this scene, but {there} in the checkpoint")
        }
    }
}

/// Tells that no step is left to do, and makes the pictures that are missing.
pub(super) fn say_finished(
    arguments: &RunArguments,
    folder: &Path,
    loaded: &LoadedScene,
    summary: &Value,
) -> Result<(), Failure> {
    let made = match arguments.no_film || pictures::are_made(folder) {
        true => Vec::new(),
        false => {
            Interrupt::watch().end_at_once(
                pictures::without_film(folder),
                pictures::partial_files(folder),
            );
            pictures::after_run(folder, &loaded.scene.output, arguments.quiet)?
        }
    };
    if arguments.json {
        say!("{summary}");
    } else if !arguments.quiet {
        let (steps, time) = (&summary["steps"], &summary["time"]);
        say!("finished already: {steps} steps to t = {time} s; --until T goes on to a later time");
        say!("result: {}", folder.display());
        made.iter()
            .for_each(|path| say!("made: {}", path.display()));
    }
    Ok(())
}

/// The present command with `--resume`.
pub(super) fn how_to_go_on() -> String {
    let mut words: Vec<String> = std::env::args_os()
        .skip(1)
        .map(|word| word.to_string_lossy().into_owned())
        .filter(|word| word != "--restart")
        .map(|word| quoted(&word))
        .collect();
    if !words.iter().any(|word| word == "--resume") {
        words.push("--resume".to_owned());
    }
    format!("go on with: koiter {}", words.join(" "))
}
