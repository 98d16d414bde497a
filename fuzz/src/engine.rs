//! The loop: damage a file, hand it to a reader, see what happens.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::FileExt;
use std::panic;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use crate::coverage::Coverage;
use crate::memory;
use crate::mutate::mutate;
use crate::random::Random;

/// How long and how hard to try.
#[derive(Clone, Debug)]
pub struct Options {
    /// Number of inputs.
    pub inputs: u64,
    /// The same seed gives the same inputs (with coverage: as far as hash tables, seeded anew each time, do not matter).
    pub seed: u64,
    /// Longest input [bytes].
    pub max_length: usize,
    /// An input that takes longer ends the run.
    pub time_limit: Duration,
    /// An input that takes more memory [bytes] ends the run.
    pub memory_limit: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            inputs: 1_000_000,
            seed: 1,
            max_length: 1 << 16,
            time_limit: Duration::from_secs(5),
            // A thousand times the longest input and the reach of a small scene.
            memory_limit: 256 << 20,
        }
    }
}

/// What happened.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Inputs tried.
    pub inputs: u64,
    /// Inputs that the reader took as good.
    pub accepted: u64,
    /// Panics, by message and place: how many, and the first input.
    pub panics: BTreeMap<String, (u64, Vec<u8>)>,
    /// The input that took longest.
    pub slowest: (Duration, Vec<u8>),
    /// The input that took most memory [bytes].
    pub hungriest: (usize, Vec<u8>),
    /// Inputs that reached something new, the given ones included.
    pub corpus: Vec<Vec<u8>>,
    /// Branches reached; 0 without instrumentation.
    pub branches: usize,
}

/// Longer inputs do not join the corpus: their copies would take most of the time and show nothing that short ones do not.
const LONGEST_KEPT: usize = 2048;

/// Tries the corpus as it is, then damaged copies of it; what reaches new branches joins the corpus. `read` says whether
/// it took its bytes as good, `dictionary` has words of the format.
///
/// The input at hand is written to `current` before it is tried. A hang, or memory beyond the limit, ends the *process*
/// with status 1, as neither can be taken back: the file then holds the input, as it does when the stack overflows.
///
/// # Errors
/// The file `current` cannot be written.
pub fn fuzz(
    read: &dyn Fn(&[u8]) -> bool,
    dictionary: &[&str],
    corpus: Vec<Vec<u8>>,
    options: &Options,
    current: &Path,
) -> io::Result<Report> {
    let mut trial = Trial::new(read, options, current)?;
    let _quiet = QuietPanics::begin();
    let mut report = Report::default();
    let mut coverage = Coverage::default();
    let mut random = Random::new(options.seed);
    for input in &corpus {
        trial.run(input, &mut report)?;
        coverage.add();
    }
    let num_good = corpus.len();
    report.corpus = corpus;
    while report.inputs < options.inputs {
        let input = mutate(
            &report.corpus,
            num_good,
            dictionary,
            options.max_length,
            &mut random,
        );
        trial.run(&input, &mut report)?;
        if coverage.add() && input.len() <= LONGEST_KEPT {
            report.corpus.push(input);
        }
    }
    report.branches = coverage.num_reached();
    fs::remove_file(current)?;
    Ok(report)
}

/// One reader under watch.
struct Trial<'a> {
    read: &'a dyn Fn(&[u8]) -> bool,
    memory_limit: usize,
    current: File,
    watchdog: Arc<Watchdog>,
}

impl<'a> Trial<'a> {
    fn new(read: &'a dyn Fn(&[u8]) -> bool, options: &Options, path: &Path) -> io::Result<Self> {
        let watchdog = Arc::new(Watchdog::new(options, path.to_path_buf()));
        let shared = Arc::downgrade(&watchdog);
        thread::spawn(move || {
            while let Some(watchdog) = shared.upgrade() {
                watchdog.look();
                drop(watchdog);
                thread::sleep(Duration::from_millis(100));
            }
        });
        Ok(Self {
            read,
            memory_limit: options.memory_limit,
            current: File::create(path)?,
            watchdog,
        })
    }

    fn run(&mut self, input: &[u8], report: &mut Report) -> io::Result<()> {
        self.current.write_all_at(input, 0)?;
        self.current.set_len(input.len() as u64)?;
        let before = memory::held();
        Coverage::reset();
        memory::watch(before.saturating_add(self.memory_limit));
        let start = Instant::now();
        self.watchdog.begin();
        let result = caught(|| (self.read)(input));
        self.watchdog.end();
        let seconds = start.elapsed();
        let bytes = memory::peak().saturating_sub(before);
        report.inputs += 1;
        match result {
            Ok(accepted) => report.accepted += u64::from(accepted),
            Err(place) => {
                let entry = report
                    .panics
                    .entry(place)
                    .or_insert_with(|| (0, input.to_vec()));
                entry.0 += 1;
            }
        }
        if seconds > report.slowest.0 {
            report.slowest = (seconds, input.to_vec());
        }
        if bytes > report.hungriest.0 {
            report.hungriest = (bytes, input.to_vec());
        }
        Ok(())
    }
}

/// Message and place of the last panic of this process.
static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

/// While it lives, panics are noted instead of printed.
struct QuietPanics;

impl QuietPanics {
    fn begin() -> Self {
        panic::set_hook(Box::new(|info| {
            if let Ok(mut last) = LAST_PANIC.lock() {
                *last = info.to_string();
            }
        }));
        Self
    }
}

impl Drop for QuietPanics {
    fn drop(&mut self) {
        drop(panic::take_hook());
    }
}

/// The value, or message and place of the panic.
fn caught<T>(action: impl FnOnce() -> T) -> Result<T, String> {
    panic::catch_unwind(panic::AssertUnwindSafe(action)).map_err(|_| {
        LAST_PANIC
            .lock()
            .map(|last| last.clone())
            .unwrap_or_default()
    })
}

/// Ends the process when an input takes too long or too much.
struct Watchdog {
    origin: Instant,
    /// Milliseconds from the origin at which the input was begun; the largest number between inputs.
    begun: AtomicU64,
    time_limit: Duration,
    current: PathBuf,
}

impl Watchdog {
    fn new(options: &Options, current: PathBuf) -> Self {
        Self {
            origin: Instant::now(),
            begun: AtomicU64::new(u64::MAX),
            time_limit: options.time_limit,
            current,
        }
    }

    fn begin(&self) {
        self.begun
            .store(self.origin.elapsed().as_millis() as u64, Relaxed);
    }

    fn end(&self) {
        self.begun.store(u64::MAX, Relaxed);
    }

    fn look(&self) {
        let elapsed = self.origin.elapsed().as_millis() as u64;
        let taken = elapsed.saturating_sub(self.begun.load(Relaxed));
        let fault = if memory::is_exceeded() {
            "took more memory than allowed"
        } else if u128::from(taken) > self.time_limit.as_millis() {
            "takes longer than allowed"
        } else {
            return;
        };
        eprintln!("the input in {} {fault}", self.current.display());
        std::process::exit(1);
    }
}

/// The files of a folder, in the order of their names.
///
/// # Errors
/// What the system says; a folder without files.
pub fn read_corpus(folder: &Path) -> io::Result<Vec<Vec<u8>>> {
    let entries = fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
    let mut paths: Vec<PathBuf> = entries.iter().map(fs::DirEntry::path).collect();
    paths.sort();
    let files = paths.iter().map(fs::read).collect::<Result<Vec<_>, _>>()?;
    if files.is_empty() {
        let message = format!("no files in {}", folder.display());
        return Err(io::Error::new(io::ErrorKind::NotFound, message));
    }
    Ok(files)
}
