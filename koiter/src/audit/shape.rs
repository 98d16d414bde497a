//! Areas, lengths and dihedral angles of shells, relative to what they are at rest.

use super::bodies::{RestFace, Topology};
use super::{COLLAPSED, FOLDED, FrameAudit, SHARP};
use crate::Vec3;

/// The smallest of some values, and the face where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smallest {
    /// The value; infinity if there was none.
    pub value: f64,
    /// The face.
    pub face: u32,
}

impl Default for Smallest {
    fn default() -> Self {
        Self {
            value: f64::INFINITY,
            face: 0,
        }
    }
}

impl Smallest {
    /// Keeps the smaller value; the first of equal ones.
    pub fn take(&mut self, other: Self) {
        if other.value < self.value {
            *self = other;
        }
    }
}

/// Rest areas, and rest lengths of edges.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    areas: Vec<f64>,
    /// In the order of the topology's edges.
    lengths: Vec<f64>,
}

impl Shape {
    pub(super) fn new(topology: &Topology, rest: &[RestFace]) -> Self {
        let length = |vertices: [u32; 2], face: u32| {
            let opposite = |v: &u32| !vertices.contains(v);
            let corner = topology.faces[face as usize].iter().position(opposite);
            rest[face as usize].edges[corner.unwrap_or(0)]
        };
        let edges = topology.edges.iter();
        Self {
            areas: rest.iter().map(|face| face.area).collect(),
            lengths: edges
                .map(|edge| length(edge.vertices, edge.faces[0]))
                .collect(),
        }
    }

    /// The parts of an audit that are about shape.
    pub(super) fn measure(&self, topology: &Topology, x: &[Vec3]) -> FrameAudit {
        let mut found = FrameAudit::default();
        for &face in &topology.shell_faces {
            let [a, b, c] = topology.faces[face as usize].map(|v| x[v as usize]);
            let area = 0.5 * (b - a).cross(&(c - a)).norm();
            let value = area / self.areas[face as usize];
            // A face without rest area has no ratio, and is not what the run made of it.
            if value < COLLAPSED {
                found.collapsed.push(face);
            }
            found.area_ratio.take(Smallest { value, face });
        }
        for (edge, rest) in topology.edges.iter().zip(&self.lengths) {
            if !topology.is_of_shell(edge) {
                continue;
            }
            let [u, v] = edge.vertices.map(|v| x[v as usize]);
            let [first, second] = edge.faces;
            let value = (v - u).norm() / rest;
            found.edge_ratio.take(Smallest { value, face: first });
            if first == second {
                continue;
            }
            let opposite = |face: u32| {
                let corners = topology.faces[face as usize];
                let corner = corners.into_iter().find(|v| !edge.vertices.contains(v));
                x[corner.unwrap_or(corners[0]) as usize]
            };
            let value = dihedral_angle(&u, &v, &opposite(first), &opposite(second));
            if value < FOLDED {
                found.folded.push(edge.vertices);
            }
            found.sharp += usize::from(value < SHARP);
            found.dihedral_angle.take(Smallest { value, face: first });
        }
        found
    }
}

/// The angle ψ between the faces `u v a` and `u v b`, seen along `u v` [rad]: π if flat, 0 if they lie on each other.
/// NaN where a face has no height: it is collapsed, and has no direction.
fn dihedral_angle(u: &Vec3, v: &Vec3, a: &Vec3, b: &Vec3) -> f64 {
    let along = (v - u).normalize();
    let height = |p: &Vec3| (p - u) - along * along.dot(&(p - u));
    let (first, second) = (height(a), height(b));
    if first.norm() == 0.0 || second.norm() == 0.0 {
        return f64::NAN;
    }
    first.cross(&second).norm().atan2(first.dot(&second))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dihedral_angles_are_half_a_turn_when_flat_and_none_when_folded() {
        let (u, v) = (Vec3::zeros(), Vec3::x() * 2.0);
        let at = |angle: f64| Vec3::new(0.7, angle.cos(), angle.sin());
        let angle = |b: Vec3| dihedral_angle(&u, &v, &at(0.0), &b);
        for psi in [0.0, 1e-9, 0.4, 2.0, std::f64::consts::PI] {
            assert!((angle(at(psi)) - psi).abs() < 1e-15, "{psi}");
        }
        assert!(angle(Vec3::x()).is_nan());
    }
}
