//! STL, text and binary. Every facet brings its own vertices; those with exactly equal coordinates become one.

use super::text::{content_lines, parse_position};
use super::{Numbering, ParseError, RawMesh};
use crate::Vec3;
use crate::io::bytes::{ByteReader, Endian};
use crate::mesh::repair;

/// Comment and count before the first facet.
const BINARY_HEADER: usize = 84;
/// Normal, three vertices in single precision, two spare bytes.
const BINARY_FACET: usize = 50;

/// Whether the length is exactly what the count at byte 80 demands. No text passes: as a count, its letters would
/// announce half a billion facets.
pub(super) fn has_binary_length(bytes: &[u8]) -> bool {
    announced_facets(bytes)
        .is_some_and(|facets| BINARY_HEADER + facets * BINARY_FACET == bytes.len())
}

fn announced_facets(bytes: &[u8]) -> Option<usize> {
    let mut reader = ByteReader::new(bytes, Endian::Little);
    reader.take(BINARY_HEADER - 4)?;
    Some(reader.u32()? as usize)
}

/// Parses an STL file; normals are passed over (the order of the corners gives the same).
///
/// Some programs begin binary files with `solid` as well, so the length decides which form it is.
///
/// # Errors
/// A coordinate that is not a finite number, a facet without three vertices, a file that ends early, more vertices
/// than 32-bit indices allow.
pub fn parse_stl(bytes: &[u8]) -> Result<RawMesh, ParseError> {
    let is_text = bytes.trim_ascii_start().starts_with(b"solid") && !has_binary_length(bytes);
    let (soup, lines) = if is_text {
        parse_text(bytes)?
    } else {
        (parse_binary(bytes)?, Vec::new())
    };
    if soup.len() > u32::MAX as usize {
        return Err(ParseError::in_file(
            "the file has more than 2³² vertices; split it",
        ));
    }
    let corners: Vec<[u32; 3]> = (0..soup.len() as u32 / 3)
        .map(|facet| [3 * facet, 3 * facet + 1, 3 * facet + 2])
        .collect();
    let (positions, faces) = repair::weld(&soup, &corners);
    let positions = positions.into_iter().map(Into::into).collect();
    Ok(RawMesh {
        positions,
        faces,
        face_lines: lines,
        numbering: Numbering::OfDistinctPoints,
        ..RawMesh::default()
    })
}

/// Three vertices a facet, and the line each facet ends on.
fn parse_text(bytes: &[u8]) -> Result<(Vec<Vec3>, Vec<usize>), ParseError> {
    let text = String::from_utf8_lossy(bytes);
    let mut vertices = Vec::new();
    let mut lines = Vec::new();
    let mut last = 1;
    for (line, content) in content_lines(&text) {
        let mut words = content.split_whitespace();
        let word = words.next().unwrap_or_default();
        if word.eq_ignore_ascii_case("vertex") {
            vertices.push(Vec3::from(parse_position(&mut words, line)?));
        } else if word.eq_ignore_ascii_case("endfacet") {
            lines.push(line);
            if vertices.len() != 3 * lines.len() {
                let count = vertices.len() as i64 - 3 * (lines.len() as i64 - 1);
                let problem =
                    format!("the facet that ends here has {count} vertices; it must have 3");
                return Err(ParseError::at_line(line, problem));
            }
        }
        last = line;
    }
    if vertices.len() != 3 * lines.len() {
        return Err(ParseError::at_line(
            last,
            "the file ends within a facet; it is cut off",
        ));
    }
    Ok((vertices, lines))
}

fn parse_binary(bytes: &[u8]) -> Result<Vec<Vec3>, ParseError> {
    let facets = announced_facets(bytes).ok_or_else(|| {
        ParseError::in_file(format!(
            "{} bytes are neither a binary STL file (at least {BINARY_HEADER}) nor a text one (starting with 'solid')",
            bytes.len()
        ))
    })?;
    let room = (bytes.len() - BINARY_HEADER) / BINARY_FACET;
    if facets > room {
        let problem = format!(
            "the header announces {facets} facets, but the file has room for {room}; it is cut off, or not STL"
        );
        return Err(ParseError::at_byte(BINARY_HEADER - 4, problem));
    }
    let mut reader = ByteReader::new(bytes, Endian::Little);
    reader.take(BINARY_HEADER);
    let mut vertices = Vec::with_capacity(3 * facets);
    for facet in 0..facets {
        reader.take(12);
        for _ in 0..3 {
            let offset = reader.offset();
            let mut next = || {
                reader
                    .f32()
                    .filter(|value| value.is_finite())
                    .map(f64::from)
            };
            let (Some(x), Some(y), Some(z)) = (next(), next(), next()) else {
                let problem = format!("a coordinate of facet {facet} is not a finite number");
                return Err(ParseError::at_byte(offset, problem));
            };
            vertices.push(Vec3::new(x, y, z));
        }
        reader.take(2);
    }
    Ok(vertices)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "solid two\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\n\
        endfacet\nfacet normal 0 0 1\n outer loop\n  VERTEX 0 0 -0.0\n  vertex 1 1 0\n  vertex 0 1 0\n endloop\n\
        endfacet\nendsolid two\n";

    fn binary(header: &[u8]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend(2u32.to_le_bytes());
        for facet in [
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]],
            [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        ] {
            bytes.extend([0; 12]);
            for [x, y] in facet {
                bytes.extend([x, y, 0f32].iter().flat_map(|value| value.to_le_bytes()));
            }
            bytes.extend([0; 2]);
        }
        bytes
    }

    #[test]
    fn equal_corners_become_one_vertex_in_text_and_binary() {
        for bytes in [
            TEXT.as_bytes().to_vec(),
            binary(b"made by us"),
            binary(b"solid binary all the same"),
        ] {
            let mesh = parse_stl(&bytes).unwrap();
            assert_eq!(mesh.positions.len(), 4);
            assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]]);
        }
        assert_eq!(parse_stl(TEXT.as_bytes()).unwrap().face_lines, [8, 15]);
    }

    #[test]
    fn faults_are_named_with_their_place() {
        let problem = |bytes: &[u8]| parse_stl(bytes).unwrap_err().to_string();
        assert!(problem(b"x").contains("1 bytes are neither"));
        let cut = binary(b"");
        assert!(
            problem(&cut[..150])
                .contains("byte 80: the header announces 2 facets, but the file has room for 1")
        );
        let mut nan = binary(b"");
        nan[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
        assert_eq!(
            problem(&nan),
            "byte 96: a coordinate of facet 0 is not a finite number"
        );
        let line = |from, to| problem(TEXT.replacen(from, to, 1).as_bytes());
        assert!(
            line("vertex 1 1 0\n", "").contains("line 7: the facet that ends here has 2 vertices")
        );
        assert!(line("vertex 1 1 0", "vertex 1 one 0").contains("line 6: the y coordinate 'one'"));
        assert!(problem(&TEXT.as_bytes()[..160]).contains("ends within a facet"));
    }
}
