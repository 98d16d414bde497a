//! Triangle meshes: what is connected to what. No positions beyond surfaces and generators.
//!
//! Conventions, used by every later module:
//! - faces are counter-clockwise; corner `c` of a face is its vertex `c`, edge `c` of a face is opposite corner `c`
//!   and runs from corner `c + 1` to corner `c + 2` (mod 3);
//! - an edge is `[u, v]` with `u < v`; its first face is the one that traverses it from `u` to `v`.

mod error;
pub mod generate;
pub mod repair;
mod surface;
mod topology;

pub use error::MeshError;
pub use surface::{
    MIN_HEIGHT_RATIO, OrientationPolicy, Surface, SurfaceOptions, UnreferencedPolicy,
};
pub use topology::{EdgeId, FaceId, TriMesh, VertexId};
