//! Meshes of quads from OBJ files, with the texture coordinates of their vertices.

use super::ParseError;
use super::obj::{logical_lines, parse_corner};
use super::text::parse_position;
use crate::Vec3;
use crate::burning::QuadMesh;

/// Reads a mesh of quads.
///
/// Faces have four corners. A vertex has the texture coordinates of the first corner that gives some; those of a seam, where
/// it would have several, are lost. If a vertex has none, the mesh has none.
///
/// # Errors
/// A coordinate or index that is not a number, a face of another number of corners, and what
/// [`QuadMesh::new`] refuses.
pub fn parse_obj_quads(bytes: &[u8]) -> Result<QuadMesh, ParseError> {
    let text = String::from_utf8_lossy(bytes);
    let (mut positions, mut quads) = (Vec::new(), Vec::new());
    let (mut coordinates, mut corners_with_coordinates) = (Vec::new(), Vec::new());
    for (line, content) in logical_lines(&text) {
        let mut words = content.split_whitespace();
        match words.next() {
            Some("v") => positions.push(Vec3::from(parse_position(&mut words, line)?)),
            Some("vt") => coordinates.push(parse_coordinates(&mut words, line)?),
            Some("f") => {
                let mut quad = Vec::with_capacity(4);
                for word in words {
                    let vertex = parse_corner(word, positions.len(), line)?;
                    quad.push(vertex);
                    if let Some(index) = word.split('/').nth(1).filter(|index| !index.is_empty()) {
                        let index = parse_corner(index, coordinates.len(), line)?;
                        corners_with_coordinates.push((vertex, index));
                    }
                }
                let quad: [u32; 4] = quad.try_into().map_err(|corners: Vec<u32>| {
                    let count = corners.len();
                    let problem = format!(
                        "a face with {count} corners: a double layer is made of quads only; convert the mesh to quads"
                    );
                    ParseError::at_line(line, problem)
                })?;
                quads.push(quad);
            }
            _ => {}
        }
    }
    let refuse = |error: crate::burning::QuadMeshError| ParseError::in_file(error.to_string());
    let mut of_vertices = vec![None; positions.len()];
    for (vertex, index) in corners_with_coordinates {
        if let Some(place @ None) = of_vertices.get_mut(vertex as usize) {
            *place = coordinates.get(index as usize).copied();
        }
    }
    let mesh = QuadMesh::new(positions, quads).map_err(refuse)?;
    match of_vertices.into_iter().collect::<Option<Vec<[f64; 2]>>>() {
        Some(coordinates) => mesh.with_texture_coordinates(coordinates).map_err(refuse),
        None => Ok(mesh),
    }
}

fn parse_coordinates<'a>(
    words: &mut impl Iterator<Item = &'a str>,
    line: usize,
) -> Result<[f64; 2], ParseError> {
    let mut next = || -> Result<f64, ParseError> {
        let word = words.next().unwrap_or("0");
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        number
            .ok_or_else(|| ParseError::at_line(line, "a texture coordinate is not a finite number"))
    };
    Ok([next()?, next()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn quads_are_read_with_their_texture_coordinates() {
        let text = format!("{SQUARE}vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 -1/-1\n");
        let mesh = parse_obj_quads(text.as_bytes()).unwrap();
        assert_eq!(mesh.quads(), [[0, 1, 2, 3]]);
        assert_eq!(mesh.texture_coordinates().unwrap()[2], [1.0, 1.0]);
        let plain = parse_obj_quads(format!("{SQUARE}f 1 2 3 4\n").as_bytes()).unwrap();
        assert!(plain.texture_coordinates().is_none());
    }

    #[test]
    fn other_faces_and_folded_quads_are_refused_with_their_place() {
        for (faces, words) in [
            ("f 1 2 3\n", "line 5: a face with 3 corners"),
            ("f 1 2 4 3\n", "folded"),
            ("f 1 2 3 9\n", "vertex 8"),
            ("", "no quads"),
            ("vt x 0\nf 1 2 3 4\n", "line 5: a texture coordinate"),
        ] {
            let error = parse_obj_quads(format!("{SQUARE}{faces}").as_bytes()).unwrap_err();
            assert!(error.to_string().contains(words), "{error}");
        }
    }
}
