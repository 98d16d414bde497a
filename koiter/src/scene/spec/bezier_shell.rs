//! `[[bezier_shell]]`: smooth shells of few elements that can be cut and sewn.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{MaterialSpec, MeshSpec, RestSpec, SceneSpec, ShellSpec, default_friction, no_stretch};
use crate::bezier::ElementKind;
use crate::scene::membrane_models::MembraneModel;
use crate::scene::model::BendingModel;

/// `[[bezier_shell]]`: a shell of corotational cubic triangles on nodes of six unknowns, in place of elastic shells.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BezierShellSpec {
    /// Name, unique in the scene.
    pub name: String,
    /// Start shape, without stress, curved as its normals say: one element a triangle.
    pub mesh: MeshSpec,
    /// Which element; the same for all Bézier shells of a scene.
    #[serde(default)]
    pub element: ElementKind,
    /// Material, isotropic: a preset, numbers, or a preset with some numbers replaced.
    #[serde(default)]
    #[schemars(schema_with = "crate::scene::schema::material")]
    pub material: MaterialSpec,
    /// Thickness [m]; default: the preset's.
    #[serde(default)]
    pub thickness: Option<f64>,
    /// Rate at which motion dies down [1/s]; the same for all Bézier shells of a scene.
    #[serde(default)]
    pub damping: f64,
    /// Start velocity of all nodes [m/s].
    #[serde(default)]
    pub velocity: [f64; 3],
    /// The fine surface that the shell carries, for contact and for pictures.
    #[serde(default)]
    pub surface: FineSurfaceSpec,
    /// Friction coefficient.
    #[serde(default = "default_friction")]
    pub friction: f64,
    /// Distance [m] at which two midsurfaces touch, as if the shell were this thick; default 0.
    #[serde(default)]
    pub contact_thickness: f64,
}

/// `[bezier_shell.surface]`: the elements divided, or a mesh that is bound to the shell where it is closest.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FineSurfaceSpec {
    /// Every element becomes so many triangles squared; the same for all Bézier shells of a scene.
    pub subdivide: usize,
    /// A mesh in place of that.
    pub mesh: Option<MeshSpec>,
    /// How far a vertex of the mesh may be from the elements [m]; default: the mean edge of the shell.
    pub reach: Option<f64>,
}

impl Default for FineSurfaceSpec {
    fn default() -> Self {
        Self {
            subdivide: 3,
            mesh: None,
            reach: None,
        }
    }
}

impl BezierShellSpec {
    /// What it has in common with other shells: mesh, material, thickness, contact.
    pub(in crate::scene) fn as_shell(&self) -> ShellSpec {
        ShellSpec {
            name: self.name.clone(),
            mesh: self.mesh.clone(),
            material: self.material.clone(),
            thickness: self.thickness,
            bending: BendingModel::default(),
            membrane: MembraneModel::default(),
            discrete_shells: None,
            damping: None,
            rest: RestSpec::Mesh,
            rest_mesh: None,
            rest_stretch: no_stretch(),
            rest_curvature: [0.0; 2],
            faces: None,
            burning: None,
            temperature: None,
            strain_limit: None,
            velocity: self.velocity,
            friction: self.friction,
            contact_thickness: self.contact_thickness,
        }
    }
}

impl SceneSpec {
    /// Names of the shells that constraints, loads and probes may be on, in their order.
    pub(in crate::scene) fn shell_names(&self) -> Vec<&str> {
        let shells = self.shell.iter().map(|shell| shell.name.as_str());
        let bezier = self.bezier_shell.iter().map(|shell| shell.name.as_str());
        shells.chain(bezier).collect()
    }
}
