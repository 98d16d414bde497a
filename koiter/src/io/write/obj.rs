//! Wavefront OBJ: positions and faces; it has no place for fields.

use std::fmt::Write;
use std::path::Path;

use super::{MeshWithFields, WriteError, as_word, unit_comment, write_file};

/// The mesh as an OBJ text. Numbers are written so that reading them gives the same bits.
///
/// Each part becomes an object (`o` line); fields are left out.
///
/// # Errors
/// A face that uses a vertex that does not exist.
pub fn obj_bytes(mesh: &MeshWithFields) -> Result<Vec<u8>, WriteError> {
    mesh.check_faces()?;
    let mut text = format!("# {}\n", unit_comment(mesh.up_axis));
    let written = "writing to a string cannot fail";
    for x in mesh.positions {
        writeln!(text, "v {:?} {:?} {:?}", x.x, x.y, x.z).expect(written);
    }
    for (face, [a, b, c]) in mesh.faces.iter().enumerate() {
        for part in mesh
            .parts
            .iter()
            .filter(|part| part.faces.start == face && !part.faces.is_empty())
        {
            writeln!(text, "o {}", as_word(&part.name)).expect(written);
        }
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).expect(written);
    }
    Ok(text.into_bytes())
}

/// Writes [`obj_bytes`] to a file.
///
/// # Errors
/// Those of [`obj_bytes`], a refusal of the system.
pub fn write_obj(path: &Path, mesh: &MeshWithFields) -> Result<(), WriteError> {
    write_file(path, &obj_bytes(mesh)?)
}
