//! Elements of which an expression may speak, and the quantities that each has.
//!
//! | on | quantities |
//! | --- | --- |
//! | all | `x y z` position [m], `rest_x rest_y rest_z` at rest; of edges and hinges of the middle of the edge, of faces of the centroid |
//! | vertex | `rest_area` a third of its faces [m²], `mass` [kg] |
//! | edge | `length`, `rest_length` [m], `tx ty tz` unit vector from the smaller to the larger vertex |
//! | hinge | `angle`, `rest_angle` [rad] in (−π, π], 0 when flat, positive where normals fan out; `length`, `rest_length`; `rest_height` (Ā + Ā')/(3 ℓ̄), a third of the mean height of both faces [m] |
//! | face | `area`, `rest_area` [m²], `nx ny nz` unit normal, `strain_11 strain_22 strain_12` Green strain along the material's axis and across it, `strain_trace`, `strain_det`, `thickness` [m] |

use crate::Vec3;
use crate::assembly::Dof;
use crate::energy::bending::turning_angle;
use crate::geometry::Real;
use crate::geometry::over_numbers::{cross, dot, norm, point, sub};
use crate::rest::RestFrame;

/// Quantities of an element at most, velocities included.
pub(super) const MAX_QUANTITIES: usize = 24;

/// Whether a quantity of this name changes with the shape.
pub(crate) fn is_of_shape(name: &str) -> bool {
    !name.starts_with("rest_") && !["mass", "thickness"].contains(&name)
}

/// Elements of one kind, of `N` unknowns in `K` points.
pub trait Elements<const N: usize, const K: usize>: Clone + Send + Sync {
    /// Names of their quantities.
    const NAMES: &'static [&'static str];
    /// Weights of the points in the position of an element.
    const WEIGHTS: [f64; K];
    /// Number of elements.
    fn count(&self) -> usize;
    /// First unknowns of the points.
    fn nodes(&self, element: usize) -> [Dof; K];
    /// What densities are multiplied by: rest area [m²] or rest length [m].
    fn measure(&self, element: usize) -> f64;
    /// Writes those quantities that are used, in the order of the names.
    fn evaluate<R: Real>(&self, element: usize, q: &[R; N], is_used: &[bool], out: &mut [R]);
    /// The element in the user's terms.
    fn describe(&self, element: usize) -> String;
}

/// A vertex.
#[derive(Clone, Copy, Debug)]
pub struct VertexElement {
    /// First unknown.
    pub dof: Dof,
    /// Number in its shell.
    pub vertex: u32,
    /// Rest position [m].
    pub rest: Vec3,
    /// A third of the rest areas of its faces [m²].
    pub area: f64,
    /// Mass [kg].
    pub mass: f64,
}

/// Vertices of a shell.
#[derive(Clone, Debug)]
pub struct Vertices(pub Vec<VertexElement>);

/// An edge.
#[derive(Clone, Copy, Debug)]
pub struct EdgeElement {
    /// First unknowns of its ends.
    pub ends: [Dof; 2],
    /// The ends by their numbers in the shell.
    pub vertices: [u32; 2],
    /// Middle at rest [m].
    pub rest: Vec3,
    /// Rest length [m].
    pub length: f64,
}

/// Edges of a shell.
#[derive(Clone, Debug)]
pub struct Edges(pub Vec<EdgeElement>);

/// An edge between two faces.
#[derive(Clone, Copy, Debug)]
pub struct HingeElement {
    /// The edge.
    pub edge: EdgeElement,
    /// Apexes of the face that traverses the edge from its first to its second end, and of the other.
    pub apexes: [Dof; 2],
    /// Rest angle [rad].
    pub angle: f64,
    /// A third of the mean rest height of both faces over the edge [m].
    pub height: f64,
}

/// Inner edges of a shell.
#[derive(Clone, Debug)]
pub struct Hinges(pub Vec<HingeElement>);

/// A face.
#[derive(Clone, Copy, Debug)]
pub struct FaceElement {
    /// First unknowns of its corners.
    pub corners: [Dof; 3],
    /// Number in its shell.
    pub face: u32,
    /// Centroid at rest [m].
    pub rest: Vec3,
    /// Rest metric.
    pub frame: RestFrame,
    /// The material's axis in the frame, a unit vector.
    pub axis: [f64; 2],
    /// Thickness [m].
    pub thickness: f64,
}

/// Faces of a shell.
#[derive(Clone, Debug)]
pub struct Faces(pub Vec<FaceElement>);

/// Writes constants.
fn put<R: Real>(out: &mut [R], first: usize, values: &[f64]) {
    for (slot, &value) in out[first..].iter_mut().zip(values) {
        *slot = R::from(value);
    }
}

/// Position with these weights, and rest position, where all kinds have them.
fn put_positions<R: Real, const N: usize, const K: usize>(
    q: &[R; N],
    weights: &[f64; K],
    rest: &Vec3,
    is_used: &[bool],
    out: &mut [R],
) {
    for axis in (0..3).filter(|&axis| is_used[axis]) {
        let parts = (0..K).map(|k| q[3 * k + axis] * weights[k]);
        out[axis] = parts.reduce(|sum, part| sum + part).unwrap_or(R::from(0.0));
    }
    put(out, 3, rest.as_slice());
}

impl Elements<3, 1> for Vertices {
    const NAMES: &'static [&'static str] = &[
        "x",
        "y",
        "z",
        "rest_x",
        "rest_y",
        "rest_z",
        "rest_area",
        "mass",
    ];
    const WEIGHTS: [f64; 1] = [1.0];

    fn count(&self) -> usize {
        self.0.len()
    }

    fn nodes(&self, element: usize) -> [Dof; 1] {
        [self.0[element].dof]
    }

    fn measure(&self, element: usize) -> f64 {
        self.0[element].area
    }

    fn evaluate<R: Real>(&self, element: usize, q: &[R; 3], is_used: &[bool], out: &mut [R]) {
        let vertex = &self.0[element];
        put_positions(q, &Self::WEIGHTS, &vertex.rest, is_used, out);
        put(out, 6, &[vertex.area, vertex.mass]);
    }

    fn describe(&self, element: usize) -> String {
        format!("vertex {}", self.0[element].vertex)
    }
}

impl EdgeElement {
    fn describe(&self) -> String {
        let [u, v] = self.vertices;
        format!("edge {u}–{v}")
    }
}

impl Elements<6, 2> for Edges {
    const NAMES: &'static [&'static str] = &[
        "x",
        "y",
        "z",
        "rest_x",
        "rest_y",
        "rest_z",
        "length",
        "rest_length",
        "tx",
        "ty",
        "tz",
    ];
    const WEIGHTS: [f64; 2] = [0.5; 2];

    fn count(&self) -> usize {
        self.0.len()
    }

    fn nodes(&self, element: usize) -> [Dof; 2] {
        self.0[element].ends
    }

    fn measure(&self, element: usize) -> f64 {
        self.0[element].length
    }

    fn evaluate<R: Real>(&self, element: usize, q: &[R; 6], is_used: &[bool], out: &mut [R]) {
        let edge = &self.0[element];
        put_positions(q, &Self::WEIGHTS, &edge.rest, is_used, out);
        put(out, 7, &[edge.length]);
        let directs = is_used[8..11].contains(&true);
        if !(is_used[6] || directs) {
            return;
        }
        let along = sub(&point(q, 1), &point(q, 0));
        out[6] = norm(&along);
        if directs {
            for axis in 0..3 {
                out[8 + axis] = along[axis] / out[6];
            }
        }
    }

    fn describe(&self, element: usize) -> String {
        self.0[element].describe()
    }
}

impl Elements<12, 4> for Hinges {
    const NAMES: &'static [&'static str] = &[
        "x",
        "y",
        "z",
        "rest_x",
        "rest_y",
        "rest_z",
        "length",
        "rest_length",
        "angle",
        "rest_angle",
        "rest_height",
    ];
    const WEIGHTS: [f64; 4] = [0.5, 0.5, 0.0, 0.0];

    fn count(&self) -> usize {
        self.0.len()
    }

    fn nodes(&self, element: usize) -> [Dof; 4] {
        let HingeElement { edge, apexes, .. } = &self.0[element];
        [edge.ends[0], edge.ends[1], apexes[0], apexes[1]]
    }

    fn measure(&self, element: usize) -> f64 {
        self.0[element].edge.length
    }

    fn evaluate<R: Real>(&self, element: usize, q: &[R; 12], is_used: &[bool], out: &mut [R]) {
        let hinge = &self.0[element];
        put_positions(q, &Self::WEIGHTS, &hinge.edge.rest, is_used, out);
        put(out, 7, &[hinge.edge.length]);
        put(out, 9, &[hinge.angle, hinge.height]);
        if is_used[6] {
            out[6] = norm(&sub(&point(q, 1), &point(q, 0)));
        }
        if is_used[8] {
            out[8] = turning_angle(&std::array::from_fn(|i| point(q, i)));
        }
    }

    fn describe(&self, element: usize) -> String {
        self.0[element].edge.describe()
    }
}

impl FaceElement {
    /// Green strain along the axis, across it, and between both.
    fn strain<R: Real>(&self, e1: &[R; 3], e2: &[R; 3]) -> [R; 3] {
        let [m11, m12, m22] = self.frame.inverse;
        let f1 = e1.map(|e| e * m11);
        let f2: [R; 3] = std::array::from_fn(|i| e1[i] * m12 + e2[i] * m22);
        let [a, b] = [(&f1, &f1), (&f2, &f2)].map(|(f, g)| (dot(f, g) - 1.0) * 0.5);
        let mixed = dot(&f1, &f2) * 0.5;
        let [c, s] = self.axis;
        [
            a * (c * c) + b * (s * s) + mixed * (2.0 * c * s),
            a * (s * s) + b * (c * c) - mixed * (2.0 * c * s),
            (b - a) * (c * s) + mixed * (c * c - s * s),
        ]
    }
}

impl Elements<9, 3> for Faces {
    const NAMES: &'static [&'static str] = &[
        "x",
        "y",
        "z",
        "rest_x",
        "rest_y",
        "rest_z",
        "area",
        "rest_area",
        "nx",
        "ny",
        "nz",
        "strain_11",
        "strain_22",
        "strain_12",
        "strain_trace",
        "strain_det",
        "thickness",
    ];
    const WEIGHTS: [f64; 3] = [1.0 / 3.0; 3];

    fn count(&self) -> usize {
        self.0.len()
    }

    fn nodes(&self, element: usize) -> [Dof; 3] {
        self.0[element].corners
    }

    fn measure(&self, element: usize) -> f64 {
        self.0[element].frame.area
    }

    fn evaluate<R: Real>(&self, element: usize, q: &[R; 9], is_used: &[bool], out: &mut [R]) {
        let face = &self.0[element];
        put_positions(q, &Self::WEIGHTS, &face.rest, is_used, out);
        put(out, 7, &[face.frame.area]);
        put(out, 16, &[face.thickness]);
        let is_directed = is_used[8..11].contains(&true);
        let is_strained = is_used[11..16].contains(&true);
        if !(is_used[6] || is_directed || is_strained) {
            return;
        }
        let [e1, e2] = [1, 2].map(|c| sub(&point(q, c), &point(q, 0)));
        if is_used[6] || is_directed {
            let doubled = cross(&e1, &e2);
            let size = norm(&doubled);
            out[6] = size * 0.5;
            if is_directed {
                for axis in 0..3 {
                    out[8 + axis] = doubled[axis] / size;
                }
            }
        }
        if is_strained {
            let [along, across, mixed] = face.strain(&e1, &e2);
            let invariants = [along + across, along * across - mixed * mixed];
            out[11..14].copy_from_slice(&[along, across, mixed]);
            out[14..16].copy_from_slice(&invariants);
        }
    }

    fn describe(&self, element: usize) -> String {
        format!("face {}", self.0[element].face)
    }
}
