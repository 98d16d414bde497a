//! Burning cloth and paper: double layers of springs that heat, lose mass, shrink, wrinkle and burn through.
//!
//! A [`BurningShell`] is stepped by projections onto lengths of springs and not by the minimisation of an energy: it shares
//! nothing with the elastic shells of this library but positions and bodies. A [`HeatedShell`] is the same heat and the same fire on
//! any triangle mesh, whose elastic shell does the shrinking and the moving. A step of a double layer is, in this order:
//!
//! | what | where |
//! | --- | --- |
//! | sources, cooling, conduction | [`HeatSource`], [`Conduction`] |
//! | mass loss, target lengths | [`BurningOptions`] |
//! | the surface that is left, springs and pieces | [`RenderSurface`], [`Remaining`] |
//! | motion, projections, bodies, itself | [`BurningShell`], [`Projection`], [`Collider`], [`SelfCollisionOptions`] |
//!
//! Paper: "Shrinkage, wrinkling and ablation of burning cloth and paper". Where its printed formulas cannot be meant
//! (signs, missing factors), the files say what stands in their place.

mod ablation;
mod collision_surface;
mod collisions;
mod diffusion;
mod double_layer;
mod error;
mod global_solve;
mod heat;
mod heated_shell;
mod mass;
mod mass_spring;
mod measures;
mod network;
mod numbers;
mod projection;
mod quad_mesh;
mod self_collision;
mod setup;
mod springs;
mod state;
mod stepper;
mod surface;
mod texture;
mod triangle_conduction;

pub use ablation::Remaining;
pub use collisions::{Collider, ColliderShape};
pub use double_layer::{COLORS, Color, DoubleLayer};
pub use error::{BurningError, QuadMeshError, TextureError};
pub use global_solve::{GlobalLimits, GlobalSolve};
pub use heat::{Conduction, DIMENSION_FACTOR, HeatSource, Side};
pub use heated_shell::{HeatedMeasures, HeatedSetup, HeatedShell, HeatedState};
pub use mass::BurningOptions;
pub use measures::BurningMeasures;
pub use network::{Errors, Mobility, Network, StepLimits};
pub use projection::{Lengths, Projection, ProjectionMethod, ProjectionOptions, ProjectionReport};
pub use quad_mesh::{MAX_VALENCE, QuadEdge, QuadMesh, QuadSide};
pub use self_collision::SelfCollisionOptions;
pub use setup::{BurningSetup, Surroundings};
pub use springs::Springs;
pub use state::BurningState;
pub use stepper::{BurningReport, BurningShell};
pub use surface::{Between, RenderSurface};
pub use texture::Texture;
pub use triangle_conduction::TriangleConduction;
