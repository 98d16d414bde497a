//! What can be typed.

mod aids;
mod bezier;
mod exporting;
mod fitting;
mod modes;
mod scenes;
mod studies;
mod sweep;
mod validation;
mod viewing;

pub(crate) use aids::{
    CatalogueArguments, CompletionsArguments, ExplainArguments, Figure, ManArguments, NewArguments,
    PlotArguments, Template,
};

pub(crate) use bezier::BezierArguments;
pub(crate) use exporting::{ExportArguments, ExportFormat};
pub(crate) use fitting::FitArguments;
pub(crate) use modes::ModesArguments;
pub(crate) use scenes::{ScenesArguments, Variation};
pub(crate) use studies::{
    BurningArguments, ConvergenceArguments, CreasedVeeArguments, DirectorSource,
    DiscreteShellsArguments, DiscreteShellsCase, EnergyArguments, RestCurvature, bending_models,
};
pub(crate) use sweep::SweepArguments;
pub(crate) use validation::ValidateArguments;
pub(crate) use viewing::ViewArguments;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueHint};

/// Thin shells: cloth, paper, cans and leaves, with bending that converges and contact that never intersects.
#[derive(Debug, Parser)]
#[command(
    name = "koiter",
    version,
    arg_required_else_help = true,
    after_help = "\
Examples:
  koiter run sphere-drape                      a cotton square falls on a ball: frames, figures, a film
  koiter run my/scene.toml --set time.end=2    any value of a scene can be set from here
  koiter check my/scene.toml                   reads and checks everything, runs nothing
  koiter new my                                writes a commented scene, my/scene.toml

Exit status: 0 done, 1 the run failed, 2 the input is wrong."
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Runs a scene into a result folder: frames, figures, pictures and a film.
    Run(RunArguments),
    /// Runs a family of scenes side by side and collects a table and pictures.
    Sweep(SweepArguments),
    /// Reads and checks a scene, or every frame of a result; runs nothing.
    Check(CheckArguments),
    /// Opens results, meshes or a run that goes on in the browser: plays, compares, plots.
    View(ViewArguments),
    /// Makes a picture or a film of a result.
    Render(RenderArguments),
    /// Writes a result in a format that other programs open.
    Export(ExportArguments),
    /// Draws the figures of a run: energies, iterations, seconds, contacts.
    Plot(PlotArguments),
    /// Writes a commented scene to start from.
    New(NewArguments),
    /// Lists the materials that scenes can name.
    #[command(after_help = "Examples:\n  koiter materials\n  koiter materials --json")]
    Materials(CatalogueArguments),
    /// Lists the bending models and membranes that scenes can name.
    #[command(after_help = "Examples:\n  koiter models\n  koiter models --json")]
    Models(CatalogueArguments),
    /// Prints the JSON Schema of scene files, by which editors complete and check them.
    #[command(after_help = "\
Examples:
  koiter schema > koiter.schema.json

With `#:schema koiter.schema.json` as the first line of a scene, editors that know Taplo (VS Code with Even Better TOML,
and others) complete its keys and mark mistakes.")]
    Schema,
    /// Tells what the code of an error means and what to do.
    Explain(ExplainArguments),
    /// Prints completions for a shell.
    Completions(CompletionsArguments),
    /// Prints or writes manual pages.
    Man(ManArguments),
    /// Prints the membrane and bending energies of a mesh under any model.
    Energy(EnergyArguments),
    /// Natural frequencies or buckling loads of a scene's structure, and their shapes.
    Modes(ModesArguments),
    /// Finds values of a scene, such as moduli, from a measured curve.
    Fit(FitArguments),
    /// Computes published shell problems and compares.
    Validate(ValidateArguments),
    /// Measures what things cost on this machine, and how models compare.
    Bench(BenchArguments),
}

#[derive(Debug, Args)]
#[command(after_help = "\
SCENE is a scene.toml, a folder that holds one, or a scene that ships with Koiter:
  sphere-drape, drape-n, cantilever, hanging-sheet, flag-in-the-wind, v-beam, rolled-strip, hinged-roof, lateral-buckling,
  popper, pinned-drop, ball-crash, can-crush, cone-crush, twisted-cylinder, twisted-sheet, corrugated-collision,
  beams, hats, paper-sheet, your-own-mesh

Examples:
  koiter run sphere-drape
  koiter run sphere-drape --set resolution=tiny --out quick
  koiter run sphere-drape --set shell.cloth.material=paper --set time.end=2
  koiter run my/scene.toml --until 0.5 --no-film --json
  koiter run my/scene.toml --resume            goes on after Ctrl-C, a kill or a full disk
  koiter run my/scene.toml --resume --until 5  goes on beyond the end that was reached
  koiter run hanging-sheet --interactive       and beside it koiter view results/hanging-sheet: drag the cloth

The result folder holds manifest.json, topology.bin, rest.bin, frames/, stats.jsonl (a line a step), probes.csv and
summary.json; a result that is there already is replaced, but not an interrupted run.

checkpoint.bin is where --resume goes on: written after a step once output.checkpoint_seconds (10 s) have gone by,
at the end, and on Ctrl-C or SIGTERM, which end the run after the present step. A second Ctrl-C ends it at once,
with the last checkpoint whole. The word pause or stop in the file request.txt of the result folder does the same from
elsewhere: pause until the file is gone, or end after the present step. --resume refuses a checkpoint of another scene or version; title, time.end,
output.camera, output.color and output.checkpoint_seconds may differ.")]
pub(crate) struct RunArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Result folder [default: results/<name of the scene>]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Stop at this simulated time [s]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(crate) until: Option<f64>,
    /// Play with it: at the pace of the clock, while the mouse pulls at its shells in `koiter view DIR`. It ends at --until,
    /// else at time.end but not before two minutes
    #[arg(long)]
    pub(crate) interactive: bool,
    /// Go on with a run that was interrupted, to the same bits as one that was not
    #[arg(long)]
    pub(crate) resume: bool,
    /// Begin again where the result folder holds an interrupted run, and replace it
    #[arg(long, conflicts_with = "resume")]
    pub(crate) restart: bool,
    /// Number of threads [default: all cores]; the result is the same bits for any number
    #[arg(long, value_name = "N", value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) threads: Option<usize>,
    /// Print nothing but warnings and errors
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Print the summary as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Make a picture of the end and a film when the run is over (the default)
    #[arg(long, conflicts_with = "no_film")]
    pub(crate) film: bool,
    /// Make no picture and no film
    #[arg(long)]
    pub(crate) no_film: bool,
    /// If surfaces intersect at the start, write them to this PLY file with the offending faces coloured
    #[arg(long, value_name = "FILE.ply", value_parser = parse_ply)]
    pub(crate) debug_mesh: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter check sphere-drape
  koiter check my/scene.toml --set resolution=paper --json
  koiter check --result results/sphere-drape   tests every frame that was written

--result looks, with exact predicates and without the code of the run, for shells that cross themselves, each other or
obstacles, for collapsed faces, and for edges whose faces lie on each other. Status 1: something was found, or a frame is
missing or damaged.")]
pub(crate) struct CheckArguments {
    #[command(flatten)]
    pub(crate) scene: Option<SceneArguments>,
    /// Check the frames of a result folder instead of a scene
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath, conflicts_with_all = ["SceneArguments", "debug_mesh"])]
    pub(crate) result: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// If surfaces intersect at the start, write them to this PLY file with the offending faces coloured
    #[arg(long, value_name = "FILE.ply", value_parser = parse_ply)]
    pub(crate) debug_mesh: Option<PathBuf>,
}

/// A scene and what is changed in it.
#[derive(Debug, Args)]
pub(crate) struct SceneArguments {
    /// Scene file, folder with a scene.toml, or name of a scene that ships with Koiter
    #[arg(value_hint = ValueHint::AnyPath)]
    pub(crate) scene: String,
    /// Set a value of the scene by dotted path, such as time.dt=0.01 or shell.cloth.thickness=5e-4
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Refuse a scene that is estimated to need more memory, such as 64GB [default: what is available now]
    #[arg(long, value_name = "SIZE", value_parser = crate::memory::parse_size)]
    pub(crate) memory: Option<u64>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter render results/sphere-drape -o end.png
  koiter render results/sphere-drape -o drape.mp4 --size 1280x720
  koiter render results/sphere-drape -o strain.png --frame 40 --color strain --camera azimuth=60,elevation=20")]
pub(crate) struct RenderArguments {
    /// Result folder
    #[arg(value_hint = ValueHint::DirPath)]
    pub(crate) result: PathBuf,
    /// Picture (.png) or film (.mp4, needs ffmpeg; .gif)
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Frame of a picture, from 0 [default: the last]
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    pub(crate) frame: Option<usize>,
    /// Colour by a field: strain, bending_energy_density or mean_curvature
    #[arg(long, value_name = "FIELD")]
    pub(crate) color: Option<String>,
    /// front, side, top, iso, or azimuth=30,elevation=20,zoom=1.2
    #[arg(long, value_name = "VIEW")]
    pub(crate) camera: Option<koiter_render::CameraView>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size)]
    pub(crate) size: (u32, u32),
    /// Frames a second of a film [default: real time, at most 30; 30 where frames are uneven in time; every frame where all
    /// is over in two seconds]
    #[arg(long, value_name = "FPS", allow_negative_numbers = true)]
    pub(crate) fps: Option<f64>,
    /// Draw the edges of the triangles
    #[arg(long)]
    pub(crate) wireframe: bool,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

fn parse_count(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|&count| count > 0);
    count.ok_or_else(|| "write a whole number, 1 or larger".to_owned())
}

fn parse_ply(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_ply = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("ply"));
    is_ply
        .then_some(path)
        .ok_or_else(|| "the format is PLY: the name must end in .ply".to_owned())
}

#[derive(Debug, Args)]
#[command(after_help = "\
Every figure is the fastest of some repetitions. Rows are for one thread and for all cores.

Examples:
  koiter bench assembly
  koiter bench solve --faces 40000 --repeats 5
  koiter bench contact --json
  koiter bench drape --n 35,70 --bending bac --threads 1
  koiter bench explicit --threads 1
  koiter bench convergence --cases sphere --plot pictures
  koiter bench creased-vee --json
  koiter bench lateral-buckling --models bac --cells 50 --plot pictures")]
pub(crate) struct BenchArguments {
    #[command(subcommand)]
    pub(crate) subject: BenchSubject,
    /// Print one JSON object
    #[arg(long, global = true)]
    pub(crate) json: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum BenchSubject {
    /// Energies, gradients and Hessians into the assembled matrix
    Assembly(SizeArguments),
    /// Sparse Cholesky factorisation and solve, beside those of the crate faer
    Solve(SizeArguments),
    /// Broad phase, collision detection and barrier of a folded stack
    Contact(SizeArguments),
    /// Whole steps of the scene drape-n
    Drape(DrapeArguments),
    /// Explicit steps of Newmark's method with the hinges and the membrane of Discrete Shells
    Explicit(ExplicitArguments),
    /// Whole runs of the contact-rich scenes, audited: "Better Bending", Table 7; and with other steps, gaps and axes
    Scenes(ScenesArguments),
    /// What each bending model costs: evaluations, and nonzeros of its Hessian
    Models(ModelsArguments),
    /// Bending energies of known shapes under refinement: "Better Bending", Table 4 and Figures 3 to 12
    Convergence(ConvergenceArguments),
    /// What a step of a burning shell costs, and how its projections converge: "Burning cloth and paper", Tables 1 and 2
    Burning(BurningArguments),
    /// Bending energies of an unresolved crease: "Better Bending", Table 5, Figures 13 and 14
    CreasedVee(CreasedVeeArguments),
    /// The scenes of "Discrete Shells" and what its integrator conserves, beside an independent program; status 1 if a figure
    /// is outside
    DiscreteShells(DiscreteShellsArguments),
    /// When a heavy plate that stands on edge buckles sideways: "Better Bending", Figure 26
    LateralBuckling(LateralBucklingArguments),
    /// Bézier shells: the roof and the hemisphere for every element, beside published figures; frames a second
    Bezier(BezierArguments),
}

#[derive(Debug, Args)]
pub(crate) struct SizeArguments {
    /// Numbers of triangles, about
    #[arg(long, value_delimiter = ',', default_value = "10000,40000,160000", value_parser = parse_faces)]
    pub(crate) faces: Vec<usize>,
    /// Repetitions; the fastest counts
    #[arg(long, default_value_t = 3, allow_negative_numbers = true, value_parser = parse_count)]
    pub(crate) repeats: usize,
}

#[derive(Debug, Args)]
pub(crate) struct DrapeArguments {
    /// Cells along an edge of the cloth
    #[arg(long, value_delimiter = ',', default_value = "35,70,141")]
    pub(crate) n: Vec<usize>,
    /// Bending models, or all
    #[arg(long, value_delimiter = ',', default_value = "ds-theta,bac")]
    pub(crate) bending: Vec<String>,
    /// Steps of 20 ms
    #[arg(long, default_value_t = 40, allow_negative_numbers = true)]
    pub(crate) steps: usize,
    /// Numbers of threads [default: one, and all cores]
    #[arg(long, value_delimiter = ',')]
    pub(crate) threads: Vec<usize>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter bench explicit --threads 1
  koiter bench explicit --faces 40000 --steps 400 --threads 1 --json")]
pub(crate) struct ExplicitArguments {
    /// Numbers of triangles, about
    #[arg(long, value_delimiter = ',', default_value = "10000,40000", value_parser = parse_faces)]
    pub(crate) faces: Vec<usize>,
    /// Steps of a run
    #[arg(long, default_value_t = 200, allow_negative_numbers = true, value_parser = parse_count)]
    pub(crate) steps: usize,
    /// Repetitions; the fastest counts
    #[arg(long, default_value_t = 3, allow_negative_numbers = true, value_parser = parse_count)]
    pub(crate) repeats: usize,
    /// Numbers of threads [default: one, and all cores]
    #[arg(long, value_delimiter = ',')]
    pub(crate) threads: Vec<usize>,
}

#[derive(Debug, Args)]
pub(crate) struct LateralBucklingArguments {
    /// Bending models, or all
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "bac,dcs,ds-theta,qb-pl,qb-cr"
    )]
    pub(crate) models: Vec<String>,
    /// Widths of the plate over its length
    #[arg(long, value_delimiter = ',', default_value = "0.1,0.5,0.9", value_parser = parse_width)]
    pub(crate) widths: Vec<f64>,
    /// Loads Γ* = 12 (1 − ν²) ρ g L³ / (E h²), growing
    #[arg(long, value_delimiter = ',', default_value = "10,12.5,15,17.5,20,22.5,25,27.5,30,32.5,35,37.5,40", value_parser = parse_load)]
    pub(crate) loads: Vec<f64>,
    /// Edges along the plate; 100 is the mesh "Res++" of Romero et al., which takes most of an hour; 30 takes a minute
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u16).range(4..=1000))]
    pub(crate) cells: u16,
    /// Draw the curves into this folder, as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub(crate) plot: Option<PathBuf>,
}

fn parse_width(text: &str) -> Result<f64, String> {
    (text.parse().ok())
        .filter(|width| (0.01..=2.0).contains(width))
        .ok_or_else(|| "write a width over length from 0.01 to 2".into())
}

fn parse_load(text: &str) -> Result<f64, String> {
    (text.parse().ok())
        .filter(|load: &f64| *load > 0.0 && load.is_finite())
        .ok_or_else(|| "write a load above 0".into())
}

#[derive(Debug, Args)]
pub(crate) struct ModelsArguments {
    /// Bending models, or all
    #[arg(long, value_delimiter = ',', default_value = "all")]
    pub(crate) models: Vec<String>,
    /// Numbers of triangles, about
    #[arg(long, value_delimiter = ',', default_value = "10000,160000", value_parser = parse_faces)]
    pub(crate) faces: Vec<usize>,
    /// Repetitions; the fastest counts
    #[arg(long, default_value_t = 3, allow_negative_numbers = true, value_parser = parse_count)]
    pub(crate) repeats: usize,
}

/// Largest meshes of benchmarks: 4 GB of matrix.
const LARGEST_BENCH: usize = 2_000_000;

fn parse_faces(text: &str) -> Result<usize, String> {
    (text.parse().ok())
        .filter(|faces| (2..=LARGEST_BENCH).contains(faces))
        .ok_or_else(|| format!("write a number of triangles from 2 to {LARGEST_BENCH}"))
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once(['x', 'X']).and_then(|(width, height)| {
        Some((
            width.trim().parse::<u32>().ok()?,
            height.trim().parse::<u32>().ok()?,
        ))
    });
    sides
        .filter(|&(width, height)| width > 0 && height > 0)
        .ok_or_else(|| "write it as 1280x720".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn help_says_each_default_once() {
        fn check(command: &mut clap::Command) {
            for line in command.render_help().to_string().lines() {
                assert!(line.matches("[default:").count() < 2, "{line}");
            }
            command.get_subcommands_mut().for_each(check);
        }
        check(&mut Arguments::command());
    }

    #[test]
    fn sizes_are_two_positive_numbers() {
        assert_eq!(parse_size("640x360"), Ok((640, 360)));
        for text in ["640", "0x3", "ax3", "640x", "-1x3"] {
            assert!(parse_size(text).is_err(), "{text}");
        }
    }
}
