//! Processes side by side, each a run; one that dies is taken up again.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use indicatif::{ProgressBar, ProgressStyle};

use crate::failure::Failure;
use crate::interrupt::Interrupt;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Outcome {
    /// Exit status; `None` if its process was killed each time, or never started.
    pub(super) status: Option<i32>,
    /// How often its process was started.
    pub(super) starts: usize,
}

impl Outcome {
    /// Of a run that the sweep did not come to.
    const NOT_BEGUN: Self = Self {
        status: None,
        starts: 0,
    };

    pub(super) fn is_good(self) -> bool {
        self.status == Some(0)
    }
}

/// Runs all commands, `jobs` at a time; each has `--out FOLDER` as its last words, and leaves FOLDER.log.txt.
pub(super) fn run_all(
    program: &Path,
    commands: &[Vec<String>],
    jobs: usize,
    retries: usize,
) -> Result<Vec<Outcome>, Failure> {
    // Ctrl-C reaches the runs too: each saves itself and ends, and no other is begun.
    let interrupt = Interrupt::watch();
    let next = AtomicUsize::new(0);
    let outcomes = Mutex::new(vec![Ok(Outcome::NOT_BEGUN); commands.len()]);
    let bar = ProgressBar::new(commands.len() as u64);
    let style = ProgressStyle::with_template("{bar:30} {pos} of {len} runs, {elapsed}, {eta} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.tick();
    std::thread::scope(|scope| {
        for _ in 0..jobs.max(1) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(words) = commands.get(index).filter(|_| !interrupt.is_asked()) else {
                        return;
                    };
                    let outcome = run_one(program, words, retries, &interrupt);
                    outcomes.lock().expect("no worker panics")[index] = outcome;
                    bar.inc(1);
                }
            });
        }
    });
    bar.finish_and_clear();
    let outcomes = outcomes.into_inner().expect("no worker panics");
    let outcomes: Result<Vec<Outcome>, String> = outcomes.into_iter().collect();
    outcomes.map_err(Failure::run)
}

/// A run that could not be started has said why.
fn run_one(
    program: &Path,
    words: &[String],
    retries: usize,
    interrupt: &Interrupt,
) -> Result<Outcome, String> {
    let folder = PathBuf::from(words.last().map_or("", String::as_str));
    let log = log_path(&folder);
    let cannot = |error: std::io::Error| format!("cannot write {}: {error}", log.display());
    let mut starts = 0;
    loop {
        let file = File::options().create(true).append(true).open(&log);
        let file = file.map_err(cannot)?;
        let copy = file.try_clone().map_err(cannot)?;
        starts += 1;
        let status = Command::new(program)
            .args(words)
            .stdin(Stdio::null())
            .stdout(file)
            .stderr(copy)
            .status()
            .map_err(|error| format!("cannot start a run: {error}"))?;
        if status.code().is_some() || starts > retries || interrupt.is_asked() {
            return Ok(Outcome {
                status: status.code(),
                starts,
            });
        }
    }
}

/// Beside the result folder, which belongs to the run: `0-bac.log.txt`.
fn log_path(folder: &Path) -> PathBuf {
    let mut name = folder.file_name().unwrap_or_default().to_owned();
    name.push(".log.txt");
    folder.with_file_name(name)
}
