//! What can be wrong with a mesh file: file, place, fault and what to do.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use super::Numbering;
use crate::mesh::MeshError;

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// A line of a text file, counted from 1.
    Line(usize),
    /// A byte of a binary file, counted from 0.
    Byte(usize),
    /// No place in particular.
    File,
}

/// A fault in the content of a mesh file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseError {
    /// Where.
    pub location: Location,
    /// What, and what to do.
    pub problem: String,
}

impl ParseError {
    pub(super) fn at_line(line: usize, problem: impl Into<String>) -> Self {
        Self {
            location: Location::Line(line),
            problem: problem.into(),
        }
    }

    pub(super) fn at_byte(byte: usize, problem: impl Into<String>) -> Self {
        Self {
            location: Location::Byte(byte),
            problem: problem.into(),
        }
    }

    pub(super) fn in_file(problem: impl Into<String>) -> Self {
        Self {
            location: Location::File,
            problem: problem.into(),
        }
    }
}

impl fmt::Display for ParseError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.location {
            Location::Line(line) => write!(f, "line {line}: {}", self.problem),
            Location::Byte(byte) => write!(f, "byte {byte}: {}", self.problem),
            Location::File => f.write_str(&self.problem),
        }
    }
}

impl std::error::Error for ParseError {}

/// Why a mesh file could not be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The system refused.
    #[error("could not read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Neither content nor extension tell the format.
    #[error(
        "{} is no mesh format known here; give a file ending in .obj, .ply, .stl or .off",
        path.display()
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file breaks the rules of its format.
    #[error("{}{source}", prefix(path, Location::File))]
    Parse {
        /// The file.
        path: PathBuf,
        /// Place and fault.
        source: ParseError,
    },
    /// The file is well-formed, its mesh is not usable.
    #[error("{}{}", prefix(path, *location), counted(source, *numbering))]
    Mesh {
        /// The file.
        path: PathBuf,
        /// Where the face at fault stands, if that is known.
        location: Location,
        /// How the message counts vertices and faces.
        numbering: Numbering,
        /// The fault; here vertices and faces are numbered from 0, faces after polygons were split.
        source: MeshError,
    },
}

/// A fault of a mesh in the numbers of its file, and how they count.
fn counted(error: &MeshError, numbering: Numbering) -> String {
    let (first, convention) = match numbering {
        Numbering::FromZero => (0, "vertices and triangles are counted from 0"),
        Numbering::FromOne => (1, "vertices and triangles are counted from 1"),
        Numbering::OfDistinctPoints => (
            0,
            "vertices and triangles are counted from 0, equal points as one",
        ),
    };
    match error.counted_from(first) {
        Some(error) => format!("{error} ({convention})"),
        None => error.to_string(),
    }
}

/// "file, line 3: ", or what is known of it.
fn prefix(path: &Path, location: Location) -> String {
    let mut parts = Vec::new();
    if !path.as_os_str().is_empty() {
        parts.push(path.display().to_string());
    }
    match location {
        Location::Line(line) => parts.push(format!("line {line}")),
        Location::Byte(byte) => parts.push(format!("byte {byte}")),
        Location::File => {}
    }
    if parts.is_empty() {
        String::new()
    } else {
        format!("{}: ", parts.join(", "))
    }
}
