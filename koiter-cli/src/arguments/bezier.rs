//! Of `koiter bench bezier`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

#[derive(Debug, Args)]
#[command(after_help = "\
The roof and the hemisphere are those of Golembiovsky and Duriez (2012), sections 5.1 and 5.2; figures beside them are from
benchmarks/bezier-shell. bezier-paper is the element as printed, which converges to another shell. The status is 1 if a
figure is outside of 1 % (of 1.5 % for large displacements, at 32 cells).

Examples:
  koiter bench bezier
  koiter bench bezier --cells 8,16 --elements bezier,dkt-andes --no-large
  koiter bench bezier --plot pictures --json
  koiter bench bezier --speed --json")]
pub(crate) struct BezierArguments {
    /// Elements, or all
    #[arg(
        long,
        value_name = "NAME",
        value_delimiter = ',',
        default_value = "all"
    )]
    pub(crate) elements: Vec<String>,
    /// Cells along a side of the quarter models
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "8,16,32,48", value_parser = parse_cells)]
    pub(crate) cells: Vec<usize>,
    /// Leave the hemisphere under large forces out
    #[arg(long)]
    pub(crate) no_large: bool,
    /// Measure frames a second instead, on one thread: Figure 9
    #[arg(long)]
    pub(crate) speed: bool,
    /// Draw displacements over the number of elements into this folder, as SVG and PNG: Figures 5 and 7
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) plot: Option<PathBuf>,
}

fn parse_cells(text: &str) -> Result<usize, String> {
    let cells = text.parse().ok().filter(|cells| (1..=200).contains(cells));
    cells.ok_or_else(|| "write a number of cells from 1 to 200".to_owned())
}
