//! Bending energies of a shell whose model has no unknowns beside positions, of vertices or of points on edges.

use super::assemble::write_points;
use super::elastic::rest_surface;
use super::model::Shell;
use crate::assembly::{Assembled, Differentiated, DofLayout, Energy};
use crate::energy::bending::{
    AngleProfile, CorotationalEdge, CorotationalFace, DiscreteShells, FaceBending, HingeSprings,
    HingeStrains, LaplacianMesh, MidEdgeAverage, QuadraticHinge, QuadraticVertex, SecondOrderEdges,
    SecondOrderFaces, VertexStrains,
};
use crate::integrate::ShellPart;
use crate::mesh::Surface;

/// What these models are made of.
pub(super) struct PositionBending<'a> {
    part: &'a ShellPart,
    layout: &'a DofLayout,
    rest: Surface,
    /// Whether the rest shape is curved.
    curved: bool,
    hinges: HingeSprings,
    /// C of every face [N·m].
    rigidity: Vec<f64>,
}

impl<'a> PositionBending<'a> {
    pub(super) fn new(shell: &Shell, part: &'a ShellPart, layout: &'a DofLayout) -> Self {
        let num_faces = part.mesh.num_faces();
        Self {
            part,
            layout,
            rest: rest_surface(shell),
            curved: shell.rest_curved,
            hinges: shell.composition.hinges,
            rigidity: (0..num_faces)
                .map(|face| part.section.flexural_rigidity(face))
                .collect(),
        }
    }

    pub(super) fn discrete_shells<P: AngleProfile + 'static>(&self) -> Box<dyn Energy> {
        let (first, frames) = (self.part.first_vertex, &self.part.frames);
        let (curved, rigidity) = (self.curved, &self.rigidity);
        let hinges = DiscreteShells::<P>::with_springs(
            &self.rest,
            first,
            frames,
            curved,
            rigidity,
            self.hinges,
        );
        Box::new(Assembled::new(hinges, self.layout))
    }

    pub(super) fn corotational_edge(&self) -> Box<dyn Energy> {
        let (first, frames) = (self.part.first_vertex, &self.part.frames);
        let edges = CorotationalEdge::new(&self.rest, first, frames, self.curved, &self.rigidity);
        Box::new(Assembled::new(edges, self.layout))
    }

    pub(super) fn corotational_face(&self) -> Box<dyn Energy> {
        let (stencils, frames) = (self.part.stencils.clone(), &self.part.frames);
        let faces = FaceBending::<CorotationalFace>::new(
            &self.rest,
            stencils,
            frames,
            self.curved,
            &self.rigidity,
        );
        Box::new(Assembled::new(faces, self.layout))
    }

    /// Patches, and what is between them.
    fn patches(&self) -> (SecondOrderFaces, SecondOrderEdges) {
        let (part, rigidity) = (self.part, &self.rigidity);
        let (first, points, frames) = (part.first_vertex, part.first_extra, &part.frames);
        let edges = SecondOrderEdges::new(&self.rest, first, points, frames, rigidity);
        let (frames, rigidity) = (frames.clone(), rigidity.clone());
        let faces = SecondOrderFaces::new(&part.mesh, first, points, frames, rigidity);
        (faces, edges)
    }

    pub(super) fn second_order(&self) -> Vec<Box<dyn Energy>> {
        let (faces, edges) = self.patches();
        vec![
            Box::new(Assembled::new(faces, self.layout)),
            Box::new(Assembled::new(edges, self.layout)),
        ]
    }

    /// The strains of [`Self::second_order`], without what keeps patches from degenerating.
    pub(super) fn second_order_strains(&self) -> Vec<Box<dyn Energy>> {
        let (faces, edges) = self.patches();
        vec![
            Box::new(Assembled::new(faces, self.layout)),
            Box::new(Assembled::new(edges.with_area_stiffness(0.0), self.layout)),
        ]
    }

    fn hinge_model(&self) -> QuadraticHinge {
        let (first, frames) = (self.part.first_vertex, &self.part.frames);
        QuadraticHinge::new(&self.rest, first, frames, &self.rigidity)
    }

    pub(super) fn quadratic_hinge(&self) -> Box<dyn Energy> {
        Box::new(Assembled::new(self.hinge_model(), self.layout))
    }

    /// The strains of [`Self::quadratic_hinge`].
    pub(super) fn quadratic_hinge_strains(&self) -> Box<dyn Energy> {
        let strains = Differentiated(HingeStrains::new(self.hinge_model()));
        Box::new(Assembled::new(strains, self.layout))
    }

    fn vertex_model(&self, laplacian: LaplacianMesh) -> QuadraticVertex {
        let (first, frames) = (self.part.first_vertex, &self.part.frames);
        let (layout, rigidity) = (self.layout, &self.rigidity);
        QuadraticVertex::new(&self.rest, first, layout, frames, rigidity, laplacian)
    }

    pub(super) fn quadratic_vertex(&self, laplacian: LaplacianMesh) -> Box<dyn Energy> {
        Box::new(self.vertex_model(laplacian))
    }

    /// The strains of [`Self::quadratic_vertex`].
    pub(super) fn quadratic_vertex_strains(&self, laplacian: LaplacianMesh) -> Box<dyn Energy> {
        Box::new(VertexStrains::new(
            self.vertex_model(laplacian),
            &self.part.mesh,
        ))
    }

    pub(super) fn mid_edge_average(&self) -> Box<dyn Energy> {
        let num_faces = self.part.mesh.num_faces();
        let (stencils, frames) = (self.part.stencils.clone(), self.part.frames.clone());
        let forms = self.part.rest_forms.clone();
        let section = self.part.section.clone();
        let faces = FaceBending::<MidEdgeAverage<_>>::new(stencils, frames, forms, section);
        let mut faces = Assembled::new(faces, self.layout);
        if self.curved {
            let mut q = vec![0.0; self.layout.num_dofs()];
            write_points(&mut q, self.part.first_vertex, &self.rest.positions);
            let form = |face: usize| {
                let of_shape = faces.local().second_form(face, &faces.gather(face, &q));
                of_shape + self.part.rest_forms[face]
            };
            let forms = (0..num_faces).map(form).collect();
            faces.local_mut().set_rest_forms(forms);
        }
        Box::new(faces)
    }
}
