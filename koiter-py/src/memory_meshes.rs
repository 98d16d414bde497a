//! Meshes of a scene that Python holds as arrays, beside those in files.

use std::collections::HashMap;
use std::path::PathBuf;

use koiter::Vec3;
use koiter::burning::{QuadMesh, Texture};
use koiter::io::{MAX_SCENE_BYTES, read_bounded, read_mesh, read_points, read_quads, read_texture};
use koiter::mesh::{Surface, SurfaceOptions};
use koiter::scene::{MeshSource, PointCache, UnreadableMesh};

/// Arrays by the name that stands for them in the scene, and the folder of files.
pub(crate) struct MemoryMeshes {
    pub(crate) arrays: HashMap<String, (Vec<Vec3>, Vec<[u32; 3]>)>,
    pub(crate) folder: PathBuf,
}

fn unreadable(error: impl std::fmt::Display) -> UnreadableMesh {
    UnreadableMesh {
        message: error.to_string(),
        help: None,
    }
}

impl MeshSource for MemoryMeshes {
    fn read(&self, file: &str, options: SurfaceOptions) -> Result<Surface, UnreadableMesh> {
        match self.arrays.get(file) {
            Some((positions, faces)) => {
                Surface::new(positions.clone(), faces.clone(), options).map_err(unreadable)
            }
            None => read_mesh(&self.folder.join(file))
                .and_then(|mesh| mesh.into_surface(options))
                .map_err(unreadable),
        }
    }

    fn read_quads(&self, file: &str) -> Result<QuadMesh, UnreadableMesh> {
        read_quads(&self.folder.join(file)).map_err(unreadable)
    }

    fn read_texture(&self, file: &str) -> Result<Texture, UnreadableMesh> {
        read_texture(&self.folder.join(file)).map_err(unreadable)
    }

    fn read_points(&self, file: &str) -> Result<PointCache, UnreadableMesh> {
        read_points(&self.folder.join(file)).map_err(unreadable)
    }

    fn read_text(&self, file: &str) -> Result<String, UnreadableMesh> {
        let path = self.folder.join(file);
        let told = |error: &dyn std::fmt::Display| {
            unreadable(format!("cannot read {}: {error}", path.display()))
        };
        let bytes = read_bounded(&path, MAX_SCENE_BYTES).map_err(|error| told(&error))?;
        String::from_utf8(bytes).map_err(|error| told(&error))
    }
}
