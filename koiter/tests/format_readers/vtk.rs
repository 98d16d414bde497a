//! Series of VTU files, PLY and OBJ, read by VTK.

use std::path::Path;

use koiter::Vec3;
use koiter::io::result::{Field, ResultReader};
use koiter::io::write::{MeshWithFields, write_obj, write_ply, write_vtu_series};
use serde_json::{Value, json};

use crate::python::{bits, read_with};
use crate::sample::write_result;

/// What VTK finds in the file; `None` where there is no VTK and none is required.
fn read_with_vtk(file: &Path) -> Option<Value> {
    let found = read_with("vtk_reader.py", file)?;
    assert_eq!(found["errors"], json!([]));
    Some(found)
}

/// 0 for the faces of the torus, 1 for those of the sheet.
fn part_numbers(result: &ResultReader) -> Value {
    let first_of_sheet = result.manifest().parts[1].faces.start;
    bits((0..result.faces().len()).map(|face| f64::from(u8::from(face >= first_of_sheet))))
}

#[test]
fn vtk_reads_every_frame_of_a_series_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    write_result(&folder.path().join("run"));
    let result = ResultReader::open(&folder.path().join("run")).unwrap();
    let mut done = 0;
    write_vtu_series(&result, &folder.path().join("run.pvd"), |frames| {
        done = frames
    })
    .unwrap();
    assert_eq!(done, 3);
    let pvd = std::fs::read_to_string(folder.path().join("run.pvd")).unwrap();
    for index in 0..3 {
        let frame = result.frame(index).unwrap();
        let name = format!("run_{index:05}.vtu");
        assert!(pvd.contains(&format!(
            "timestep=\"{:?}\" part=\"0\" file=\"{name}\"",
            frame.time
        )));
        let Some(found) = read_with_vtk(&folder.path().join(name)) else {
            return;
        };
        let points: Value = frame
            .positions
            .iter()
            .map(|x| bits(x.iter().copied()))
            .collect();
        assert_eq!(found["points"], points);
        assert_eq!(found["cells"], json!(result.faces()));
        assert_eq!(found["types"], json!([5]));
        assert_eq!(found["field_data"]["TimeValue"], bits([frame.time]));
        let field_bits = |field: &Field| bits(field.values.iter().map(|&value| f64::from(value)));
        let (vertex, face) = (&frame.vertex_fields[0], &frame.face_fields[0]);
        assert_eq!(found["point_data"][&vertex.name], field_bits(vertex));
        assert_eq!(found["cell_data"][&face.name], field_bits(face));
        assert_eq!(found["cell_data"]["part"], part_numbers(&result));
        assert_eq!(found["field_data"]["part_names"], json!(["torus", "sheet"]));
    }
}

#[test]
fn vtk_reads_our_ply_and_obj() {
    let folder = tempfile::tempdir().unwrap();
    write_result(&folder.path().join("run"));
    let result = ResultReader::open(&folder.path().join("run")).unwrap();
    let frame = result.frame(2).unwrap();
    let mesh = MeshWithFields::of_frame(&result, &frame);
    let (ply, obj) = (
        folder.path().join("mesh.ply"),
        folder.path().join("mesh.obj"),
    );
    write_ply(&ply, &mesh).unwrap();
    write_obj(&obj, &mesh).unwrap();
    let exact: Value = frame
        .positions
        .iter()
        .map(|x| bits(x.iter().copied()))
        .collect();
    // VTK keeps points of these formats in single precision, except those of OBJ since version 9.
    let rounded = |x: &Vec3| bits(x.iter().map(|&value| f64::from(value as f32)));
    let rounded: Value = frame.positions.iter().map(rounded).collect();
    for file in [ply, obj] {
        let Some(found) = read_with_vtk(&file) else {
            return;
        };
        assert_eq!(found["cells"], json!(result.faces()), "{}", file.display());
        if file.extension().is_some_and(|extension| extension == "ply") {
            let text = String::from_utf8_lossy(&std::fs::read(&file).unwrap()).into_owned();
            assert!(text.contains("comment part 0 torus\ncomment part 1 sheet\n"));
            assert!(text.contains("property int part\nend_header"));
        }
        assert!(
            found["points"] == exact || found["points"] == rounded,
            "{}",
            file.display()
        );
    }
}
