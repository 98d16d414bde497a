//! Mesh files in: OBJ, PLY, STL, OFF; quads from OBJ; textures from PNG; positions over time from PC2 and NPZ.
//!
//! Only positions and faces are read; polygons become fans of triangles about their first corner, which is right for
//! convex polygons. Lengths are taken as metres and axes as they are.

mod error;
mod obj;
mod off;
mod ply;
mod png;
mod point_cache;
mod quads;
mod stl;
mod text;

pub use self::png::parse_png;
pub use error::{Location, ParseError, ReadError};
pub use obj::parse_obj;
pub use off::parse_off;
pub use ply::parse_ply;
pub use point_cache::parse_point_cache;
pub use quads::parse_obj_quads;
pub use stl::parse_stl;

use std::path::{Path, PathBuf};

use crate::Vec3;
use crate::burning::{QuadMesh, Texture};
use crate::io::{MAX_DATA_BYTES, read_bounded};
use crate::mesh::{Surface, SurfaceOptions};
use crate::scene::PointCache;

/// What a mesh file holds, before it is checked to be a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawMesh {
    /// The file, for error messages; empty if the mesh was parsed from memory.
    pub path: PathBuf,
    /// Vertex positions [m].
    pub positions: Vec<[f64; 3]>,
    /// Triangles, by vertex index from 0.
    pub faces: Vec<[u32; 3]>,
    /// The line each triangle comes from, counted from 1; empty for binary files.
    pub face_lines: Vec<usize>,
    /// How people who look into the file count; only for error messages.
    pub numbering: Numbering,
}

/// How vertices and faces of a file are counted where people are told of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Numbering {
    /// From 0, as in PLY and OFF.
    #[default]
    FromZero,
    /// From 1, as in OBJ.
    FromOne,
    /// From 0, in the order of first appearance, as equal points became one (STL).
    OfDistinctPoints,
}

/// A mesh file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY, text or binary.
    Ply,
    /// Stereolithography, text or binary.
    Stl,
    /// Object file format.
    Off,
}

impl MeshFormat {
    /// The format of a file, from its content where that is unmistakable, else from its extension.
    pub fn detect(bytes: &[u8], path: &Path) -> Option<Self> {
        let word = bytes
            .trim_ascii_start()
            .split(u8::is_ascii_whitespace)
            .next()
            .unwrap_or_default();
        match word {
            b"ply" => return Some(Self::Ply),
            _ if off::is_header(word) => return Some(Self::Off),
            b"solid" => return Some(Self::Stl),
            _ if stl::has_binary_length(bytes) => return Some(Self::Stl),
            _ => {}
        }
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "off" => Some(Self::Off),
            _ => None,
        }
    }

    /// Parses a file of this format.
    ///
    /// # Errors
    /// The place and nature of the first fault.
    pub fn parse(self, bytes: &[u8]) -> Result<RawMesh, ParseError> {
        match self {
            Self::Obj => parse_obj(bytes),
            Self::Ply => parse_ply(bytes),
            Self::Stl => parse_stl(bytes),
            Self::Off => parse_off(bytes),
        }
    }
}

/// Reads a mesh file.
///
/// # Errors
/// Not a regular file, a refusal of the system, a format that is not known, a fault in the file.
pub fn read_mesh(path: &Path) -> Result<RawMesh, ReadError> {
    let in_file = || path.to_path_buf();
    let bytes = read_bounded(path, MAX_DATA_BYTES).map_err(|source| ReadError::Io {
        path: in_file(),
        source,
    })?;
    // Some editors put a byte order mark before UTF-8; it is no part of the first word.
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    let format = MeshFormat::detect(bytes, path)
        .ok_or_else(|| ReadError::UnknownFormat { path: in_file() })?;
    let mesh = format.parse(bytes).map_err(|source| ReadError::Parse {
        path: in_file(),
        source,
    })?;
    Ok(RawMesh {
        path: in_file(),
        ..mesh
    })
}

/// Reads a mesh of quads; see [`parse_obj_quads`].
///
/// # Errors
/// Not a regular file, a refusal of the system, a fault in the file.
pub fn read_quads(path: &Path) -> Result<QuadMesh, ReadError> {
    read_parsed(path, parse_obj_quads)
}

/// Reads a texture; see [`parse_png`].
///
/// # Errors
/// Not a regular file, a refusal of the system, a fault in the file.
pub fn read_texture(path: &Path) -> Result<Texture, ReadError> {
    read_parsed(path, parse_png)
}

/// Reads positions over time; see [`parse_point_cache`].
///
/// # Errors
/// Not a regular file, a refusal of the system, a fault in the file.
pub fn read_points(path: &Path) -> Result<PointCache, ReadError> {
    read_parsed(path, parse_point_cache)
}

fn read_parsed<T>(
    path: &Path,
    parse: impl Fn(&[u8]) -> Result<T, ParseError>,
) -> Result<T, ReadError> {
    let in_file = || path.to_path_buf();
    let bytes = read_bounded(path, MAX_DATA_BYTES).map_err(|source| ReadError::Io {
        path: in_file(),
        source,
    })?;
    parse(&bytes).map_err(|source| ReadError::Parse {
        path: in_file(),
        source,
    })
}

impl RawMesh {
    /// Checks the mesh; see [`Surface::new`].
    ///
    /// # Errors
    /// What [`Surface::new`] refuses, with the line of the face at fault where it is known.
    pub fn into_surface(self, options: SurfaceOptions) -> Result<Surface, ReadError> {
        let positions = self.positions.iter().map(|&x| Vec3::from(x)).collect();
        Surface::new(positions, self.faces, options).map_err(|source| {
            let line = source.face().and_then(|face| self.face_lines.get(face));
            let location = line.map_or(Location::File, |&line| Location::Line(line));
            ReadError::Mesh {
                path: self.path,
                location,
                numbering: self.numbering,
                source,
            }
        })
    }

    /// Adds a polygon as a fan of triangles about its first corner.
    fn add_polygon(&mut self, corners: &[u32], line: Option<usize>) {
        for pair in corners.windows(2).skip(1) {
            self.faces.push([corners[0], pair[0], pair[1]]);
            self.face_lines.extend(line);
        }
    }
}

#[cfg(test)]
mod tests;
