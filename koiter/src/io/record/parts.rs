//! The result folder's description of a simulation.

use crate::io::result::{FrameTopology, Manifest, Part, PartKind};
use crate::scene::model::{Model, Obstacle};
use crate::scene::{PartTopology, Scene, Simulation};

/// Parts and faces of everything that is shown.
pub fn parts_and_faces(simulation: &Simulation) -> (Vec<Part>, Vec<[u32; 3]>) {
    number(simulation.model(), simulation.parts())
}

/// Parts and faces as they are now, where faces burn away; `None`: [`parts_and_faces`] are right throughout.
pub(super) fn present_parts(simulation: &Simulation) -> Option<FrameTopology> {
    let (parts, faces) = number(simulation.model(), &simulation.present_parts()?);
    Some(FrameTopology { parts, faces })
}

/// Numbers the vertices and faces of all parts through.
fn number(model: &Model, shown: &[PartTopology]) -> (Vec<Part>, Vec<[u32; 3]>) {
    let (mut parts, mut faces) = (Vec::new(), Vec::new());
    let simulated = shown.iter().filter(|part| !part.is_obstacle).count();
    let solids = (0..simulated).map(|_| None);
    let solids = solids.chain(model.obstacles.iter().map(Obstacle::solid));
    let mut first_vertex = 0;
    for (part, solid) in shown.iter().zip(solids) {
        let first_face = faces.len();
        let offset = first_vertex as u32;
        faces.extend(
            part.faces
                .iter()
                .map(|corners| corners.map(|vertex| vertex + offset)),
        );
        parts.push(Part {
            name: part.name.clone(),
            kind: if part.is_obstacle {
                PartKind::Obstacle
            } else {
                PartKind::Shell
            },
            thickness: part.thickness,
            vertices: first_vertex..first_vertex + part.num_vertices,
            faces: first_face..faces.len(),
            solid,
        });
        first_vertex += part.num_vertices;
    }
    (parts, faces)
}

/// The result folder's description of a simulation, and its faces.
pub(super) fn manifest(
    scene: &Scene,
    scene_text: &str,
    simulation: &Simulation,
) -> (Manifest, Vec<[u32; 3]>) {
    let (parts, faces) = parts_and_faces(simulation);
    let manifest = Manifest {
        title: scene.title.clone(),
        scene_text: scene_text.to_owned(),
        parts,
        ..Manifest::default()
    };
    (manifest, faces)
}
