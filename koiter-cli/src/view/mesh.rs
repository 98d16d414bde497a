//! A mesh file as a result of one part and one frame.

use std::path::Path;

use koiter::Vec3;
use koiter::io::read_mesh;
use koiter::io::result::{Manifest, Part, PartKind};

use crate::failure::Failure;

/// What is read of the file.
#[derive(Debug)]
pub(super) struct Mesh {
    pub(super) manifest: Manifest,
    pub(super) faces: Vec<[u32; 3]>,
    pub(super) positions: Vec<Vec3>,
}

impl Mesh {
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let raw = read_mesh(path).map_err(Failure::mesh)?;
        let name = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        if raw.faces.is_empty() {
            let message = format!(
                "{} has no triangles: there is nothing to show",
                path.display()
            );
            return Err(Failure::input(message));
        }
        let count = raw.positions.len();
        if let Some(v) = raw.faces.iter().flatten().find(|&&v| v as usize >= count) {
            let message = format!(
                "{}: a triangle has vertex {v}, but there are {count}",
                path.display()
            );
            return Err(Failure::input(message));
        }
        let part = Part {
            name: name.clone(),
            kind: PartKind::Shell,
            thickness: 0.0,
            vertices: 0..count,
            faces: 0..raw.faces.len(),
            solid: None,
        };
        Ok(Self {
            manifest: Manifest {
                title: name,
                parts: vec![part],
                ..Manifest::default()
            },
            positions: raw.positions.into_iter().map(Vec3::from).collect(),
            faces: raw.faces,
        })
    }
}
