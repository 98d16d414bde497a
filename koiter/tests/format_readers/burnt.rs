//! Films whose faces burn away: VTKHDF and USDA have them, other formats refuse them.

use std::path::Path;

use koiter::Vec3;
use koiter::io::result::{
    Field, Frame, FrameTopology, Manifest, Part, PartKind, ResultReader, ResultWriter,
};
use koiter::io::write::{npz_bytes, pc2_bytes, write_usda, write_vtkhdf};
use serde_json::json;

use crate::python::{bits, read_with};

/// A fan of triangles that loses the last and then its vertices.
fn write_result(folder: &Path) -> ResultReader {
    let part = |vertices, faces| Part {
        name: "paper".to_string(),
        kind: PartKind::Shell,
        thickness: 1e-3,
        vertices,
        faces,
        solid: None,
    };
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let faces = vec![[0, 1, 2], [0, 2, 3]];
    let manifest = Manifest {
        parts: vec![part(0..4, 0..2)],
        ..Manifest::default()
    };
    let mut writer = ResultWriter::create(folder, &manifest, &faces).unwrap();
    for (step, (num_vertices, num_faces)) in [(4, 2), (4, 1), (3, 1)].into_iter().enumerate() {
        let points = corners[..num_vertices].iter();
        let topology = FrameTopology {
            parts: vec![part(0..num_vertices, 0..num_faces)],
            faces: faces[..num_faces].to_vec(),
        };
        let frame = Frame {
            step: step as u64,
            time: step as f64,
            positions: points
                .map(|[x, y]| Vec3::new(*x, *y, step as f64))
                .collect(),
            vertex_fields: vec![],
            face_fields: vec![Field {
                name: "temperature".to_string(),
                values: (0..num_faces)
                    .map(|face| (10 * step + face) as f32)
                    .collect(),
            }],
            topology: (step > 0).then_some(topology),
        };
        writer.write_frame(&frame).unwrap();
    }
    ResultReader::open(folder).unwrap()
}

#[test]
fn faces_that_burn_away_are_shown_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let result = write_result(&folder.path().join("run"));
    let all = [0, 1, 2];
    for bytes in [npz_bytes(&result, &all), pc2_bytes(&result, &all)] {
        let error = bytes.unwrap_err().to_string();
        assert!(
            error.contains("faces change from frame to frame"),
            "{error}"
        );
    }
    assert!(npz_bytes(&result, &[2]).is_ok());
    let (vtkhdf, usda) = (
        folder.path().join("run.vtkhdf"),
        folder.path().join("run.usda"),
    );
    write_vtkhdf(&vtkhdf, &result, &all).unwrap();
    write_usda(&usda, &result, &all).unwrap();
    for file in [vtkhdf, usda] {
        let Some(found) = read_with("film_reader.py", &file) else {
            return;
        };
        for index in all {
            let frame = result.frame(index).unwrap();
            let found = &found["frames"][index];
            let positions: Vec<_> = frame
                .positions
                .iter()
                .map(|x| bits(x.iter().copied()))
                .collect();
            assert_eq!(found["positions"], json!(positions), "{}", file.display());
            assert_eq!(
                found["faces"],
                json!(result.faces_in(&frame)),
                "{}",
                file.display()
            );
            let values = frame.face_fields[0]
                .values
                .iter()
                .map(|&value| f64::from(value));
            assert_eq!(found["fields"]["face temperature"], bits(values));
        }
    }
}
