//! A result as GLB, in the colours of its pictures.

use std::path::Path;

use koiter::io::result::{Frame, PartKind, ResultReader};
use koiter::io::write::{GlbLook, glb_frames, write_glb};
use koiter_render::Rgb;

use crate::arguments::ExportArguments;
use crate::failure::Failure;
use crate::pictures::{color_map, color_range, missing_field};

/// Writes one frame as a still, or all as a film.
pub(super) fn export(
    reader: &ResultReader,
    arguments: &ExportArguments,
    output: &Path,
) -> Result<(), Failure> {
    let frames = match arguments.frame {
        Some(frame) => vec![frame],
        None => glb_frames(reader.len()),
    };
    let vertex_colors = match &arguments.color {
        None => None,
        Some(name) => {
            let frame = reader.frame(frames[0]).map_err(Failure::result)?;
            Some(field_colors(reader, &frame, name)?)
        }
    };
    let look = GlbLook {
        part_colors: part_colors(reader),
        vertex_colors,
    };
    write_glb(output, reader, &frames, &look).map_err(Failure::export)
}

/// Shells in the order of the render's colours, obstacles in stone.
fn part_colors(reader: &ResultReader) -> Vec<[f32; 3]> {
    let mut shells = 0;
    let parts = reader.manifest().parts.iter();
    parts
        .map(|part| {
            if part.kind == PartKind::Obstacle {
                return Rgb::STONE.linear();
            }
            shells += 1;
            Rgb::of_part(shells - 1).linear()
        })
        .collect()
}

/// Colours of the field's mean about every vertex; stone where it has no value.
fn field_colors(
    reader: &ResultReader,
    frame: &Frame,
    name: &str,
) -> Result<Vec<[f32; 3]>, Failure> {
    let field = frame.face_fields.iter().find(|field| field.name == name);
    let field = field.ok_or_else(|| missing_field(frame, name))?;
    let mut sums = vec![(0.0, 0.0); frame.positions.len()];
    for (face, &value) in reader.faces_in(frame).iter().zip(&field.values) {
        if value.is_finite() {
            for &vertex in face {
                let (sum, count) = &mut sums[vertex as usize];
                *sum += f64::from(value);
                *count += 1.0;
            }
        }
    }
    let means = sums.iter().map(|(sum, count)| sum / count);
    let values: Vec<f64> = means.collect();
    let (low, high) = color_range(values.clone()).unwrap_or((0.0, 1.0));
    let map = color_map(name).1;
    let color = |value: &f64| match value.is_nan() {
        true => Rgb::STONE.linear(),
        false => map.at((value - low) / (high - low)).linear(),
    };
    Ok(values.iter().map(color).collect())
}
