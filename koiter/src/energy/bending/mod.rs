//! Bending models.

mod corotational_edge;
mod corotational_face;
mod director_clamp;
mod discrete_shells;
mod extra_unknowns;
mod face_bending;
mod held_kirchhoff;
mod held_mid_edge;
mod hinge;
mod hinge_function;
mod kirchhoff;
mod kirchhoff_form;
mod mid_edge;
mod mid_edge_average;
mod profile;
mod quadratic_basis;
mod quadratic_form;
mod quadratic_hinge;
mod quadratic_vertex;
mod second_order_edges;
mod second_order_faces;
mod symmetry_edge;

pub use corotational_edge::CorotationalEdge;
pub use corotational_face::CorotationalFace;
pub use director_clamp::{ClampedEdge, DirectorClamp};
pub use discrete_shells::DiscreteShells;
pub use extra_unknowns::ExtraUnknowns;
pub use face_bending::{FaceBending, FaceLaw};
pub(super) use hinge::turning_angle;
pub use kirchhoff::{DiscreteKirchhoff, vertex_normals};
pub use kirchhoff_form::kirchhoff_forms;
pub use mid_edge::{
    BendingStencil, DirectorShape, MidEdgeBending, bending_stencils, curvatures, directors,
};
pub use mid_edge_average::MidEdgeAverage;
pub use profile::{AngleProfile, Identity, Sine, Tangent};
pub use quadratic_hinge::QuadraticHinge;
pub use quadratic_vertex::{LaplacianMesh, QuadraticVertex};
pub use second_order_edges::SecondOrderEdges;
pub use second_order_faces::SecondOrderFaces;
pub use symmetry_edge::{SymmetryEdge, SymmetryEdges};
