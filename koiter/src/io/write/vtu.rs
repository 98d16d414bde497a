//! VTK's XML unstructured grid (`.vtu`) with raw appended data, and the collection of a time series (`.pvd`).
//!
//! Reference: "VTK XML Formats" in the VTK documentation. An array in the appended section is its length in bytes as
//! `u64`, then its values; the offset in the XML counts from the byte after the underscore.

use std::fmt::Write;
use std::path::Path;

use super::{MeshWithFields, PART, WriteError, unit_comment, write_file};
use crate::io::result::{Part, ResultReader};

/// The `types` entry of a triangle.
const VTK_TRIANGLE: u8 = 5;

/// The mesh as a VTU file: `Float64` points, `Float32` point and cell arrays, the time [s], if any, as `TimeValue`.
///
/// With parts, the `Int32` cell array `part` numbers them from 0, and the field data has their names as `part_names`.
///
/// # Errors
/// A face that uses a vertex that does not exist, a field of wrong length or with a name that is empty or taken.
pub fn vtu_bytes(mesh: &MeshWithFields, time: Option<f64>) -> Result<Vec<u8>, WriteError> {
    mesh.check(escaped, &[PART])?;
    let mut data = Appended::default();
    let mut xml = String::from("<?xml version=\"1.0\"?>\n");
    let mut line = |text: &str| {
        xml.push_str(text);
        xml.push('\n');
    };
    line(&format!("<!-- {} -->", unit_comment(mesh.up_axis)));
    line(
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">",
    );
    line("<UnstructuredGrid>");
    line("<FieldData>");
    if let Some(time) = time {
        let one = "NumberOfTuples=\"1\"";
        line(&data.array("Float64", "TimeValue", one, time.to_le_bytes()));
    }
    if !mesh.parts.is_empty() {
        line(&names_array(mesh.parts));
    }
    line("</FieldData>");
    let (points, cells) = (mesh.positions.len(), mesh.faces.len());
    line(&format!(
        "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">"
    ));

    line("<Points>");
    let coordinates = mesh.positions.iter().flat_map(|x| x.iter());
    let bytes = coordinates.flat_map(|value| value.to_le_bytes());
    line(&data.array("Float64", "Points", "NumberOfComponents=\"3\"", bytes));
    line("</Points>\n<Cells>");
    let bytes = mesh
        .faces
        .iter()
        .flatten()
        .flat_map(|&index| i64::from(index).to_le_bytes());
    line(&data.array("Int64", "connectivity", "", bytes));
    let bytes = (1..=cells as i64).flat_map(|cell| (3 * cell).to_le_bytes());
    line(&data.array("Int64", "offsets", "", bytes));
    line(&data.array(
        "UInt8",
        "types",
        "",
        std::iter::repeat_n(VTK_TRIANGLE, cells),
    ));
    line("</Cells>");
    for (section, fields) in [
        ("PointData", mesh.vertex_fields),
        ("CellData", mesh.face_fields),
    ] {
        line(&format!("<{section}>"));
        for field in fields {
            let bytes = field.values.iter().flat_map(|value| value.to_le_bytes());
            line(&data.array("Float32", &escaped(&field.name), "", bytes));
        }
        if let Some(numbers) = mesh.part_numbers().filter(|_| section == "CellData") {
            let bytes = numbers.iter().flat_map(|number| number.to_le_bytes());
            line(&data.array("Int32", PART, "", bytes));
        }
        line(&format!("</{section}>"));
    }
    line("</Piece>\n</UnstructuredGrid>");
    xml.push_str("<AppendedData encoding=\"raw\">\n_");
    let mut file = xml.into_bytes();
    file.extend(data.bytes);
    file.extend(b"\n</AppendedData>\n</VTKFile>\n");
    Ok(file)
}

/// Writes [`vtu_bytes`] to a file.
///
/// # Errors
/// Those of [`vtu_bytes`], a refusal of the system.
pub fn write_vtu(path: &Path, mesh: &MeshWithFields, time: Option<f64>) -> Result<(), WriteError> {
    write_file(path, &vtu_bytes(mesh, time)?)
}

/// A PVD collection: the time [s] of each file, by its name relative to the collection.
pub fn pvd_bytes(files: &[(f64, String)]) -> Vec<u8> {
    let mut xml = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, file) in files {
        let file = escaped(file);
        writeln!(
            xml,
            "<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{file}\"/>"
        )
        .expect("writing to a string cannot fail");
    }
    xml.push_str("</Collection>\n</VTKFile>\n");
    xml.into_bytes()
}

/// Writes [`pvd_bytes`] to a file.
///
/// # Errors
/// A refusal of the system.
pub fn write_pvd(path: &Path, files: &[(f64, String)]) -> Result<(), WriteError> {
    write_file(path, &pvd_bytes(files))
}

/// Writes every frame of a result as `NAME_00000.vtu`, … beside the collection `NAME.pvd` at `pvd_path`.
///
/// `progress` is called with the number of frames done after each.
///
/// # Errors
/// A frame that cannot be read, a refusal of the system.
pub fn write_vtu_series(
    result: &ResultReader,
    pvd_path: &Path,
    mut progress: impl FnMut(usize),
) -> Result<(), WriteError> {
    let stem = pvd_path
        .file_stem()
        .map_or_else(|| "frames".into(), |stem| stem.to_string_lossy());
    let mut files = Vec::with_capacity(result.len());
    for index in 0..result.len() {
        let frame = result.frame(index)?;
        let name = format!("{stem}_{index:05}.vtu");
        let mesh = MeshWithFields::of_frame(result, &frame);
        write_vtu(&pvd_path.with_file_name(&name), &mesh, Some(frame.time))?;
        files.push((frame.time, name));
        progress(index + 1);
    }
    write_pvd(pvd_path, &files)
}

/// The appended section as it grows.
#[derive(Default)]
struct Appended {
    bytes: Vec<u8>,
}

impl Appended {
    /// Appends an array and returns the XML element that points to it.
    fn array(
        &mut self,
        scalar: &str,
        name: &str,
        attributes: &str,
        values: impl IntoIterator<Item = u8>,
    ) -> String {
        let offset = self.bytes.len();
        self.bytes.extend([0; 8]);
        self.bytes.extend(values);
        let length = (self.bytes.len() - offset - 8) as u64;
        self.bytes[offset..offset + 8].copy_from_slice(&length.to_le_bytes());
        format!(
            "<DataArray type=\"{scalar}\" Name=\"{name}\" {attributes} format=\"appended\" offset=\"{offset}\"/>"
        )
    }
}

/// The names of the parts: VTK writes text in XML as numbers, each string ended by a 0.
fn names_array(parts: &[Part]) -> String {
    let codes: Vec<String> = parts
        .iter()
        .flat_map(|part| part.name.bytes().filter(|&byte| byte != 0).chain([0]))
        .map(|byte| byte.to_string())
        .collect();
    format!(
        "<DataArray type=\"String\" Name=\"part_names\" NumberOfTuples=\"{}\" format=\"ascii\">\n{}\n</DataArray>",
        parts.len(),
        codes.join(" ")
    )
}

/// A name as the value of an XML attribute; control characters, which XML cannot hold, are left out.
fn escaped(name: &str) -> String {
    let mut text = String::with_capacity(name.len());
    for c in name.chars().filter(|c| !c.is_control()) {
        match c {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '"' => text.push_str("&quot;"),
            _ => text.push(c),
        }
    }
    text
}
