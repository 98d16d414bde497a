//! A result inside the viewer's page: one file that opens from a disk or an e-mail.

use std::path::Path;

use koiter::io::result::{Frame, ResultReader};
use serde_json::{Value, json};

use super::page::Page;
use super::quantised::{Extent, Scale, base64, chunk, compressed};
use super::shown::Shown;
use crate::failure::Failure;

/// Frames a chunk: what a page unpacks at a time.
const FRAMES_A_CHUNK: usize = 16;
/// Most frames; of longer runs every second, third, … is kept.
const MAX_FRAMES: usize = 600;
/// Most bytes before they are compressed: what e-mails and browsers take.
const MAX_BYTES: usize = 400 << 20;

/// The page with some frames of a result.
pub(crate) fn html(folder: &Path, page: &Page, frames: &[usize]) -> Result<String, Failure> {
    let shown = Shown::open(folder)?;
    let reader = ResultReader::open(folder).map_err(Failure::result)?;
    let data = data(&shown, &reader, frames)?;
    // In JSON `<` stands in texts alone, where it may be written so: no text ends the script that it is in.
    let data = data.to_string().replace('<', "\\u003c");
    Ok(page.with_data(&data))
}

/// The frames of a film: all, or so many that the file can still be sent.
pub(crate) fn html_frames(reader: &ResultReader) -> Vec<usize> {
    let manifest = reader.manifest();
    let fields = reader.frame(0).map_or(0, |frame| {
        frame.face_fields.len() + frame.vertex_fields.len()
    });
    let bytes = 2 * (3 * manifest.num_vertices() + fields * manifest.num_faces());
    let by_size = (reader.len() * bytes).div_ceil(MAX_BYTES);
    let stride = reader.len().div_ceil(MAX_FRAMES).max(by_size).max(1);
    (0..reader.len()).step_by(stride).collect()
}

fn data(shown: &Shown, reader: &ResultReader, frames: &[usize]) -> Result<Value, Failure> {
    let scales = Scales::of(reader, frames)?;
    let (mut times, mut chunks) = (Vec::new(), Vec::new());
    for indices in frames.chunks(FRAMES_A_CHUNK) {
        let mut numbers = Vec::new();
        for &index in indices {
            let frame = reader.frame(index).map_err(Failure::result)?;
            times.push(frame.time);
            numbers.push(scales.numbers(reader, &frame));
        }
        chunks.push(base64(&chunk(&numbers)));
    }
    let mut info = shown.info();
    // Where the folder lies is nobody else's business.
    info["path"] = reader
        .folder()
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into();
    let ranges = (0..scales.fields.len()).map(|field| shown.range(field));
    let ranges: Vec<Value> = ranges.collect::<Result<_, _>>().map_err(Failure::run)?;
    Ok(json!({
        "info": info,
        "times": times,
        "frames_a_chunk": FRAMES_A_CHUNK,
        "topology": base64(&compressed(&shown.topology())),
        "positions": scales.positions,
        "fields": scales.fields.iter().map(|(_, scale)| scale).collect::<Vec<_>>(),
        "ranges": ranges,
        "chunks": chunks,
        "stats": shown.stats().map_err(Failure::input)?,
        "probes": shown.probes().map_err(Failure::input)?,
        "summary": reader.summary().map_err(Failure::result)?,
        "scene": shown.scene(),
    }))
}

/// What the numbers of all frames mean.
struct Scales {
    /// Of every part, along x, y and z.
    positions: Vec<[Scale; 3]>,
    /// Of every field of the first frame, by its name: those of faces first.
    fields: Vec<(String, Scale)>,
}

impl Scales {
    /// Looks through all frames.
    fn of(reader: &ResultReader, frames: &[usize]) -> Result<Self, Failure> {
        let parts = &reader.manifest().parts;
        let mut positions = vec![[Extent::EMPTY; 3]; parts.len()];
        let mut fields: Vec<(String, Extent)> = Vec::new();
        for &index in frames {
            let frame = reader.frame(index).map_err(Failure::result)?;
            for (part, extents) in parts.iter().zip(&mut positions) {
                for position in &frame.positions[part.vertices.clone()] {
                    (0..3).for_each(|axis| extents[axis].include(position[axis]));
                }
            }
            if fields.is_empty() {
                let named = frame.face_fields.iter().chain(&frame.vertex_fields);
                fields = named
                    .map(|field| (field.name.clone(), Extent::EMPTY))
                    .collect();
            }
            for (name, extent) in &mut fields {
                let values = frame.field(name).map_or(&[][..], |field| &field.values);
                values
                    .iter()
                    .for_each(|&value| extent.include(value.into()));
            }
        }
        let of_axes = |extents: [Extent; 3]| extents.map(|extent| extent.scale());
        Ok(Self {
            positions: positions.into_iter().map(of_axes).collect(),
            fields: (fields.into_iter())
                .map(|(name, extent)| (name, extent.scale()))
                .collect(),
        })
    }

    /// Positions of all parts, then all fields.
    fn numbers(&self, reader: &ResultReader, frame: &Frame) -> Vec<u16> {
        let mut numbers = Vec::new();
        for (part, scales) in reader.manifest().parts.iter().zip(&self.positions) {
            for position in &frame.positions[part.vertices.clone()] {
                numbers.extend((0..3).map(|axis| scales[axis].number(position[axis])));
            }
        }
        for (name, scale) in &self.fields {
            match frame.field(name) {
                Some(field) => numbers.extend(field.values.iter().map(|&v| scale.number(v.into()))),
                // The first frame has every field, and all are as long in every frame.
                None => numbers.extend((0..reader.faces().len()).map(|_| scale.number(f64::NAN))),
            }
        }
        numbers
    }
}
