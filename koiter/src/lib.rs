//! Thin-shell simulation: see the README.
#![forbid(unsafe_code)]

pub mod integrate;
#[cfg(feature = "io")]
pub mod io;
pub mod mesh;
pub mod scene;

/// A point or vector in space, in metres unless said otherwise.
pub type Vec3 = nalgebra::Vector3<f64>;
