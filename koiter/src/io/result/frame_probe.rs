//! One vertex or face of a frame file, without reading the rest.

use std::io::{self, Read, Seek, SeekFrom};

use super::frame::{HEADER_LENGTH, Header, decode_header};

/// Longest name of a field that is believed: a length beyond it is damage.
const MAX_NAME: usize = 4096;

/// What is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    /// A vertex, by its number in the whole.
    Vertex(usize),
    /// A face, by its number in the whole.
    Face(usize),
}

/// What a frame says of one vertex or face.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameProbe {
    /// Time [s].
    pub time: f64,
    /// Position of a vertex [m].
    pub position: Option<[f64; 3]>,
    /// Fields by name, of vertices or of faces.
    pub fields: Vec<(String, f32)>,
}

/// Why there is no probe.
pub(super) enum ProbeError {
    Io(io::Error),
    Broken(String),
}

impl From<io::Error> for ProbeError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => Self::Broken("it ends too early".to_owned()),
            _ => Self::Io(error),
        }
    }
}

/// Reads an element of a frame of so many vertices and faces.
pub(super) fn probe_frame(
    file: &mut (impl Read + Seek),
    (num_vertices, num_faces): (usize, usize),
    element: Element,
) -> Result<FrameProbe, ProbeError> {
    let broken = |reason: &str| Err(ProbeError::Broken(reason.to_owned()));
    let header = decode_header(&bytes::<HEADER_LENGTH>(file)?).map_err(ProbeError::Broken)?;
    if (header.num_vertices, header.num_faces) != (num_vertices, num_faces) {
        return broken("it has other numbers of vertices and faces than the manifest");
    }
    let mut position = None;
    match element {
        Element::Vertex(vertex) if vertex < num_vertices => {
            skip(file, 24 * vertex)?;
            let mut coordinates = [0.0; 3];
            for coordinate in &mut coordinates {
                *coordinate = f64::from_le_bytes(bytes(file)?);
            }
            position = Some(coordinates);
            skip(file, 24 * (num_vertices - vertex - 1))?;
        }
        Element::Face(face) if face < num_faces => skip(file, 24 * num_vertices)?,
        _ => return broken("it has no such vertex or face"),
    }
    Ok(FrameProbe {
        time: header.info.time,
        position,
        fields: fields(file, &header, element)?,
    })
}

fn fields(
    file: &mut (impl Read + Seek),
    header: &Header,
    element: Element,
) -> Result<Vec<(String, f32)>, ProbeError> {
    let (of_vertices, of_faces) = match element {
        Element::Vertex(vertex) => (Some(vertex), None),
        Element::Face(face) => (None, Some(face)),
    };
    let mut found = Vec::new();
    for (count, length, wanted) in [
        (header.num_vertex_fields, header.num_vertices, of_vertices),
        (header.num_face_fields, header.num_faces, of_faces),
    ] {
        for _ in 0..count {
            let name_length = u32::from_le_bytes(bytes(file)?) as usize;
            if name_length > MAX_NAME {
                return Err(ProbeError::Broken("a field's name has no end".to_owned()));
            }
            let mut name = vec![0; name_length];
            file.read_exact(&mut name)?;
            let Some(index) = wanted else {
                skip(file, 4 * length)?;
                continue;
            };
            skip(file, 4 * index)?;
            let value = f32::from_le_bytes(bytes(file)?);
            skip(file, 4 * (length - index - 1))?;
            found.push((String::from_utf8_lossy(&name).into_owned(), value));
        }
    }
    Ok(found)
}

fn bytes<const N: usize>(file: &mut impl Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

fn skip(file: &mut impl Seek, count: usize) -> io::Result<()> {
    file.seek(SeekFrom::Current(count as i64)).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::io::result::{Field, Frame};
    use std::io::Cursor;

    fn file() -> Vec<u8> {
        let field = |name: &str, values: &[f32]| Field {
            name: name.to_owned(),
            values: values.to_vec(),
        };
        let frame = Frame {
            step: 3,
            time: 0.5,
            positions: (0..4)
                .map(|k| Vec3::new(f64::from(k), 10.0, -1.0))
                .collect(),
            vertex_fields: vec![field("heat", &[1.0, 2.0, 3.0, 4.0])],
            face_fields: vec![field("strain", &[0.1, 0.2]), field("h", &[7.0, 8.0])],
            topology: None,
        };
        frame.encode(2)
    }

    fn probe(bytes: &[u8], element: Element) -> Result<FrameProbe, ProbeError> {
        probe_frame(&mut Cursor::new(bytes), (4, 2), element)
    }

    #[test]
    fn a_vertex_has_its_position_and_fields_a_face_its_fields() {
        let file = file();
        let vertex = probe(&file, Element::Vertex(2)).ok().unwrap();
        assert_eq!(
            (vertex.time, vertex.position),
            (0.5, Some([2.0, 10.0, -1.0]))
        );
        assert_eq!(vertex.fields, [("heat".to_owned(), 3.0)]);
        let face = probe(&file, Element::Face(1)).ok().unwrap();
        assert_eq!(face.position, None);
        assert_eq!(
            face.fields,
            [("strain".to_owned(), 0.2), ("h".to_owned(), 8.0)]
        );
    }

    #[test]
    fn what_is_not_there_or_cut_off_is_no_probe() {
        let file = file();
        for element in [Element::Vertex(4), Element::Face(2)] {
            assert!(matches!(probe(&file, element), Err(ProbeError::Broken(_))));
        }
        for length in [0, 20, 60, 150, file.len() - 20] {
            let error = probe(&file[..length], Element::Face(1));
            assert!(matches!(error, Err(ProbeError::Broken(_))), "{length}");
        }
    }
}
