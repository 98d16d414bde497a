//! Wavefront OBJ: `v` and `f` lines; everything else (normals, texture, groups, materials, curves) is passed over.

use std::borrow::Cow;

use super::text::{check_corner, check_corner_count, parse_position, shortened};
use super::{Numbering, ParseError, RawMesh};

/// Parses an OBJ file.
///
/// Corners may be `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative indices count back from the last vertex so far; a
/// backslash continues a line. Vertices may follow the faces that use them.
///
/// # Errors
/// A coordinate or index that is not a number, an index of no vertex, a face of fewer than three corners, no faces.
pub fn parse_obj(bytes: &[u8]) -> Result<RawMesh, ParseError> {
    // Names may be in any encoding; what we read is ASCII.
    let text = String::from_utf8_lossy(bytes);
    let mut mesh = RawMesh {
        numbering: Numbering::FromOne,
        ..RawMesh::default()
    };
    let mut corners = Vec::new();
    for (line, content) in logical_lines(&text) {
        let mut words = content.split_whitespace();
        match words.next() {
            Some("v") => mesh.positions.push(parse_position(&mut words, line)?),
            Some("f") => {
                corners.clear();
                for word in words {
                    corners.push(parse_corner(word, mesh.positions.len(), line)?);
                }
                check_corner_count(corners.len())
                    .map_err(|problem| ParseError::at_line(line, problem))?;
                mesh.add_polygon(&corners, Some(line));
            }
            _ => {}
        }
    }
    if mesh.faces.is_empty() {
        let found = mesh.positions.len();
        let problem =
            format!("no faces ('f' lines) were found, and {found} vertices; is this an OBJ mesh?");
        return Err(ParseError::in_file(problem));
    }
    for (face, &line) in mesh.faces.iter().zip(&mesh.face_lines) {
        for &vertex in face {
            // Told as the file counts: from 1.
            check_corner(vertex, mesh.positions.len()).map_err(|_| {
                let (index, count) = (u64::from(vertex) + 1, mesh.positions.len());
                let problem = format!(
                    "the face uses vertex {index}, but the file has only {count} vertices; correct the index"
                );
                ParseError::at_line(line, problem)
            })?;
        }
    }
    Ok(mesh)
}

/// A zero-based index from `v`, `v/vt`, `v//vn` or `v/vt/vn`.
pub(super) fn parse_corner(
    word: &str,
    num_vertices: usize,
    line: usize,
) -> Result<u32, ParseError> {
    let fault = |problem: String| ParseError::at_line(line, problem);
    let index = word.split('/').next().unwrap_or_default();
    let index: i64 = index.parse().map_err(|_| {
        fault(format!(
            "the vertex index '{}' is not an integer",
            shortened(word)
        ))
    })?;
    let from_zero = match index {
        0 => {
            return Err(fault(
                "vertex index 0: OBJ counts from 1 (or back from −1)".to_string(),
            ));
        }
        1.. => index - 1,
        _ => num_vertices as i64 + index,
    };
    u32::try_from(from_zero).map_err(|_| {
        fault(format!(
            "vertex index {index} points outside the {num_vertices} vertices before this line"
        ))
    })
}

/// Lines without comments, joined where they end in a backslash; with the number of their first line.
pub(super) fn logical_lines(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (index, line) = lines.next()?;
        let mut content = Cow::Borrowed(line.trim_end());
        let mut is_continued = content.ends_with('\\');
        while is_continued {
            // Grown in place: a file may continue one line a million times.
            let joined = content.to_mut();
            joined.pop();
            joined.push(' ');
            let Some((_, next)) = lines.next() else {
                break;
            };
            let next = next.trim_end();
            joined.push_str(next);
            is_continued = next.ends_with('\\');
        }
        match content.find('#') {
            Some(comment) => Some((index + 1, Cow::Owned(content[..comment].to_string()))),
            None => Some((index + 1, content)),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(text: &str) -> String {
        parse_obj(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn all_forms_of_corners_comments_and_continued_lines_are_read() {
        let text = "# a square\r\nmtllib x.mtl\no été\nv 0 0 0 # origin\nv 1 0 0 1.0\nv 1 1 0 0.5 0.5 0.5\n\
                    v 0 1 \\\n  -1e-3\nvt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3/1\nf -4 -2 \\\n -1\n";
        let mesh = parse_obj(text.as_bytes()).unwrap();
        assert_eq!(
            mesh.positions,
            [
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [1.0, 1.0, 0.0],
                [0.0, 1.0, -1e-3]
            ]
        );
        assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.face_lines, [11, 12]);
    }

    #[test]
    fn polygons_become_fans_and_vertices_may_come_later() {
        let mesh = parse_obj(b"f 1 2 3 4 5\nv 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0").unwrap();
        assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(mesh.face_lines, [1, 1, 1]);
    }

    #[test]
    fn names_in_other_encodings_do_no_harm() {
        assert_eq!(
            parse_obj(b"o \xe9t\xe9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3")
                .unwrap()
                .faces
                .len(),
            1
        );
    }

    #[test]
    fn faults_are_named_with_their_line() {
        assert_eq!(problem("v 0 0\n"), "line 1: the z coordinate is missing");
        assert_eq!(
            problem("\nv 0 nan 0"),
            "line 2: the y coordinate 'nan' is not a finite number"
        );
        assert_eq!(
            problem("v 0 0 0\nf 1 1"),
            "line 2: the face has 2 corners; at least 3 are needed: complete or remove it"
        );
        assert_eq!(
            problem("v 0 0 0\nf 1 x 1"),
            "line 2: the vertex index 'x' is not an integer"
        );
        assert!(
            problem("v 0 0 0\nf 0 1 1").starts_with("line 2: vertex index 0: OBJ counts from 1")
        );
        assert!(
            problem("v 0 0 0\nf 1 1 -2").contains("index -2 points outside the 1 vertices before")
        );
        assert!(
            problem("v 0 0 0\nf 1 1 9").contains("uses vertex 9, but the file has only 1 vertices")
        );
        assert!(problem("v 0 0 0\nf 1 1 99999999999").contains("99999999999 points outside"));
        assert!(problem("hello").contains("no faces ('f' lines)"));
    }
}
