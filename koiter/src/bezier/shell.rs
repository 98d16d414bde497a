//! The mesh of elements and what it weighs.

use std::sync::Arc;

use nalgebra::UnitQuaternion;

use super::element::ElementState;
use super::newton::Potential;
use super::pose::NODE_UNKNOWNS;
use super::{BezierError, Element, ElementKind, FrameRule, Pose, RestElement, Section, Tangent};
use crate::Vec3;
use crate::assembly::{
    DofLayout, HessianBuilder, NodeId, PatternBuilder, ordered_sum, parallel_map,
};
use crate::geometry::point_triangle;
use crate::mesh::{Surface, TriMesh};

/// What a shell is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellOptions {
    /// Material and thickness.
    pub section: Section,
    /// Which element.
    pub kind: ElementKind,
    /// Which frame goes with an element; that of the kind without.
    pub frame: Option<FrameRule>,
}

/// A Bézier shell: elements over a mesh. Every element keeps its own rest state, so parts can be sewn together that were
/// made apart.
#[derive(Clone, Debug)]
pub struct BezierShell {
    options: ShellOptions,
    mesh: TriMesh,
    rest: Vec<RestElement>,
    /// Shared with the shells this one was cut or sewn from.
    elements: Vec<Arc<Element>>,
    masses: Vec<f64>,
    rotational_inertias: Vec<f64>,
}

impl BezierShell {
    /// A shell whose rest shape is `surface` with the given normals at its vertices (see [`vertex_normals`]).
    ///
    /// # Errors
    /// A number of the section, the number of normals, a normal without direction, an inverted element.
    pub fn new(
        surface: &Surface,
        normals: &[Vec3],
        options: ShellOptions,
    ) -> Result<Self, BezierError> {
        let vertices = surface.mesh.num_vertices();
        if normals.len() != vertices {
            let normals = normals.len();
            return Err(BezierError::NormalCount { normals, vertices });
        }
        let lacking = |n: &Vec3| !(n.norm() > 0.0 && n.norm().is_finite());
        if let Some(vertex) = normals.iter().position(lacking) {
            return Err(BezierError::NoNormal { vertex });
        }
        let rest = (surface.mesh.faces().iter())
            .map(|face| RestElement {
                corners: face.map(|v| surface.positions[v as usize]),
                normals: face.map(|v| normals[v as usize].normalize()),
                attached: [UnitQuaternion::identity(); 3],
                section: options.section,
            })
            .collect();
        options.section.check()?;
        Self::of_elements(surface.mesh.clone(), rest, options, |_| None)
    }

    /// A shell of elements with their own rest states, one a face of `mesh`; `known` gives those that need not be made.
    ///
    /// # Errors
    /// An inverted element.
    pub(super) fn of_elements(
        mesh: TriMesh,
        rest: Vec<RestElement>,
        options: ShellOptions,
        known: impl Fn(usize) -> Option<Arc<Element>> + Sync + Send,
    ) -> Result<Self, BezierError> {
        let rule = options.frame.unwrap_or(options.kind.frame_rule());
        let made = parallel_map(rest.len(), |index| match known(index) {
            Some(element) => Ok(element),
            None => Element::new(&rest[index], options.kind, rule, index).map(Arc::new),
        });
        let elements: Vec<Arc<Element>> = made.into_iter().collect::<Result<_, _>>()?;
        let (masses, rotational_inertias) = lump(&mesh, &rest, &elements);
        Ok(Self {
            options,
            mesh,
            rest,
            elements,
            masses,
            rotational_inertias,
        })
    }

    /// What it was made of first; elements that were sewn on have sections of their own ([`RestElement::section`]).
    pub fn options(&self) -> &ShellOptions {
        &self.options
    }

    /// What is connected to what.
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// Rest states of the elements.
    pub fn rest(&self) -> &[RestElement] {
        &self.rest
    }

    /// The elements.
    pub fn elements(&self) -> &[Arc<Element>] {
        &self.elements
    }

    /// Mass of each node: a third of each of its elements [kg].
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// Resistance of each node to turning, about any axis [kg m²].
    pub fn rotational_inertias(&self) -> &[f64] {
        &self.rotational_inertias
    }

    /// Area of the rest shape [m²].
    pub fn area(&self) -> f64 {
        self.elements.iter().map(|element| element.area()).sum()
    }

    /// Mass [kg].
    pub fn mass(&self) -> f64 {
        self.masses.iter().sum()
    }

    /// The pose of the rest shape; where parts were sewn together, of one of them.
    pub fn rest_pose(&self) -> Pose {
        let mut positions = vec![Vec3::zeros(); self.mesh.num_vertices()];
        for (face, rest) in self.mesh.faces().iter().zip(&self.rest) {
            for (&v, x) in face.iter().zip(&rest.corners) {
                positions[v as usize] = *x;
            }
        }
        Pose::at(positions)
    }

    /// Where a point is on the flat triangle of its element at rest [m].
    pub fn rest_position(&self, point: &super::SurfacePoint) -> Vec3 {
        let corners = &self.rest[point.element].corners;
        (0..3).map(|c| corners[c] * point.barycentric[c]).sum()
    }

    /// The point of some elements, on their flat triangles at rest, that is nearest to a position, and how far it is [m].
    pub fn nearest(
        &self,
        x: &Vec3,
        is_meant: impl Fn(usize) -> bool,
    ) -> Option<(f64, super::SurfacePoint)> {
        let found = (0..self.elements.len())
            .filter(|e| is_meant(*e))
            .map(|element| {
                let [a, b, c] = &self.rest[element].corners;
                let closest = point_triangle(x, a, b, c);
                let barycentric = [1, 2, 3].map(|k| -closest.weights[k]);
                let point = super::SurfacePoint {
                    element,
                    barycentric,
                };
                (closest.distance_squared.sqrt(), point)
            });
        found.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// As [`Self::nearest`], where that is not farther than an edge of an element.
    ///
    /// # Errors
    /// A position that is farther.
    pub fn nearest_within_an_edge(
        &self,
        x: &Vec3,
        is_meant: impl Fn(usize) -> bool,
    ) -> Result<super::SurfacePoint, BezierError> {
        let limit = (2.0 * self.area() / self.elements.len() as f64).sqrt();
        match self.nearest(x, is_meant) {
            Some((distance, point)) if distance <= limit => Ok(point),
            found => Err(BezierError::PathFar {
                at: (*x).into(),
                distance: found.map_or(f64::INFINITY, |(distance, _)| distance),
                limit,
            }),
        }
    }

    /// Six unknowns a node.
    pub fn layout(&self) -> DofLayout {
        let mut layout = DofLayout::new();
        layout.push_nodes(self.mesh.num_vertices(), NODE_UNKNOWNS, true);
        layout
    }

    /// Positions and rotations of the corners of an element.
    pub fn corners(&self, element: usize, pose: &Pose) -> ([Vec3; 3], [UnitQuaternion<f64>; 3]) {
        let face = self.mesh.faces()[element].map(|v| v as usize);
        (
            face.map(|v| pose.positions[v]),
            face.map(|v| pose.rotations[v]),
        )
    }

    /// Elastic energy [J]; `None` if an element has collapsed.
    pub fn energy(&self, pose: &Pose) -> Option<f64> {
        let energy = ordered_sum(self.elements.len(), |index| {
            let (x, turns) = self.corners(index, pose);
            self.elements[index].energy(&x, &turns).unwrap_or(f64::NAN)
        });
        energy.is_finite().then_some(energy)
    }

    /// The element with the smallest share of its area at rest, and that share.
    pub fn most_pressed(&self, pose: &Pose) -> (usize, f64) {
        let share = |index: usize| {
            let [a, b, c] = self.corners(index, pose).0;
            0.5 * (b - a).cross(&(c - a)).norm() / self.elements[index].area()
        };
        (0..self.elements.len())
            .map(|index| (index, share(index)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .expect("a shell has elements")
    }

    /// Derivative of the elastic energy by positions [N] and rotations [N m]; collapsed elements add nothing.
    pub fn gradient(&self, pose: &Pose) -> Vec<f64> {
        let states = parallel_map(self.elements.len(), |index| {
            let (x, turns) = self.corners(index, pose);
            self.elements[index].state(&x, &turns)
        });
        let mut gradient = vec![0.0; NODE_UNKNOWNS * pose.len()];
        for (index, state) in states.iter().enumerate() {
            if let Some(state) = state {
                self.scatter(index, state, &mut gradient);
            }
        }
        gradient
    }

    /// The forces and moments by the linear theory that hold a motion of the rest shape, six numbers a node [N, N m].
    pub fn linear_forces(&self, motion: &[f64]) -> Vec<f64> {
        let rest = self.rest_pose();
        let mut forces = vec![0.0; motion.len()];
        for (index, face) in self.mesh.faces().iter().enumerate() {
            let (x, turns) = self.corners(index, &rest);
            let made = self.elements[index].derivatives(&x, &turns, Tangent::Corotated);
            let Some((_, stiffness)) = made else { continue };
            for i in 0..18 {
                for j in 0..18 {
                    let [to, from] = [i, j].map(|k| NODE_UNKNOWNS * face[k / 6] as usize + k % 6);
                    forces[to] += stiffness[(i, j)] * motion[from];
                }
            }
        }
        forces
    }

    fn scatter(&self, element: usize, state: &ElementState, gradient: &mut [f64]) {
        for (corner, &v) in self.mesh.faces()[element].iter().enumerate() {
            for k in 0..NODE_UNKNOWNS {
                gradient[NODE_UNKNOWNS * v as usize + k] += state.gradient[6 * corner + k];
            }
        }
    }
}

impl Potential for BezierShell {
    fn value(&self, pose: &Pose) -> Option<f64> {
        self.energy(pose)
    }

    fn has_energy(&self) -> bool {
        let rule = self.options.frame.unwrap_or(self.options.kind.frame_rule());
        !matches!(rule, FrameRule::Iterated { .. })
    }

    fn add_derivatives(
        &self,
        pose: &Pose,
        tangent: Tangent,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        // Evaluated in batches: the matrices of all elements at once would fall out of the cache.
        const BATCH: usize = 256;
        for first in (0..self.elements.len()).step_by(BATCH) {
            let count = BATCH.min(self.elements.len() - first);
            let made = parallel_map(count, |k| {
                let (x, turns) = self.corners(first + k, pose);
                self.elements[first + k].derivatives(&x, &turns, tangent)
            });
            for (k, made) in made.iter().enumerate() {
                let Some((state, block)) = made else { continue };
                self.scatter(first + k, state, gradient);
                let nodes = self.mesh.faces()[first + k].map(NodeId);
                for i in 0..3 {
                    for j in 0..=i {
                        hessian.add(nodes[i], nodes[j], i == j, |r, c| {
                            block[(6 * i + r, 6 * j + c)]
                        });
                    }
                }
            }
        }
    }

    fn add_to_pattern(&self, pattern: &mut PatternBuilder) {
        for face in self.mesh.faces() {
            pattern.couple(face.map(NodeId));
        }
    }

    /// Half of a way on which the normal of an element turns by more than a right angle: it may have gone through nothing.
    fn allowed(&mut self, from: &Pose, to: &Pose) -> f64 {
        let normal = |face: &[u32; 3], pose: &Pose| {
            let [a, b, c] = face.map(|v| pose.positions[v as usize]);
            (b - a).cross(&(c - a))
        };
        let turns_over = |face: &[u32; 3]| normal(face, from).dot(&normal(face, to)) < 0.0;
        match self.mesh.faces().iter().any(turns_over) {
            true => 0.5,
            false => 1.0,
        }
    }
}

/// Masses [kg] and resistances to turning [kg m²] of the nodes: a node has a third of each of its elements, and turns it as a
/// round plate of its area A about a diameter, `m (t²/12 + A/4π)`.
fn lump(mesh: &TriMesh, rest: &[RestElement], elements: &[Arc<Element>]) -> (Vec<f64>, Vec<f64>) {
    let vertices = mesh.num_vertices();
    let (mut masses, mut areas) = (vec![0.0; vertices], vec![0.0; vertices]);
    let mut inertias = vec![0.0; vertices];
    for ((face, rest), element) in mesh.faces().iter().zip(rest).zip(elements) {
        let (area, section) = (element.area() / 3.0, &rest.section);
        let mass = section.area_density() * area;
        for v in face.map(|v| v as usize) {
            masses[v] += mass;
            areas[v] += area;
            inertias[v] += mass * section.thickness.powi(2) / 12.0;
        }
    }
    for (v, inertia) in inertias.iter_mut().enumerate() {
        *inertia += masses[v] * areas[v] / (4.0 * std::f64::consts::PI);
    }
    (masses, inertias)
}
