//! VTKHDF: a film in one file for ParaView and VTK, faces written once.
//!
//! Polygons of version 2.0 of the format with the group `Steps`, which says for every time where its points, cells and values
//! begin. The root group has `up_axis` and `metres_per_unit` beside what the format asks for, and the names of the parts, which
//! the cell array `part` numbers. Reference: "VTKHDF file format" in the VTK documentation.

use std::path::Path;

use super::film::Film;
use super::hdf5::{Attribute, Dataset, Group, NumberKind, file_bytes};
use super::{MeshWithFields, PART, WriteError, write_file};
use crate::io::result::{Field, Frame, ResultReader, UpAxis};

/// Some frames of a result as a VTKHDF file: `Float64` points, `Float32` fields.
///
/// # Errors
/// A frame that cannot be read, a face that uses a vertex that does not exist, fields that are not those of the first frame or
/// have a name that is empty or taken.
///
/// # Panics
/// No frames.
pub fn vtkhdf_bytes(result: &ResultReader, frames: &[usize]) -> Result<Vec<u8>, WriteError> {
    let mut pieces = Pieces::default();
    Film::new(result, frames, "VTKHDF").visit(|frame| {
        let mesh = MeshWithFields::of_frame(result, frame);
        mesh.check(as_link, &[PART])?;
        pieces.add(&mesh, frame);
        Ok(())
    })?;
    let mut file = Group::default();
    file.group("VTKHDF", pieces.into_root(result));
    Ok(file_bytes(file))
}

/// Writes [`vtkhdf_bytes`] to a file.
///
/// # Errors
/// Those of [`vtkhdf_bytes`], a refusal of the system.
///
/// # Panics
/// No frames.
pub fn write_vtkhdf(
    path: &Path,
    result: &ResultReader,
    frames: &[usize],
) -> Result<(), WriteError> {
    write_file(path, &vtkhdf_bytes(result, frames)?)
}

/// The name of a field as that of a link, which cannot hold a slash.
fn as_link(name: &str) -> String {
    name.replace('/', "_")
}

/// Arrays as they grow. A geometry is written once for all frames in a row that have it.
#[derive(Default)]
struct Pieces {
    /// Numbers of points and cells of each geometry.
    geometries: Vec<[i64; 2]>,
    connectivity: Vec<[i64; 1]>,
    offsets: Vec<[i64; 1]>,
    parts: Vec<u8>,
    points: Vec<u8>,
    vertex_fields: Vec<Values>,
    face_fields: Vec<Values>,
    times: Vec<u8>,
    starts: Vec<Start>,
    num_points: i64,
    num_cell_values: i64,
    /// Cells of all geometries.
    num_cells: i64,
    last_has_own_faces: bool,
}

/// A field as it grows.
struct Values {
    name: String,
    bytes: Vec<u8>,
}

/// Where the data of a frame begin.
struct Start {
    geometry: i64,
    point: i64,
    /// Among the cells of all geometries.
    cell: i64,
    connectivity: i64,
    /// Among the values of cells, which every frame has.
    cell_value: i64,
}

impl Pieces {
    fn add(&mut self, mesh: &MeshWithFields, frame: &Frame) {
        let (points, cells) = (mesh.positions.len() as i64, mesh.faces.len() as i64);
        let is_new =
            self.geometries.is_empty() || self.last_has_own_faces || frame.topology.is_some();
        if is_new {
            self.geometries.push([points, cells]);
            self.num_cells += cells;
            let corners = mesh.faces.iter().flatten();
            self.connectivity
                .extend(corners.map(|&corner| [i64::from(corner)]));
            self.offsets.extend((0..=cells).map(|cell| [3 * cell]));
            let numbers = mesh
                .part_numbers()
                .unwrap_or_else(|| vec![0; mesh.faces.len()]);
            self.parts
                .extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        }
        self.last_has_own_faces = frame.topology.is_some();
        self.starts.push(Start {
            geometry: self.geometries.len() as i64 - 1,
            point: self.num_points,
            cell: self.num_cells - cells,
            connectivity: self.connectivity.len() as i64 - 3 * cells,
            cell_value: self.num_cell_values,
        });
        self.num_points += points;
        self.num_cell_values += cells;
        self.times.extend(frame.time.to_le_bytes());
        let coordinates = mesh.positions.iter().flat_map(|x| x.iter());
        self.points
            .extend(coordinates.flat_map(|value| value.to_le_bytes()));
        add_fields(&mut self.vertex_fields, mesh.vertex_fields);
        add_fields(&mut self.face_fields, mesh.face_fields);
    }

    fn into_root(self, result: &ResultReader) -> Group {
        let manifest = result.manifest();
        let mut root = Group::default();
        root.attribute("Version", Attribute::Integers(vec![2, 0]));
        root.attribute("Type", Attribute::Text("PolyData".to_string()));
        let axis = match manifest.up_axis {
            UpAxis::X => "x",
            UpAxis::Y => "y",
            UpAxis::Z => "z",
        };
        root.attribute("up_axis", Attribute::Text(axis.to_string()));
        root.attribute("metres_per_unit", Attribute::Real(1.0));
        for (number, part) in manifest.parts.iter().enumerate() {
            let name = format!("part_{number}");
            root.attribute(&name, Attribute::Text(part.name.clone()));
        }
        let num_points: Vec<[i64; 1]> = self.geometries.iter().map(|[n, _]| [*n]).collect();
        let num_cells: Vec<i64> = self.geometries.iter().map(|[_, m]| *m).collect();
        root.integers("NumberOfPoints", &num_points);
        root.group("Steps", self.steps());
        let points = self.num_points as usize;
        root.dataset(
            "Points",
            numbers(NumberKind::Float64, &[points, 3], self.points),
        );
        root.group(
            "Polygons",
            cells(&num_cells, &self.connectivity, &self.offsets),
        );
        for other in ["Vertices", "Lines", "Strips"] {
            let zeros = vec![0; num_cells.len()];
            // One offset, 0, a geometry.
            root.group(other, cells(&zeros, &[], &vec![[0]; num_cells.len()]));
        }
        root.group("PointData", fields(self.vertex_fields, points));
        let mut cell_data = fields(self.face_fields, self.num_cell_values as usize);
        let num_parts = self.num_cells as usize;
        cell_data.dataset(PART, numbers(NumberKind::Int32, &[num_parts], self.parts));
        root.group("CellData", cell_data);
        root
    }

    /// The group `Steps`.
    fn steps(&self) -> Group {
        let each = |value: &dyn Fn(&Start) -> i64| -> Vec<[i64; 1]> {
            self.starts.iter().map(|start| [value(start)]).collect()
        };
        // Columns: vertices, lines, polygons, strips.
        let polygons = |value: &dyn Fn(&Start) -> i64| -> Vec<[i64; 4]> {
            self.starts
                .iter()
                .map(|start| [0, 0, value(start), 0])
                .collect()
        };
        let mut steps = Group::default();
        let count = self.starts.len();
        steps.attribute("NSteps", Attribute::Integer(count as i64));
        steps.dataset(
            "Values",
            numbers(NumberKind::Float64, &[count], self.times.clone()),
        );
        steps.integers("PartOffsets", &each(&|start| start.geometry));
        steps.integers("NumberOfParts", &each(&|_| 1));
        steps.integers("PointOffsets", &each(&|start| start.point));
        steps.integers("CellOffsets", &polygons(&|start| start.cell));
        steps.integers(
            "ConnectivityIdOffsets",
            &polygons(&|start| start.connectivity),
        );
        let offsets = |values: &[Values], at: &dyn Fn(&Start) -> i64| {
            let mut group = Group::default();
            for field in values {
                group.integers(&as_link(&field.name), &each(at));
            }
            group
        };
        steps.group(
            "PointDataOffsets",
            offsets(&self.vertex_fields, &|start| start.point),
        );
        let mut cell_data = offsets(&self.face_fields, &|start| start.cell_value);
        cell_data.integers(PART, &each(&|start| start.cell));
        steps.group("CellDataOffsets", cell_data);
        steps
    }
}

fn add_fields(values: &mut Vec<Values>, fields: &[Field]) {
    if values.is_empty() {
        values.extend(fields.iter().map(|field| Values {
            name: field.name.clone(),
            bytes: Vec::new(),
        }));
    }
    for (values, field) in values.iter_mut().zip(fields) {
        let numbers = field.values.iter().flat_map(|value| value.to_le_bytes());
        values.bytes.extend(numbers);
    }
}

fn fields(values: Vec<Values>, count: usize) -> Group {
    let mut group = Group::default();
    for field in values {
        let dataset = numbers(NumberKind::Float32, &[count], field.bytes);
        group.dataset(&as_link(&field.name), dataset);
    }
    group
}

/// Cells of one kind: their numbers by geometry, corners, and the places where they begin and end.
fn cells(counts: &[i64], connectivity: &[[i64; 1]], offsets: &[[i64; 1]]) -> Group {
    let mut group = Group::default();
    let counts: Vec<[i64; 1]> = counts.iter().map(|count| [*count]).collect();
    let corners: Vec<[i64; 1]> = counts.iter().map(|[count]| [3 * count]).collect();
    group.integers("NumberOfCells", &counts);
    group.integers("NumberOfConnectivityIds", &corners);
    group.integers("Connectivity", connectivity);
    group.integers("Offsets", offsets);
    group
}

fn numbers(kind: NumberKind, shape: &[usize], bytes: Vec<u8>) -> Dataset {
    Dataset {
        kind,
        shape: shape.to_vec(),
        bytes,
    }
}
