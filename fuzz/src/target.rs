//! The readers, each as a function from bytes to whether they were taken as good.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use koiter::Vec3;
use koiter::energy::expression::{ElementKind, Names};
use koiter::io::crc32;
use koiter::io::read::{MeshFormat, parse_obj_quads, parse_png, parse_point_cache};
use koiter::io::result::{Checkpoint, Frame, Manifest, decode_stats, decode_topology};
use koiter::mesh::{OrientationPolicy, Surface, SurfaceOptions, UnreferencedPolicy};
use koiter::scene::{MeshSource, PointCache, Scene, SceneFile, UnreadableMesh};

/// A reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Wavefront OBJ, to a checked surface.
    Obj,
    /// Stanford PLY, to a checked surface.
    Ply,
    /// STL, to a checked surface.
    Stl,
    /// OFF, to a checked surface.
    Off,
    /// Quads of an OBJ file, to a checked mesh.
    Quads,
    /// PNG, to a texture.
    Texture,
    /// PC2 or NPZ, to positions over time.
    Points,
    /// A scene, to a checked model. Lines that begin with `#set ` are overrides.
    Scene,
    /// The text of an energy, parsed.
    Expression,
    /// `manifest.json` of a result.
    Manifest,
    /// `topology.bin` of a result.
    Topology,
    /// A frame of a result.
    Frame,
    /// `stats.jsonl` of a result.
    Stats,
    /// `checkpoint.bin` of a result.
    Checkpoint,
}

impl Target {
    /// All readers.
    pub const ALL: [Self; 14] = [
        Self::Obj,
        Self::Ply,
        Self::Stl,
        Self::Off,
        Self::Quads,
        Self::Texture,
        Self::Points,
        Self::Scene,
        Self::Expression,
        Self::Manifest,
        Self::Topology,
        Self::Frame,
        Self::Stats,
        Self::Checkpoint,
    ];

    /// What it is called on the command line; its corpus is in the folder of this name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::Off => "off",
            Self::Quads => "quads",
            Self::Texture => "texture",
            Self::Points => "points",
            Self::Scene => "scene",
            Self::Expression => "expression",
            Self::Manifest => "manifest",
            Self::Topology => "topology",
            Self::Frame => "frame",
            Self::Stats => "stats",
            Self::Checkpoint => "checkpoint",
        }
    }

    /// Hands bytes to the reader; whether it took them as good.
    ///
    /// # Panics
    /// Never, if the reader is right.
    pub fn read(self, bytes: &[u8]) -> bool {
        match self {
            Self::Obj => read_mesh(MeshFormat::Obj, bytes),
            Self::Ply => read_mesh(MeshFormat::Ply, bytes),
            Self::Stl => read_mesh(MeshFormat::Stl, bytes),
            Self::Off => read_mesh(MeshFormat::Off, bytes),
            Self::Quads => parse_obj_quads(bytes).is_ok(),
            Self::Texture => parse_png(bytes).is_ok(),
            Self::Points => parse_point_cache(bytes).is_ok(),
            Self::Scene => read_scene(bytes),
            Self::Expression => read_expression(bytes),
            Self::Manifest => Manifest::decode(Path::new("result"), bytes)
                .is_ok_and(|manifest| manifest.check(&[[0, 1, 2], [3, 4, 5]]).is_ok()),
            Self::Topology => with_checksum(bytes, |bytes| decode_topology(bytes).is_ok()),
            Self::Frame => with_checksum(bytes, |bytes| {
                Frame::decode(bytes).is_ok_and(|frame| frame.check(4, 2).is_ok())
            }),
            Self::Stats => decode_stats(bytes).is_ok(),
            Self::Checkpoint => with_checksum(bytes, read_checkpoint),
        }
    }

    /// Words of the format.
    pub fn dictionary(self) -> &'static [&'static str] {
        match self {
            Self::Obj | Self::Quads => &[
                "v ", "f ", "vt ", "\\\n", "#", "/", "//", "vn ", "-1", "\r\n", "\n",
            ],
            Self::Texture => &["IHDR", "IDAT", "IEND", "PLTE", "tRNS", "\u{8}"],
            Self::Points => &[
                "POINTCACHE2",
                "PK\u{3}\u{4}",
                "PK\u{1}\u{2}",
                "<f8",
                "(2,)",
                "positions.npy",
                "times.npy",
            ],
            Self::Ply => PLY_WORDS,
            Self::Stl => &[
                "solid", "facet", "vertex ", "endfacet", "endloop", "endsolid", "\n",
            ],
            Self::Off => &["OFF", "COFF", "BINARY", "#", "\n"],
            Self::Scene => SCENE_WORDS,
            Self::Expression => EXPRESSION_WORDS,
            Self::Manifest | Self::Stats => &[
                "{", "}", "[", "]", "\"", ":", ",", "null", "\\u0000", "1e999",
            ],
            Self::Topology | Self::Frame | Self::Checkpoint => {
                &["KOITERTP", "KOITERFR", "KOITERCP"]
            }
        }
    }
}

const PLY_WORDS: &[&str] = &[
    "element vertex ",
    "element face ",
    "element edge ",
    "property ",
    "list ",
    "uchar ",
    "char ",
    "int ",
    "uint ",
    "short ",
    "float ",
    "double ",
    "x\n",
    "y\n",
    "z\n",
    "vertex_indices\n",
    "format ascii 1.0\n",
    "format binary_little_endian 1.0\n",
    "format binary_big_endian 1.0\n",
    "comment ",
    "end_header\n",
    "\n",
];

const EXPRESSION_WORDS: &[&str] = &[
    "(",
    ")",
    ",",
    ";",
    "=",
    "+",
    "-",
    "*",
    "/",
    "^",
    "u = ",
    "u",
    "area",
    "vx",
    "k",
    "time",
    "pi",
    "sqrt(",
    "atan2(",
    "abs(",
    "min(",
    "smoothstep(",
    "1e308",
    "0",
    ".5",
    "β",
    " ",
];

const SCENE_WORDS: &[&str] = &[
    "[[shell]]\n",
    "[[double_layer]]\n",
    "[[heat_source]]\n",
    "thickness = ",
    "area_density = ",
    "burning.",
    "projection.",
    "[[obstacle]]\n",
    "[[constraint]]\n",
    "[[probe]]\n",
    "[[energy]]\n",
    "density = ",
    "on = \"face\"",
    "parameters = {",
    "[variants.a]\n",
    "[variants.a.b]\n",
    "#set ",
    "name = ",
    "mesh.grid",
    "mesh.file",
    "mesh.disc",
    "mesh.cylinder",
    "mesh.cone",
    "mesh.icosphere",
    "mesh.torus",
    "mesh.cap",
    "mesh.irregular",
    "cells = [",
    "rings = ",
    "around = ",
    "along = ",
    "subdivisions = ",
    "degrees = ",
    "hole_degrees = ",
    "max_area = ",
    "scale = ",
    "translate = [",
    "rotate = {",
    "units = \"mm\"",
    "up = \"y\"",
    "center = true",
    "plane = {",
    "sphere = {",
    "capsule = {",
    "box = {",
    "cylinder = {",
    "select.",
    "all = true",
    "boundary = ",
    "nearest = ",
    "vertices = [",
    "motion.",
    "until = ",
    "from = ",
    "[[phase]]\n",
    "[[obstacle.deform]]\n",
    "animation = { file = \"a\", fps = 1 }",
    "[[contact.pair]]\n",
    "scale = { factor = [[0, 1]] }",
    "axes = \"xyz\"",
    "clamp = true",
    "bending = ",
    "rest = \"mesh\"",
    "rest_mesh.",
    "velocity = [",
    "friction = ",
    "contact_thickness = ",
    "gravity_scale = [",
    "time.",
    "end = ",
    "dt = ",
    "output.",
    "every_seconds = ",
    "quantity = ",
    "shell.",
    "\"",
    "'",
    "\"\"\"",
    "{",
    "}",
    "[",
    "]",
    "=",
    ".",
    ",",
    "\n",
    "1979-05-27",
    "inf",
    "nan",
    "a.a.a.a.a.a.a.a.",
];

fn read_mesh(format: MeshFormat, bytes: &[u8]) -> bool {
    let Ok(mesh) = format.parse(bytes) else {
        return false;
    };
    let repair = SurfaceOptions {
        orientation: OrientationPolicy::Repair,
        unreferenced: UnreferencedPolicy::Drop,
    };
    let as_it_is = mesh.clone().into_surface(SurfaceOptions::default());
    let repaired = mesh.into_surface(repair);
    assert!(
        as_it_is.is_err() || repaired.is_ok(),
        "a sound mesh is spoilt by repairing it"
    );
    repaired.is_ok()
}

/// A file for whichever name a scene gives.
struct Square;

impl MeshSource for Square {
    fn read(&self, _: &str, options: SurfaceOptions) -> Result<Surface, UnreadableMesh> {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let positions = corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec();
        let faces = vec![[0, 1, 2], [0, 2, 3]];
        Surface::new(positions, faces, options).map_err(|error| UnreadableMesh {
            message: error.to_string(),
            help: None,
        })
    }

    fn read_points(&self, _: &str) -> Result<PointCache, UnreadableMesh> {
        Ok(PointCache {
            times: None,
            frames: vec![vec![Vec3::x(); 4], vec![Vec3::y(); 4]],
        })
    }
}

/// Memory of the machine that scenes are built for [bytes]: some 3000 triangles, so that no input takes long.
const SCENE_MEMORY: u64 = 100_000_000;

fn read_scene(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let overrides: Vec<String> = text
        .lines()
        .filter_map(|line| line.strip_prefix("#set "))
        .map(ToOwned::to_owned)
        .collect();
    let built = SceneFile::parse("scene.toml", &text, &overrides).and_then(|file| {
        let scene = Scene::build_within(&file, &Square, SCENE_MEMORY)?;
        Ok((scene, file))
    });
    match built {
        Ok((_, file)) => {
            // What a result keeps of a scene must be the same scene.
            let again = file.document.to_toml();
            if let Err(error) = SceneFile::parse("again", &again, &[]) {
                panic!("the scene as it was run cannot be read: {error}");
            }
            true
        }
        Err(error) => {
            // Its place must be in the text.
            if let Some(location) = &error.location {
                let _ = (location.line(), location.column());
                let text = &location.source.text;
                assert!(
                    text.get(location.span.clone()).is_some(),
                    "{error}: its place is not in the text"
                );
            }
            false
        }
    }
}

fn read_expression(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let (quantities, parameters) = (ElementKind::Face.rate_names(), ["k".to_owned()]);
    let names = Names {
        quantities: &quantities,
        parameters: &parameters,
    };
    match names.parse(&text) {
        Ok(_) => true,
        Err(error) => {
            let end = text.chars().count() + 1;
            assert!(
                (1..=end).contains(&error.column),
                "{error}: its place is not in the text"
            );
            false
        }
    }
}

fn read_checkpoint(bytes: &[u8]) -> bool {
    let Ok(checkpoint) = Checkpoint::from_bytes(bytes) else {
        return false;
    };
    // Bits are kept, those of NaN too; one byte, which says whether there is contact, may have been any but 1.
    let again = Checkpoint::from_bytes(&checkpoint.to_bytes());
    assert!(
        again.is_ok(),
        "a checkpoint that was read is written as none"
    );
    true
}

/// Reads bytes as they are, and with their last four bytes replaced by the right checksum: it must not be the only guard.
fn with_checksum(bytes: &[u8], read: impl Fn(&[u8]) -> bool) -> bool {
    let as_it_is = read(bytes);
    let Some((content, _)) = bytes.split_last_chunk::<4>() else {
        return as_it_is;
    };
    let sealed = [content, &crc32(content).to_le_bytes()].concat();
    read(&sealed) || as_it_is
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Target {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let names = Self::ALL.map(Self::name).join(", ");
        Self::ALL
            .into_iter()
            .find(|target| target.name() == name)
            .ok_or_else(|| format!("there is no target '{name}'; there are {names}"))
    }
}
