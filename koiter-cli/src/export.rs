//! `koiter export`: a result for other programs.

mod glb;

use std::path::{Path, PathBuf};

use koiter::io::result::ResultReader;
use koiter::io::write::{
    MeshWithFields, WriteError, write_npz, write_obj, write_pc2, write_ply, write_stl, write_usda,
    write_vtkhdf, write_vtu, write_vtu_series,
};
use koiter::io::write_atomically;
use serde_json::json;

use crate::arguments::{ExportArguments, ExportFormat};
use crate::failure::Failure;
use crate::output::say;
use crate::output_path;
use crate::view;

/// Exports a frame, or all to a format that holds films.
pub(crate) fn export(arguments: &ExportArguments) -> Result<(), Failure> {
    let reader = ResultReader::open(&arguments.result).map_err(Failure::result)?;
    if reader.is_empty() {
        let message = format!("{} has no frames", arguments.result.display());
        return Err(Failure::input(message));
    }
    check_color(arguments)?;
    let output = output(arguments)?;
    let beside = write(arguments, &reader, &output)?;
    report(arguments, &reader, &output, beside.as_deref());
    Ok(())
}

fn check_color(arguments: &ExportArguments) -> Result<(), Failure> {
    let is_still = arguments.to == ExportFormat::Glb && arguments.frame.is_some();
    if arguments.color.is_none() || is_still {
        return Ok(());
    }
    let message = "--color is for one frame as glb: colours do not move, and the other formats hold the fields";
    Err(Failure::input(message).with_help("add --to glb --frame K, or leave --color out"))
}

/// Whether all frames go into the export.
fn is_film(arguments: &ExportArguments) -> bool {
    use ExportFormat::{Obj, Ply, Stl};
    arguments.frame.is_none() && !matches!(arguments.to, Obj | Ply | Stl)
}

/// The file to write, with the extension of its format.
fn output(arguments: &ExportArguments) -> Result<PathBuf, Failure> {
    let extension = match arguments.to {
        ExportFormat::Obj => "obj",
        ExportFormat::Stl => "stl",
        ExportFormat::Ply => "ply",
        ExportFormat::Vtu if is_film(arguments) => "pvd",
        ExportFormat::Vtu => "vtu",
        ExportFormat::Vtkhdf => "vtkhdf",
        ExportFormat::Glb => "glb",
        ExportFormat::Usda => "usda",
        ExportFormat::Pc2 => "pc2",
        ExportFormat::Npz => "npz",
        ExportFormat::Html => "html",
    };
    let path = &arguments.output;
    output_path::check(path)?;
    let given = path.extension().map(|given| given.to_ascii_lowercase());
    let output = match given {
        None => path.with_extension(extension),
        Some(given) if given == extension => path.clone(),
        Some(_) => {
            let message = format!("{}: this export must end in .{extension}", path.display());
            return Err(Failure::input(message));
        }
    };
    output_path::check(&output)?;
    Ok(output)
}

/// Writes the export; returns a file that belongs to it, if there is one.
fn write(
    arguments: &ExportArguments,
    reader: &ResultReader,
    output: &Path,
) -> Result<Option<PathBuf>, Failure> {
    let frames = match arguments.frame {
        Some(frame) => vec![frame],
        None => (0..reader.len()).collect(),
    };
    match arguments.to {
        ExportFormat::Vtu if is_film(arguments) => write_vtu_series(reader, output, |_| {}),
        ExportFormat::Vtkhdf => write_vtkhdf(output, reader, &frames),
        ExportFormat::Usda => write_usda(output, reader, &frames),
        ExportFormat::Npz => write_npz(output, reader, &frames),
        ExportFormat::Pc2 => {
            let mesh = write_pc2(output, reader, &frames).map_err(Failure::export)?;
            return Ok(Some(mesh));
        }
        ExportFormat::Glb => return glb::export(reader, arguments, output).map(|()| None),
        ExportFormat::Html => return write_html(reader, arguments, output).map(|()| None),
        ExportFormat::Obj | ExportFormat::Stl | ExportFormat::Ply | ExportFormat::Vtu => {
            write_frame(arguments, reader, output)
        }
    }
    .map_err(Failure::export)?;
    Ok(None)
}

fn write_frame(
    arguments: &ExportArguments,
    reader: &ResultReader,
    output: &Path,
) -> Result<(), WriteError> {
    let frame = reader.frame(arguments.frame.unwrap_or(reader.len() - 1))?;
    let mesh = MeshWithFields::of_frame(reader, &frame);
    match arguments.to {
        ExportFormat::Obj => write_obj(output, &mesh),
        ExportFormat::Stl => write_stl(output, &mesh),
        ExportFormat::Ply => write_ply(output, &mesh),
        _ => write_vtu(output, &mesh, Some(frame.time)),
    }
}

fn write_html(
    reader: &ResultReader,
    arguments: &ExportArguments,
    output: &Path,
) -> Result<(), Failure> {
    let page = view::bundled_page()?;
    let frames = match arguments.frame {
        Some(frame) => vec![frame],
        None => view::html_frames(reader),
    };
    let html = view::html(&arguments.result, &page, &frames)?;
    write_atomically(output, html.as_bytes()).map_err(|error| Failure::writing(output, &error))
}

fn report(
    arguments: &ExportArguments,
    reader: &ResultReader,
    output: &Path,
    beside: Option<&Path>,
) {
    if !arguments.json {
        for path in [Some(output), beside].into_iter().flatten() {
            say!("made: {}", path.display());
        }
        return;
    }
    let manifest = reader.manifest();
    let mut json = json!({
        "made": output.display().to_string(),
        "frames": if is_film(arguments) { reader.len() } else { 1 },
        "vertices": manifest.num_vertices(),
        "faces": manifest.num_faces(),
    });
    if let Some(mesh) = beside {
        json["mesh"] = json!(mesh.display().to_string());
    }
    say!("{json}");
}
