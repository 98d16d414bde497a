//! Planes of symmetry: which unknowns they hold, and which directors.

use super::assemble::BuildError;
use super::clamps::clamp_stiffness;
use super::model::{BendingModel, Model, SymmetryPlane};
use crate::Vec3;
use crate::energy::bending::{ExtraUnknowns, SymmetryEdge, SymmetryEdges};
use crate::integrate::ShellPart;
use crate::mesh::EdgeId;

/// Stiffness that holds directors in the plane, in units of the bending stiffness of the face: half a shell then bends like
/// a whole one up to about 10⁻⁶.
const STIFFNESS: f64 = 1e6;

impl BendingModel {
    /// Whether the model can be cut at a plane of symmetry: the slope there must be an unknown that can be held, or of no
    /// account. Models of positions alone would bend there as freely as a hinge.
    pub(super) fn knows_symmetry(self) -> bool {
        let held = [ExtraUnknowns::EdgeAngles, ExtraUnknowns::VertexDirectors];
        self == Self::None || held.contains(&self.info().unknowns)
    }
}

/// Boundary edges on planes of symmetry, in shells with edge angles.
pub(super) fn symmetry_edges(
    model: &Model,
    parts: &[ShellPart],
    q: &[f64],
) -> Result<SymmetryEdges, BuildError> {
    let mut edges = Vec::new();
    for plane in &model.symmetry_planes {
        let (shell, part) = (&model.shells[plane.shell], &parts[plane.shell]);
        if !shell.bending.knows_symmetry() {
            return Err(BuildError::SymmetryWithoutDirectors {
                shell: shell.name.clone(),
            });
        }
        if part.extra != ExtraUnknowns::EdgeAngles {
            continue;
        }
        for (edge, face, corner) in edges_on(plane, part) {
            let stencil = &part.stencils[face];
            let [a, b, c] = [(corner + 1) % 3, (corner + 2) % 3, corner];
            let x = part.face_corners(face, q);
            let along = x[b] - x[a];
            let altitude = along.cross(&(x[c] - x[a])).norm() / along.norm();
            let mut normal = Vec3::zeros();
            normal[plane.axis] = 1.0;
            if normal.cross(&along).dot(&part.directors(face, q)[corner]) < 0.0 {
                normal = -normal;
            }
            let rigidity = part.section.flexural_rigidity(face);
            edges.push(SymmetryEdge {
                corners: [a, b, c].map(|i| stencil.corners[i]),
                angle: stencil.angles[corner],
                sign: stencil.signs[corner],
                normal,
                stiffness: clamp_stiffness(rigidity, STIFFNESS, along.norm(), altitude),
                vertices: part.mesh.edges()[edge],
            });
        }
    }
    Ok(SymmetryEdges { edges })
}

/// Boundary edges with both ends on the plane, each with its face and its corner there.
fn edges_on(plane: &SymmetryPlane, part: &ShellPart) -> Vec<(usize, usize, usize)> {
    let mut on_plane = vec![false; part.mesh.num_vertices()];
    for vertex in &plane.vertices {
        on_plane[vertex.0 as usize] = true;
    }
    let mut found = Vec::new();
    for (face, edges) in part.mesh.face_edges().iter().enumerate() {
        for (corner, EdgeId(edge)) in edges.iter().enumerate() {
            let ends = part.mesh.edges()[*edge as usize];
            if part.mesh.is_boundary_edge(EdgeId(*edge))
                && ends.iter().all(|v| on_plane[*v as usize])
            {
                found.push((*edge as usize, face, corner));
            }
        }
    }
    found
}

/// Holds the vertices on the plane and their directors in it: which unknowns of `q`, and their values.
pub(super) fn held_by(model: &Model, parts: &[ShellPart]) -> Vec<(usize, f64)> {
    let mut held = Vec::new();
    for plane in &model.symmetry_planes {
        let (shell, part) = (&model.shells[plane.shell], &parts[plane.shell]);
        for vertex in &plane.vertices {
            let place = 3 * vertex.0 as usize + plane.axis;
            let start = shell.surface.positions[vertex.0 as usize][plane.axis];
            held.push((part.first_vertex.0 as usize + place, start));
            if part.extra == ExtraUnknowns::VertexDirectors {
                held.push((part.first_extra.0 as usize + place, 0.0));
            }
        }
    }
    held
}
