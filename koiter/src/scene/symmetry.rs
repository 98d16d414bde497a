//! Planes of symmetry: which unknowns they hold, and which directors.

use super::assemble::BuildError;
use super::clamps::clamp_stiffness;
use super::model::{BendingModel, Model, SymmetryPlane};
use crate::Vec3;
use crate::energy::bending::{ExtraUnknowns, SymmetryEdge, SymmetryEdges};
use crate::integrate::ShellPart;
use crate::mesh::{EdgeId, VertexId};

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
        edges.extend(held_edges(plane, part, q));
    }
    Ok(SymmetryEdges { edges })
}

/// Those of one plane at the configuration `q`; none without edge angles.
fn held_edges(plane: &SymmetryPlane, part: &ShellPart, q: &[f64]) -> Vec<SymmetryEdge> {
    if part.extra != ExtraUnknowns::EdgeAngles {
        return Vec::new();
    }
    let hold = |(edge, face, corner): (usize, usize, usize)| {
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
        SymmetryEdge {
            corners: [a, b, c].map(|i| stencil.corners[i]),
            angle: stencil.angles[corner],
            sign: stencil.signs[corner],
            normal,
            stiffness: clamp_stiffness(rigidity, STIFFNESS, along.norm(), altitude),
            vertices: part.mesh.edges()[edge],
        }
    };
    edges_on(plane, part).into_iter().map(hold).collect()
}

/// The directors of the shell with this index that planes of symmetry hold at the positions in `q`: unknowns and values.
pub(super) fn held_directors(
    model: &Model,
    shell: usize,
    part: &ShellPart,
    q: &[f64],
) -> Vec<(usize, f64)> {
    let mut held = Vec::new();
    for plane in model.symmetry_planes.iter().filter(|p| p.shell == shell) {
        held.extend(held_edges(plane, part, q).iter().map(|edge| {
            let place = |i: usize| edge.corners[i / 3].0 as usize + i % 3;
            let corners = std::array::from_fn(|i| q[place(i)]);
            (edge.angle.0 as usize, edge.angle_in_plane(&corners))
        }));
        if part.extra == ExtraUnknowns::VertexDirectors {
            let place = |v: &VertexId| part.first_extra.0 as usize + 3 * v.0 as usize + plane.axis;
            held.extend(plane.vertices.iter().map(|v| (place(v), 0.0)));
        }
    }
    held
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
