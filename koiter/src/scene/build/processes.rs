//! From `[[process]]` to what it does to which edges.

use super::{Builder, vertices};
use crate::Vec3;
use crate::mesh::EdgeId;
use crate::scene::error::{SceneError, SceneErrorKind as Kind};
use crate::scene::model::{ProcessKind, RestProcess, Shell};
use crate::scene::spec::{CreaseSpec, ProcessSpec};

/// A vertex lies on a line if it is no further from it than this share of the line's length.
const ON_LINE: f64 = 1e-6;

impl Builder<'_> {
    pub(super) fn processes(&self, shells: &[Shell]) -> Result<Vec<RestProcess>, SceneError> {
        let processes = self.spec.process.iter();
        processes
            .map(|process| self.process(process, shells))
            .collect()
    }

    fn process(&self, process: &ProcessSpec, shells: &[Shell]) -> Result<RestProcess, SceneError> {
        let path = format!("process.{}", process.name);
        let shell = self.shell_index(&format!("{path}.shell"), &process.shell)?;
        // The checks let exactly one of them through, and one threshold.
        let kind = if let Some(curl) = &process.curl {
            ProcessKind::Curl {
                radius: curl.radius,
                axis: Vec3::from(curl.axis),
            }
        } else if let Some(crease) = &process.crease {
            ProcessKind::Crease {
                edges: creased(&format!("{path}.crease"), crease, &shells[shell])?,
                angle: crease.degrees.to_radians(),
            }
        } else if let Some(yielding) = &process.yielding {
            let angle = yielding.degrees.map(f64::to_radians);
            ProcessKind::Yield {
                threshold: angle.or(yielding.curvature).unwrap_or(f64::NAN),
                rate: yielding.rate.unwrap_or(f64::INFINITY),
                hardening: yielding.hardening,
            }
        } else {
            return Err(
                SceneError::new(Kind::MissingKey, "the process does nothing").inside(&path),
            );
        };
        Ok(RestProcess {
            name: process.name.clone(),
            shell,
            kind,
            scale: process.scale.clone(),
        })
    }
}

/// The inner edges of which both ends lie on the line, or are selected.
fn creased(path: &str, crease: &CreaseSpec, shell: &Shell) -> Result<Vec<EdgeId>, SceneError> {
    let mesh = &shell.surface.mesh;
    let mut chosen = vec![false; mesh.num_vertices()];
    if let Some(select) = &crease.select {
        for vertex in vertices(&format!("{path}.select"), select, shell)? {
            chosen[vertex.0 as usize] = true;
        }
    }
    if let Some(ends) = crease.line {
        let [start, end] = ends.map(Vec3::from);
        for (chosen, x) in chosen.iter_mut().zip(&shell.surface.positions) {
            *chosen = is_on_line(x, &start, &end);
        }
    }
    let is_creased = |(index, ends): &(usize, &[u32; 2])| {
        ends.iter().all(|&v| chosen[v as usize]) && !mesh.is_boundary_edge(EdgeId(*index as u32))
    };
    let edges = mesh.edges().iter().enumerate().filter(is_creased);
    let edges: Vec<EdgeId> = edges.map(|(index, _)| EdgeId(index as u32)).collect();
    if edges.is_empty() {
        let message = format!("shell '{}': no inner edge lies on the crease", shell.name);
        let key = if crease.line.is_some() {
            "line"
        } else {
            "select"
        };
        let error = SceneError::new(Kind::EmptySelection, message).inside(&format!("{path}.{key}"));
        return Err(error.with_help(
            "the mesh must have a row of edges there: choose its cells so that a side of them is on the crease",
        ));
    }
    Ok(edges)
}

fn is_on_line(x: &Vec3, start: &Vec3, end: &Vec3) -> bool {
    let along = end - start;
    let length = along.norm();
    let share = (x - start).dot(&along) / (length * length);
    let foot = start + along * share;
    (-ON_LINE..=1.0 + ON_LINE).contains(&share) && (x - foot).norm() <= ON_LINE * length
}
