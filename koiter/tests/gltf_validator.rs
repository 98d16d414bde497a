//! GLB files are accepted by the validator of Khronos, without errors, warnings or hints.
//!
//! Needs Node.js and its package `gltf-validator`: `NODE_PATH` names the folder `node_modules` that holds it. Without it
//! the test passes and says so, unless `KOITER_REQUIRE_GLTF_VALIDATOR=1`.
#![cfg(feature = "io")]

use std::path::Path;
use std::process::Command;

use koiter::Vec3;
use koiter::io::result::{Frame, Manifest, Part, PartKind, ResultReader, ResultWriter, UpAxis};
use koiter::io::write::{GlbLook, write_glb};
use koiter::mesh::generate;
use serde_json::{Value, json};

/// The validator's report; `None` where there is no validator and none is required.
fn validate(file: &Path) -> Option<Value> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/gltf_validator.js");
    let output = Command::new("node").arg(script).arg(file).output();
    match output {
        Ok(output) if output.status.success() => {
            Some(serde_json::from_slice(&output.stdout).expect("the script prints JSON"))
        }
        failed => {
            let required =
                std::env::var("KOITER_REQUIRE_GLTF_VALIDATOR").is_ok_and(|value| value == "1");
            assert!(
                !required,
                "KOITER_REQUIRE_GLTF_VALIDATOR=1, but node says {failed:?}"
            );
            eprintln!(
                "skipped: no node with gltf-validator (npm install gltf-validator, set NODE_PATH)"
            );
            None
        }
    }
}

/// A sheet that is lifted off a ball, and a triangle so thin that it has no normal; with names that JSON must escape.
fn write_result(folder: &Path, up_axis: UpAxis) -> ResultReader {
    let sheet = generate::grid(1.0, 1.0, 5, 4, generate::GridDiagonals::Checkerboard).unwrap();
    let ball = generate::icosphere(0.3, 2).unwrap();
    let (n, m) = (sheet.positions.len(), sheet.mesh.num_faces());
    let (vertices, num_faces) = (n + ball.positions.len(), m + ball.mesh.num_faces());
    let mut faces = sheet.mesh.faces().to_vec();
    faces.extend(ball.mesh.faces().iter().map(|f| f.map(|v| v + n as u32)));
    let v = vertices as u32;
    faces.push([v, v + 1, v + 2]);
    let part = |name: &str, kind, vertices, faces| Part {
        name: name.to_string(),
        kind,
        thickness: 0.0,
        vertices,
        faces,
        solid: None,
    };
    let manifest = Manifest {
        title: "A \"sheet\" \\ ü".to_string(),
        up_axis,
        parts: vec![
            part("sheet \"a\"", PartKind::Shell, 0..n, 0..m),
            part("ball", PartKind::Obstacle, n..vertices, m..num_faces),
            part(
                "thread",
                PartKind::Shell,
                vertices..vertices + 3,
                num_faces..num_faces + 1,
            ),
        ],
        ..Manifest::default()
    };
    let mut writer = ResultWriter::create(folder, &manifest, &faces).unwrap();
    for step in 0..4 {
        let lift = Vec3::new(0.0, 0.0, 0.31 + f64::from(step) / 7.0);
        let sheet = sheet
            .positions
            .iter()
            .map(|x| x + lift + Vec3::z() * x.x.powi(step));
        let thread = (0..3).map(|i| Vec3::new(f64::from(i), f64::from(step), 0.0));
        let frame = Frame {
            step: step as u64,
            time: f64::from(step) / 120.0,
            positions: sheet.chain(ball.positions.clone()).chain(thread).collect(),
            ..Frame::default()
        };
        writer.write_frame(&frame).unwrap();
    }
    ResultReader::open(folder).unwrap()
}

#[test]
fn films_and_stills_are_sound() {
    let folder = tempfile::tempdir().unwrap();
    for (index, up_axis) in [UpAxis::X, UpAxis::Y, UpAxis::Z].into_iter().enumerate() {
        let result = write_result(&folder.path().join(index.to_string()), up_axis);
        let plain = GlbLook {
            part_colors: vec![[0.1, 0.3, 0.8], [0.5; 3], [1.0, 0.0, 0.0]],
            vertex_colors: None,
        };
        let colored = GlbLook {
            vertex_colors: Some(vec![[0.2, 0.4, 0.9]; result.manifest().num_vertices()]),
            ..plain.clone()
        };
        for (frames, look) in [
            (&[0, 1, 2, 3][..], &plain),
            (&[2], &plain),
            (&[1], &colored),
        ] {
            let path = folder.path().join("result.glb");
            write_glb(&path, &result, frames, look).unwrap();
            let Some(report) = validate(&path) else {
                return;
            };
            assert_eq!(
                report["issues"]["messages"],
                json!([]),
                "{up_axis:?} {frames:?}"
            );
            assert_eq!(
                report["info"]["totalVertexCount"],
                result.manifest().num_vertices()
            );
            assert_eq!(
                report["info"]["totalTriangleCount"],
                result.manifest().num_faces()
            );
            assert_eq!(
                report["info"]["animationCount"],
                usize::from(frames.len() > 1)
            );
        }
    }
}
