//! The surfaces of a refused start, the faces at fault in red.

use std::collections::HashSet;
use std::fmt::Write;
use std::io;
use std::path::Path;

use koiter::contact::StartError;
use koiter::io::write_atomically;
use koiter::mesh::Surface;
use koiter::scene::model::{Model, ObstacleShape};

const AT_FAULT: &str = "220 30 30";
const SHELL: &str = "170 185 205";
const OBSTACLE: &str = "200 200 195";

/// Writes shells and mesh obstacles as ASCII PLY with face colours, which MeshLab and Blender show. Balls, capsules and
/// planes have no faces and are left out.
pub(crate) fn write(path: &Path, model: &Model, error: &StartError) -> io::Result<()> {
    write_atomically(path, ply(model, error).as_bytes())
}

fn ply(model: &Model, error: &StartError) -> String {
    let at_fault: HashSet<u32> = error
        .pairs
        .iter()
        .flat_map(|pair| pair.vertices.iter().copied())
        .collect();
    let mut vertices = String::new();
    let mut faces = String::new();
    let (mut num_vertices, mut num_faces) = (0, 0);
    for (first, surface, color) in surfaces(model) {
        for x in &surface.positions {
            let _ = writeln!(vertices, "{} {} {}", x.x, x.y, x.z);
        }
        for corners in surface.mesh.faces() {
            let is_at_fault = corners
                .iter()
                .any(|corner| at_fault.contains(&(corner + first)));
            let color = if is_at_fault { AT_FAULT } else { color };
            let [a, b, c] = corners.map(|corner| corner + num_vertices);
            let _ = writeln!(faces, "3 {a} {b} {c} {color}");
        }
        num_vertices += surface.positions.len() as u32;
        num_faces += surface.mesh.num_faces();
    }
    format!(
        "ply\nformat ascii 1.0\ncomment faces at fault are red; lengths in metres, z up\n\
         element vertex {num_vertices}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {num_faces}\nproperty list uchar int vertex_indices\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n{vertices}{faces}"
    )
}

/// Surfaces with the number of their first vertex in the collision mesh: shells first, then obstacles in their order, of
/// which planes have no vertices, balls one and capsules two.
fn surfaces(model: &Model) -> Vec<(u32, &Surface, &'static str)> {
    let mut first = 0;
    let mut found = Vec::new();
    for shell in &model.shells {
        found.push((first, &shell.surface, SHELL));
        first += shell.surface.positions.len() as u32;
    }
    for obstacle in &model.obstacles {
        first += match &obstacle.shape {
            ObstacleShape::Mesh(surface) => {
                found.push((first, surface, OBSTACLE));
                surface.positions.len() as u32
            }
            ObstacleShape::Sphere { .. } => 1,
            ObstacleShape::Capsule { .. } => 2,
            _ => 0,
        };
    }
    found
}
