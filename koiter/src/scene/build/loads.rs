//! From `[[load]]` to the vertices, edges and faces that are loaded.

use super::{Builder, vertices};
use crate::Vec3;
use crate::mesh::{EdgeId, FaceId, VertexId};
use crate::scene::error::{SceneError, SceneErrorKind as Kind};
use crate::scene::model::{Load, LoadKind, Shell};
use crate::scene::spec::{EdgeChoice, LoadSpec};

impl Builder<'_> {
    pub(super) fn loads(&self, shells: &[Shell]) -> Result<Vec<Load>, SceneError> {
        let loads = self.spec.load.iter();
        loads.map(|load| self.load(load, shells)).collect()
    }

    fn load(&self, load: &LoadSpec, shells: &[Shell]) -> Result<Load, SceneError> {
        let shell = self.shell_index(&format!("load.{}.shell", load.name), &load.shell)?;
        Ok(Load {
            name: load.name.clone(),
            shell,
            kind: load_kind(load, &shells[shell])?,
            scale: load.scale.clone(),
        })
    }
}

fn load_kind(load: &LoadSpec, shell: &Shell) -> Result<LoadKind, SceneError> {
    if let Some(pressure) = load.pressure {
        let origin = Vec3::from(load.origin.unwrap_or_default());
        return Ok(LoadKind::Pressure { pressure, origin });
    }
    let path = format!("load.{}.select", load.name);
    let selected = match &load.select {
        Some(select) => vertices(&path, select, shell)?,
        None => (0..shell.surface.positions.len() as u32)
            .map(VertexId)
            .collect(),
    };
    let edges = || edges(&path, load, shell, &selected);
    // The checks let exactly one of them through.
    if let Some(force) = load.force {
        let force = Vec3::from(force) / selected.len() as f64;
        return Ok(LoadKind::Point {
            vertices: selected,
            force,
        });
    }
    if let Some(force) = load.force_per_length {
        let force = Vec3::from(force);
        return Ok(LoadKind::Edge {
            edges: edges()?,
            force,
        });
    }
    if let Some(force) = load.force_per_area {
        let faces = faces(&path, shell, &selected)?;
        let force = Vec3::from(force);
        return Ok(LoadKind::Area { faces, force });
    }
    if let Some(moment) = load.moment_per_length {
        return Ok(LoadKind::Moment {
            edges: edges()?,
            moment,
        });
    }
    if let Some(moment) = load.moment_each {
        return Ok(LoadKind::Turning {
            vertices: selected,
            moment: Vec3::from(moment),
        });
    }
    Ok(LoadKind::Point {
        vertices: selected,
        force: Vec3::from(load.force_each.unwrap_or_default()),
    })
}

fn is_selected(shell: &Shell, selected: &[VertexId]) -> Vec<bool> {
    let mut chosen = vec![false; shell.surface.positions.len()];
    for vertex in selected {
        chosen[vertex.0 as usize] = true;
    }
    chosen
}

fn edges(
    path: &str,
    load: &LoadSpec,
    shell: &Shell,
    selected: &[VertexId],
) -> Result<Vec<EdgeId>, SceneError> {
    let chosen = is_selected(shell, selected);
    let mesh = &shell.surface.mesh;
    let between: Vec<EdgeId> = (0..mesh.num_edges() as u32)
        .map(EdgeId)
        .filter(|e| {
            mesh.edges()[e.0 as usize]
                .iter()
                .all(|v| chosen[*v as usize])
        })
        .collect();
    let taken: Vec<EdgeId> = between
        .iter()
        .copied()
        .filter(|e| load.edges == EdgeChoice::All || mesh.is_boundary_edge(*e))
        .collect();
    if !taken.is_empty() {
        return Ok(taken);
    }
    let (what, help) = match between.len() {
        0 => ("edge", "select both ends of the edges to load"),
        _ => ("boundary edge", "edges = \"all\" takes inner edges too"),
    };
    let message = format!(
        "shell '{}': no {what} has both its ends in the selection",
        shell.name
    );
    Err(SceneError::new(Kind::EmptySelection, message)
        .inside(path)
        .with_help(help))
}

fn faces(path: &str, shell: &Shell, selected: &[VertexId]) -> Result<Vec<FaceId>, SceneError> {
    let chosen = is_selected(shell, selected);
    let faces = shell.surface.mesh.faces().iter().enumerate();
    let taken: Vec<FaceId> = faces
        .filter(|(_, face)| face.iter().all(|v| chosen[*v as usize]))
        .map(|(f, _)| FaceId(f as u32))
        .collect();
    if taken.is_empty() {
        let message = format!(
            "shell '{}': no triangle has all its corners in the selection",
            shell.name
        );
        return Err(SceneError::new(Kind::EmptySelection, message)
            .inside(path)
            .with_help("select the three corners of the triangles to load"));
    }
    Ok(taken)
}
