//! A shell after a change of its mesh, and how to take along what belonged to the old one.

use nalgebra::UnitQuaternion;

use super::map::SurfacePoint;
use super::pose::NODE_UNKNOWNS;
use super::{BezierShell, DeadLoad, Pose, RestElement, Supports};
use crate::Vec3;

/// Where a vertex comes from: so far from one old vertex to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Origin {
    /// The old vertices.
    pub ends: [u32; 2],
    /// 0 at the first, 1 at the second.
    pub fraction: f64,
}

impl Origin {
    /// An old vertex.
    pub fn vertex(v: u32) -> Self {
        Self {
            ends: [v, v],
            fraction: 0.0,
        }
    }

    fn between<T>(&self, values: &[T], mix: impl Fn(&T, &T, f64) -> T) -> T {
        let [a, b] = self.ends.map(|v| &values[v as usize]);
        mix(a, b, self.fraction)
    }
}

/// Where an element comes from: which old one, and the barycentric coordinates of its corners there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parent {
    /// The old element.
    pub element: usize,
    /// Of each corner.
    pub corners: [[f64; 3]; 3],
}

impl Parent {
    /// The old element itself.
    pub fn whole(element: usize) -> Self {
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Self { element, corners }
    }

    /// Whether it is all of the old element, with its corners in their order.
    pub(super) fn is_whole(&self) -> bool {
        *self == Self::whole(self.element)
    }

    /// The rest state of this part of an element: the flat part of its flat triangle, with normals in between, so that
    /// areas add up and what was at rest is at rest.
    pub(super) fn rest(&self, old: &RestElement) -> RestElement {
        let mix = |of: &[Vec3; 3], b: &[f64; 3]| -> Vec3 { (0..3).map(|c| of[c] * b[c]).sum() };
        RestElement {
            corners: self.corners.map(|b| mix(&old.corners, &b)),
            normals: self.corners.map(|b| mix(&old.normals, &b).normalize()),
            attached: self.corners.map(|b| {
                // From the corner with the largest share: rotations between corners of an element are small.
                let vectors =
                    [0, 1, 2].map(|c| (old.attached[0].inverse() * old.attached[c]).scaled_axis());
                old.attached[0] * UnitQuaternion::from_scaled_axis(mix(&vectors, &b))
            }),
            section: old.section,
        }
    }

    /// Barycentric coordinates in this part of a point of the old element.
    fn within(&self, point: &[f64; 3]) -> Option<[f64; 3]> {
        let corners = nalgebra::Matrix3::from_fn(|row, column| self.corners[column][row]);
        let inside = corners.lu().solve(&nalgebra::Vector3::from(*point))?;
        Some(inside.into())
    }
}

/// A shell after a change.
#[derive(Clone, Debug)]
pub struct Change {
    /// The new shell.
    pub shell: BezierShell,
    /// Where each of its vertices comes from.
    pub origins: Vec<Origin>,
    /// Where each of its elements comes from.
    pub parents: Vec<Parent>,
    /// Where each old vertex went; of those it became the first.
    pub present: Vec<u32>,
    /// Pairs of vertices that were one: the two lips of a cut.
    pub seam: Vec<[u32; 2]>,
}

impl Change {
    /// The pose of the new shell: strains of the elements' triangles stay as they were.
    pub fn pose(&self, old: &Pose) -> Pose {
        let rotation = |origin: &Origin| {
            origin.between(&old.rotations, |a, b, t| {
                UnitQuaternion::from_scaled_axis((b * a.inverse()).scaled_axis() * t) * a
            })
        };
        Pose {
            positions: self.positions(&old.positions),
            rotations: self.origins.iter().map(rotation).collect(),
        }
    }

    /// Velocities of the new nodes, six numbers each.
    pub fn velocities(&self, old: &[f64]) -> Vec<f64> {
        (self.origins.iter())
            .flat_map(|origin| {
                let [a, b] = origin.ends.map(|v| NODE_UNKNOWNS * v as usize);
                (0..NODE_UNKNOWNS)
                    .map(move |k| old[a + k] + (old[b + k] - old[a + k]) * origin.fraction)
            })
            .collect()
    }

    /// Loads on nodes: what was on an old vertex is on the first of the vertices it became, and adds up where vertices became
    /// one. Weight is better made anew.
    pub fn load(&self, old: &DeadLoad) -> DeadLoad {
        let mut loads = vec![0.0; NODE_UNKNOWNS * self.origins.len()];
        for (of_node, now) in old.values().chunks_exact(NODE_UNKNOWNS).zip(&self.present) {
            let first = NODE_UNKNOWNS * *now as usize;
            for (sum, load) in loads[first..first + NODE_UNKNOWNS].iter_mut().zip(of_node) {
                *sum += load;
            }
        }
        let mut load = DeadLoad::none(self.origins.len());
        load.add(&loads);
        load
    }

    /// Which of the new vertices belong to a group: what became of its vertices, and what lies between two of them.
    pub fn group(&self, old: &[bool]) -> Vec<bool> {
        let between = |origin: &Origin| origin.ends.iter().all(|v| old[*v as usize]);
        let mut group: Vec<bool> = self.origins.iter().map(between).collect();
        for (belongs, now) in old.iter().zip(&self.present) {
            group[*now as usize] |= belongs;
        }
        group
    }

    /// Positions of the new vertices, where the old ones had these [m].
    pub fn positions(&self, old: &[Vec3]) -> Vec<Vec3> {
        let position = |origin: &Origin| origin.between(old, |a, b, t| a + (b - a) * t);
        self.origins.iter().map(position).collect()
    }

    /// Supports: a new vertex on an edge is held where both of its ends are.
    pub fn supports(&self, old: &Supports) -> Supports {
        let held = (self.origins.iter())
            .flat_map(|origin| {
                let [a, b] = origin.ends.map(|v| NODE_UNKNOWNS * v as usize);
                (0..NODE_UNKNOWNS).map(move |k| old.held()[a + k] && old.held()[b + k])
            })
            .collect();
        Supports::of(held)
    }

    /// The nodes at the cut or the seam, and their neighbours.
    pub fn near(&self) -> Vec<bool> {
        let nodes = self.origins.len();
        let mut counts = vec![0; nodes];
        self.present
            .iter()
            .for_each(|now| counts[*now as usize] += 1);
        let mut at_change: Vec<bool> = counts.into_iter().map(|count| count > 1).collect();
        for v in self.seam.iter().flatten() {
            at_change[*v as usize] = true;
        }
        let mut near = vec![false; nodes];
        for face in self.shell.mesh().faces() {
            if face.iter().any(|v| at_change[*v as usize]) {
                face.iter().for_each(|v| near[*v as usize] = true);
            }
        }
        near
    }

    /// The parts of every old element, by its number.
    fn parts(&self, old_elements: usize) -> Vec<Vec<usize>> {
        let mut parts = vec![Vec::new(); old_elements];
        for (index, parent) in self.parents.iter().enumerate() {
            parts[parent.element].push(index);
        }
        parts
    }

    /// Where points of the old shell are on the new one.
    pub fn points(&self, old: &[SurfacePoint]) -> Vec<SurfacePoint> {
        let parts = self.parts(1 + self.parents.iter().map(|p| p.element).max().unwrap_or(0));
        let least = |b: &[f64; 3]| b.iter().copied().fold(f64::INFINITY, f64::min);
        (old.iter())
            .map(|point| {
                let inside = parts[point.element].iter().filter_map(|&element| {
                    let barycentric = self.parents[element].within(&point.barycentric)?;
                    Some(SurfacePoint {
                        element,
                        barycentric,
                    })
                });
                // Round-off puts points of a common edge outside of all parts by some 1e-16.
                inside
                    .max_by(|a, b| least(&a.barycentric).total_cmp(&least(&b.barycentric)))
                    .expect("every old element has parts")
            })
            .collect()
    }

    /// For every element, at which lip of the cut it is: false left of the path, true right of it.
    pub(super) fn sides(&self) -> Vec<Option<bool>> {
        let mut lip = vec![None; self.shell.mesh().num_vertices()];
        for [left, right] in &self.seam {
            lip[*left as usize] = Some(false);
            lip[*right as usize] = Some(true);
        }
        (self.shell.mesh().faces().iter())
            .map(|face| face.iter().find_map(|v| lip[*v as usize]))
            .collect()
    }
}
