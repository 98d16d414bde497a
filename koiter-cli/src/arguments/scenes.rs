//! Of `koiter bench scenes`.

use clap::{Args, ValueEnum};

/// What is changed of a scene to see whether it still runs through.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Variation {
    /// As it ships
    Plain,
    /// Time steps four times as long
    LongSteps,
    /// Time steps a quarter as long
    ShortSteps,
    /// A quarter of the distance at which surfaces begin to repel
    ThinBarrier,
    /// The whole world turned about an axis that is none of the mesh
    Turned,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Every row is a whole run in memory; every frame that a run would write is tested as `koiter check --result` does. The status
is 1 if a run broke off, did not converge somewhere, or has a frame at fault. At --resolution paper the published figures
of \"Better Bending\", Table 7, stand beside ours.

Examples:
  koiter bench scenes popper
  koiter bench scenes --models bac --variations plain,long-steps,short-steps,thin-barrier,turned
  koiter bench scenes cone-crush --resolution paper --models bac,ds-theta --json")]
pub(crate) struct ScenesArguments {
    /// Scenes; all of the published table without any
    pub(crate) scenes: Vec<String>,
    /// tiny, small or paper
    #[arg(long, default_value = "tiny")]
    pub(crate) resolution: String,
    /// Bending models, or all; of each scene those it was published with if none are named
    #[arg(long, value_delimiter = ',')]
    pub(crate) models: Vec<String>,
    /// Ways to run each
    #[arg(long, value_delimiter = ',', value_enum, default_value = "plain")]
    pub(crate) variations: Vec<Variation>,
}
