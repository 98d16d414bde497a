//! What can be typed to measure shapes and to compare models.

use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};
use koiter::scene::model::BendingModel;
use koiter::scene::nearest;

#[derive(Debug, Args)]
#[command(after_help = "\
Without --rest the deformed mesh is its own rest shape as far as lengths go, and it is flat: the membrane energy is zero,
and bending is measured from --rest-curvature zero.

A file of directors is JSON: {\"edges\": [[u, v], …], \"edge_angles\": […]} with u < v, or
{\"vertex_directors\": [[x, y, z], …]}, or {\"edges\": [[u, v], …], \"edge_points\": [[x, y, z], …]}, as --json prints them.
With several models, those that have other directors than the file minimise theirs.

A model without an energy here (its directors do not converge, or it is not defined at the given ones) has null in the
JSON with a reason, and a warning. The status is 1 if it was asked for by its name, and 0 under all.

Examples:
  koiter energy --deformed bent.obj --thickness 1e-4 --young 1e11 --poisson 0.3
  koiter energy --deformed bent.ply --rest flat.ply --model bac,dso --thickness 1e-4 --young 1e11 --poisson 0.3 --json
  koiter energy --deformed bent.obj --rest made.obj --rest-curvature zero --model dcs --directors d.json --gradient \\
                --thickness 1e-4 --young 1e11 --poisson 0.3 --json")]
pub(crate) struct EnergyArguments {
    /// Mesh whose energy is asked for: OBJ, PLY, STL or OFF
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) deformed: PathBuf,
    /// Its rest shape, a mesh of the same faces [default: the deformed mesh itself, taken as flat]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) rest: Option<PathBuf>,
    /// Rest curvature: that of the rest mesh, or zero [default: mesh with --rest, zero without]
    #[arg(long, value_enum)]
    pub(crate) rest_curvature: Option<RestCurvature>,
    /// Bending models, or all
    #[arg(
        long,
        value_name = "NAME",
        value_delimiter = ',',
        default_value = "all"
    )]
    pub(crate) model: Vec<String>,
    /// Thickness [m]
    #[arg(long, value_name = "H", value_parser = parse_positive, allow_negative_numbers = true)]
    pub(crate) thickness: f64,
    /// Young's modulus [Pa]
    #[arg(long, value_name = "E", value_parser = parse_positive, allow_negative_numbers = true)]
    pub(crate) young: f64,
    /// Poisson's ratio
    #[arg(long, value_name = "NU", value_parser = parse_poisson, allow_negative_numbers = true)]
    pub(crate) poisson: f64,
    /// Directors: those of least bending energy, those that bisect the normals, or from a JSON file
    #[arg(long, value_name = "minimise|zero|FILE", default_value = "minimise", value_parser = parse_directors)]
    pub(crate) directors: DirectorSource,
    /// Print gradients too; needs --json
    #[arg(long, requires = "json")]
    pub(crate) gradient: bool,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Where the rest curvature comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RestCurvature {
    /// From the rest mesh
    Mesh,
    /// Zero
    Zero,
}

/// Where the directors come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum DirectorSource {
    Minimise,
    Zero,
    File(PathBuf),
}

#[derive(Debug, Args)]
#[command(after_help = "\
Level k has triangles of about 4^k 1e-8 m². All models on all shapes take a few minutes for levels 4 to 1; level 0, where
the published figures are taken, takes half an hour and 6 GB. Marks and rates are in koiter bench convergence --json too.

Examples:
  koiter bench convergence
  koiter bench convergence --levels 4,3,2 --models bac,dso --cases sphere,helix-irregular
  koiter bench convergence --levels 4,3,2,1,0 --plot pictures --json > table4.json")]
pub(crate) struct ConvergenceArguments {
    /// Bending models, or all
    #[arg(
        long,
        value_name = "NAME",
        value_delimiter = ',',
        default_value = "all"
    )]
    pub(crate) models: Vec<String>,
    /// Levels of refinement, 8 (coarse) to 0
    #[arg(long, value_name = "K", value_delimiter = ',', default_value = "4,3,2,1", value_parser = clap::value_parser!(u8).range(0..=8))]
    pub(crate) levels: Vec<u8>,
    /// Shapes, or all
    #[arg(
        long,
        value_name = "NAME",
        value_delimiter = ',',
        default_value = "all"
    )]
    pub(crate) cases: Vec<String>,
    /// Draw the errors into this folder, one figure a shape, as SVG and PNG
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) plot: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter bench burning
  koiter bench burning --scenes
  koiter bench burning --cells 10,20,40 --iterations 40 --json

The status is 1 if a figure is outside its gate.")]
pub(crate) struct BurningArguments {
    /// Cells along a side of the sheet: n of them have 10 n² springs
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "10,20,40,50,100", value_parser = clap::value_parser!(u16).range(2..=1000))]
    pub(crate) cells: Vec<u16>,
    /// Iterations of conjugate gradients a solve where all are taken
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) iterations: u16,
    /// Steps of which the fastest counts
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) steps: u16,
    /// Run the scenes of double layers and hold them against what the paper shows, instead (two minutes)
    #[arg(long)]
    pub(crate) scenes: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter bench creased-vee
  koiter bench creased-vee --models bac,dcs --plot pictures --json")]
pub(crate) struct CreasedVeeArguments {
    /// Bending models, or all
    #[arg(
        long,
        value_name = "NAME",
        value_delimiter = ',',
        default_value = "all"
    )]
    pub(crate) models: Vec<String>,
    /// Level of refinement: triangles of about 4^k 1e-8 m²; the published figures are for 0
    #[arg(long, value_name = "K", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=6))]
    pub(crate) level: u8,
    /// Draw the energies over the angle into this folder, as SVG and PNG
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) plot: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter bench discrete-shells
  koiter bench discrete-shells --cases paper,beams --json")]
pub(crate) struct DiscreteShellsArguments {
    /// What to compute
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        default_value = "conservation,beams,paper,hats"
    )]
    pub(crate) cases: Vec<DiscreteShellsCase>,
}

/// Parts of the benchmark of Discrete Shells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DiscreteShellsCase {
    /// Momenta, energy, order in time, the longest explicit step, gains of energy
    Conservation,
    /// Flat beams and V-beams of three stiffnesses: Figure 2
    Beams,
    /// A sheet that is curled, creased and pulled: Figure 3
    Paper,
    /// Hats that fall: Figure 1
    Hats,
}

/// The models of a list of names; `all` stands for all that bend.
///
/// # Errors
/// A name that is none, in words with the nearest one.
pub(crate) fn bending_models(names: &[String]) -> Result<Vec<BendingModel>, String> {
    let all: Vec<BendingModel> = (BendingModel::ALL.into_iter())
        .filter(|model| *model != BendingModel::None)
        .collect();
    let mut models = Vec::new();
    for name in names {
        let found: Vec<BendingModel> = (all.iter().copied())
            .filter(|model| name == "all" || model.info().name == name)
            .collect();
        if found.is_empty() {
            let known = all.iter().map(|model| model.info().name);
            let advice = match nearest(name, known.clone()) {
                Some(near) => format!("did you mean {near}?"),
                None => format!("there are: all, {}", known.collect::<Vec<_>>().join(", ")),
            };
            return Err(format!("there is no bending model {name}; {advice}"));
        }
        for model in found {
            if !models.contains(&model) {
                models.push(model);
            }
        }
    }
    Ok(models)
}

fn parse_positive(text: &str) -> Result<f64, String> {
    (text.parse().ok())
        .filter(|value: &f64| *value > 0.0 && value.is_finite())
        .ok_or_else(|| "write a number above 0".to_owned())
}

fn parse_poisson(text: &str) -> Result<f64, String> {
    (text.parse().ok())
        .filter(|nu: &f64| *nu > -1.0 && *nu <= 0.5)
        .ok_or_else(|| "write a number above -1 and at most 0.5".to_owned())
}

fn parse_directors(text: &str) -> Result<DirectorSource, String> {
    Ok(match text {
        "minimise" | "minimize" => DirectorSource::Minimise,
        "zero" => DirectorSource::Zero,
        file => DirectorSource::File(file.into()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_found_once_and_mistyped_names_get_the_nearest() {
        let names = |names: &[&str]| names.iter().map(|&n| n.to_owned()).collect::<Vec<_>>();
        let all = bending_models(&names(&["all", "bac"])).unwrap();
        assert_eq!(all.len(), BendingModel::ALL.len() - 1);
        assert_eq!(
            bending_models(&names(&["dso"])).unwrap(),
            [BendingModel::Dso]
        );
        let message = bending_models(&names(&["bca"])).unwrap_err();
        assert!(
            message.contains("bca") && message.contains("did you mean bac"),
            "{message}"
        );
    }
}
