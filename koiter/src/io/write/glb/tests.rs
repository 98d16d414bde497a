use super::*;
use crate::io::result::{Manifest, ResultWriter};
use crate::mesh::generate;

/// A sheet that rises and bends over three frames, above a box that stays; z is up.
fn result(folder: &Path) -> ResultReader {
    let sheet = generate::grid(1.0, 1.0, 3, 2, generate::GridDiagonals::Uniform).unwrap();
    let body = generate::box_mesh([0.5, 0.5, 0.1]).unwrap();
    let (n, m) = (sheet.positions.len(), sheet.mesh.num_faces());
    let mut faces = sheet.mesh.faces().to_vec();
    faces.extend(body.mesh.faces().iter().map(|f| f.map(|v| v + n as u32)));
    let part = |name: &str, kind, vertices, faces| Part {
        name: name.to_string(),
        kind,
        thickness: 0.0,
        vertices,
        faces,
        solid: None,
    };
    let manifest = Manifest {
        title: "Sheet".to_string(),
        parts: vec![
            part("sheet", PartKind::Shell, 0..n, 0..m),
            part("box", PartKind::Obstacle, n..n + 8, m..m + 12),
        ],
        ..Manifest::default()
    };
    let mut writer = ResultWriter::create(folder, &manifest, &faces).unwrap();
    for step in 0..3 {
        let height = |x: &Vec3| f64::from(step) * (0.3 + x.x * x.x);
        let moved = sheet.positions.iter().map(|x| x + height(x) * Vec3::z());
        let frame = Frame {
            step: step as u64,
            time: f64::from(step) * 0.04,
            positions: moved.chain(body.positions.clone()).collect(),
            ..Frame::default()
        };
        writer.write_frame(&frame).unwrap();
    }
    ResultReader::open(folder).unwrap()
}

fn look() -> GlbLook {
    GlbLook {
        part_colors: vec![[0.1, 0.2, 0.3], [0.5; 3]],
        vertex_colors: None,
    }
}

/// The two chunks, after a check of the container.
fn chunks(file: &[u8]) -> (Value, Vec<u8>) {
    let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(
        (&file[..4], word(4), word(8)),
        (&b"glTF"[..], 2, file.len())
    );
    assert_eq!(&file[16..20], b"JSON");
    let json_length = word(12);
    let binary = 20 + json_length;
    assert_eq!(
        (json_length % 4, &file[binary + 4..binary + 8]),
        (0, &b"BIN\0"[..])
    );
    assert_eq!(word(binary), file.len() - binary - 8);
    let document = serde_json::from_slice(&file[20..binary]).unwrap();
    (document, file[binary + 8..].to_vec())
}

/// The values of an array of vectors, after a check of its bounds.
fn vectors(document: &Value, binary: &[u8], accessor: &Value) -> Vec<[f32; 3]> {
    let accessor = &document["accessors"][accessor.as_u64().unwrap() as usize];
    let view = &document["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let offset = |value: &Value| value["byteOffset"].as_u64().unwrap() as usize;
    let start = offset(view) + offset(accessor);
    let count = accessor["count"].as_u64().unwrap() as usize;
    let (values, _) = binary[start..start + 12 * count].as_chunks::<4>();
    let values: Vec<f32> = values.iter().map(|&v| f32::from_le_bytes(v)).collect();
    let values: Vec<[f32; 3]> = values.as_chunks::<3>().0.to_vec();
    if let Some(low) = accessor["min"].as_array() {
        for axis in 0..3 {
            let found = values.iter().map(|v| v[axis]).fold(f32::MAX, f32::min);
            assert_eq!(Some(f64::from(found)), low[axis].as_f64());
        }
    }
    values
}

#[test]
fn the_shapes_of_a_film_are_its_frames() {
    let folder = tempfile::tempdir().unwrap();
    let result = result(folder.path());
    let (document, binary) = chunks(&glb_bytes(&result, &[0, 1, 2], &look()).unwrap());
    let sheet = &document["meshes"][0]["primitives"][0];
    let base = vectors(&document, &binary, &sheet["attributes"]["POSITION"]);
    for k in 1..3 {
        let expected = result.frame(k).unwrap().positions;
        let target = &sheet["targets"][k - 1]["POSITION"];
        let added = vectors(&document, &binary, target);
        for ((base, added), expected) in base.iter().zip(&added).zip(&expected) {
            for axis in 0..3 {
                // Two roundings to single precision of numbers up to 2.
                let found = f64::from(base[axis]) + f64::from(added[axis]);
                assert!((found - expected[axis]).abs() < 4.0 * f64::from(f32::EPSILON));
            }
        }
        let normals = vectors(&document, &binary, &sheet["attributes"]["NORMAL"]);
        let change = vectors(&document, &binary, &sheet["targets"][k - 1]["NORMAL"]);
        for (normal, change) in normals.iter().zip(change) {
            let length: f32 = (0..3).map(|i| (normal[i] + change[i]).powi(2)).sum();
            assert!((length - 1.0).abs() < 1e-6, "{length}");
        }
    }
    // What stands still has no shapes, and what has edges no normals.
    let body = &document["meshes"][1]["primitives"][0];
    assert!(body.get("targets").is_none() && body["attributes"].get("NORMAL").is_none());
    let channels = document["animations"][0]["channels"].as_array().unwrap();
    assert_eq!(channels.len(), 1);
    assert_eq!(
        document["meshes"][0]["extras"]["targetNames"][1],
        "t = 0.08 s"
    );
}

#[test]
fn a_still_has_no_animation_and_stands_upright() {
    let folder = tempfile::tempdir().unwrap();
    let result = result(folder.path());
    let colors = vec![[1.0, 0.5, 0.0]; 20];
    let look = GlbLook {
        vertex_colors: Some(colors),
        ..look()
    };
    let (document, _) = chunks(&glb_bytes(&result, &[2], &look).unwrap());
    assert!(document.get("animations").is_none());
    assert_eq!(
        document["scenes"][0]["extras"]["times"][0].as_f64(),
        Some(f64::from(0.08f32))
    );
    let root = document["scenes"][0]["nodes"][0].as_u64().unwrap() as usize;
    let [x, y, z, w]: [f64; 4] =
        serde_json::from_value(document["nodes"][root]["rotation"].clone()).unwrap();
    let turn = nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z));
    assert!((turn * Vec3::z() - Vec3::y()).norm() < 1e-15);
    assert!(document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"].is_u64());
}

#[test]
fn long_films_are_thinned_evenly() {
    assert_eq!(glb_frames(3), [0, 1, 2]);
    let frames = glb_frames(1001);
    assert_eq!((frames.len(), frames[0], frames[1]), (167, 0, 6));
    assert!(glb_frames(100_000_000).len() <= MAX_GLB_FRAMES);
}

#[test]
fn coordinates_beyond_single_precision_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let part = Part {
        name: "a".to_string(),
        kind: PartKind::Shell,
        thickness: 0.0,
        vertices: 0..3,
        faces: 0..1,
        solid: None,
    };
    let manifest = Manifest {
        parts: vec![part],
        ..Manifest::default()
    };
    let mut writer = ResultWriter::create(folder.path(), &manifest, &[[0, 1, 2]]).unwrap();
    let frame = Frame {
        positions: vec![Vec3::zeros(), Vec3::x() * 1e39, Vec3::y()],
        ..Frame::default()
    };
    writer.write_frame(&frame).unwrap();
    let result = ResultReader::open(folder.path()).unwrap();
    let look = GlbLook {
        part_colors: vec![[0.5; 3]],
        vertex_colors: None,
    };
    let error = glb_bytes(&result, &[0], &look).unwrap_err().to_string();
    assert!(error.contains("single precision"), "{error}");
}
