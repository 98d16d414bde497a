//! Surfaces made from numbers: sheets, tubes, cones, balls, boxes. Lengths in metres, normals outward (or up, +z).
//!
//! Everything is centred at the origin with z as its axis; exceptions are the cone, whose base lies at
//! z = 0, the hat, which stands there, and patches of cylinders and spheres.

mod corrugated;
mod delaunay;
pub mod face_count;
mod hat;
mod inset_cap;
mod irregular;
mod patch;
mod random_sphere;
mod rectangle;
mod refinement;
mod revolution;
mod rings;
mod solids;
mod split_mix;
mod vee;

pub use corrugated::{Corrugation, corrugated_tube};
pub use delaunay::delaunay;
pub use hat::{HatSize, hat};
pub use inset_cap::inset_cap;
pub use irregular::{IRREGULAR_MIN_ANGLE_DEGREES, irregular};
pub use patch::{cylinder_panel, sphere_zone};
pub use random_sphere::random_sphere;
pub use rectangle::{GridDiagonals, grid};
pub use revolution::{cone, cylinder, disc, solid_cylinder, spherical_cap, torus};
pub use solids::{box_mesh, icosphere};
pub use vee::vee;

use super::{MeshError, Surface, SurfaceOptions};
use crate::Vec3;

/// The most faces a generator makes: with topology about 5 GB. A slip in a resolution should be an error, not an
/// exhausted memory; larger meshes can be read from a file.
pub const MAX_GENERATED_FACES: usize = 50_000_000;

/// Why a surface cannot be made from these numbers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeneratorError {
    /// A length or area that is zero, negative or not finite.
    #[error("the {what} must be a positive, finite number, but it is {value}")]
    NotPositive {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A count that is too small.
    #[error("the {what} must be at least {minimum}, but it is {value}")]
    TooFew {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: usize,
        /// Smallest value accepted.
        minimum: usize,
    },
    /// A value outside an open interval.
    #[error("the {what} must lie between {low} and {high} (exclusive), but it is {value}")]
    OutOfRange {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
    },
    /// More faces than [`MAX_GENERATED_FACES`].
    #[error(
        "this resolution means about {count:.1e} faces, more than {limit:.0e}; make it coarser"
    )]
    TooManyFaces {
        /// Number of faces asked for.
        count: f64,
        /// The limit.
        limit: f64,
    },
    /// Delaunay refinement stopped before all triangles were good.
    #[error(
        "the irregular mesh did not reach its quality: smallest angle {min_angle_degrees:.2}° \
         (wanted {wanted_degrees}°) with {faces} faces; use another seed or area"
    )]
    Quality {
        /// Smallest angle reached [°].
        min_angle_degrees: f64,
        /// Smallest angle wanted [°].
        wanted_degrees: f64,
        /// Number of faces.
        faces: usize,
    },
    /// The numbers are each fine, but together give triangles that are not (for example, far too thin).
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

fn check_positive(what: &'static str, value: f64) -> Result<(), GeneratorError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(GeneratorError::NotPositive { what, value })
    }
}

fn check_at_least(what: &'static str, value: usize, minimum: usize) -> Result<(), GeneratorError> {
    if value >= minimum {
        Ok(())
    } else {
        Err(GeneratorError::TooFew {
            what,
            value,
            minimum,
        })
    }
}

fn check_between(
    what: &'static str,
    value: f64,
    low: f64,
    high: f64,
) -> Result<(), GeneratorError> {
    if value > low && value < high {
        Ok(())
    } else {
        Err(GeneratorError::OutOfRange {
            what,
            value,
            low,
            high,
        })
    }
}

/// `count` as a float, so that the product of large resolutions does not overflow.
fn check_face_count(count: f64) -> Result<(), GeneratorError> {
    let limit = MAX_GENERATED_FACES as f64;
    if count <= limit {
        Ok(())
    } else {
        Err(GeneratorError::TooManyFaces { count, limit })
    }
}

fn build(positions: Vec<Vec3>, faces: Vec<[u32; 3]>) -> Result<Surface, GeneratorError> {
    Ok(Surface::new(positions, faces, SurfaceOptions::default())?)
}
