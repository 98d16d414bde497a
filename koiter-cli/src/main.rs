//! The command line of Koiter: see [`arguments::Verb`] for what it does.
//!
//! Exit status: 0 done; 1 the run failed (it did not converge, or was interrupted); 2 the input is wrong. Errors go to
//! standard error, results to standard output, progress to a terminal only.
#![forbid(unsafe_code)]

mod arguments;
mod bench;
mod catalogue;
mod check;
mod debug_mesh;
mod energy;
mod explain;
mod export;
mod failure;
mod fit;
mod interrupt;
mod logger;
mod manual;
mod memory;
mod model_style;
mod modes;
mod new;
mod output;
mod output_path;
mod pictures;
mod plot;
mod probes;
mod render;
mod run;
mod scene_source;
mod sweep;
mod validate;
mod view;

use std::process::ExitCode;

use arguments::{Arguments, Verb};
use clap::Parser;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    failure::set_style();
    logger::install();
    let result = match arguments.verb {
        Verb::Run(arguments) => run::run(&arguments),
        Verb::Sweep(arguments) => sweep::sweep(&arguments),
        Verb::Check(arguments) => check::check(&arguments),
        Verb::View(arguments) => view::view(&arguments),
        Verb::Render(arguments) => render::render(&arguments),
        Verb::Export(arguments) => export::export(&arguments),
        Verb::Plot(arguments) => plot::plot(&arguments),
        Verb::New(arguments) => new::new(&arguments),
        Verb::Materials(arguments) => catalogue::materials(&arguments),
        Verb::Models(arguments) => catalogue::models(&arguments),
        Verb::Schema => catalogue::schema(),
        Verb::Explain(arguments) => explain::explain(&arguments),
        Verb::Completions(arguments) => manual::completions(&arguments),
        Verb::Man(arguments) => manual::man(&arguments),
        Verb::Energy(arguments) => energy::energy(&arguments),
        Verb::Modes(arguments) => modes::modes(&arguments),
        Verb::Fit(arguments) => fit::fit(&arguments),
        Verb::Validate(arguments) => validate::validate(&arguments),
        Verb::Bench(arguments) => bench::bench(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print();
            failure.exit_code()
        }
    }
}
