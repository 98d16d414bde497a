//! From what was typed to a running simulation: `SceneSpec` → `Scene` → `Model` → `Simulation`.
//!
//! [`SceneFile::parse`] reads TOML text into a [`SceneSpec`]; [`Scene::build`] reads the meshes through a
//! [`MeshSource`], resolves selections and gives a checked [`model::Model`]. A mistake is a [`SceneError`] with a
//! message, a dotted path, a place in the text and a help.

mod arc_length;
mod assemble;
mod bending_caveats;
mod bending_models;
mod bezier;
mod burning;
mod clamps;
mod composition;
mod composition_error;
mod display;
mod elastic;
mod expressions;
mod fields;
mod fingerprint;
mod free_parts;
mod heated;
mod holds;
mod loads;
mod material_models;
pub mod measure;
pub mod model;
mod modes;
mod obstacles;
mod outside;
mod phases;
mod point_cache;
mod position_bending;
mod pulled;
pub mod schedule;
mod simulation;
mod sizes;
mod snapshot;
mod step_control;
mod symmetry;
mod totals;
mod turned;
mod vertex_directors;

#[cfg(feature = "serde")]
mod build;
mod damping;
#[cfg(feature = "serde")]
mod decode;
#[cfg(feature = "serde")]
mod document;
#[cfg(feature = "serde")]
mod error;
#[cfg(feature = "serde")]
mod face_file;
mod membrane_models;
#[cfg(feature = "serde")]
mod memory;
#[cfg(feature = "serde")]
mod nearest;
#[cfg(feature = "serde")]
mod placement;
#[cfg(feature = "serde")]
mod probe;
mod processes;
#[cfg(feature = "serde")]
mod schema;
#[cfg(feature = "serde")]
mod selection;
#[cfg(feature = "serde")]
pub mod spec;
#[cfg(feature = "serde")]
mod warnings;

pub use self::{
    arc_length::ArcLengthError,
    assemble::BuildError,
    bending_models::BendingModelInfo,
    bezier::BezierState,
    composition_error::CompositionError,
    display::PartTopology,
    free_parts::FreePart,
    holds::Anchor,
    loads::LoadTotal,
    material_models::MaterialModelInfo,
    outside::ChangeError,
    phases::{PhaseSteps, Timeline},
    point_cache::PointCache,
    pulled::{PullError, VertexPull},
    simulation::Simulation,
    sizes::SystemStats,
    snapshot::{RestoreError, Snapshot},
};
#[cfg(feature = "serde")]
pub use self::{
    build::Scene,
    document::{Difference, Document},
    error::{Location, SceneError, SceneErrorKind, Source, Warning},
    memory::readable_bytes,
    nearest::nearest,
    placement::{MeshSource, NoFiles, UnreadableMesh},
    probe::{Observable, Probe, ProbeTarget},
    schema::json_schema,
    selection::{SelectionError, select},
    spec::{KEYS_OF_NO_STEP, SceneFile, SceneSpec},
};
