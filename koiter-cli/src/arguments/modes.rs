//! Of `koiter modes`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use super::SceneArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Without --buckling: the lowest free vibrations about the shape at the start, K φ = ω² M φ, under what is constrained and
loaded there. Motions that nothing resists have the frequency 0.

With --buckling: the lowest factors λ by which gravity and the loads of a time must grow until the structure buckles,
(K + λ K_g) φ = 0, where K_g comes from the membrane stresses of the linear response. That a structure changes its shape
before, as a shallow roof does, is not seen: follow it with integrator = \"arc-length\". Contact is left out of both.

Examples:
  koiter modes cantilever                                 3.516 √(B / ρ h L⁴) / 2π = 1.24 Hz, and more
  koiter modes cantilever --count 12 --shapes modes      mode-1.ply, … with a tenth of the structure's extent as amplitude
  koiter modes lateral-buckling --buckling --at 1        there the time is the weight Γ*, so the factor is the critical one")]
pub(crate) struct ModesArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// How many modes
    #[arg(long, default_value_t = 6, value_parser = parse_count)]
    pub(crate) count: usize,
    /// Buckling loads instead of frequencies
    #[arg(long)]
    pub(crate) buckling: bool,
    /// The time whose loads count [s], or the load factor of an arc-length scene [default: the end of the scene]
    #[arg(long, value_name = "T", requires = "buckling", value_parser = parse_time)]
    pub(crate) at: Option<f64>,
    /// Write the shapes into this folder, as PLY
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) shapes: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Each mode takes a few vectors as long as the unknowns.
const MOST_MODES: usize = 1000;

fn parse_count(text: &str) -> Result<usize, String> {
    let count = text.parse().ok();
    let count = count.filter(|count| (1..=MOST_MODES).contains(count));
    count.ok_or_else(|| format!("write a whole number from 1 to {MOST_MODES}"))
}

fn parse_time(text: &str) -> Result<f64, String> {
    let time = text.parse().ok();
    let time = time.filter(|time: &f64| time.is_finite() && *time >= 0.0);
    time.ok_or_else(|| "write a time in seconds, 0 or later".to_owned())
}
