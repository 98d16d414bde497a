//! What `koiter export` takes.

use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  koiter export results/sphere-drape --to vtu -o drape.pvd      every frame, for ParaView
  koiter export results/sphere-drape --to obj -o end.obj        the last frame
  koiter export results/sphere-drape --to ply -o k40.ply --frame 40
  koiter export results/sphere-drape --to glb -o drape.glb      a film, for browsers and Blender
  koiter export results/sphere-drape --to usda -o drape.usda    a film, for Houdini, Maya and Blender
  koiter export results/sphere-drape --to pc2 -o drape.pc2      a point cache, and drape.obj for its modifier
  koiter export results/sphere-drape --to npz -o drape.npz      arrays for NumPy
  koiter export results/sphere-drape --to html -o drape.html    the viewer with the result inside, to be sent
  koiter export results/sphere-drape --to glb -o strain.glb --frame 40 --color strain")]
pub(crate) struct ExportArguments {
    /// Result folder
    #[arg(value_hint = ValueHint::DirPath)]
    pub(crate) result: PathBuf,
    /// Format
    #[arg(long, value_enum)]
    pub(crate) to: ExportFormat,
    /// File to write; for a vtu series, the .pvd that lists it
    #[arg(short, long, value_name = "PATH")]
    pub(crate) output: PathBuf,
    /// Frame, from 0 [default: the last for obj, stl and ply; all for the others]
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    pub(crate) frame: Option<usize>,
    /// Colour a frame of a glb by a field: strain, bending_energy_density or mean_curvature
    #[arg(long, value_name = "FIELD")]
    pub(crate) color: Option<String>,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ExportFormat {
    /// Wavefront, an object a part
    Obj,
    /// Binary STL: triangles only, in metres
    Stl,
    /// Binary PLY with fields
    Ply,
    /// VTK with fields; a series and its .pvd unless --frame is given
    Vtu,
    /// VTKHDF with fields for ParaView 5.12 and later; all frames in one file, faces once
    Vtkhdf,
    /// glTF 2.0 in one file; a film unless --frame is given
    Glb,
    /// Universal Scene Description as text, with points and fields over time
    Usda,
    /// Point cache for the mesh caches of Blender and Houdini, and an .obj beside it
    Pc2,
    /// Arrays for NumPy
    Npz,
    /// The viewer with the result inside: one file that opens anywhere
    Html,
}
