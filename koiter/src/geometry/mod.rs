//! Formulas on a few points, with first and second derivatives.
//!
//! Sign and index conventions, once for the whole library (pinned by `tests/conventions.rs`):
//! - faces are counter-clockwise; the normal of face `(i, j, k)` is `(x_j − x_i) × (x_k − x_i)`, normalised;
//! - corner `c` of a face is opposite edge `c`, which runs from corner `c + 1` to corner `c + 2` (mod 3);
//! - the hinge angle θ of an edge is the signed turning angle of the normals: 0 when flat, positive where the normals
//!   fan out (a sphere with outward normals), in (−π, π); 0 on boundary edges;
//! - the sign ε of an edge in a face is +1 if the face traverses it from the smaller to the larger vertex index;
//! - the tilt of the director of an edge, seen from a face, is ζ = θ/2 + ε α with the edge angle α.

mod closest;
mod crossing;
mod dual;
mod jet;
mod log_barrier;
pub mod over_numbers;
mod rigid_fit;
mod wing;

pub use closest::{
    ClosestPoints, edge_edge, edge_edge_distance_squared, point_edge, point_edge_distance_squared,
    point_triangle, point_triangle_distance_squared,
};
pub use crossing::segment_meets_triangle;
pub use dual::Dual;
pub use jet::{Jet, Real};
pub use log_barrier::{log_barrier, log_barrier_slope_quotient};
pub use rigid_fit::rigid_misfit;
pub use wing::{Wing, WingFunctional, hinge_angle};
