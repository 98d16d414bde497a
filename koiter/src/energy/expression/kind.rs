//! What an expression may be of.

use super::elements::{Edges, Elements, Faces, Hinges, Vertices};
use super::rate_potential::VELOCITY;
use super::whole_potential::WHOLE;

/// The elements over which an expression is summed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Deserialize, serde::Serialize, schemars::JsonSchema),
    serde(rename_all = "kebab-case")
)]
#[non_exhaustive]
pub enum ElementKind {
    /// Vertices.
    Vertex,
    /// Edges, those of the boundary too.
    Edge,
    /// Edges between two faces, with their angle.
    Hinge,
    /// Faces.
    Face,
    /// The shell as a whole, with its volume and area.
    Shell,
}

impl ElementKind {
    /// The quantities that an energy may name.
    pub fn names(self) -> &'static [&'static str] {
        match self {
            Self::Vertex => Vertices::NAMES,
            Self::Edge => Edges::NAMES,
            Self::Hinge => Hinges::NAMES,
            Self::Face => Faces::NAMES,
            Self::Shell => &WHOLE,
        }
    }

    /// The quantities that a dissipation function may name; a whole shell has none.
    pub fn rate_names(self) -> Vec<&'static str> {
        let velocity: &[&str] = match self {
            Self::Shell => &[],
            _ => &VELOCITY,
        };
        [self.names(), velocity].concat()
    }

    /// What densities are multiplied by.
    pub fn measure(self) -> &'static str {
        match self {
            Self::Vertex | Self::Face | Self::Shell => "rest area",
            Self::Edge | Self::Hinge => "rest length",
        }
    }

    /// Many of them, in words.
    pub fn plural(self) -> &'static str {
        match self {
            Self::Vertex => "vertices",
            Self::Edge => "edges",
            Self::Hinge => "hinges",
            Self::Face => "faces",
            Self::Shell => "shells",
        }
    }
}
