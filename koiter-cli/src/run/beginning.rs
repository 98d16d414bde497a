//! Where a run begins: at the start, at a checkpoint, or nowhere because it is finished.

use std::path::Path;

use koiter::io::Checkpoint;
use koiter::io::result::{ResultError, ResultReader};
use koiter::scene::{Difference, Document, KEYS_OF_NO_STEP};
use serde_json::Value;

use crate::arguments::RunArguments;
use crate::failure::Failure;
use crate::output::{say, say_error};
use crate::scene_source::LoadedScene;

/// What a refused checkpoint leaves to do.
pub(super) const BEGIN_AGAIN: &str =
    "--restart runs the scene from the beginning and replaces this result";

/// Where a run begins.
pub(super) enum Beginning {
    /// At time 0.
    Start,
    /// Where an earlier run stopped.
    Checkpoint(Box<Checkpoint>),
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
    let checkpoint = Checkpoint::read(folder);
    if !arguments.resume {
        return match checkpoint {
            Ok(Some(checkpoint)) if !arguments.restart => {
                refuse_to_replace(folder, loaded, &checkpoint).map(|()| Beginning::Start)
            }
            // What cannot be resumed is replaced like any other result.
            _ => Ok(Beginning::Start),
        };
    }
    let checkpoint = match checkpoint {
        Ok(Some(checkpoint)) => checkpoint,
        Ok(None) => {
            if !arguments.quiet {
                let folder = folder.display();
                say_error!("{folder} has no checkpoint to resume from: beginning at the start");
            }
            return Ok(Beginning::Start);
        }
        Err(error @ ResultError::Broken { .. }) => {
            return Err(Failure::input(error).with_help(BEGIN_AGAIN));
        }
        Err(error) => return Err(Failure::run(error)),
    };
    if let Some(reason) = difference(loaded, &checkpoint) {
        let path = folder.join("checkpoint.bin");
        let message = format!("cannot resume from {}: {reason}", path.display());
        return Err(Failure::input(message).with_help(
            "resume with the scene and the --set values of the interrupted run, or choose another folder with --out",
        ));
    }
    let summary = summary(folder).filter(|_| checkpoint.snapshot.state.step >= num_steps);
    Ok(match summary {
        Some(summary) => Beginning::Finished(summary),
        None => Beginning::Checkpoint(Box::new(checkpoint)),
    })
}

/// Hours of work are not replaced because `--resume` was forgotten; a scene that was changed begins anew.
fn refuse_to_replace(
    folder: &Path,
    loaded: &LoadedScene,
    checkpoint: &Checkpoint,
) -> Result<(), Failure> {
    let interrupted = summary(folder).is_none_or(|summary| summary["interrupted"] == true);
    if !interrupted || difference(loaded, checkpoint).is_some() {
        return Ok(());
    }
    let message = format!(
        "{} holds an interrupted run of this scene, saved after step {}",
        folder.display(),
        checkpoint.snapshot.state.step
    );
    Err(Failure::input(message)
        .with_help("--resume goes on with it, --restart begins again and replaces it"))
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

/// Tells that nothing is left to do.
pub(super) fn say_finished(
    arguments: &RunArguments,
    folder: &Path,
    summary: &Value,
) -> Result<(), Failure> {
    if arguments.json {
        say!("{summary}");
    } else if !arguments.quiet {
        let (steps, time) = (&summary["steps"], &summary["time"]);
        say!("finished already: {steps} steps to t = {time} s; --until T goes on to a later time");
        say!("result: {}", folder.display());
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

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+@%".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_split_them() {
        assert_eq!(quoted("--set"), "--set");
        assert_eq!(quoted("gravity=[0, 1]"), "'gravity=[0, 1]'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
    }
}
