//! What a run was made of: `manifest.json`.

use std::io;
use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::while_trying;
use super::{MANIFEST, ResultError};
use crate::audit::Solid;
use crate::io::{MAX_DATA_BYTES, read_bounded};

/// The value of the key `format` by which a result folder is known.
const FORMAT: &str = "koiter-result";
/// Raised when a reader of the old version would misread a new folder.
const FORMAT_VERSION: u32 = 1;

/// What a run was made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of Koiter that wrote the result.
    pub version: String,
    /// A title for people.
    pub title: String,
    /// Which way is up. Lengths are in metres.
    #[serde(default)]
    pub up_axis: UpAxis,
    /// The scene file as it was run, overrides included, so that the run can be repeated.
    #[serde(default)]
    pub scene_text: String,
    /// Shells and obstacles, in the order of their vertices and faces.
    pub parts: Vec<Part>,
}

impl Default for Manifest {
    fn default() -> Self {
        Self {
            version: crate::VERSION.to_string(),
            title: String::new(),
            up_axis: UpAxis::default(),
            scene_text: String::new(),
            parts: Vec::new(),
        }
    }
}

/// The axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UpAxis {
    /// +x.
    X,
    /// +y.
    Y,
    /// +z.
    #[default]
    Z,
}

/// One shell or obstacle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Its name in the scene.
    pub name: String,
    /// What it is.
    pub kind: PartKind,
    /// Thickness [m]; 0 for an obstacle.
    pub thickness: f64,
    /// Its vertices.
    pub vertices: Range<usize>,
    /// Its faces; they use its vertices only, by their number in the whole.
    pub faces: Range<usize>,
    /// The exact shape of an obstacle whose faces only come near it, as it stands in the first frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid: Option<Solid>,
}

/// What a part is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum PartKind {
    /// It is simulated.
    Shell,
    /// It acts on shells and is not acted upon.
    Obstacle,
}

#[derive(Serialize, Deserialize)]
struct ManifestFile<T> {
    format: String,
    format_version: u32,
    #[serde(flatten)]
    manifest: T,
}

/// What every version of the format has, to tell "too new" from "broken".
#[derive(Deserialize)]
struct AnyVersion {}

impl Manifest {
    /// Number of vertices of all parts.
    pub fn num_vertices(&self) -> usize {
        self.parts.last().map_or(0, |part| part.vertices.end)
    }

    /// Number of faces of all parts.
    pub fn num_faces(&self) -> usize {
        self.parts.last().map_or(0, |part| part.faces.end)
    }

    /// Checks that the parts follow each other without gap and that faces stay in their part.
    ///
    /// # Errors
    /// What is wrong, as the end of a sentence that begins with the file's name.
    pub fn check(&self, faces: &[[u32; 3]]) -> Result<(), String> {
        check_parts(&self.parts, faces)
    }

    pub(super) fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(&ManifestFile {
            format: FORMAT.to_string(),
            format_version: FORMAT_VERSION,
            manifest: self,
        })
    }

    pub(super) fn read(folder: &Path) -> Result<Self, ResultError> {
        let path = folder.join(MANIFEST);
        match read_bounded(&path, MAX_DATA_BYTES) {
            Ok(bytes) => Self::decode(folder, &bytes),
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::NotFound | io::ErrorKind::NotADirectory
                ) =>
            {
                let is_there = folder.is_dir();
                let reason = if is_there {
                    "it has no manifest.json"
                } else {
                    "there is no such folder"
                };
                Err(not_a_result(folder, reason.to_string()))
            }
            // No run writes such a thing: the folder is not taken for a result, and nothing in it is replaced.
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::InvalidInput | io::ErrorKind::FileTooLarge
                ) =>
            {
                Err(not_a_result(
                    folder,
                    format!("its manifest.json cannot be one: {error}"),
                ))
            }
            Err(error) => Err(while_trying("read", &path)(error)),
        }
    }

    /// The manifest in the bytes of `manifest.json`; `folder` is named in errors.
    ///
    /// # Errors
    /// Not a manifest of ours, a newer format, a broken file.
    pub fn decode(folder: &Path, bytes: &[u8]) -> Result<Self, ResultError> {
        let path = folder.join(MANIFEST);
        let head: ManifestFile<AnyVersion> = serde_json::from_slice(bytes).map_err(|error| {
            not_a_result(folder, format!("its manifest.json is not ours ({error})"))
        })?;
        if head.format != FORMAT {
            let reason = format!("its manifest.json is of format '{}'", head.format);
            return Err(not_a_result(folder, reason));
        }
        if head.format_version != FORMAT_VERSION {
            let (found, supported) = (head.format_version, FORMAT_VERSION);
            return Err(ResultError::Version {
                path,
                found,
                supported,
            });
        }
        match serde_json::from_slice::<ManifestFile<Self>>(bytes) {
            Ok(file) => Ok(file.manifest),
            Err(error) => Err(ResultError::Broken {
                path,
                reason: error.to_string(),
            }),
        }
    }
}

/// See [`Manifest::check`].
pub(super) fn check_parts(parts: &[Part], faces: &[[u32; 3]]) -> Result<(), String> {
    let (mut next_vertex, mut next_face) = (0, 0);
    for part in parts {
        let Part {
            name,
            thickness,
            vertices: v,
            faces: f,
            ..
        } = part;
        if v.start != next_vertex || f.start != next_face || v.end < v.start || f.end < f.start {
            return Err(format!(
                "part '{name}' has vertices {v:?} and faces {f:?}, but the parts before end at vertex \
                     {next_vertex} and face {next_face}"
            ));
        }
        if !(thickness.is_finite() && *thickness >= 0.0) {
            return Err(format!("part '{name}' has thickness {thickness}"));
        }
        (next_vertex, next_face) = (v.end, f.end);
    }
    if next_face != faces.len() {
        return Err(format!(
            "the parts have {next_face} faces, but there are {}",
            faces.len()
        ));
    }
    for part in parts {
        for face in part.faces.clone() {
            if let Some(v) = faces[face]
                .iter()
                .find(|&&v| !part.vertices.contains(&(v as usize)))
            {
                let (name, range) = (&part.name, &part.vertices);
                return Err(format!(
                    "face {face} of part '{name}' uses vertex {v}, outside {range:?}"
                ));
            }
        }
    }
    Ok(())
}

fn not_a_result(folder: &Path, reason: String) -> ResultError {
    ResultError::NotAResult {
        path: folder.to_path_buf(),
        reason,
    }
}
