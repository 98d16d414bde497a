//! What we write is read by VTK itself, not only by us.
//!
//! Needs a Python with the package `vtk`: `KOITER_PYTHON` names the interpreter (default `python3`). Without it the
//! tests pass and say so, unless `KOITER_REQUIRE_VTK=1`.
#![cfg(feature = "io")]

use std::path::Path;
use std::process::Command;

use koiter::Vec3;
use koiter::io::result::{Field, Frame, Manifest, Part, PartKind, ResultReader, ResultWriter};
use koiter::io::write::{MeshWithFields, write_obj, write_ply, write_vtu_series};
use koiter::mesh::generate;
use serde_json::{Value, json};

/// What VTK finds in the file; `None` where there is no VTK and none is required.
fn read_with_vtk(file: &Path) -> Option<Value> {
    let python = std::env::var("KOITER_PYTHON").unwrap_or_else(|_| "python3".to_string());
    let has_vtk = Command::new(&python)
        .args(["-c", "import vtkmodules"])
        .output();
    if !has_vtk.is_ok_and(|output| output.status.success()) {
        let required = std::env::var("KOITER_REQUIRE_VTK").is_ok_and(|value| value == "1");
        assert!(
            !required,
            "KOITER_REQUIRE_VTK=1, but {python} cannot import vtkmodules"
        );
        eprintln!("skipped: {python} has no vtk (pip install vtk, or set KOITER_PYTHON)");
        return None;
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vtk_reader.py");
    let output = Command::new(&python)
        .arg(script)
        .arg(file)
        .output()
        .expect("python was just run");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && errors.is_empty(),
        "VTK on {}: {errors}",
        file.display()
    );
    let found: Value = serde_json::from_slice(&output.stdout).expect("the script prints JSON");
    assert_eq!(found["errors"], json!([]));
    Some(found)
}

fn bits(values: impl IntoIterator<Item = f64>) -> Value {
    values
        .into_iter()
        .map(|value| json!(value.to_bits()))
        .collect()
}

/// 0 for the faces of the torus, 1 for those of the sheet.
fn part_numbers(result: &ResultReader) -> Value {
    let first_of_sheet = result.manifest().parts[1].faces.start;
    bits((0..result.faces().len()).map(|face| f64::from(u8::from(face >= first_of_sheet))))
}

/// A torus and a sheet that move, with a field of vertices and one of faces.
fn write_result(folder: &Path) {
    let torus = generate::torus(1.0 / 3.0, 0.1, 12, 6).unwrap();
    let sheet = generate::grid(1.0, 1.0, 3, 3, generate::GridDiagonals::Checkerboard).unwrap();
    let (n, m) = (torus.positions.len(), torus.mesh.num_faces());
    let mut faces = torus.mesh.faces().to_vec();
    faces.extend(
        sheet
            .mesh
            .faces()
            .iter()
            .map(|face| face.map(|v| v + n as u32)),
    );
    let (total, num_faces) = (n + sheet.positions.len(), faces.len());
    let part = |name: &str, kind, vertices, faces| Part {
        name: name.to_string(),
        kind,
        thickness: 1e-3,
        vertices,
        faces,
        solid: None,
    };
    let manifest = Manifest {
        parts: vec![
            part("torus", PartKind::Shell, 0..n, 0..m),
            part("sheet", PartKind::Obstacle, n..total, m..num_faces),
        ],
        ..Manifest::default()
    };
    let mut writer = ResultWriter::create(folder, &manifest, &faces).unwrap();
    for step in 0..3 {
        let shift = Vec3::new(0.0, 0.0, f64::from(step) / 7.0);
        let positions = torus
            .positions
            .iter()
            .map(|x| x + shift)
            .chain(sheet.positions.clone());
        let frame = Frame {
            step: step as u64,
            time: f64::from(step) / 120.0,
            positions: positions.collect(),
            vertex_fields: vec![Field {
                name: "speed <&\"> [m/s]".to_string(),
                values: (0..total).map(|v| v as f32 / 3.0).collect(),
            }],
            face_fields: vec![Field {
                name: "bending_energy_density".to_string(),
                values: (0..num_faces).map(|f| f as f32 * -1e-6).collect(),
            }],
            topology: None,
        };
        writer.write_frame(&frame).unwrap();
    }
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
