//! One frame: `frames/00000.bin`.
//!
//! ```text
//! "KOITERFR"  u32 version: 1, or 2 where the frame has faces of its own
//! u64 step  f64 time  u64 vertices  u64 faces  u32 vertex fields  u32 face fields
//! f64 × 3 a vertex
//! each field, of vertices first:  u32 length of name  name (UTF-8)  f32 a vertex or face
//! version 2 only: u32 parts  u64 vertices, u64 faces a part  u32 × 3 a face
//! u32 CRC-32
//! ```

use super::manifest::check_parts;
use super::topology_file::checked_body;
use super::{Part, PartKind};
use crate::Vec3;
use crate::io::bytes::{ByteReader, Endian};
use crate::io::checksum::crc32;

const MAGIC: &[u8; 8] = b"KOITERFR";
const VERSION: u32 = 1;
const VERSION_WITH_FACES: u32 = 2;
/// Bytes of the header, from the magic to the numbers of fields.
pub(super) const HEADER_LENGTH: usize = 8 + 4 + 8 + 8 + 8 + 8 + 4 + 4;

/// The state of all parts at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Number of the step that led here; 0 at the start.
    pub step: u64,
    /// Time [s].
    pub time: f64,
    /// Positions of the vertices of all parts [m].
    pub positions: Vec<Vec3>,
    /// Values at vertices.
    pub vertex_fields: Vec<Field>,
    /// Values at faces.
    pub face_fields: Vec<Field>,
    /// Parts and faces of this frame, where they are not those of the result: something burnt away.
    pub topology: Option<FrameTopology>,
}

/// Parts and faces of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameTopology {
    /// The parts of the result, each with the vertices and faces that it has in this frame.
    pub parts: Vec<Part>,
    /// The faces of all parts, by the vertex numbers of the whole.
    pub faces: Vec<[u32; 3]>,
}

impl FrameTopology {
    fn num_vertices(&self) -> usize {
        self.parts.last().map_or(0, |part| part.vertices.end)
    }
}

/// A named value at every vertex or face of all parts, in single precision: for looking at, not for restarting.
///
/// The unit belongs to the name's documentation, SI without prefix. NaN: no value here (strain of an obstacle).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Field {
    /// Name in snake case, such as `bending_energy_density`.
    pub name: String,
    /// One value a vertex or face.
    pub values: Vec<f32>,
}

/// What the head of a frame file says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameInfo {
    /// Number of the step.
    pub step: u64,
    /// Time [s].
    pub time: f64,
}

/// What stands before the positions.
pub(super) struct Header {
    pub(super) info: FrameInfo,
    pub(super) num_vertices: usize,
    pub(super) num_faces: usize,
    pub(super) num_vertex_fields: u32,
    pub(super) num_face_fields: u32,
}

impl Frame {
    /// The field of this name, of faces or of vertices.
    pub fn field(&self, name: &str) -> Option<&Field> {
        self.face_fields
            .iter()
            .chain(&self.vertex_fields)
            .find(|field| field.name == name)
    }

    /// Checks the lengths, and that times and positions are finite.
    ///
    /// # Errors
    /// What is wrong, as the end of a sentence that begins with the file's name.
    pub fn check(&self, num_vertices: usize, num_faces: usize) -> Result<(), String> {
        let (num_vertices, num_faces) = match &self.topology {
            None => (num_vertices, num_faces),
            Some(own) => {
                check_parts(&own.parts, &own.faces)?;
                (own.num_vertices(), own.faces.len())
            }
        };
        if !self.time.is_finite() {
            return Err(format!("its time is {}", self.time));
        }
        if self.positions.len() != num_vertices {
            return Err(format!(
                "it has {} positions for {num_vertices} vertices",
                self.positions.len()
            ));
        }
        for (vertex, x) in self.positions.iter().enumerate() {
            if !x.iter().all(|value| value.is_finite()) {
                let [x, y, z] = (*x).into();
                return Err(format!("vertex {vertex} is at ({x}, {y}, {z})"));
            }
        }
        for (fields, count, what) in [
            (&self.vertex_fields, num_vertices, "vertices"),
            (&self.face_fields, num_faces, "faces"),
        ] {
            if let Some(field) = fields.iter().find(|field| field.values.len() != count) {
                let (name, len) = (&field.name, field.values.len());
                return Err(format!(
                    "field '{name}' has {len} values for {count} {what}"
                ));
            }
        }
        Ok(())
    }

    pub(super) fn encode(&self, num_faces: usize) -> Vec<u8> {
        let own = self.topology.as_ref();
        let num_faces = own.map_or(num_faces, |own| own.faces.len());
        let num_values = self
            .vertex_fields
            .iter()
            .chain(&self.face_fields)
            .map(|f| f.values.len() + 16);
        let mut bytes =
            Vec::with_capacity(64 + 24 * self.positions.len() + 4 * num_values.sum::<usize>());
        bytes.extend(MAGIC);
        let version = own.map_or(VERSION, |_| VERSION_WITH_FACES);
        bytes.extend(version.to_le_bytes());
        bytes.extend(self.step.to_le_bytes());
        bytes.extend(self.time.to_le_bytes());
        bytes.extend((self.positions.len() as u64).to_le_bytes());
        bytes.extend((num_faces as u64).to_le_bytes());
        bytes.extend((self.vertex_fields.len() as u32).to_le_bytes());
        bytes.extend((self.face_fields.len() as u32).to_le_bytes());
        for value in self.positions.iter().flat_map(|x| x.iter()) {
            bytes.extend(value.to_le_bytes());
        }
        for field in self.vertex_fields.iter().chain(&self.face_fields) {
            bytes.extend((field.name.len() as u32).to_le_bytes());
            bytes.extend(field.name.as_bytes());
            for value in &field.values {
                bytes.extend(value.to_le_bytes());
            }
        }
        if let Some(own) = own {
            bytes.extend((own.parts.len() as u32).to_le_bytes());
            for part in &own.parts {
                bytes.extend((part.vertices.len() as u64).to_le_bytes());
                bytes.extend((part.faces.len() as u64).to_le_bytes());
            }
            for corner in own.faces.iter().flatten() {
                bytes.extend(corner.to_le_bytes());
            }
        }
        let checksum = crc32(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    }

    /// The frame in the bytes of a frame file; its lengths and numbers are not yet checked, and parts of its own have no
    /// names: those are in the manifest.
    ///
    /// # Errors
    /// What is wrong, as the end of a sentence that begins with the file's name.
    pub fn decode(bytes: &[u8]) -> Result<Self, String> {
        let has_faces = bytes.get(8..12) == Some(&VERSION_WITH_FACES.to_le_bytes()[..]);
        let version = if has_faces {
            VERSION_WITH_FACES
        } else {
            VERSION
        };
        let body = checked_body(bytes, MAGIC, version)?;
        let mut reader = ByteReader::new(body, Endian::Little);
        let header = read_header(&mut reader)?;
        let short = || "it ends too early for its header".to_string();
        let positions_length = header.num_vertices.checked_mul(24).ok_or_else(short)?;
        let coordinates = reader.take(positions_length).ok_or_else(short)?;
        let mut coordinates = ByteReader::new(coordinates, Endian::Little);
        let mut positions = Vec::with_capacity(header.num_vertices);
        while let (Some(x), Some(y), Some(z)) =
            (coordinates.f64(), coordinates.f64(), coordinates.f64())
        {
            positions.push(Vec3::new(x, y, z));
        }
        // Counts of fields are not trusted with memory: each field must be in the file before the next is read.
        let mut read_fields = |count: u32, length: usize| -> Result<Vec<Field>, String> {
            let mut fields = Vec::new();
            for _ in 0..count {
                let name_length = reader.u32().ok_or_else(short)? as usize;
                let name = reader.take(name_length).ok_or_else(short)?;
                let name =
                    str::from_utf8(name).map_err(|_| "a field's name is not UTF-8".to_string())?;
                let length = length.checked_mul(4).ok_or_else(short)?;
                let (values, _) = reader.take(length).ok_or_else(short)?.as_chunks::<4>();
                let values = values
                    .iter()
                    .map(|&value| f32::from_le_bytes(value))
                    .collect();
                fields.push(Field {
                    name: name.to_string(),
                    values,
                });
            }
            Ok(fields)
        };
        let vertex_fields = read_fields(header.num_vertex_fields, header.num_vertices)?;
        let face_fields = read_fields(header.num_face_fields, header.num_faces)?;
        let topology = match has_faces {
            true => Some(read_topology(&mut reader, header.num_faces).ok_or_else(short)?),
            false => None,
        };
        if reader.remaining() > 0 {
            return Err(format!(
                "{} bytes are left over at its end",
                reader.remaining()
            ));
        }
        let FrameInfo { step, time } = header.info;
        Ok(Self {
            step,
            time,
            positions,
            vertex_fields,
            face_fields,
            topology,
        })
    }

    /// Step and time from the first [`HEADER_LENGTH`] bytes, without checking the rest.
    pub(super) fn decode_info(bytes: &[u8]) -> Result<FrameInfo, String> {
        Ok(decode_header(bytes)?.info)
    }
}

/// The header in the first [`HEADER_LENGTH`] bytes.
pub(super) fn decode_header(bytes: &[u8]) -> Result<Header, String> {
    let mut reader = ByteReader::new(bytes, Endian::Little);
    let is_ours = reader.take(8) == Some(MAGIC);
    if !is_ours || !matches!(reader.u32(), Some(VERSION | VERSION_WITH_FACES)) {
        return Err("it does not start as a frame of this version does".to_string());
    }
    read_header(&mut reader)
}

fn read_topology(reader: &mut ByteReader, num_faces: usize) -> Option<FrameTopology> {
    let count = reader.u32()? as usize;
    // Counts are not trusted with memory that the file does not have.
    if count.checked_mul(16)? > reader.remaining() {
        return None;
    }
    let mut parts: Vec<Part> = Vec::with_capacity(count);
    for _ in 0..count {
        let sizes = [reader.u64()?, reader.u64()?];
        let [vertices, faces] = sizes.map(|size| usize::try_from(size).ok());
        let (first, first_face) = parts
            .last()
            .map_or((0, 0), |p| (p.vertices.end, p.faces.end));
        parts.push(Part {
            name: String::new(),
            kind: PartKind::Shell,
            thickness: 0.0,
            vertices: first..first.checked_add(vertices?)?,
            faces: first_face..first_face.checked_add(faces?)?,
            solid: None,
        });
    }
    let bytes = reader.take(num_faces.checked_mul(12)?)?;
    let mut corners = ByteReader::new(bytes, Endian::Little);
    let mut faces = Vec::with_capacity(num_faces);
    while let (Some(a), Some(b), Some(c)) = (corners.u32(), corners.u32(), corners.u32()) {
        faces.push([a, b, c]);
    }
    Some(FrameTopology { parts, faces })
}

fn read_header(reader: &mut ByteReader) -> Result<Header, String> {
    let mut read = || {
        Some(Header {
            info: FrameInfo {
                step: reader.u64()?,
                time: reader.f64()?,
            },
            num_vertices: usize::try_from(reader.u64()?).ok()?,
            num_faces: usize::try_from(reader.u64()?).ok()?,
            num_vertex_fields: reader.u32()?,
            num_face_fields: reader.u32()?,
        })
    };
    read().ok_or_else(|| "it ends within the header".to_string())
}
