//! `rest.bin`: what every face is at rest, as a frame file without vertices.
//!
//! Its fields of faces are `area` [m²] and `edge_0`, `edge_1`, `edge_2` [m], the lengths opposite to the corners; in single
//! precision, for ratios that people look at.

use super::{Field, Frame};
use crate::audit::RestFace;

const AREA: &str = "area";
const EDGES: [&str; 3] = ["edge_0", "edge_1", "edge_2"];

pub(super) fn encode(rest: &[RestFace]) -> Vec<u8> {
    let field = |name: &str, value: &dyn Fn(&RestFace) -> f64| Field {
        name: name.to_owned(),
        values: rest.iter().map(|face| value(face) as f32).collect(),
    };
    let mut fields = vec![field(AREA, &|face| face.area)];
    fields.extend((0..3).map(|k| field(EDGES[k], &|face| face.edges[k])));
    let frame = Frame {
        face_fields: fields,
        ..Frame::default()
    };
    frame.encode(rest.len())
}

/// The rest shape of `num_faces` faces from the bytes of `rest.bin`.
///
/// # Errors
/// What is wrong, as the end of a sentence that begins with the file's name.
pub(super) fn decode(bytes: &[u8], num_faces: usize) -> Result<Vec<RestFace>, String> {
    let frame = Frame::decode(bytes)?;
    frame.check(0, num_faces)?;
    let values = |name: &str| match frame.field(name) {
        Some(field) => Ok(&field.values),
        None => Err(format!("it has no field '{name}'")),
    };
    let (areas, edges) = (
        values(AREA)?,
        [values(EDGES[0])?, values(EDGES[1])?, values(EDGES[2])?],
    );
    let face = |face: usize| RestFace {
        area: f64::from(areas[face]),
        edges: edges.map(|lengths| f64::from(lengths[face])),
    };
    Ok((0..num_faces).map(face).collect())
}
