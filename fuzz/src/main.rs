//! `fuzz/run`: see `fuzz/README.md`.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use koiter_fuzz::{Options, Report, Target, fuzz};

/// Hands damaged files to the readers of Koiter.
#[derive(Parser)]
struct Arguments {
    /// Reader, or all
    target: String,
    /// Number of inputs for each target
    #[arg(long, default_value_t = Options::default().inputs)]
    inputs: u64,
    /// Another seed, other inputs
    #[arg(long, default_value_t = Options::default().seed)]
    seed: u64,
    /// Longest input [bytes]
    #[arg(long, default_value_t = Options::default().max_length)]
    max_length: usize,
    /// Seconds after which an input hangs
    #[arg(long, default_value_t = Options::default().time_limit.as_secs())]
    seconds: u64,
    /// Memory that an input may take [MiB]
    #[arg(long, default_value_t = Options::default().memory_limit >> 20)]
    memory: usize,
    /// Hand this file to the target, once, instead of damaged ones
    #[arg(long, value_name = "FILE")]
    replay: Option<PathBuf>,
    /// Add the inputs that reached something new to the corpus
    #[arg(long)]
    keep: bool,
}

fn main() -> ExitCode {
    match try_main(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

/// Whether all went well.
fn try_main(arguments: &Arguments) -> Result<bool, String> {
    let targets = match arguments.target.as_str() {
        "all" => Target::ALL.to_vec(),
        name => vec![name.parse()?],
    };
    let mut is_sound = true;
    for target in targets {
        let run = match &arguments.replay {
            Some(file) => replay(target, file),
            None => run(target, arguments),
        };
        is_sound &= run.map_err(|error| format!("{target}: {error}"))?;
    }
    Ok(is_sound)
}

fn replay(target: Target, file: &Path) -> io::Result<bool> {
    let bytes = fs::read(file)?;
    let start = Instant::now();
    let word = if target.read(&bytes) {
        "accepted"
    } else {
        "refused"
    };
    println!(
        "{target}: {word} after {:.3} s",
        start.elapsed().as_secs_f64()
    );
    Ok(true)
}

fn run(target: Target, arguments: &Arguments) -> io::Result<bool> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (corpus, failures) = (folder.join("corpus"), folder.join("failures"));
    let corpus = corpus.join(target.name());
    fs::create_dir_all(&failures)?;
    let options = Options {
        inputs: arguments.inputs,
        seed: arguments.seed,
        max_length: arguments.max_length,
        time_limit: Duration::from_secs(arguments.seconds),
        memory_limit: arguments.memory << 20,
    };
    let seeds = koiter_fuzz::read_corpus(&corpus)?;
    let num_seeds = seeds.len();
    let start = Instant::now();
    let current = failures.join(format!("{target}-current"));
    let report = fuzz(
        &|bytes| target.read(bytes),
        target.dictionary(),
        seeds,
        &options,
        &current,
    )?;
    print_report(target, &report, num_seeds, start.elapsed());
    for (index, (message, (_, input))) in report.panics.iter().enumerate() {
        let path = failures.join(format!("{target}-panic-{index}"));
        fs::write(&path, input)?;
        println!("  {}: {message}", path.display());
    }
    if arguments.keep {
        for (index, input) in report.corpus[num_seeds..].iter().enumerate() {
            fs::write(
                corpus.join(format!("found-{}-{index:05}", arguments.seed)),
                input,
            )?;
        }
    }
    fs::write(
        failures.join(format!("{target}-slowest")),
        &report.slowest.1,
    )?;
    fs::write(
        failures.join(format!("{target}-hungriest")),
        &report.hungriest.1,
    )?;
    Ok(report.panics.is_empty())
}

fn print_report(target: Target, report: &Report, num_seeds: usize, elapsed: Duration) {
    let panics: u64 = report.panics.values().map(|panic| panic.0).sum();
    println!(
        "{target}: {} inputs in {:.0} s, {} accepted, {panics} panics at {} places; slowest {:.3} s ({} bytes), \
         most memory {:.1} MB ({} bytes); {} branches, {} files and {} inputs that reached more",
        report.inputs,
        elapsed.as_secs_f64(),
        report.accepted,
        report.panics.len(),
        report.slowest.0.as_secs_f64(),
        report.slowest.1.len(),
        report.hungriest.0 as f64 * 1e-6,
        report.hungriest.1.len(),
        report.branches,
        num_seeds,
        report.corpus.len() - num_seeds
    );
}
