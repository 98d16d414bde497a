//! NPZ: arrays for NumPy, `numpy.load("drape.npz")`.
//!
//! ```text
//! times (f)  steps (f)  positions (f, n, 3)  faces (m, 3)
//! vertex_NAME (f, n), face_NAME (f, m)       a field of vertices or faces each
//! part_names (p)  part_vertices (p, 2)  part_faces (p, 2)   ranges: first, and one past the last
//! up_axis  metres_per_unit
//! ```
//!
//! An NPZ file is a ZIP archive of NPY files; here they are not compressed. References: "NEP 1, a simple file format for
//! NumPy arrays", and PKWARE's APPNOTE for ZIP.

mod zip;

use std::path::Path;

use super::film::Film;
use super::{WriteError, as_word, write_file};
use crate::io::result::{Field, Frame, Part, ResultReader, UpAxis};
use zip::Archive;

/// Some frames of a result as an NPZ file.
///
/// # Errors
/// A frame that cannot be read, faces that burn away from frame to frame, more than 4 GiB.
///
/// # Panics
/// No frames.
pub fn npz_bytes(result: &ResultReader, frames: &[usize]) -> Result<Vec<u8>, WriteError> {
    let film = Film::new(result, frames, "NPZ");
    let mut arrays = Arrays::default();
    film.visit_same_faces(|frame| {
        arrays.add(result, frame);
        Ok(())
    })?;
    arrays
        .into_archive(result.manifest().up_axis)
        .ok_or(WriteError::TooLarge {
            what: "an NPZ file holds at most 4 GiB here",
        })
}

/// Writes [`npz_bytes`] to a file.
///
/// # Errors
/// Those of [`npz_bytes`], a refusal of the system.
///
/// # Panics
/// No frames.
pub fn write_npz(path: &Path, result: &ResultReader, frames: &[usize]) -> Result<(), WriteError> {
    write_file(path, &npz_bytes(result, frames)?)
}

/// The arrays as they grow, frame after frame.
#[derive(Default)]
struct Arrays {
    times: Vec<u8>,
    steps: Vec<u8>,
    positions: Vec<u8>,
    num_frames: usize,
    num_vertices: usize,
    /// Name, values a frame, values.
    fields: Vec<(String, usize, Vec<u8>)>,
    faces: Vec<[u32; 3]>,
    parts: Vec<Part>,
}

impl Arrays {
    fn add(&mut self, result: &ResultReader, frame: &Frame) {
        if self.num_frames == 0 {
            self.num_vertices = frame.positions.len();
            self.faces = result.faces_in(frame).to_vec();
            self.parts = result.parts_in(frame).to_vec();
            let begun = |prefix: &str, field: &Field| {
                let name = format!("{prefix}_{}", as_word(&field.name));
                (name, field.values.len(), Vec::new())
            };
            let of_vertices = frame.vertex_fields.iter().map(|f| begun("vertex", f));
            let of_faces = frame.face_fields.iter().map(|f| begun("face", f));
            self.fields = of_vertices.chain(of_faces).collect();
        }
        self.num_frames += 1;
        self.times.extend(frame.time.to_le_bytes());
        self.steps.extend(frame.step.to_le_bytes());
        let coordinates = frame.positions.iter().flat_map(|x| x.iter());
        self.positions
            .extend(coordinates.flat_map(|value| value.to_le_bytes()));
        let fields = frame.vertex_fields.iter().chain(&frame.face_fields);
        for ((_, _, bytes), field) in self.fields.iter_mut().zip(fields) {
            bytes.extend(field.values.iter().flat_map(|value| value.to_le_bytes()));
        }
    }

    /// `None`: larger than an archive can be.
    fn into_archive(self, up_axis: UpAxis) -> Option<Vec<u8>> {
        let mut archive = Archive::default();
        let mut add = |name: &str, kind: &str, shape: &[usize], values: &[u8]| {
            archive.add(&format!("{name}.npy"), &npy(kind, shape, values))
        };
        let frames = self.num_frames;
        add("times", "<f8", &[frames], &self.times)?;
        add("steps", "<u8", &[frames], &self.steps)?;
        let shape = [frames, self.num_vertices, 3];
        add("positions", "<f8", &shape, &self.positions)?;
        let corners = self.faces.iter().flatten();
        let corners: Vec<u8> = corners.flat_map(|v| v.to_le_bytes()).collect();
        add("faces", "<u4", &[self.faces.len(), 3], &corners)?;
        for (name, length, values) in &self.fields {
            add(name, "<f4", &[frames, *length], values)?;
        }
        let names: Vec<&str> = self.parts.iter().map(|part| part.name.as_str()).collect();
        let (kind, values) = texts(&names);
        add("part_names", &kind, &[names.len()], &values)?;
        for (name, ranges) in [
            (
                "part_vertices",
                self.parts.iter().map(|p| &p.vertices).collect::<Vec<_>>(),
            ),
            ("part_faces", self.parts.iter().map(|p| &p.faces).collect()),
        ] {
            let ends = ranges.iter().flat_map(|range| [range.start, range.end]);
            let values: Vec<u8> = ends.flat_map(|end| (end as u64).to_le_bytes()).collect();
            add(name, "<u8", &[ranges.len(), 2], &values)?;
        }
        let (kind, values) = texts(&[match up_axis {
            UpAxis::X => "x",
            UpAxis::Y => "y",
            UpAxis::Z => "z",
        }]);
        add("up_axis", &kind, &[], &values)?;
        add("metres_per_unit", "<f8", &[], &1_f64.to_le_bytes())?;
        archive.finish()
    }
}

/// An NPY file, version 1.0: values in C order.
fn npy(kind: &str, shape: &[usize], values: &[u8]) -> Vec<u8> {
    let mut lengths: Vec<String> = shape.iter().map(usize::to_string).collect();
    // A tuple of one has a comma.
    if lengths.len() == 1 {
        lengths.push(String::new());
    }
    let shape = lengths.join(",");
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}");
    // Values begin at a multiple of 64 bytes, as NumPy's own do; 10 bytes stand before, a line break ends the header.
    let padding = 64 - (10 + header.len() + 1) % 64;
    header.extend(std::iter::repeat_n(' ', padding % 64));
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(values);
    bytes
}

/// Texts of one length each, in UCS-4, as NumPy keeps them.
fn texts(texts: &[&str]) -> (String, Vec<u8>) {
    let longest = texts.iter().map(|text| text.chars().count()).max();
    let length = longest.unwrap_or(0).max(1);
    let mut bytes = Vec::with_capacity(4 * length * texts.len());
    for text in texts {
        let mut codes: Vec<u32> = text.chars().map(u32::from).collect();
        codes.resize(length, 0);
        bytes.extend(codes.iter().flat_map(|code| code.to_le_bytes()));
    }
    (format!("<U{length}"), bytes)
}
