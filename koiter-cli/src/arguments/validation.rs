//! Of `koiter validate`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

#[derive(Debug, Args)]
#[command(after_help = "\
Every case is a scene of benchmarks/ with its published values, computed on three meshes, each with cells half as large
as the one before. Deviations are those of the finest mesh; for a path the largest along it, over its largest reference,
and beside it the largest relative to the reference at the same load. The status is 1 if a study could not be computed.

Examples:
  koiter validate --list
  koiter validate
  koiter validate roof-original hemisphere-linear --models bac,dkt
  koiter validate cantilever-shear --levels 2 --plot pictures
  koiter validate plate-supported-pressure --models ds-theta,qb-cr    two models that do not converge")]
pub(crate) struct ValidateArguments {
    /// Cases; all of them without any, or with all
    pub(crate) cases: Vec<String>,
    /// Names the cases and runs nothing
    #[arg(long)]
    pub(crate) list: bool,
    /// Bending models, or all
    #[arg(long, value_delimiter = ',', default_value = "bac,dcs,dso,dkt")]
    pub(crate) models: Vec<String>,
    /// Meshes of every case, from the coarsest
    #[arg(long, default_value_t = 3, value_parser = parse_levels)]
    pub(crate) levels: usize,
    /// Draw load–displacement curves into this folder, as SVG and PNG
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) plot: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

fn parse_levels(text: &str) -> Result<usize, String> {
    let levels = text.parse().ok().filter(|levels| (1..=3).contains(levels));
    levels.ok_or_else(|| "write 1, 2 or 3".to_owned())
}
