//! A result to be exported.

use std::path::Path;

use koiter::Vec3;
use koiter::io::result::{Field, Frame, Manifest, Part, PartKind, ResultWriter};
use koiter::mesh::generate;

/// A torus and a sheet that move, with a field of vertices and one of faces.
pub(crate) fn write_result(folder: &Path) {
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
