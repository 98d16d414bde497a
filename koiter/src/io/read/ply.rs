//! Stanford PLY, text and binary of both byte orders.

use super::text::{check_corner, check_corner_count, shortened};
use super::{ParseError, RawMesh};
use crate::io::bytes::{ByteReader, Endian};

/// Parses a PLY file: `x`, `y`, `z` of the element `vertex` and the list `vertex_indices` (or `vertex_index`) of the
/// element `face`; everything else is passed over.
///
/// # Errors
/// A header that breaks the rules or announces more than the file holds, a missing property, a coordinate that is not
/// a finite number, an index of no vertex, a face of fewer than three corners.
pub fn parse_ply(bytes: &[u8]) -> Result<RawMesh, ParseError> {
    let (header, body) = parse_header(bytes)?;
    let mut values = match header.encoding {
        Encoding::Text => Values::Text {
            body,
            offset: 0,
            line: header.num_lines + 1,
        },
        Encoding::Binary(endian) => Values::Binary {
            reader: ByteReader::new(body, endian),
            start: bytes.len() - body.len(),
        },
    };
    let mut mesh = RawMesh::default();
    for element in &header.elements {
        check_room(element, &values)?;
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut values, &mut mesh)?,
            "face" => read_faces(element, &mut values, &mut mesh)?,
            _ => (0..element.count).try_for_each(|_| {
                element
                    .properties
                    .iter()
                    .try_for_each(|property| skip(property, &mut values))
            })?,
        }
    }
    for name in ["vertex", "face"] {
        if !header.elements.iter().any(|element| element.name == name) {
            let problem =
                format!("the header has no element '{name}'; save the file as a triangle mesh");
            return Err(ParseError::in_file(problem));
        }
    }
    for (face, corners) in mesh.faces.iter().enumerate() {
        // At the end, as faces may come before vertices.
        for &vertex in corners {
            check_corner(vertex, mesh.positions.len()).map_err(|problem| {
                match mesh.face_lines.get(face) {
                    Some(&line) => ParseError::at_line(line, problem),
                    None => ParseError::in_file(format!("face {face}: {problem}")),
                }
            })?;
        }
    }
    Ok(mesh)
}

#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Text,
    Binary(Endian),
}

#[derive(Clone, Copy, PartialEq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

struct Property {
    name: String,
    /// Type of the length, if the property is a list.
    length: Option<Scalar>,
    item: Scalar,
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    num_lines: usize,
}

impl Encoding {
    fn parse(name: &str, line: usize) -> Result<Self, ParseError> {
        match name {
            "ascii" => Ok(Self::Text),
            "binary_little_endian" => Ok(Self::Binary(Endian::Little)),
            "binary_big_endian" => Ok(Self::Binary(Endian::Big)),
            _ => Err(ParseError::at_line(
                line,
                "the format is none of ascii, binary_little_endian, binary_big_endian",
            )),
        }
    }
}

impl Property {
    /// From the words after `property`.
    fn parse(words: &[&str], line: usize) -> Result<Self, ParseError> {
        let (length, item, name) = match words {
            ["list", length, item, name] => (Some(Scalar::parse(length, line)?), item, name),
            [item, name] => (None, item, name),
            _ => {
                return Err(ParseError::at_line(
                    line,
                    "a property is 'property TYPE NAME' or 'property list TYPE TYPE NAME'",
                ));
            }
        };
        Ok(Self {
            name: (*name).to_string(),
            length,
            item: Scalar::parse(item, line)?,
        })
    }
}

impl Scalar {
    fn parse(word: &str, line: usize) -> Result<Self, ParseError> {
        Ok(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => {
                let word = shortened(word);
                return Err(ParseError::at_line(
                    line,
                    format!("'{word}' is not a PLY type"),
                ));
            }
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// The header and the bytes after it.
fn parse_header(bytes: &[u8]) -> Result<(Header, &[u8]), ParseError> {
    let mut rest = bytes;
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    for line in 1.. {
        let fault = |problem: &str| ParseError::at_line(line, problem);
        let end = rest.iter().position(|&byte| byte == b'\n');
        let end = end.ok_or_else(|| fault("the header does not end (there is no 'end_header')"))?;
        let content = String::from_utf8_lossy(&rest[..end]);
        rest = &rest[end + 1..];
        let words: Vec<&str> = content.split_whitespace().collect();
        match words.as_slice() {
            ["ply"] if line == 1 => {}
            _ if line == 1 => return Err(fault("a PLY file starts with the line 'ply'")),
            [] | ["comment" | "obj_info", ..] => {}
            ["format", name, "1.0"] => encoding = Some(Encoding::parse(name, line)?),
            ["element", name, count] => {
                let count = count
                    .parse()
                    .map_err(|_| fault("the count of the element is not a whole number"))?;
                elements.push(Element {
                    name: (*name).to_string(),
                    count,
                    properties: Vec::new(),
                });
            }
            ["property", description @ ..] => {
                let element = elements
                    .last_mut()
                    .ok_or_else(|| fault("a property comes before any element"))?;
                element.properties.push(Property::parse(description, line)?);
            }
            ["end_header"] => {
                let encoding = encoding.ok_or_else(|| fault("the header has no 'format' line"))?;
                return Ok((
                    Header {
                        encoding,
                        elements,
                        num_lines: line,
                    },
                    rest,
                ));
            }
            _ => {
                return Err(fault(&format!(
                    "'{}' is not a line of a PLY 1.0 header",
                    shortened(content.trim())
                )));
            }
        }
    }
    unreachable!("the loop has no end but by return")
}

/// Refuses counts that the rest of the file cannot hold, before any memory is reserved or time spent for them.
fn check_room(element: &Element, values: &Values) -> Result<(), ParseError> {
    let smallest: usize = match values {
        // A value and its separator.
        Values::Text { .. } => 2 * element.properties.len(),
        Values::Binary { .. } => element
            .properties
            .iter()
            .map(|p| p.length.unwrap_or(p.item).size())
            .sum(),
    };
    // The last value of a text needs no separator.
    let room = (values.remaining() + 1).checked_div(smallest).unwrap_or(0);
    if element.count > room {
        let Element { name, count, .. } = element;
        let problem = format!(
            "the header announces {count} of element '{name}', but the rest of the file has room for at most {room}; \
             it is cut off or the count is wrong"
        );
        return Err(values.fault(problem));
    }
    Ok(())
}

fn read_vertices(
    element: &Element,
    values: &mut Values,
    mesh: &mut RawMesh,
) -> Result<(), ParseError> {
    let axes = ["x", "y", "z"];
    for axis in axes {
        if !element
            .properties
            .iter()
            .any(|p| p.name == axis && p.length.is_none())
        {
            return Err(ParseError::in_file(format!(
                "the element 'vertex' has no property '{axis}'"
            )));
        }
    }
    mesh.positions.reserve(element.count);
    for vertex in 0..element.count {
        let mut position = [0.0; 3];
        for property in &element.properties {
            match axes
                .iter()
                .position(|axis| property.name == *axis && property.length.is_none())
            {
                Some(axis) => {
                    let value = values.next(property.item)?;
                    if !value.is_finite() {
                        let problem = format!(
                            "the {} coordinate of vertex {vertex} is {value}",
                            axes[axis]
                        );
                        return Err(values.fault(problem));
                    }
                    position[axis] = value;
                }
                None => skip(property, values)?,
            }
        }
        mesh.positions.push(position);
    }
    Ok(())
}

fn read_faces(
    element: &Element,
    values: &mut Values,
    mesh: &mut RawMesh,
) -> Result<(), ParseError> {
    let is_corners = |p: &Property| {
        p.length.is_some() && matches!(p.name.as_str(), "vertex_indices" | "vertex_index")
    };
    if !element.properties.iter().any(is_corners) {
        let problem = "the element 'face' has no list 'vertex_indices'";
        return Err(ParseError::in_file(problem));
    }
    let mut corners = Vec::new();
    for _ in 0..element.count {
        for property in &element.properties {
            let Some(length) = property.length.filter(|_| is_corners(property)) else {
                skip(property, values)?;
                continue;
            };
            let count = values.next_index(length, "number of corners")?;
            check_corner_count(count as usize).map_err(|problem| values.fault(problem))?;
            corners.clear();
            for _ in 0..count {
                corners.push(values.next_index(property.item, "vertex index")?);
            }
            mesh.add_polygon(&corners, values.line());
        }
    }
    Ok(())
}

fn skip(property: &Property, values: &mut Values) -> Result<(), ParseError> {
    let count = match property.length {
        Some(length) => values.next_index(length, "length of a list")?,
        None => 1,
    };
    (0..count).try_for_each(|_| values.next(property.item).map(|_| ()))
}

/// The numbers after the header.
enum Values<'a> {
    Text {
        body: &'a [u8],
        offset: usize,
        line: usize,
    },
    Binary {
        reader: ByteReader<'a>,
        start: usize,
    },
}

impl Values<'_> {
    fn remaining(&self) -> usize {
        match self {
            Self::Text { body, offset, .. } => body.len() - offset,
            Self::Binary { reader, .. } => reader.remaining(),
        }
    }

    /// The line of the last value read, in a text.
    fn line(&self) -> Option<usize> {
        match self {
            Self::Text { line, .. } => Some(*line),
            Self::Binary { .. } => None,
        }
    }

    fn fault(&self, problem: impl Into<String>) -> ParseError {
        match self {
            Self::Text { line, .. } => ParseError::at_line(*line, problem),
            Self::Binary { reader, start } => ParseError::at_byte(start + reader.offset(), problem),
        }
    }

    /// The next number; 32-bit integers are exact in it.
    fn next(&mut self, scalar: Scalar) -> Result<f64, ParseError> {
        let value = match self {
            Self::Text { body, offset, line } => {
                while let Some(byte) = body.get(*offset).filter(|byte| byte.is_ascii_whitespace()) {
                    *line += usize::from(*byte == b'\n');
                    *offset += 1;
                }
                let rest = &body[*offset..];
                let length = rest
                    .iter()
                    .position(u8::is_ascii_whitespace)
                    .unwrap_or(rest.len());
                *offset += length;
                let word = String::from_utf8_lossy(&rest[..length]);
                if word.is_empty() {
                    None
                } else {
                    let problem = || format!("'{}' is not a number", shortened(&word));
                    Some(
                        word.parse()
                            .map_err(|_| ParseError::at_line(*line, problem()))?,
                    )
                }
            }
            Self::Binary { reader, .. } => match scalar {
                Scalar::I8 => reader.u8().map(|value| f64::from(value as i8)),
                Scalar::U8 => reader.u8().map(f64::from),
                Scalar::I16 => reader.u16().map(|value| f64::from(value as i16)),
                Scalar::U16 => reader.u16().map(f64::from),
                Scalar::I32 => reader.u32().map(|value| f64::from(value as i32)),
                Scalar::U32 => reader.u32().map(f64::from),
                Scalar::F32 => reader.f32().map(f64::from),
                Scalar::F64 => reader.f64(),
            },
        };
        value
            .ok_or_else(|| self.fault("the file ends here, before all its elements; it is cut off"))
    }

    fn next_index(&mut self, scalar: Scalar, what: &str) -> Result<u32, ParseError> {
        let value = self.next(scalar)?;
        if value >= 0.0 && value <= f64::from(u32::MAX) && value.fract() == 0.0 {
            Ok(value as u32)
        } else {
            Err(self.fault(format!(
                "the {what} {value} is not a whole number of 32 bits"
            )))
        }
    }
}

#[cfg(test)]
mod tests;
