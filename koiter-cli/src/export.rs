//! `koiter export`: a result for other programs.

mod glb;

use std::path::Path;

use koiter::io::result::ResultReader;
use koiter::io::write::{MeshWithFields, write_obj, write_ply, write_vtu, write_vtu_series};
use koiter::io::write_atomically;
use serde_json::json;

use crate::arguments::{ExportArguments, ExportFormat};
use crate::failure::Failure;
use crate::output::say;
use crate::output_path;
use crate::view;

/// Exports a frame, or all as a VTK series.
pub(crate) fn export(arguments: &ExportArguments) -> Result<(), Failure> {
    let reader = ResultReader::open(&arguments.result).map_err(Failure::result)?;
    let Some(last) = reader.len().checked_sub(1) else {
        return Err(Failure::input(format!(
            "{} has no frames",
            arguments.result.display()
        )));
    };
    if arguments.color.is_some() && (arguments.to != ExportFormat::Glb || arguments.frame.is_none())
    {
        let message = "--color is for one frame as glb: colours do not move, and the other formats hold the fields";
        return Err(
            Failure::input(message).with_help("add --to glb --frame K, or leave --color out")
        );
    }
    let is_series = arguments.to == ExportFormat::Vtu && arguments.frame.is_none();
    let extension = match (arguments.to, is_series) {
        (ExportFormat::Obj, _) => "obj",
        (ExportFormat::Ply, _) => "ply",
        (ExportFormat::Vtu, true) => "pvd",
        (ExportFormat::Vtu, false) => "vtu",
        (ExportFormat::Glb, _) => "glb",
        (ExportFormat::Html, _) => "html",
    };
    output_path::check(&arguments.output)?;
    let given = arguments
        .output
        .extension()
        .map(|given| given.to_ascii_lowercase());
    let output = match given {
        None => arguments.output.with_extension(extension),
        Some(given) if given == extension => arguments.output.clone(),
        Some(_) => {
            let message = format!(
                "{}: this export must end in .{extension}",
                arguments.output.display()
            );
            return Err(Failure::input(message));
        }
    };
    output_path::check(&output)?;
    if is_series {
        write_vtu_series(&reader, &output, |_| {}).map_err(Failure::run)?;
    } else if arguments.to == ExportFormat::Glb {
        glb::export(&reader, arguments, &output)?;
    } else if arguments.to == ExportFormat::Html {
        write_html(&reader, arguments, &output)?;
    } else {
        let frame = reader
            .frame(arguments.frame.unwrap_or(last))
            .map_err(Failure::result)?;
        let mesh = MeshWithFields::of_frame(&reader, &frame);
        match arguments.to {
            ExportFormat::Obj => write_obj(&output, &mesh),
            ExportFormat::Ply => write_ply(&output, &mesh),
            _ => write_vtu(&output, &mesh, Some(frame.time)),
        }
        .map_err(Failure::run)?;
    }
    report(arguments, &reader, &output);
    Ok(())
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
    write_atomically(output, html.as_bytes())
        .map_err(|error| Failure::run(format!("cannot write {}: {error}", output.display())))
}

fn report(arguments: &ExportArguments, reader: &ResultReader, output: &Path) {
    if !arguments.json {
        say!("made: {}", output.display());
        return;
    }
    let can_hold_all = !matches!(arguments.to, ExportFormat::Obj | ExportFormat::Ply);
    let is_all = can_hold_all && arguments.frame.is_none();
    let manifest = reader.manifest();
    let json = json!({
        "made": output.display().to_string(),
        "frames": if is_all { reader.len() } else { 1 },
        "vertices": manifest.num_vertices(),
        "faces": manifest.num_faces(),
    });
    say!("{json}");
}
