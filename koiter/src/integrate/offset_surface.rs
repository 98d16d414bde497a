//! The size of a step, measured on the offset surfaces.
//!
//! ```text
//! x_jk^off = (x_j + x_k)/2 + (h/2) d_jk        x_i^off = x_ik^off + x_ij^off − x_jk^off
//! ```
//!
//! Positions and edge angles have different units; the motion of the upper surface of the shell, at half the thickness h
//! along the directors d, measures both in metres. Reference: "Better Bending" (2026), Eqs. (53), (54). Where vertices
//! have directors, `x_i^off = x_i + (h/2) d_i`. Models without directors are measured by their points.

use super::shell_part::ShellPart;
use crate::Vec3;
use crate::assembly::{ConfigurationSpace, parallel_map};
use crate::energy::bending::ExtraUnknowns;

/// Positions and extra unknowns of all shells, measured on their offset surfaces.
pub struct OffsetSurfaces {
    /// The shells.
    pub shells: Vec<ShellPart>,
}

/// The three offset corners of a face whose edges have directors.
fn corners(shell: &ShellPart, face: usize, q: &[f64]) -> [Vec3; 3] {
    let x = shell.face_corners(face, q);
    let half = 0.5 * shell.thickness;
    let directors = shell.directors(face, q);
    let middle: [Vec3; 3] =
        std::array::from_fn(|c| (x[(c + 1) % 3] + x[(c + 2) % 3]) * 0.5 + directors[c] * half);
    std::array::from_fn(|c| middle[(c + 1) % 3] + middle[(c + 2) % 3] - middle[c])
}

/// The largest displacement of an offset corner by edge directors.
fn edge_displacement(shell: &ShellPart, q: &[f64], dq: &[f64]) -> f64 {
    let after: Vec<f64> = q.iter().zip(dq).map(|(x, d)| x + d).collect();
    let by_face = parallel_map(shell.mesh.num_faces(), |face| {
        let (old, new) = (corners(shell, face, q), corners(shell, face, &after));
        (0..3).map(|c| (new[c] - old[c]).norm()).fold(0.0, larger)
    });
    by_face.into_iter().fold(0.0, larger)
}

/// The largest displacement of an offset vertex, at half the thickness along the director of the vertex.
fn vertex_displacement(shell: &ShellPart, q: &[f64], dq: &[f64]) -> f64 {
    let half = 0.5 * shell.thickness;
    let (vertices, directors) = (shell.vertex_dofs().start, shell.extra_dofs().start);
    let point = |values: &[f64], start: usize| Vec3::from_column_slice(&values[start..start + 3]);
    let moved = |v: usize| {
        let (x, d) = (vertices + 3 * v, directors + 3 * v);
        let (before, change) = (point(q, d), point(dq, d));
        let turned = (before + change).normalize() - before.normalize();
        (point(dq, x) + turned * half).norm()
    };
    (0..shell.mesh.num_vertices()).map(moved).fold(0.0, larger)
}

/// Lengths of vectors given by their components.
fn lengths(components: &[f64]) -> impl Iterator<Item = f64> {
    components
        .chunks_exact(3)
        .map(|d| (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt())
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
            largest = lengths(&dq[vertices]).fold(largest, larger);
            largest = match shell.extra {
                ExtraUnknowns::None => largest,
                ExtraUnknowns::EdgePoints => lengths(&dq[shell.extra_dofs()]).fold(largest, larger),
                ExtraUnknowns::VertexDirectors => {
                    larger(largest, vertex_displacement(shell, q, dq))
                }
                ExtraUnknowns::EdgeAngles => larger(largest, edge_displacement(shell, q, dq)),
            };
        }
        largest
    }

    /// The vertex that moves furthest; angles have no length to compare.
    fn describe_largest(&self, dq: &[f64]) -> String {
        let (mut largest, mut place) = (0.0, String::new());
        for shell in &self.shells {
            for (vertex, length) in lengths(&dq[shell.vertex_dofs()]).enumerate() {
                if length > largest {
                    largest = length;
                    place = format!("vertex {vertex} of '{}'", shell.name);
                }
            }
        }
        place
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
            let extra = shell.extra_dofs();
            if extra.contains(&dof) {
                let node = (dof - extra.start) / shell.extra.node_size();
                let edge = || {
                    let [u, v] = shell.mesh.edges()[node];
                    format!("edge {u}–{v}")
                };
                let what = match shell.extra {
                    ExtraUnknowns::VertexDirectors => format!("the director of vertex {node}"),
                    ExtraUnknowns::EdgePoints => format!("the point of {}", edge()),
                    _ => format!("the director of {}", edge()),
                };
                return format!("{what} of '{}'", shell.name);
            }
        }
        format!("unknown {dof}")
    }
}
