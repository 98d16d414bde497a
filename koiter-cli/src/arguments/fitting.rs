//! What `koiter fit` takes.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use super::{SceneArguments, parse_count};

/// `koiter fit`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter fit cantilever --measured drape.csv --vary shell.strip.material.young=1e7
  koiter fit my/strip.toml --measured load.csv --vary shell.strip.material.young=1e9 --vary shell.strip.thickness=1e-4
  koiter fit my/plate.toml --measured modes.csv --vary shell.plate.material.young=7e10

CSV is a line of headings and a line of numbers a measurement: time and columns of the scene's probes, as probes.csv has
them (a load that grows over time makes a load-deflection curve of it),
  time,tip.z
  0.5,-0.0812
  1.0,-0.1400
or mode and frequency [Hz], for natural frequencies:
  mode,frequency
  1,12.7

Values are found by least squares (Levenberg and Marquardt) over whole runs, in logarithms, so they stay above 0. Intervals are
those of Student's distribution, for errors that are independent and of one size; they know nothing of what the model leaves out.")]
pub(crate) struct FitArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Curve that was measured
    #[arg(long, value_name = "CSV", value_hint = ValueHint::FilePath)]
    pub(crate) measured: PathBuf,
    /// Key that is fitted, and where it starts; as often as there are keys
    #[arg(long, value_name = "KEY=START", required = true)]
    pub(crate) vary: Vec<String>,
    /// Iterations at most
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) iterations: usize,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}
