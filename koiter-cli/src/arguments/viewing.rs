//! Of `koiter view`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter view results/sphere-drape                     plays it, also while the run goes on
  koiter view results/bac results/dkt                  side by side, or one coloured by its distance to the other
  koiter view shirt.obj                                a mesh: OBJ, PLY, STL or OFF
  koiter view results/sphere-drape --port 8000 --no-open

The page comes from this program alone, on 127.0.0.1: nothing is fetched from elsewhere, and nobody else is answered. A key
opens its help: ?. Runs are paused, continued and stopped from it.")]
pub(crate) struct ViewArguments {
    /// Result folders or mesh files; several are compared
    #[arg(required = true, value_name = "DIR|MESH", value_hint = ValueHint::AnyPath)]
    pub(crate) shown: Vec<PathBuf>,
    /// Port to listen on [default: a free one]
    #[arg(long, value_name = "N")]
    pub(crate) port: Option<u16>,
    /// Print the address and open no browser
    #[arg(long)]
    pub(crate) no_open: bool,
    /// Print the address as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}
