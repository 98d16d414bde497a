//! What helps around a run: new scenes, what there is, plots, completions, the manual.

use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};
use clap_complete::Shell;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter new flag                          flag/scene.toml: a cloth falls on a ball
  koiter new bridge --template cantilever  a clamped strip, static
  koiter new shirt --template mesh         a mesh from a file, with one to start from
  koiter new vessel --template incision    a tube is cut open and patched
  koiter new tests/one.toml                a single file

Nothing that is there is overwritten.")]
pub(crate) struct NewArguments {
    /// Folder to make, or file if it ends in .toml
    #[arg(value_hint = ValueHint::AnyPath)]
    pub(crate) name: PathBuf,
    /// What to start from
    #[arg(long, value_enum, default_value_t = Template::Drape)]
    pub(crate) template: Template,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// What to start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Template {
    /// A cloth falls on a ball; explains every common key
    Drape,
    /// A strip bends under its weight: statics, a clamp, reactions
    Cantilever,
    /// A mesh from a file falls over a pole
    Mesh,
    /// A soft tube is cut open and patched: Bézier shells
    Incision,
}

impl Template {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Drape => "drape",
            Self::Cantilever => "cantilever",
            Self::Mesh => "mesh",
            Self::Incision => "incision",
        }
    }
}

/// Of `koiter materials` and `koiter models`.
#[derive(Debug, Args)]
pub(crate) struct CatalogueArguments {
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter plot results/sphere-drape -o drape.svg
  koiter plot results/sphere-drape -o drape.png --size 1600x1200
  koiter plot results/sphere-drape -o slow.png --figures seconds,iterations,fraction
  koiter plot results/beams -o tips.svg --figures probes --size 1200x500

Reads stats.jsonl and probes.csv, also of a run that still goes on or was stopped.")]
pub(crate) struct PlotArguments {
    /// Result folder
    #[arg(value_hint = ValueHint::DirPath)]
    pub(crate) result: PathBuf,
    /// Figure to write, .svg or .png [default: plot.svg in the result folder]
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    /// What to draw, from above [default: all there is]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "FIGURES")]
    pub(crate) figures: Vec<Figure>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1200x1400", value_parser = super::parse_size)]
    pub(crate) size: (u32, u32),
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// A figure of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Figure {
    /// What the probes measured, a panel a quantity
    Probes,
    /// Load factor of a path followed by arc length
    LoadFactor,
    /// All energies
    Energies,
    /// Energies whose zero means something, on a logarithmic axis
    SmallEnergies,
    /// Seconds a step, by part
    Seconds,
    /// Newton iterations a step, by what cut them short
    Iterations,
    /// The smallest fraction of a Newton step that a line search left
    Fraction,
    /// Active contact pairs, by bodies
    Contacts,
    /// The smallest gap
    Gap,
    /// Stiffness of the barrier
    Stiffness,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter explain                       all codes, a line each
  koiter explain start-touching        the code that an error began with")]
pub(crate) struct ExplainArguments {
    /// The code with which an error begins [default: all, a line each]
    pub(crate) code: Option<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter completions bash > ~/.local/share/bash-completion/completions/koiter
  koiter completions zsh > ~/.zfunc/_koiter
  koiter completions fish > ~/.config/fish/completions/koiter.fish")]
pub(crate) struct CompletionsArguments {
    /// The shell
    #[arg(value_enum)]
    pub(crate) shell: Shell,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter man | man -l -                    the page of the program
  koiter man -o ~/.local/share/man/man1    a page for it and one for every command")]
pub(crate) struct ManArguments {
    /// Folder for the pages; made if it is not there [default: the main page to standard output]
    #[arg(short, long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) output: Option<PathBuf>,
}
