//! `koiter bench`: what things cost on this machine, and how models compare.
//!
//! Every time is the fastest of a few repetitions: machines are noisy, and noise only adds.

mod assembly;
mod bezier;
mod bezier_speed;
mod burning;
mod contact;
mod convergence;
mod creased_vee;
mod discrete_shells;
mod drape;
mod explicit;
mod gates;
mod lateral_buckling;
mod models;
mod published;
mod scenes;
mod sheet;
mod solve;
mod table;

use std::time::Instant;

use crate::arguments::{BenchArguments, BenchSubject};
use crate::failure::Failure;
use crate::output::say;

/// Runs a benchmark and prints its table or, with `--json`, one object.
pub(crate) fn bench(arguments: &BenchArguments) -> Result<(), Failure> {
    let table = match &arguments.subject {
        BenchSubject::Assembly(options) => assembly::bench(options),
        BenchSubject::Solve(options) => solve::bench(options),
        BenchSubject::Contact(options) => contact::bench(options),
        BenchSubject::Drape(options) => drape::bench(options),
        BenchSubject::Explicit(options) => explicit::bench(options),
        BenchSubject::Convergence(options) => {
            return convergence::bench(options, arguments.json);
        }
        BenchSubject::Burning(options) => return burning::bench(options, arguments.json),
        BenchSubject::CreasedVee(options) => {
            return creased_vee::bench(options, arguments.json);
        }
        BenchSubject::Scenes(options) => scenes::bench(options),
        BenchSubject::Models(options) => models::bench(options),
        BenchSubject::DiscreteShells(options) => discrete_shells::bench(options),
        BenchSubject::LateralBuckling(options) => lateral_buckling::bench(options),
        BenchSubject::Bezier(options) if options.speed => bezier_speed::bench(options),
        BenchSubject::Bezier(options) => bezier::bench(options),
    }?;
    if arguments.json {
        say!("{}", table.json());
    } else {
        say!("{table}");
    }
    match table.failures.is_empty() {
        true => Ok(()),
        false => Err(Failure::run(table.failures.join("\n"))),
    }
}

/// Seconds of the fastest of `repeats` runs.
fn fastest(repeats: usize, mut run: impl FnMut()) -> f64 {
    (0..repeats.max(1))
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

/// Runs on a pool of so many threads.
fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> Result<T, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    Ok(pool
        .map_err(|error| Failure::run(format!("cannot start {threads} threads: {error}")))?
        .install(run))
}

/// 1 and, where there are more, all cores.
fn thread_counts() -> Vec<usize> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    if cores > 1 { vec![1, cores] } else { vec![1] }
}
