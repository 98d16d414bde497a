//! Stanford PLY, binary, little-endian, with fields as `float` properties and the number of a face's part as `int`.

use std::path::Path;

use super::{MeshWithFields, PART, WriteError, as_word, unit_comment, write_file};

/// The mesh as a binary PLY file; positions are `double`, fields `float` properties of vertices or faces.
///
/// Comments name the parts: `part 0 cloth`. Characters of a field's name other than letters and digits become `_`.
///
/// # Errors
/// A face that uses a vertex that does not exist, a field of wrong length or with a name that is empty or taken.
pub fn ply_bytes(mesh: &MeshWithFields) -> Result<Vec<u8>, WriteError> {
    mesh.check(as_word, &["x", "y", "z", "vertex_indices", PART])?;
    let mut header = vec![
        "ply".to_string(),
        "format binary_little_endian 1.0".to_string(),
        format!("comment {}", unit_comment(mesh.up_axis)),
    ];
    for (number, part) in mesh.parts.iter().enumerate() {
        header.push(format!("comment part {number} {}", as_word(&part.name)));
    }
    header.push(format!("element vertex {}", mesh.positions.len()));
    header.extend(["x", "y", "z"].map(|axis| format!("property double {axis}")));
    header.extend(
        mesh.vertex_fields
            .iter()
            .map(|f| format!("property float {}", as_word(&f.name))),
    );
    header.push(format!("element face {}", mesh.faces.len()));
    // Signed indices: some readers know no others.
    header.push("property list uchar int vertex_indices".to_string());
    header.extend(
        mesh.face_fields
            .iter()
            .map(|f| format!("property float {}", as_word(&f.name))),
    );
    let parts = mesh.part_numbers();
    if parts.is_some() {
        header.push(format!("property int {PART}"));
    }
    header.push("end_header\n".to_string());

    let mut bytes = header.join("\n").into_bytes();
    let vertex_size = 24 + 4 * mesh.vertex_fields.len();
    let face_size = 13 + 4 * (mesh.face_fields.len() + usize::from(parts.is_some()));
    bytes.reserve(vertex_size * mesh.positions.len() + face_size * mesh.faces.len());
    for (vertex, x) in mesh.positions.iter().enumerate() {
        bytes.extend(x.iter().flat_map(|value| value.to_le_bytes()));
        for field in mesh.vertex_fields {
            bytes.extend(field.values[vertex].to_le_bytes());
        }
    }
    for (face, corners) in mesh.faces.iter().enumerate() {
        bytes.push(3);
        bytes.extend(corners.iter().flat_map(|index| index.to_le_bytes()));
        for field in mesh.face_fields {
            bytes.extend(field.values[face].to_le_bytes());
        }
        if let Some(parts) = &parts {
            bytes.extend(parts[face].to_le_bytes());
        }
    }
    Ok(bytes)
}

/// Writes [`ply_bytes`] to a file.
///
/// # Errors
/// Those of [`ply_bytes`], a refusal of the system.
pub fn write_ply(path: &Path, mesh: &MeshWithFields) -> Result<(), WriteError> {
    write_file(path, &ply_bytes(mesh)?)
}
