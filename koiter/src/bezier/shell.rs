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
            None => Element::new(&rest[index], options.kind, rule, &options.section, index)
                .map(Arc::new),
        });
        let elements: Vec<Arc<Element>> = made.into_iter().collect::<Result<_, _>>()?;
        let mut masses = vec![0.0; mesh.num_vertices()];
        for (face, element) in mesh.faces().iter().zip(&elements) {
            for &v in face {
                masses[v as usize] += options.section.area_density() * element.area() / 3.0;
            }
        }
        let mut shell = Self {
            options,
            mesh,
            rest,
            elements,
            masses,
            rotational_inertias: Vec::new(),
        };
        shell.rotational_inertias = shell.lump_rotational_inertia();
        Ok(shell)
    }

    /// A node turns its share of the surface, as a round plate of its area A about a diameter: `m (t²/12 + A/4π)` [kg m²].
    fn lump_rotational_inertia(&self) -> Vec<f64> {
        let section = &self.options.section;
        (self.masses.iter())
            .map(|mass| {
                let area = mass / section.area_density();
                let round = area / (4.0 * std::f64::consts::PI);
                mass * (section.thickness.powi(2) / 12.0 + round)
            })
            .collect()
    }

    /// What it is made of.
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
        self.options.section.area_density() * self.area()
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
}

/// Normals at the vertices: of their faces, weighted by the angles there.
pub fn vertex_normals(surface: &Surface) -> Vec<Vec3> {
    let mut normals = vec![Vec3::zeros(); surface.mesh.num_vertices()];
    for (index, face) in surface.mesh.faces().iter().enumerate() {
        let x = surface.corners(index);
        for c in 0..3 {
            let (a, b) = (x[(c + 1) % 3] - x[c], x[(c + 2) % 3] - x[c]);
            let cross = a.cross(&b);
            let angle = cross.norm().atan2(a.dot(&b));
            normals[face[c] as usize] += cross.normalize() * angle;
        }
    }
    normals.iter().map(|n| n.normalize()).collect()
}
