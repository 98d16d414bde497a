//! A shell among the unknowns of a system: where they stand, and the shapes and forms they make.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::Vector3;

use crate::Vec3;
use crate::assembly::Dof;
use crate::energy::bending::{
    BendingStencil, DirectorShape, ExtraUnknowns, curvatures, directors, kirchhoff_forms,
};
use crate::material::Section;
use crate::mesh::TriMesh;
use crate::rest::RestFrame;

/// A shell's place among the unknowns, and what its kinematics needs.
#[derive(Clone, Debug)]
pub struct ShellPart {
    /// Name in the scene.
    pub name: String,
    /// Topology.
    pub mesh: TriMesh,
    /// First unknown of vertex 0.
    pub first_vertex: Dof,
    /// What its bending model has as unknowns beside the positions of the vertices.
    pub extra: ExtraUnknowns,
    /// The first of them.
    pub first_extra: Dof,
    /// Rest frames of the faces.
    pub frames: Vec<RestFrame>,
    /// Thickness [m].
    pub thickness: f64,
    /// What it resists with.
    pub section: Arc<dyn Section>,
    /// Rest second fundamental forms in these frames, components `11, 22, 12` [1/m].
    pub rest_forms: Vec<Vector3<f64>>,
    /// How directors depend on tilts.
    pub director_shape: DirectorShape,
    /// The unknowns of each face and its neighbours.
    pub stencils: Vec<BendingStencil>,
    /// Places among [`super::System::elastic`] of the energies of its membrane.
    pub membranes: Range<usize>,
    /// Place among [`super::System::elastic`] of the energy that compares measures of curvature with rest values, if there is one.
    pub bending: Option<usize>,
}

impl ShellPart {
    /// The unknowns of all vertices.
    pub fn vertex_dofs(&self) -> Range<usize> {
        let start = self.first_vertex.0 as usize;
        start..start + 3 * self.mesh.num_vertices()
    }

    /// The unknowns that the bending model adds.
    pub fn extra_dofs(&self) -> Range<usize> {
        let start = self.first_extra.0 as usize;
        start..start + self.extra.num_nodes(&self.mesh) * self.extra.node_size()
    }

    /// Position of a vertex.
    pub fn position(&self, vertex: usize, q: &[f64]) -> Vec3 {
        let start = self.first_vertex.0 as usize + 3 * vertex;
        Vec3::new(q[start], q[start + 1], q[start + 2])
    }

    /// Corners of a face.
    pub fn face_corners(&self, face: usize, q: &[f64]) -> [Vec3; 3] {
        self.mesh.faces()[face].map(|v| self.position(v as usize, q))
    }

    /// Directors of the edges of a face, as seen from it.
    pub fn directors(&self, face: usize, q: &[f64]) -> [Vec3; 3] {
        directors(&self.stencils[face], self.director_shape, q)
    }

    /// Largest principal Green strain of a face.
    pub fn largest_strain(&self, face: usize, q: &[f64]) -> f64 {
        let x = self.face_corners(face, q);
        let [f1, f2] = self.frames[face].deformation_gradient(&(x[1] - x[0]), &(x[2] - x[0]));
        let (a, b, c) = (f1.norm_squared(), f2.norm_squared(), f1.dot(&f2));
        0.5 * (0.5 * (a + b) + (0.25 * (a - b) * (a - b) + c * c).sqrt() - 1.0)
    }

    /// Second fundamental form of a face, or its mean over the face, in its rest frame, components `11, 22, 12` [1/m].
    pub fn second_form(&self, face: usize, q: &[f64]) -> Vector3<f64> {
        if self.extra == ExtraUnknowns::VertexDirectors {
            let first = self.first_extra.0 as usize;
            let directors = self.mesh.faces()[face].map(|v| {
                let start = first + 3 * v as usize;
                Vec3::from_column_slice(&q[start..start + 3])
            });
            let forms =
                kirchhoff_forms(&self.frames[face], &self.face_corners(face, q), &directors);
            return (forms[0] + forms[1] + forms[2]) / 3.0;
        }
        let curvature = Vector3::from(curvatures(&self.stencils[face], self.director_shape, q));
        Vector3::from(
            self.frames[face]
                .second_form_matrix()
                .map(|row| Vector3::from(row).dot(&curvature)),
        )
    }

    /// Mean curvature of a face [1/m]: half the trace of the second fundamental form in the rest metric.
    pub fn mean_curvature(&self, face: usize, q: &[f64]) -> f64 {
        let form = self.second_form(face, q);
        0.5 * (form.x + form.y)
    }
}
