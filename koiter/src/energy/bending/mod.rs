//! Bending models.

mod director_clamp;
mod extra_unknowns;
mod hinge;
mod kirchhoff;
mod kirchhoff_form;
mod mid_edge;
mod profile;
mod quadratic_form;

pub use director_clamp::{ClampedEdge, DirectorClamp};
pub use extra_unknowns::ExtraUnknowns;
pub use hinge::DiscreteShellsHinge;
pub(super) use hinge::turning_angle;
pub use kirchhoff::{DiscreteKirchhoff, vertex_normals};
pub use kirchhoff_form::kirchhoff_forms;
pub use mid_edge::{
    BendingStencil, DirectorShape, MidEdgeBending, bending_stencils, curvatures, directors,
};
pub use profile::{AngleProfile, Identity, Sine, Tangent};
