//! From `[[symmetry]]` to the vertices on the plane.

use super::Builder;
use crate::mesh::{Surface, VertexId};
use crate::scene::error::{SceneError, SceneErrorKind as Kind};
use crate::scene::model::{Shell, SymmetryPlane};
use crate::scene::spec::SymmetrySpec;

impl Builder<'_> {
    pub(super) fn symmetry_planes(
        &self,
        shells: &[Shell],
    ) -> Result<Vec<SymmetryPlane>, SceneError> {
        let planes = self.spec.symmetry.iter().enumerate();
        planes
            .map(|(index, plane)| {
                let path = format!("symmetry.{index}");
                let shell = self.shell_index(&format!("{path}.shell"), &plane.shell)?;
                let axis = plane.normal as usize;
                let vertices = on_plane(&path, plane, &shells[shell].surface)?;
                check_rest(&path, plane, &shells[shell], &vertices)?;
                Ok(SymmetryPlane {
                    shell,
                    axis,
                    vertices,
                })
            })
            .collect()
    }
}

/// A curved rest shape must go on as its mirror image too.
fn check_rest(
    path: &str,
    plane: &SymmetrySpec,
    shell: &Shell,
    vertices: &[VertexId],
) -> Result<(), SceneError> {
    let axis = plane.normal as usize;
    let place = |v: &VertexId| shell.rest_positions[v.0 as usize][axis];
    let (low, high) = (vertices.iter().map(place))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
            (l.min(x), h.max(x))
        });
    let (from, to) = shell.surface.bounding_box();
    if !shell.rest_curved || high - low <= 1e-9 * (to - from).norm() {
        return Ok(());
    }
    let message = format!(
        "the rest shape of shell '{}' has no plane of symmetry where the shell has: its vertices there lie between {low:.4} m and {high:.4} m",
        plane.shell
    );
    Err(SceneError::new(Kind::Conflict, message)
        .inside(path)
        .with_help(
            "turn the rest mesh as the mesh is, use rest = \"flat\", or simulate the whole shell",
        ))
}

/// The vertices on the plane, with the tolerance of a selection by box; the shell must lie on one side.
fn on_plane(
    path: &str,
    plane: &SymmetrySpec,
    surface: &Surface,
) -> Result<Vec<VertexId>, SceneError> {
    let axis = plane.normal as usize;
    let name = ["x", "y", "z"][axis];
    let (low, high) = surface.bounding_box();
    let tolerance = 1e-9 * (high - low).norm();
    let beyond = (high[axis] - plane.at, plane.at - low[axis]);
    if beyond.0 > tolerance && beyond.1 > tolerance {
        let message = format!(
            "shell '{}' lies on both sides of the plane {name} = {} m: from {:.4} m to {:.4} m",
            plane.shell, plane.at, low[axis], high[axis]
        );
        return Err(SceneError::new(Kind::Conflict, message)
            .inside(&format!("{path}.at"))
            .with_help("use half of the shell: what is behind the plane is its mirror image"));
    }
    let positions = surface.positions.iter().enumerate();
    let vertices: Vec<VertexId> = positions
        .filter(|(_, x)| (x[axis] - plane.at).abs() <= tolerance)
        .map(|(v, _)| VertexId(v as u32))
        .collect();
    match vertices.len() {
        0 => {
            let message = format!(
                "shell '{}' has no vertices on the plane {name} = {} m: it lies between {:.4} m and {:.4} m",
                plane.shell, plane.at, low[axis], high[axis]
            );
            Err(SceneError::new(Kind::EmptySelection, message).inside(&format!("{path}.at")))
        }
        count if count == surface.positions.len() => {
            let message = format!(
                "shell '{}' lies in the plane {name} = {} m",
                plane.shell, plane.at
            );
            Err(SceneError::new(Kind::Conflict, message)
                .inside(&format!("{path}.normal"))
                .with_help("a plane of symmetry cuts the shell"))
        }
        _ => Ok(vertices),
    }
}
