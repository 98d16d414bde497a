//! Parts of shells that no constraint holds: they have no static equilibrium, or more than one.

use std::fmt;

use super::model::{Model, Phase};
use crate::mesh::VertexId;

/// A connected part of a shell that can be moved along an axis without being deformed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FreePart {
    /// Name of the shell.
    pub shell: String,
    /// The first vertex of the part, where the shell has several.
    pub vertex: Option<VertexId>,
    /// Along which of x, y, z.
    pub axes: [bool; 3],
}

impl fmt::Display for FreePart {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if let Some(vertex) = self.vertex {
            write!(f, "the part with vertex {} of ", vertex.0)?;
        }
        let axes: Vec<&str> = (0..3)
            .filter(|&axis| self.axes[axis])
            .map(|axis| ["x", "y", "z"][axis])
            .collect();
        write!(f, "shell '{}' along {}", self.shell, axes.join(", "))
    }
}

impl Model {
    /// The parts of shells that are free to move in the first static phase; contact may hold them all the same.
    pub fn free_parts(&self) -> Vec<FreePart> {
        let phases = self.all_phases();
        let Some(phase) = phases.iter().find(|phase| !phase.integrator.is_dynamic()) else {
            return Vec::new();
        };
        (0..self.shells.len())
            .flat_map(|shell| self.free_parts_of(shell, phase))
            .collect()
    }

    fn free_parts_of(&self, shell: usize, phase: &Phase) -> Vec<FreePart> {
        let mesh = &self.shells[shell].surface.mesh;
        let (count, part_of_vertex) = mesh.components();
        let mut axes = vec![[true; 3]; count];
        let constraints = self.constraints.iter().zip(&phase.constraints);
        for (constraint, _) in constraints.filter(|(c, holds)| c.shell == shell && **holds) {
            for vertex in &constraint.vertices {
                let part = part_of_vertex[vertex.0 as usize] as usize;
                for (free, held) in axes[part].iter_mut().zip(constraint.axes) {
                    *free &= !held;
                }
            }
        }
        for plane in self.symmetry_planes.iter().filter(|p| p.shell == shell) {
            for vertex in &plane.vertices {
                axes[part_of_vertex[vertex.0 as usize] as usize][plane.axis] = false;
            }
        }
        let first = |part: usize| part_of_vertex.iter().position(|&p| p as usize == part);
        (0..count)
            .filter(|&part| axes[part].contains(&true))
            .map(|part| FreePart {
                shell: self.shells[shell].name.clone(),
                vertex: first(part)
                    .filter(|_| count > 1)
                    .map(|vertex| VertexId(vertex as u32)),
                axes: axes[part],
            })
            .collect()
    }

    /// Whether there is anything that a shell could rest on.
    pub(super) fn has_supports(&self) -> bool {
        self.contact.enabled && (self.shells.len() > 1 || !self.obstacles.is_empty())
    }
}
