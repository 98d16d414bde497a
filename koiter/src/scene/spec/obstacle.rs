//! `[[obstacle]]`: what shells run into.

use schemars::JsonSchema;
use serde::Deserialize;

use super::default_friction;
use super::shape::{
    BoxSpec, CapsuleSpec, CylinderBodySpec, MeshSpec, PlaneSpec, RotationSpec, SphereSpec,
};
use crate::scene::schedule::MotionSpec;

/// `[[obstacle]]`: exactly one shape.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObstacleSpec {
    /// Name, unique in the scene.
    pub name: String,
    /// Half-space.
    #[serde(default)]
    pub plane: Option<PlaneSpec>,
    /// Exact ball.
    #[serde(default)]
    pub sphere: Option<SphereSpec>,
    /// Exact cylinder with round ends.
    #[serde(default)]
    pub capsule: Option<CapsuleSpec>,
    /// Box.
    #[serde(default, rename = "box")]
    pub cuboid: Option<BoxSpec>,
    /// Cylinder with flat ends, along z.
    #[serde(default)]
    pub cylinder: Option<CylinderBodySpec>,
    /// Any mesh.
    #[serde(default)]
    pub mesh: Option<MeshSpec>,
    /// Shapes that `mesh` takes one after the other, linear in time from each to the next.
    #[serde(default)]
    pub deform: Vec<DeformSpec>,
    /// In place of `deform`: positions of the vertices of `mesh` over time, from a file.
    #[serde(default)]
    pub animation: Option<AnimationSpec>,
    /// Turned by this first.
    #[serde(default)]
    pub rotate: Option<RotationSpec>,
    /// Then moved by this [m].
    #[serde(default)]
    pub translate: [f64; 3],
    /// Friction coefficient.
    #[serde(default = "default_friction")]
    pub friction: f64,
    /// Motion over time.
    #[serde(default)]
    pub motion: MotionSpec,
}

/// `[[obstacle.deform]]`: a shape of an obstacle that is a mesh.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeformSpec {
    /// When it has this shape [s]; at time 0 it has that of `mesh`.
    pub time: f64,
    /// The shape, of the same triangles in the same order.
    pub mesh: MeshSpec,
}

/// `animation` of an obstacle that is a mesh: where its vertices are over time, linear between frames, still before the first
/// and after the last. They are placed as `mesh` is.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AnimationSpec {
    /// PC2 point cache, or NPZ file with `positions` (frames, vertices, 3) and `times` [s]; relative to the scene's folder.
    pub file: String,
    /// Frames a second; without, the file must say times.
    #[serde(default)]
    pub fps: Option<f64>,
    /// Added to the times of the file [s].
    #[serde(default)]
    pub start: f64,
}
