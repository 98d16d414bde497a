//! PC2 point caches, of Blender's and Houdini's mesh caches: positions over frames, beside a mesh in an OBJ file.
//!
//! ```text
//! "POINTCACHE2\0"  i32 version 1  i32 points  f32 first frame  f32 frames a sample  i32 samples
//! f32 × 3 a point, sample after sample
//! ```
//!
//! Little-endian. The format holds neither faces nor times, units or axes: a sample is a frame of the result, lengths are metres.

use std::path::{Path, PathBuf};

use super::film::Film;
use super::{MeshWithFields, WriteError, write_file, write_obj};
use crate::io::result::ResultReader;

/// How a file begins, the version included.
pub(in crate::io) const PC2_MAGIC: &[u8; 16] = b"POINTCACHE2\0\x01\0\0\0";

/// The positions of all parts in some frames as a PC2 file.
///
/// # Errors
/// A frame that cannot be read, faces that burn away, more points or frames than 31 bits count.
///
/// # Panics
/// No frames.
pub fn pc2_bytes(result: &ResultReader, frames: &[usize]) -> Result<Vec<u8>, WriteError> {
    let count = |number: usize| {
        i32::try_from(number).map_err(|_| WriteError::TooLarge {
            what: "a PC2 file counts points and frames in 31 bits",
        })
    };
    let film = Film::new(result, frames, "PC2");
    let num_samples = count(film.len())?;
    let mut bytes = PC2_MAGIC.to_vec();
    film.visit_same_faces(|frame| {
        if bytes.len() == PC2_MAGIC.len() {
            bytes.extend(count(frame.positions.len())?.to_le_bytes());
            bytes.extend(0_f32.to_le_bytes());
            bytes.extend(1_f32.to_le_bytes());
            bytes.extend(num_samples.to_le_bytes());
        }
        let coordinates = frame.positions.iter().flat_map(|x| x.iter());
        bytes.extend(coordinates.flat_map(|&value| (value as f32).to_le_bytes()));
        Ok(())
    })?;
    Ok(bytes)
}

/// Writes [`pc2_bytes`] to a file, and the mesh of the first frame beside it, with the extension `obj`; returns the mesh's path.
///
/// The mesh is one object without parts: programs split the vertices of several, and the cache would no longer fit.
///
/// # Errors
/// Those of [`pc2_bytes`], a refusal of the system.
///
/// # Panics
/// No frames.
pub fn write_pc2(
    path: &Path,
    result: &ResultReader,
    frames: &[usize],
) -> Result<PathBuf, WriteError> {
    write_file(path, &pc2_bytes(result, frames)?)?;
    let first = result.frame(frames[0])?;
    let whole = MeshWithFields {
        parts: &[],
        ..MeshWithFields::of_frame(result, &first)
    };
    let mesh = path.with_extension("obj");
    write_obj(&mesh, &whole)?;
    Ok(mesh)
}
