//! `[[double_layer]]`, `[shell.burning]` and `[[heat_source]]`: cloth and paper that burn.

use schemars::JsonSchema;
use serde::Deserialize;

use super::shape::{RotationSpec, SphereSpec, TorusSpec};
use crate::burning::{ProjectionMethod, Side};
use crate::scene::schedule::MotionSpec;

/// `[[double_layer]]`: a shell of two layers of springs on a mesh of quads, which heats, shrinks and burns.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DoubleLayerSpec {
    /// Name, unique in the scene.
    pub name: String,
    /// Start shape, without stress.
    pub mesh: QuadMeshSpec,
    /// Distance of the layers [m].
    pub thickness: f64,
    /// Mass of a square metre [kg/m²].
    pub area_density: f64,
    /// Temperature at the start [K].
    #[serde(default = "room_temperature")]
    pub temperature: f64,
    /// Rate at which motion dies down in the air [1/s].
    #[serde(default)]
    pub damping: f64,
    /// Heat, mass loss and shrinkage.
    #[serde(default)]
    pub burning: BurningSpec,
    /// How the springs keep their lengths.
    #[serde(default)]
    pub projection: ProjectionSpec,
    /// How it keeps out of itself; default: it may pass through itself.
    #[serde(default)]
    pub self_collision: Option<SelfCollisionSpec>,
}

/// `[double_layer.self_collision]`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SelfCollisionSpec {
    /// How far apart the surface is kept from itself [m], or half the height of its triangles where that is less; default: the
    /// thickness.
    #[serde(default)]
    pub distance: Option<f64>,
    /// Share of the motion along each other that touching parts lose in a step, 0 to 1.
    #[serde(default)]
    pub friction: f64,
}

/// A mesh of quads: exactly one of `file`, `grid` and `torus`, then scaled, turned and moved.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct QuadMeshSpec {
    /// OBJ file of faces with four corners, relative to the scene's folder.
    #[serde(default)]
    pub file: Option<String>,
    /// Rectangle in the plane z = 0, centred.
    #[serde(default)]
    pub grid: Option<QuadGridSpec>,
    /// Torus about z.
    #[serde(default)]
    pub torus: Option<TorusSpec>,
    /// Factor on all lengths.
    #[serde(default = "one")]
    pub scale: f64,
    /// Turned by this.
    #[serde(default)]
    pub rotate: Option<RotationSpec>,
    /// Then moved by this [m].
    #[serde(default)]
    pub translate: [f64; 3],
}

impl QuadMeshSpec {
    /// The shape keys that are given: exactly one in a sound scene.
    pub fn given_shapes(&self) -> Vec<&'static str> {
        [
            ("file", self.file.is_some()),
            ("grid", self.grid.is_some()),
            ("torus", self.torus.is_some()),
        ]
        .into_iter()
        .filter_map(|(name, given)| given.then_some(name))
        .collect()
    }
}

/// Rectangle of quads.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct QuadGridSpec {
    /// Size along x and y [m].
    pub size: [f64; 2],
    /// Quads along x and y.
    pub cells: [usize; 2],
}

/// `[double_layer.burning]` and `[shell.burning]`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BurningSpec {
    /// Temperature of the air [K].
    pub ambient_temperature: f64,
    /// Rate at which the shell takes on the temperature of the air [1/s].
    pub cooling_rate: f64,
    /// Thermal diffusivity [m²/s]. That of paper is 1e-7, which spreads heat by half a millimetre in a second.
    pub diffusivity: f64,
    /// Temperature above which mass is lost [K].
    pub ignition_temperature: f64,
    /// Share of the initial mass that is lost in a second for each kelvin above ignition [1/(K s)].
    pub loss_rate: f64,
    /// Rise in temperature that burning the whole mass brings [K].
    pub heat_of_combustion: f64,
    /// Share of the initial mass at which a place disappears; at or below `smallest_mass`: it only shrinks.
    pub loss_level: f64,
    /// Share of the initial mass that does not burn.
    pub smallest_mass: f64,
    /// Lengths shrink by the mean mass ratio to this power: 1 by as much as the mass, 1/3 alike in all directions, 0 not.
    pub shrinkage_exponent: f64,
    /// Most by which a mass ratio changes before the shell is moved: larger steps are taken in parts.
    pub largest_change: f64,
    /// Shells: rate at which top and bottom layer take on each other's temperature [1/s]; default: `π² α / (2 h²)`, with
    /// diffusivity α and thickness h.
    pub exchange_rate: Option<f64>,
    /// Shells: tensile strength [Pa], which falls with the mass: where the largest principal stress is above it, faces tear;
    /// default: none do.
    pub strength: Option<f64>,
    /// PNG file whose brightness scales `loss_rate`, laid on by the texture coordinates of the mesh; on a shell over the two
    /// longest sides of the box around its start shape.
    pub loss_texture: Option<String>,
    /// PNG file whose brightness scales `diffusivity`.
    pub diffusivity_texture: Option<String>,
}

impl Default for BurningSpec {
    fn default() -> Self {
        let options = crate::burning::BurningOptions::default();
        Self {
            ambient_temperature: room_temperature(),
            cooling_rate: 2.0,
            diffusivity: 1e-7,
            ignition_temperature: options.ignition_temperature,
            loss_rate: options.loss_rate,
            heat_of_combustion: options.heat_of_combustion,
            loss_level: options.loss_level,
            smallest_mass: options.smallest_mass,
            shrinkage_exponent: options.shrinkage_exponent,
            largest_change: options.largest_change,
            exchange_rate: None,
            strength: None,
            loss_texture: None,
            diffusivity_texture: None,
        }
    }
}

/// `[double_layer.projection]`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ProjectionSpec {
    /// Colour after colour, all springs at once, or springs by Hooke's law.
    pub method: ProjectionMethod,
    /// Compliance of a spring in the global method [m/N].
    pub compliance: f64,
    /// Stiffness of a spring of the method of masses and springs [N/m].
    pub stiffness: f64,
    /// Most sweeps over all springs in a step, or iterations of the global method.
    pub sweeps: usize,
    /// Sweeps end when every spring has its length up to this share.
    pub tolerance: f64,
    /// Most iterations of conjugate gradients for the springs of one colour.
    pub iterations: usize,
    /// No particle is moved further at once than this share of the mean length of springs.
    pub longest_move: f64,
    /// Weights of the red, green, blue and yellow springs, above 0 and at most 1: smaller is softer.
    pub weights: [f64; 4],
}

impl Default for ProjectionSpec {
    fn default() -> Self {
        let options = crate::burning::ProjectionOptions::default();
        Self {
            method: options.method,
            compliance: options.compliance,
            stiffness: options.stiffness,
            sweeps: options.sweeps,
            tolerance: options.tolerance,
            iterations: options.gradient_iterations,
            longest_move: options.longest_move,
            weights: options.weights,
        }
    }
}

/// `[[heat_source]]`: a hot ball that may move, or heat everywhere, after a texture.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeatSourceSpec {
    /// Name, unique in the scene.
    pub name: String,
    /// Where it heats; default: everywhere.
    #[serde(default)]
    pub sphere: Option<SphereSpec>,
    /// Motion of the sphere over time.
    #[serde(default)]
    pub motion: MotionSpec,
    /// Temperature [K].
    pub temperature: f64,
    /// Rate at which the shell takes it on [1/s].
    pub rate: f64,
    /// Which layers it heats: both, the top one, where normals point, or the bottom one.
    #[serde(default)]
    pub side: Side,
    /// PNG file whose brightness scales `rate`, laid on by the texture coordinates of the mesh.
    #[serde(default)]
    pub texture: Option<String>,
}

/// 20 °C [K].
pub(in crate::scene) const ROOM_TEMPERATURE: f64 = 293.0;

fn room_temperature() -> f64 {
    ROOM_TEMPERATURE
}

fn one() -> f64 {
    1.0
}
