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
