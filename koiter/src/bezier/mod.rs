//! Bézier shells: corotational cubic triangles on nodes of six unknowns, for smooth surfaces of few elements.
//!
//! A node has a position x and a rotation R. Each of its triangles hangs two control points on it, by levers s that turn
//! with the node, and shares a third; the cubic surface through the ten control points is, with ℓ_i a polynomial in the
//! levers of corner i (`control_points`),
//!
//! ```text
//! T(ξ) = Σ_i N_i(ξ) x_i + R_i ℓ_i(ξ)
//! ```
//!
//! Strains are small in the frame that goes with an element (`frame`): its energy is `½ dᵀ K d` with the deformation d
//! of its corners in that frame, and forces are its exact derivatives (`element`). What is minimised is a sum of
//! [`Potential`]s over a [`Pose`]: it has rotations, so it is not the vector of unknowns of the other shells.
//!
//! Reference: Golembiovsky, Duriez, "Bezier Shell Finite Element for Interactive Surgical Simulation" (2012). The element
//! as printed there does not converge to the right answer; [`ElementKind`] says what was mended.

mod andes;
mod change;
mod collapse;
mod control_points;
mod cut;
mod discrete_kirchhoff;
mod dynamics;
mod element;
mod error;
mod fields;
mod frame;
mod interactive;
mod lips;
mod map;
mod mapped_contact;
mod newton;
mod normals;
mod pose;
pub mod problems;
mod rotation;
mod section;
mod shell;
mod statics;
mod stiffness;
mod surface_path;
mod suture;
mod tangent;
mod torn;

pub use change::{Change, Origin, Parent};
pub use collapse::BEGIN as COLLAPSE_BEGINS;
pub use dynamics::Dynamics;
pub use element::{Element, ElementKind, ElementState, RestElement};
pub use error::BezierError;
pub use fields::PointFields;
pub use frame::FrameRule;
pub use interactive::{Drag, Drags, FrameReport, Interaction};
pub use lips::{Lens, Lips, Patch};
pub use map::{Carried, MappedSurface, SurfacePoint};
pub use mapped_contact::{ContactOptions, ContactState, MappedContact};
pub use newton::{NewtonLimits, NewtonOutcome, Potential, Solver};
pub use normals::{smooth_normals, vertex_normals, vertex_normals_at};
pub use pose::{NODE_UNKNOWNS, Pose, Supports};
pub use section::Section;
pub use shell::{BezierShell, ShellOptions};
pub use statics::{DeadLoad, Pressure, linear_static};
pub use surface_path::{NEAR_END, PathNode, SurfacePath};
pub use suture::SeamAngle;
pub use tangent::Tangent;
