//! Files for other programs. Of a mesh: OBJ, STL, PLY and VTU with fields. Of a film: PVD, which lists VTU files, GLB, and VTKHDF,
//! USDA and NPZ with fields, PC2 without.
//!
//! Each format has a function from mesh to bytes and one that writes the bytes to a file, whole or not at all.
//! Lengths are metres; the up axis is stated in a comment where the format has comments.

mod film;
mod glb;
mod hdf5;
mod npz;
mod obj;
mod pc2;
mod ply;
mod stl;
mod usda;
mod vtkhdf;
mod vtu;

pub use glb::{GlbLook, MAX_GLB_FRAMES, glb_bytes, glb_frames, write_glb};
pub use npz::{npz_bytes, write_npz};
pub use obj::{obj_bytes, write_obj};
pub(super) use pc2::PC2_MAGIC;
pub use pc2::{pc2_bytes, write_pc2};
pub use ply::{ply_bytes, write_ply};
pub use stl::{stl_bytes, write_stl};
pub use usda::{usda_bytes, write_usda};
pub use vtkhdf::{vtkhdf_bytes, write_vtkhdf};
pub use vtu::{pvd_bytes, vtu_bytes, write_pvd, write_vtu, write_vtu_series};

use std::collections::HashSet;
use std::io;
use std::path::{Path, PathBuf};

use super::result::{Field, Frame, Part, ResultError, ResultReader, UpAxis};
use super::write_atomically;
use crate::Vec3;
use crate::mesh::Surface;

/// A mesh to be written: positions, faces and named values.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeshWithFields<'a> {
    /// Vertex positions [m].
    pub positions: &'a [Vec3],
    /// Triangles, by vertex index from 0.
    pub faces: &'a [[u32; 3]],
    /// Values at vertices.
    pub vertex_fields: &'a [Field],
    /// Values at faces.
    pub face_fields: &'a [Field],
    /// Names of ranges of faces: objects in OBJ, in PLY and VTU the number of its part at every face, with a table of names.
    pub parts: &'a [Part],
    /// Which way is up.
    pub up_axis: UpAxis,
}

/// Why a mesh could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The system refused: full disk, no permission, no such folder.
    #[error("could not write {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A field has the wrong length.
    #[error("field '{name}' has {found} values for {expected} {what}; give one a piece")]
    FieldLength {
        /// Name of the field.
        name: String,
        /// Number of its values.
        found: usize,
        /// Number of vertices or faces.
        expected: usize,
        /// "vertices" or "faces".
        what: &'static str,
    },
    /// A field's name is empty, used twice, or means something else in the format.
    #[error("the name '{name}' of a field is empty or taken; rename the field")]
    FieldName {
        /// Name of the field, as it would be written.
        name: String,
    },
    /// A face uses a vertex that does not exist, or one beyond the indices of the format.
    #[error("face {face} uses vertex {vertex} of {num_vertices}; correct the index")]
    IndexOutOfRange {
        /// Face index.
        face: usize,
        /// The vertex it uses.
        vertex: u32,
        /// Number of vertices.
        num_vertices: usize,
    },
    /// More than the format can hold.
    #[error("the result is too large: {what}; export one frame, or another format")]
    TooLarge {
        /// What the format holds.
        what: &'static str,
    },
    /// A part has faces that do not exist.
    #[error("part '{name}' ends at face {end} of {num_faces}; correct its range")]
    PartOutOfRange {
        /// Name of the part.
        name: String,
        /// End of its faces.
        end: usize,
        /// Number of faces.
        num_faces: usize,
    },
    /// A film of faces that change, in a format that moves vertices only.
    #[error(
        "faces change from frame to frame (burnt, cut or sewn), which a {format} film cannot show; export one frame, or all as vtu, vtkhdf or usda"
    )]
    ChangingFaces {
        /// The format.
        format: &'static str,
    },
    /// A film of fields that come and go, in a format that names them once.
    #[error(
        "frame {frame} has other fields than the first, which a {format} film cannot show; export one frame, or all as vtu"
    )]
    ChangingFields {
        /// The frame.
        frame: usize,
        /// The format.
        format: &'static str,
    },
    /// A frame to be exported could not be read.
    #[error(transparent)]
    Result(#[from] ResultError),
}

impl<'a> MeshWithFields<'a> {
    /// A surface without fields.
    pub fn of_surface(surface: &'a Surface) -> Self {
        Self {
            positions: &surface.positions,
            faces: surface.mesh.faces(),
            ..Self::default()
        }
    }

    /// A frame of a result with its fields and parts.
    pub fn of_frame(result: &'a ResultReader, frame: &'a Frame) -> Self {
        Self {
            positions: &frame.positions,
            faces: result.faces_in(frame),
            vertex_fields: &frame.vertex_fields,
            face_fields: &frame.face_fields,
            parts: result.parts_in(frame),
            up_axis: result.manifest().up_axis,
        }
    }

    /// The number of the part of every face, from 0; none without parts, −1 for a face of no part.
    fn part_numbers(&self) -> Option<Vec<i32>> {
        if self.parts.is_empty() {
            return None;
        }
        let mut numbers = vec![-1; self.faces.len()];
        for (number, part) in (0..).zip(self.parts) {
            numbers[part.faces.clone()].fill(number);
        }
        Some(numbers)
    }

    /// Checks what readers would choke on. `written_name` is what the format makes of a field's name; `taken` are names
    /// that it uses itself.
    fn check(
        &self,
        written_name: impl Fn(&str) -> String,
        taken: &[&str],
    ) -> Result<(), WriteError> {
        self.check_faces()?;
        self.check_fields(written_name, taken)
    }

    fn check_faces(&self) -> Result<(), WriteError> {
        for (face, corners) in self.faces.iter().enumerate() {
            for &vertex in corners {
                // Formats and readers with signed 32-bit indices are common.
                if vertex as usize >= self.positions.len() || i32::try_from(vertex).is_err() {
                    let num_vertices = self.positions.len();
                    return Err(WriteError::IndexOutOfRange {
                        face,
                        vertex,
                        num_vertices,
                    });
                }
            }
        }
        for part in self.parts {
            if part.faces.end > self.faces.len() {
                return Err(WriteError::PartOutOfRange {
                    name: part.name.clone(),
                    end: part.faces.end,
                    num_faces: self.faces.len(),
                });
            }
        }
        Ok(())
    }

    fn check_fields(
        &self,
        written_name: impl Fn(&str) -> String,
        taken: &[&str],
    ) -> Result<(), WriteError> {
        for (fields, expected, what) in [
            (self.vertex_fields, self.positions.len(), "vertices"),
            (self.face_fields, self.faces.len(), "faces"),
        ] {
            let mut names: HashSet<String> = taken.iter().map(|name| (*name).to_string()).collect();
            for field in fields {
                let found = field.values.len();
                if found != expected {
                    let name = field.name.clone();
                    return Err(WriteError::FieldLength {
                        name,
                        found,
                        expected,
                        what,
                    });
                }
                let name = written_name(&field.name);
                if name.is_empty() || !names.insert(name.clone()) {
                    return Err(WriteError::FieldName { name });
                }
            }
        }
        Ok(())
    }
}

/// The name of the array of [`MeshWithFields::part_numbers`].
const PART: &str = "part";

/// The comment that most formats can hold.
fn unit_comment(up_axis: UpAxis) -> &'static str {
    match up_axis {
        UpAxis::X => "Koiter: lengths in metres, x up",
        UpAxis::Y => "Koiter: lengths in metres, y up",
        UpAxis::Z => "Koiter: lengths in metres, z up",
    }
}

fn write_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_atomically(path, bytes).map_err(|source| WriteError::Io {
        path: path.to_path_buf(),
        source,
    })
}

/// A name as one word of letters, digits and underscores, for formats that separate by blanks.
fn as_word(name: &str) -> String {
    name.chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect()
}

#[cfg(test)]
mod tests;
