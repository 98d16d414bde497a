//! From a model to a simulation, and the result folder's description of it.

use std::path::Path;

use koiter::io::result::{FrameTopology, Manifest, Part, PartKind};
use koiter::scene::model::{Model, Obstacle};
use koiter::scene::{BuildError, PartTopology, Simulation};

use crate::debug_mesh;
use crate::failure::Failure;
use crate::scene_source::LoadedScene;

/// Sets the simulation up; a start that is refused is an error of the input.
pub(crate) fn start(model: &Model, debug_mesh: Option<&Path>) -> Result<Simulation, Failure> {
    Simulation::new(model.clone()).map_err(|error| {
        let help = match (&error, debug_mesh) {
            (BuildError::Start(start), Some(path)) => match debug_mesh::write(path, model, start) {
                Ok(()) => format!("the faces at fault are red in {}", path.display()),
                Err(refusal) => format!("cannot write {}: {refusal}", path.display()),
            },
            (BuildError::Start(_), None) => {
                "--debug-mesh FILE.ply writes the surfaces with the faces at fault in red"
                    .to_owned()
            }
            _ => return Failure::start(error),
        };
        Failure::start(error).with_help(help)
    })
}

/// Parts and faces of everything that is shown.
pub(crate) fn parts(simulation: &Simulation) -> (Vec<Part>, Vec<[u32; 3]>) {
    number(simulation.model(), simulation.parts())
}

/// Parts and faces as they are now, where faces burn away; `None`: [`parts`] are right throughout.
pub(super) fn present_parts(simulation: &Simulation) -> Option<FrameTopology> {
    let (parts, faces) = number(simulation.model(), &simulation.present_parts()?);
    Some(FrameTopology { parts, faces })
}

/// Numbers the vertices and faces of all parts through.
fn number(model: &Model, shown: &[PartTopology]) -> (Vec<Part>, Vec<[u32; 3]>) {
    let (mut parts, mut faces) = (Vec::new(), Vec::new());
    let simulated = model.shells.len() + model.double_layers.len();
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
pub(super) fn manifest(loaded: &LoadedScene, simulation: &Simulation) -> (Manifest, Vec<[u32; 3]>) {
    let (parts, faces) = parts(simulation);
    let manifest = Manifest {
        title: loaded.scene.title.clone(),
        scene_text: loaded.text.clone(),
        parts,
        ..Manifest::default()
    };
    (manifest, faces)
}
