use super::*;
use crate::io::read::{parse_obj, parse_ply};
use crate::io::result::PartKind;

struct Sample {
    positions: Vec<Vec3>,
    faces: Vec<[u32; 3]>,
    vertex_fields: Vec<Field>,
    face_fields: Vec<Field>,
}

fn field(name: &str, values: &[f32]) -> Field {
    Field {
        name: name.to_string(),
        values: values.to_vec(),
    }
}

fn sample() -> Sample {
    let p = |x: f64, y: f64| Vec3::new(x, y, 1.0 / 3.0);
    Sample {
        positions: vec![p(0.0, 0.0), p(0.1, -1e-300), p(1e17, 1.0), p(-0.0, 1.0)],
        faces: vec![[0, 1, 2], [0, 2, 3]],
        vertex_fields: vec![field("contact gap [m]", &[1.0, 2.0, 3.0, 4.0])],
        face_fields: vec![field("strain", &[0.5, -0.5])],
    }
}

impl Sample {
    fn mesh(&self) -> MeshWithFields<'_> {
        MeshWithFields {
            positions: &self.positions,
            faces: &self.faces,
            vertex_fields: &self.vertex_fields,
            face_fields: &self.face_fields,
            ..MeshWithFields::default()
        }
    }
}

#[test]
fn obj_and_ply_come_back_bit_for_bit() {
    let sample = sample();
    let obj = parse_obj(&obj_bytes(&sample.mesh()).unwrap()).unwrap();
    let ply = parse_ply(&ply_bytes(&sample.mesh()).unwrap()).unwrap();
    for read in [obj, ply] {
        assert_eq!(read.faces, sample.faces);
        for (a, b) in read.positions.iter().zip(&sample.positions) {
            assert_eq!(a.map(f64::to_bits), <[f64; 3]>::from(*b).map(f64::to_bits));
        }
    }
}

#[test]
fn files_say_units_axis_and_parts() {
    let sample = sample();
    let part = |name: &str, faces| Part {
        name: name.to_string(),
        kind: PartKind::Shell,
        thickness: 0.0,
        vertices: 0..4,
        faces,
        solid: None,
    };
    let parts = [part("left sheet", 0..1), part("right", 1..2)];
    let mesh = MeshWithFields {
        parts: &parts,
        up_axis: UpAxis::Y,
        ..sample.mesh()
    };
    let text = String::from_utf8(obj_bytes(&mesh).unwrap()).unwrap();
    assert!(text.contains("metres, y up"));
    assert!(
        text.contains("o left_sheet\nf 1 2 3\no right\nf 1 3 4\n"),
        "{text}"
    );
    let ply = ply_bytes(&mesh).unwrap();
    let header = String::from_utf8_lossy(&ply[..500.min(ply.len())]).to_string();
    assert!(header.contains("comment Koiter: lengths in metres, y up"));
    assert!(header.contains("property float contact_gap__m_"));
    assert!(header.contains("comment part 0 left_sheet\ncomment part 1 right\n"));
    assert!(header.contains("property int part\nend_header"));
    // The part is the last word of each face.
    assert!(ply.ends_with(&1_i32.to_le_bytes()));
    assert_eq!(ply[ply.len() - 21 - 4..][..4], 0_i32.to_le_bytes());
    assert_eq!(parse_ply(&ply).unwrap().faces, sample.faces);
    let beyond = MeshWithFields {
        parts: &[part("left sheet", 0..3)],
        ..sample.mesh()
    };
    let text = vtu_bytes(&beyond, None).unwrap_err().to_string();
    assert!(text.contains("'left sheet' ends at face 3 of 2"), "{text}");
}

#[test]
fn meshes_that_contradict_themselves_are_refused() {
    let refused = |change: fn(&mut Sample)| {
        let mut sample = sample();
        change(&mut sample);
        let mesh = sample.mesh();
        let text = ply_bytes(&mesh).unwrap_err().to_string();
        assert_eq!(
            vtu_bytes(&mesh, None).map_err(|error| error.to_string()),
            Err(text.clone())
        );
        text
    };
    assert!(refused(|s| s.faces[1][2] = 4).contains("face 1 uses vertex 4 of 4"));
    assert!(
        refused(|s| s.face_fields[0].values.clear()).contains("'strain' has 0 values for 2 faces")
    );
    assert!(refused(|s| s.face_fields[0].name.clear()).contains("empty or taken"));
    assert!(refused(|s| s.face_fields.push(field("strain", &[0.0; 2]))).contains("'strain'"));
    let mut sample = sample();
    sample.vertex_fields[0].name = "x".to_string();
    assert!(matches!(
        ply_bytes(&sample.mesh()),
        Err(WriteError::FieldName { .. })
    ));
    assert!(vtu_bytes(&sample.mesh(), None).is_ok());
}

#[test]
fn unwritable_path_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("missing").join("a.obj");
    let error = write_obj(&path, &sample().mesh()).unwrap_err().to_string();
    assert!(
        error.contains("could not write") && error.contains("a.obj"),
        "{error}"
    );
}
