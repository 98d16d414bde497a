//! What `koiter sweep` takes.

use std::path::PathBuf;

use clap::Args;

use super::{SceneArguments, parse_count};

/// `koiter sweep`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter sweep pinned-drop --set resolution=tiny --vary shell.cloth.bending=bac,dcs,ds-theta
  koiter sweep sphere-drape --vary resolution=tiny,small --vary shell.cloth.thickness=5e-4,1e-3,2e-3 --jobs 2
  koiter sweep my/scene.toml --vary 'gravity=[0.0, 0.0, -9.81],[0.0, 0.0, -1.62]'
  koiter sweep sphere-drape --vary resolution=tiny,small --list      the commands, for a cluster

Every combination of the values is a run of its own process. OUT holds a result folder a run, table.csv and table.json with
what was varied and what came out of it (iterations, seconds, gap, the last values of the probes), and grid.png, the end of
every run, row by row in the order of the table.

A sweep that is stopped goes on where it was when the same command is given again: runs that are finished are not made anew,
others resume. A run whose process dies is taken up again as often as --retries says; one that fails (status 1) stays in the
table with its status, and the status of the sweep is then 1.")]
pub(crate) struct SweepArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Values of a key, separated by commas outside of brackets and quotes; all combinations are run
    #[arg(long, value_name = "KEY=A,B,…", required = true)]
    pub(crate) vary: Vec<String>,
    /// Folder of the sweep [default: results/sweep-<name of the scene>]
    #[arg(long, value_name = "OUT")]
    pub(crate) out: Option<PathBuf>,
    /// Stop every run at this simulated time [s]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(crate) until: Option<f64>,
    /// Runs at a time, each on one thread [default: one a core]
    #[arg(long, value_name = "N", value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) jobs: Option<usize>,
    /// How often a run is taken up again whose process died
    #[arg(long, value_name = "N", default_value_t = 2)]
    pub(crate) retries: usize,
    /// Print the commands of the runs and run nothing
    #[arg(long)]
    pub(crate) list: bool,
    /// Print the table as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}
