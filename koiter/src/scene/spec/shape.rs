//! Shapes in a scene file: meshes from files and generators, solids, and where they are put.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A mesh: exactly one of `file` and the generators, then placed.
///
/// Placed in this order: units, scale and stretch, up axis, centring, rotation, translation.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshSpec {
    /// OBJ, PLY, STL or OFF file, relative to the scene's folder.
    #[serde(default)]
    pub file: Option<String>,
    /// Rectangle of regular triangles.
    #[serde(default)]
    pub grid: Option<GridSpec>,
    /// Rectangle of irregular Delaunay triangles.
    #[serde(default)]
    pub irregular: Option<IrregularSpec>,
    /// Flat disc.
    #[serde(default)]
    pub disc: Option<DiscSpec>,
    /// Open tube along z.
    #[serde(default)]
    pub cylinder: Option<CylinderSpec>,
    /// Cone or frustum along z.
    #[serde(default)]
    pub cone: Option<ConeSpec>,
    /// Ball of nearly equal triangles.
    #[serde(default)]
    pub icosphere: Option<IcosphereSpec>,
    /// Torus about z.
    #[serde(default)]
    pub torus: Option<TorusSpec>,
    /// Part of a sphere about the +z pole.
    #[serde(default)]
    pub cap: Option<CapSpec>,
    /// Four-sided part of a cylinder about the y axis.
    #[serde(default)]
    pub panel: Option<PanelSpec>,
    /// Four-sided part of a sphere.
    #[serde(default)]
    pub zone: Option<ZoneSpec>,
    /// Sheet folded along its middle line.
    #[serde(default)]
    pub vee: Option<VeeSpec>,
    /// Crown with a brim.
    #[serde(default)]
    pub hat: Option<HatSpec>,
    /// Unit of the file's numbers.
    #[serde(default)]
    pub units: Units,
    /// Factor on all lengths.
    #[serde(default = "one")]
    pub scale: f64,
    /// Factors on lengths along x, y and z, besides: a ball becomes an ellipsoid.
    #[serde(default)]
    pub stretch: Option<[f64; 3]>,
    /// Axis of the file that points up.
    #[serde(default)]
    pub up: UpAxis,
    /// Moves the centre of the bounding box to the origin.
    #[serde(default)]
    pub center: bool,
    /// Turned by this.
    #[serde(default)]
    pub rotate: Option<RotationSpec>,
    /// Then moved by this [m].
    #[serde(default)]
    pub translate: [f64; 3],
    /// Reverses triangles where neighbours disagree, instead of refusing the mesh.
    #[serde(default)]
    pub repair_orientation: bool,
}

fn one() -> f64 {
    1.0
}

impl MeshSpec {
    /// The shape keys that are given: exactly one in a sound scene.
    pub fn given_shapes(&self) -> Vec<&'static str> {
        [
            ("file", self.file.is_some()),
            ("grid", self.grid.is_some()),
            ("irregular", self.irregular.is_some()),
            ("disc", self.disc.is_some()),
            ("cylinder", self.cylinder.is_some()),
            ("cone", self.cone.is_some()),
            ("icosphere", self.icosphere.is_some()),
            ("torus", self.torus.is_some()),
            ("cap", self.cap.is_some()),
            ("panel", self.panel.is_some()),
            ("zone", self.zone.is_some()),
            ("vee", self.vee.is_some()),
            ("hat", self.hat.is_some()),
        ]
        .into_iter()
        .filter_map(|(name, given)| given.then_some(name))
        .collect()
    }
}

/// Unit of lengths in a mesh file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[non_exhaustive]
pub enum Units {
    /// Metre.
    #[default]
    #[serde(rename = "m")]
    Metre,
    /// Centimetre.
    #[serde(rename = "cm")]
    Centimetre,
    /// Millimetre.
    #[serde(rename = "mm")]
    Millimetre,
    /// Inch.
    #[serde(rename = "in")]
    Inch,
    /// Foot.
    #[serde(rename = "ft")]
    Foot,
}

impl Units {
    /// Metres in one unit.
    pub fn in_metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 1e-2,
            Self::Millimetre => 1e-3,
            Self::Inch => 0.0254,
            Self::Foot => 0.3048,
        }
    }
}

/// Which axis of a mesh file points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum UpAxis {
    /// As many games and modellers have it.
    Y,
    /// As here.
    #[default]
    Z,
}

/// A rotation about a line.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotationSpec {
    /// Direction of the axis, of any length but 0.
    pub axis: [f64; 3],
    /// Angle [°], right-handed.
    pub degrees: f64,
    /// A point of the axis [m].
    #[serde(default)]
    pub through: [f64; 3],
}

/// Direction of the diagonals of a grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Diagonals {
    /// All the same.
    Uniform,
    /// Changing from row to row.
    Alternating,
    /// Changing from cell to cell.
    #[default]
    Checkerboard,
}

/// Rectangle of regular triangles in the plane z = 0, centred.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GridSpec {
    /// Size along x and y [m].
    pub size: [f64; 2],
    /// Cells along x and y, each of two triangles.
    pub cells: [usize; 2],
    /// Direction of the diagonals.
    #[serde(default)]
    pub diagonals: Diagonals,
}

/// Rectangle of irregular triangles in the plane z = 0, centred.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IrregularSpec {
    /// Size along x and y [m].
    pub size: [f64; 2],
    /// Largest area of a triangle [m²]; the mean is about 0.65 of it.
    pub max_area: f64,
    /// Another seed, another mesh.
    #[serde(default)]
    pub seed: u64,
}

/// Flat disc in the plane z = 0.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DiscSpec {
    /// Radius [m].
    pub radius: f64,
    /// Rings of triangles; 6 rings² triangles.
    pub rings: usize,
}

/// Open tube along z, centred.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CylinderSpec {
    /// Radius [m].
    pub radius: f64,
    /// Height [m].
    pub height: f64,
    /// Cells around.
    pub around: usize,
    /// Cells along the axis.
    pub along: usize,
    /// Waves of the radius along the axis; default: none.
    #[serde(default)]
    pub corrugation: Option<CorrugationSpec>,
}

/// Waves of the radius of a tube, from trough to trough; the tube's radius is the mean.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CorrugationSpec {
    /// Whole waves on the height; each takes at least four cells.
    pub waves: usize,
    /// From trough to crest [m].
    pub depth: f64,
}

/// Cone or frustum along z, its base at z = 0.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConeSpec {
    /// Radius at the base [m].
    pub base_radius: f64,
    /// Height [m].
    pub height: f64,
    /// Radius at the top [m]; default: a point.
    #[serde(default)]
    pub top_radius: Option<f64>,
    /// Cells around the base.
    pub around: usize,
    /// Cells along the axis.
    pub along: usize,
}

/// Ball of nearly equal triangles about the origin.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IcosphereSpec {
    /// Radius [m].
    pub radius: f64,
    /// Times the icosahedron's triangles are split in four: 20·4ⁿ triangles.
    pub subdivisions: usize,
}

/// Torus about z.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorusSpec {
    /// Radius of the circle in the tube's middle [m].
    pub major_radius: f64,
    /// Radius of the tube [m].
    pub minor_radius: f64,
    /// Cells around the axis.
    pub around: usize,
    /// Cells around the tube.
    pub tube: usize,
}

/// Part of a sphere about the +z pole, centred at the sphere's centre.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CapSpec {
    /// Radius of the sphere [m].
    pub radius: f64,
    /// Angle from the pole to the rim [°]; 90 is a hemisphere.
    pub degrees: f64,
    /// Angle from the pole to the rim of a hole [°].
    #[serde(default)]
    pub hole_degrees: Option<f64>,
    /// Width [m] of a flat band from the rim towards the axis; default: none.
    #[serde(default)]
    pub inset: Option<f64>,
    /// Rings of triangles.
    pub rings: usize,
}

/// Four-sided part of a cylinder about the y axis, from y = 0.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PanelSpec {
    /// Radius of the cylinder [m].
    pub radius: f64,
    /// Length along y [m].
    pub length: f64,
    /// First and last angle from the top, +z, towards +x [°].
    pub degrees: [f64; 2],
    /// Cells around and along, each of two triangles.
    pub cells: [usize; 2],
    /// Direction of the diagonals.
    #[serde(default)]
    pub diagonals: Diagonals,
}

/// Four-sided part of a sphere, centred at the sphere's centre.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ZoneSpec {
    /// Radius of the sphere [m].
    pub radius: f64,
    /// First and last longitude from +x towards +y [°].
    pub longitudes: [f64; 2],
    /// First and last latitude from the equator, north is +z [°].
    pub latitudes: [f64; 2],
    /// Cells around and up, each of two triangles.
    pub cells: [usize; 2],
    /// Direction of the diagonals.
    #[serde(default)]
    pub diagonals: Diagonals,
}

/// Two rectangles that meet in a crease on the x axis; it opens upwards.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VeeSpec {
    /// Length of the crease [m].
    pub length: f64,
    /// Width of each side [m].
    pub width: f64,
    /// Angle between the sides [°]; 180 would be flat.
    pub degrees: f64,
    /// Cells along the crease.
    pub along: usize,
    /// Cells across each side.
    pub across: usize,
}

/// Crown with a brim, along z; it stands on its rim at z = 0.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HatSpec {
    /// Radius of the crown at its foot [m].
    pub radius: f64,
    /// Height of the crown above its foot [m].
    pub height: f64,
    /// Width of the brim, seen from above [m].
    pub brim: f64,
    /// By how much the brim falls outwards, over its width; below 1.
    #[serde(default)]
    pub slope: f64,
    /// Cells around.
    pub around: usize,
    /// Rings of triangles from the rim to the top.
    pub rings: usize,
}

/// Half-space.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneSpec {
    /// A point of the plane [m].
    #[serde(default)]
    pub point: [f64; 3],
    /// Direction to the free side, of any length but 0.
    #[serde(default = "up")]
    pub normal: [f64; 3],
}

fn up() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

/// Ball.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereSpec {
    /// Centre [m].
    #[serde(default)]
    pub center: [f64; 3],
    /// Radius [m].
    pub radius: f64,
}

/// Cylinder with round ends.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CapsuleSpec {
    /// Ends of the axis [m].
    pub ends: [[f64; 3]; 2],
    /// Radius [m].
    pub radius: f64,
}

/// Box about the origin.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxSpec {
    /// Size along x, y and z [m].
    pub size: [f64; 3],
}

/// Cylinder with flat ends along z, about the origin.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CylinderBodySpec {
    /// Radius [m].
    pub radius: f64,
    /// Height [m].
    pub height: f64,
    /// Sides of the polygon that stands for the circle.
    #[serde(default = "default_sides")]
    pub sides: usize,
}

fn default_sides() -> usize {
    64
}
