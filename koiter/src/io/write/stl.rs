//! Stereolithography (STL), binary: triangles without shared vertices, fields or units.

use std::path::Path;

use super::{MeshWithFields, WriteError, unit_comment, write_file};

/// Bytes of the free text at the beginning.
const HEADER_LENGTH: usize = 80;

/// The mesh as a binary STL file, in single precision; its header says units and axis, which the format does not hold.
///
/// # Errors
/// A face that uses a vertex that does not exist, more faces than the format can count.
pub fn stl_bytes(mesh: &MeshWithFields) -> Result<Vec<u8>, WriteError> {
    mesh.check_faces()?;
    let num_faces = u32::try_from(mesh.faces.len()).map_err(|_| WriteError::TooLarge {
        what: "an STL file counts its faces in 32 bits",
    })?;
    let mut bytes = unit_comment(mesh.up_axis).as_bytes().to_vec();
    bytes.resize(HEADER_LENGTH, 0);
    bytes.extend(num_faces.to_le_bytes());
    for face in mesh.faces {
        let corners = face.map(|vertex| mesh.positions[vertex as usize]);
        let [a, b, c] = corners;
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0);
        for vector in [normal.unwrap_or_default(), a, b, c] {
            bytes.extend(vector.iter().flat_map(|&x| (x as f32).to_le_bytes()));
        }
        // The "attribute byte count", which nobody uses.
        bytes.extend([0, 0]);
    }
    Ok(bytes)
}

/// Writes [`stl_bytes`] to a file.
///
/// # Errors
/// Those of [`stl_bytes`], a refusal of the system.
pub fn write_stl(path: &Path, mesh: &MeshWithFields) -> Result<(), WriteError> {
    write_file(path, &stl_bytes(mesh)?)
}
