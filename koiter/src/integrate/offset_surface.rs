//! The size of a step, measured on the offset surfaces.
//!
//! ```text
//! x_jk^off = (x_j + x_k)/2 + (h/2) d_jk        x_i^off = x_ik^off + x_ij^off − x_jk^off
//! ```
//!
//! Positions and edge angles have different units; the motion of the upper surface of the shell, at half the thickness h
//! along the directors d, measures both in metres. Reference: "Better Bending" (2026), Eqs. (53), (54). Models without
//! directors are measured by their vertices.

use super::system::ShellPart;
use crate::Vec3;
use crate::assembly::{ConfigurationSpace, parallel_map};

/// Positions and edge angles of all shells, measured on their offset surfaces.
pub struct OffsetSurfaces {
    /// The shells.
    pub shells: Vec<ShellPart>,
}

impl OffsetSurfaces {
    /// The three offset corners of a face.
    fn corners(shell: &ShellPart, face: usize, q: &[f64]) -> [Vec3; 3] {
        let x = shell.face_corners(face, q);
        let half = 0.5 * shell.thickness;
        let directors = shell.directors(face, q);
        let middle: [Vec3; 3] =
            std::array::from_fn(|c| (x[(c + 1) % 3] + x[(c + 2) % 3]) * 0.5 + directors[c] * half);
        std::array::from_fn(|c| middle[(c + 1) % 3] + middle[(c + 2) % 3] - middle[c])
    }
}

/// The larger of two, infinite if either is not a number.
fn larger(a: f64, b: f64) -> f64 {
    if a >= b {
        a
    } else if b > a {
        b
    } else {
        f64::INFINITY
    }
}

impl ConfigurationSpace for OffsetSurfaces {
    fn displacement(&self, q: &[f64], dq: &[f64]) -> f64 {
        let mut largest = 0.0;
        for shell in &self.shells {
            let vertices = shell.vertex_dofs();
            let by_vertex = dq[vertices]
                .chunks_exact(3)
                .map(|d| (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt());
            largest = by_vertex.fold(largest, larger);
            if shell.first_edge.is_none() {
                continue;
            }
            let after: Vec<f64> = q.iter().zip(dq).map(|(x, d)| x + d).collect();
            let by_face = parallel_map(shell.mesh.num_faces(), |face| {
                let (old, new) = (
                    Self::corners(shell, face, q),
                    Self::corners(shell, face, &after),
                );
                (0..3).map(|c| (new[c] - old[c]).norm()).fold(0.0, larger)
            });
            largest = by_face.into_iter().fold(largest, larger);
        }
        largest
    }

    fn describe(&self, dof: usize) -> String {
        for shell in &self.shells {
            let vertices = shell.vertex_dofs();
            if vertices.contains(&dof) {
                let (vertex, axis) = ((dof - vertices.start) / 3, (dof - vertices.start) % 3);
                return format!(
                    "coordinate {} of vertex {vertex} of '{}'",
                    ["x", "y", "z"][axis],
                    shell.name
                );
            }
            if let Some(first) = shell.first_edge {
                let edges = first.0 as usize..first.0 as usize + shell.mesh.num_edges();
                if edges.contains(&dof) {
                    let [u, v] = shell.mesh.edges()[dof - edges.start];
                    return format!("the director of edge {u}–{v} of '{}'", shell.name);
                }
            }
        }
        format!("unknown {dof}")
    }
}
