//! OFF, the object file format: counts, then a line a vertex, then a line a face.

use super::text::{check_corner, check_corner_count, content_lines, parse_position, shortened};
use super::{ParseError, RawMesh};

/// Whether this first word is that of an OFF file we read: with or without colours, normals, texture coordinates.
pub(super) fn is_header(word: &[u8]) -> bool {
    matches!(
        word,
        b"OFF" | b"COFF" | b"NOFF" | b"CNOFF" | b"STOFF" | b"STCNOFF"
    )
}

/// Parses an OFF file in text form; colours, normals and texture coordinates are passed over.
///
/// # Errors
/// A wrong first word, counts or indices that are not integers, a file that ends early, an index of no vertex, a face
/// of fewer than three corners.
pub fn parse_off(bytes: &[u8]) -> Result<RawMesh, ParseError> {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = content_lines(&text);
    let (mut line, first) = lines
        .next()
        .ok_or_else(|| ParseError::in_file("the file is empty"))?;
    let mut words = first.split_whitespace().peekable();
    if !words.next().is_some_and(|word| is_header(word.as_bytes())) {
        return Err(ParseError::at_line(
            line,
            "an OFF file starts with the word OFF",
        ));
    }
    if words.peek() == Some(&"BINARY") {
        return Err(ParseError::at_line(
            line,
            "binary OFF is not read; save as text, or as PLY",
        ));
    }
    // The counts follow on the same line or on the next.
    if words.peek().is_none() {
        let counts = lines
            .next()
            .ok_or_else(|| ParseError::at_line(line, "the counts are missing"))?;
        line = counts.0;
        words = counts.1.split_whitespace().peekable();
    }
    let num_vertices = parse_count(words.next(), "number of vertices", line)?;
    let num_faces = parse_count(words.next(), "number of faces", line)?;

    let mut mesh = RawMesh::default();
    for read in 0..num_vertices {
        let (line, content) = lines
            .next()
            .ok_or_else(|| ended("vertices", read, num_vertices))?;
        mesh.positions
            .push(parse_position(&mut content.split_whitespace(), line)?);
    }
    let mut corners = Vec::new();
    for read in 0..num_faces {
        let (line, content) = lines
            .next()
            .ok_or_else(|| ended("faces", read, num_faces))?;
        let fault = |problem: String| ParseError::at_line(line, problem);
        let mut words = content.split_whitespace();
        let count = parse_count(words.next(), "number of corners", line)?;
        check_corner_count(count).map_err(fault)?;
        corners.clear();
        for _ in 0..count {
            let corner = parse_count(words.next(), "vertex index", line)?;
            let corner = u32::try_from(corner).unwrap_or(u32::MAX);
            check_corner(corner, mesh.positions.len()).map_err(fault)?;
            corners.push(corner);
        }
        mesh.add_polygon(&corners, Some(line));
    }
    Ok(mesh)
}

fn ended(what: &str, read: usize, announced: usize) -> ParseError {
    let problem = format!(
        "the file ends after {read} of {announced} {what}; it is cut off or its counts are wrong"
    );
    ParseError::in_file(problem)
}

fn parse_count(word: Option<&str>, what: &str, line: usize) -> Result<usize, ParseError> {
    let word = word.ok_or_else(|| ParseError::at_line(line, format!("a {what} is missing")))?;
    word.parse().map_err(|_| {
        let word = shortened(word);
        ParseError::at_line(
            line,
            format!("the {what} '{word}' is not a whole number (0, 1, …)"),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(text: &str) -> String {
        parse_off(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn counts_may_share_the_first_line_and_colours_are_passed_over() {
        for text in [
            "OFF\n# square\n4 1 0\n0 0 0\n1 0 0\n\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n",
            "COFF 4 1 0\n0 0 0 9 9 9 9\n1 0 0 9 9 9 9\n1 1 0 9 9 9 9\n0 1 0 9 9 9 9\n4 0 1 2 3",
        ] {
            let mesh = parse_off(text.as_bytes()).unwrap();
            assert_eq!(mesh.positions[2], [1.0, 1.0, 0.0]);
            assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]]);
        }
    }

    #[test]
    fn faults_are_named_with_their_line() {
        assert_eq!(problem(""), "the file is empty");
        assert!(problem("FFO\n").starts_with("line 1: an OFF file starts with"));
        assert!(problem("OFF BINARY\n").contains("save as text"));
        assert_eq!(
            problem("OFF\n\n3\n"),
            "line 3: a number of faces is missing"
        );
        assert!(
            problem("OFF\n-3 1 0\n")
                .contains("line 2: the number of vertices '-3' is not a whole number")
        );
        assert!(problem("OFF\n2 0 0\n0 0 0\n").contains("ends after 1 of 2 vertices"));
        assert!(problem("OFF\n1 1 0\n0 0 0\n").contains("ends after 0 of 1 faces"));
        assert!(
            problem("OFF\n1 1 0\n0 0 0\n3 0 0 7\n").starts_with("line 4: the face uses vertex 7")
        );
        assert!(
            problem("OFF\n1 1 0\n0 0 0\n2 0 0\n").starts_with("line 4: the face has 2 corners")
        );
        assert!(
            problem("OFF\n1 1 0\n0 0 0\n3 0 0\n").contains("line 4: a vertex index is missing")
        );
        assert!(problem("OFF\n18446744073709551615 1 0\n0 0 0\n").contains("ends after 1 of"));
    }
}
