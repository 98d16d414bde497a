//! Bézier shells in a scene: what they are made of, what is done to them, and their steps.
//!
//! They have unknowns and a Newton's method of their own ([`crate::bezier`]), so [`Simulation`](super::Simulation) steps them beside
//! the elastic system, which is then empty: a scene has Bézier shells or others. All of them are pieces of one shell, so that they can
//! be sewn together.

mod body;
mod played;
mod procedures;
mod report;
mod shown;
mod state;
mod step;
mod tracked;

pub(super) use body::BezierBody;
pub use state::BezierState;

use super::model::{Constraint, Load, Shell, SymmetryPlane};
use crate::Vec3;
use crate::bezier::{ElementKind, Section, ShellOptions};
use crate::mesh::{Surface, VertexId};

/// The Bézier shells of a model, with what holds and loads them; all indices of shells are those of `parts`.
#[derive(Clone, Debug)]
pub struct BezierModel {
    /// The shells, at least one.
    pub parts: Vec<BezierPart>,
    /// Which element they are made of.
    pub element: ElementKind,
    /// Rate at which motion dies down [1/s].
    pub damping: f64,
    /// Triangles on an edge of an element, where the fine surface is the elements divided.
    pub subdivide: usize,
    /// Prescribed vertices; a clamp holds their rotations too.
    pub constraints: Vec<Constraint>,
    /// Planes of symmetry.
    pub symmetry_planes: Vec<SymmetryPlane>,
    /// Loads.
    pub loads: Vec<Load>,
    /// What is done to the shells, in the order of time.
    pub procedures: Vec<Procedure>,
}

/// A Bézier shell of a model.
#[derive(Clone, Debug)]
pub struct BezierPart {
    /// Name, start shape, material, contact.
    pub shell: Shell,
    /// Normals at the vertices of the start shape.
    pub normals: Vec<Vec3>,
    /// The surface that it carries.
    pub surface: FineSurface,
}

/// What a Bézier shell shows and touches with.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum FineSurface {
    /// Its elements, divided.
    Subdivided,
    /// Another mesh, bound to it where it is closest.
    Bound {
        /// The mesh.
        surface: Box<Surface>,
        /// How far a vertex may be from the elements [m].
        reach: f64,
    },
}

/// What is done at a time.
#[derive(Clone, Debug)]
pub struct Procedure {
    /// Name, unique in the scene.
    pub name: String,
    /// When [s].
    pub at: f64,
    /// What.
    pub kind: ProcedureKind,
}

/// Kinds of procedures; `cut` is the index of the procedure that made the cut.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum ProcedureKind {
    /// A shell is cut along a path.
    Cut {
        /// The shell.
        shell: usize,
        /// Points of its start shape [m].
        path: Vec<Vec3>,
    },
    /// The lips of a cut are pulled apart.
    Open {
        /// Which cut.
        cut: usize,
        /// Force on each vertex, away from the other lip [N].
        force: f64,
        /// Force on each vertex along the normal [N].
        lift: f64,
        /// How long it grows [s].
        ramp: f64,
        /// When it ends [s].
        until: f64,
    },
    /// A patch is sewn between the lips of a cut.
    Patch {
        /// Which cut.
        cut: usize,
        /// Width in the middle [m].
        width: f64,
        /// Elements from lip to lip.
        across: usize,
        /// What it is made of.
        section: Section,
    },
    /// The lips of a cut are sewn together.
    Close {
        /// Which cut.
        cut: usize,
    },
    /// Vertices are joined, each of the first with the nearest of the second.
    Sew {
        /// A shell and some of its vertices.
        first: (usize, Vec<VertexId>),
        /// Another row.
        second: (usize, Vec<VertexId>),
        /// How far apart two of them may be [m].
        reach: f64,
    },
}

impl BezierPart {
    /// Material and thickness.
    pub fn section(&self) -> Section {
        let shell = &self.shell;
        Section {
            youngs_modulus: shell.youngs_modulus,
            poissons_ratio: shell.poissons_ratio,
            thickness: shell.thickness,
            density: shell.density,
        }
    }
}

impl BezierModel {
    /// What a shell of some material is made of.
    pub(super) fn options(&self, section: Section) -> ShellOptions {
        ShellOptions {
            section,
            kind: self.element,
            frame: None,
        }
    }
}
