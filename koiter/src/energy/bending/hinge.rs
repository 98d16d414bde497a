//! Interior edges with their two faces: the stencil of the models that see one hinge at a time.

use crate::Vec3;
use crate::assembly::Dof;
use crate::geometry::over_numbers::{angle_about, cross, sub};
use crate::geometry::{Real, Wing, hinge_angle};
use crate::mesh::{EdgeId, Surface};
use crate::rest::RestFrame;

/// An interior edge at rest.
pub(super) struct Hinge {
    /// Edge ends, apex of the face that traverses the edge from the first to the second, apex of the other face.
    pub(super) vertices: [Dof; 4],
    /// The edge by its vertices, for reports.
    pub(super) edge: [u32; 2],
    /// Rest positions of the four vertices [m].
    pub(super) rest: [Vec3; 4],
    /// Rest areas of the two faces [m²].
    pub(super) areas: [f64; 2],
    /// C: mean over the two faces, weighted by their areas [N·m].
    pub(super) rigidity: f64,
}

impl Hinge {
    /// Sum of the rest areas.
    pub(super) fn area(&self) -> f64 {
        self.areas[0] + self.areas[1]
    }

    /// Square of the rest length of the edge.
    pub(super) fn length_squared(&self) -> f64 {
        (self.rest[1] - self.rest[0]).norm_squared()
    }

    /// The two wings at rest.
    pub(super) fn rest_wings(&self) -> [Wing; 2] {
        wings(&self.rest)
    }

    /// The edge in the user's terms.
    pub(super) fn describe(&self) -> String {
        let [u, v] = self.edge;
        format!("edge {u}–{v}")
    }
}

/// The interior edges of `rest`. `flexural_rigidity` is `E h³ / (12 (1 − ν²))` of every face [N·m], which equals
/// `C = h³ (α + 2β) / 12`.
pub(super) fn hinges(
    rest: &Surface,
    first_vertex: Dof,
    frames: &[RestFrame],
    flexural_rigidity: &[f64],
) -> Vec<Hinge> {
    let mut hinges = Vec::new();
    for (index, faces) in rest.mesh.edge_faces().iter().enumerate() {
        let [Some(f0), Some(f1)] = *faces else {
            continue;
        };
        let edge = rest.mesh.edges()[index];
        let apex = |side| {
            rest.mesh
                .opposite_vertex(EdgeId(index as u32), side)
                .expect("an interior edge has two apexes")
                .0
        };
        let corners = [edge[0], edge[1], apex(0), apex(1)];
        let faces = [f0, f1].map(|f| f.0 as usize);
        let areas = faces.map(|f| frames[f].area);
        let [c0, c1] = faces.map(|f| flexural_rigidity[f]);
        hinges.push(Hinge {
            vertices: corners.map(|i| Dof(first_vertex.0 + 3 * i)),
            edge,
            rest: corners.map(|i| rest.positions[i as usize]),
            areas,
            // Written so that equal rigidities give that rigidity without rounding.
            rigidity: c0 + (c1 - c0) * (areas[1] / (areas[0] + areas[1])),
        });
    }
    hinges
}

/// The wings of the hinge of edge `x₀ x₁` with apexes `x₂`, `x₃`, each with its own traversal of the edge.
#[inline]
pub(super) fn wings(x: &[Vec3; 4]) -> [Wing; 2] {
    [
        Wing::new(&x[0], &x[1], &x[2]),
        Wing::new(&x[1], &x[0], &x[3]),
    ]
}

/// Places of edge ends and apex of each wing among the vertices of a hinge.
pub(super) const WING_PLACES: [[usize; 3]; 2] = [[0, 1, 2], [1, 0, 3]];

/// Hinge angle of two wings.
#[inline]
pub(super) fn angle([wing, neighbor]: &[Wing; 2]) -> f64 {
    hinge_angle(wing, neighbor)
}

/// Hinge angle of edge `x₀ x₁` with apexes `x₂` (face traversing `0 → 1`) and `x₃`, over any numbers.
pub(in crate::energy) fn turning_angle<R: Real>(x: &[[R; 3]; 4]) -> R {
    let edge = sub(&x[1], &x[0]);
    let n0 = cross(&edge, &sub(&x[2], &x[0]));
    let n1 = cross(&sub(&x[3], &x[0]), &edge);
    angle_about(&edge, &n0, &n1)
}
