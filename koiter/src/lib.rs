//! Thin-shell simulation: see the README.
#![forbid(unsafe_code)]

pub mod assembly;
pub mod audit;
pub mod bezier;
pub mod burning;
pub mod contact;
pub mod energy;
pub mod geometry;
pub mod integrate;
#[cfg(feature = "io")]
pub mod io;
pub mod material;
pub mod mesh;
pub mod process;
pub mod rest;
pub mod scene;
pub mod solve;
#[cfg(feature = "testing")]
pub mod testing;

/// Version of this library.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// A point or vector in space, in metres unless said otherwise.
pub type Vec3 = nalgebra::Vector3<f64>;
