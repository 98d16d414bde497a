//! The membrane of Discrete Shells: springs on the lengths of edges and on the areas of faces.
//!
//! ```text
//! E = Σ_edges k_L ℓ̄ (ℓ/ℓ̄ − 1)² + Σ_faces k_A Ā (A/Ā − 1)²
//! ```
//!
//! ℓ, ℓ̄ length and rest length of an edge [m], A, Ā area and rest area of a face [m²], k_L [N], k_A [N/m]. Reference:
//! Grinspun et al., "Discrete Shells" (2003), section 4.
//!
//! The stiffness is given, as in the paper, or that of a material: if the directions of edges are spread evenly, small
//! strains ε cost s k_L (tr(ε)²/8 + tr(ε²)/4) + k_A tr(ε)² by area, with s = Σ ℓ̄ / Σ Ā. That is the energy of stretching
//! `h/2 (α tr(ε)² + 2 β tr(ε²))` of [`super::Membrane`] for
//!
//! ```text
//! k_L = 2 E h / ((1 + ν) s),    k_A = E h / (1 + ν) · (1/(2 (1 − ν)) − 3/4)
//! ```
//!
//! k_A would be negative for ν < 1/3 and is 0 then: edges alone have ν = 1/3. k_L by itself means another material on
//! another mesh: half the edge length is twice the stiffness. Meshes of which all edges have a few directions are stiffer
//! along those than across.

mod areas;
mod lengths;

pub use areas::FaceAreas;
pub use lengths::EdgeLengths;

use nalgebra::Vector3;

use crate::material::Section;
use crate::mesh::{FaceId, TriMesh};
use crate::rest::RestFrame;

/// k_L and k_A where they are not those of the material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DiscreteStiffness {
    /// k_L [N].
    pub edges: Option<f64>,
    /// k_A [N/m].
    pub areas: Option<f64>,
}

/// k_L of every edge and k_A of every face.
struct Stiffnesses {
    edges: Vec<f64>,
    areas: Vec<f64>,
}

impl Stiffnesses {
    fn new(
        mesh: &TriMesh,
        frames: &[RestFrame],
        lengths: &[f64],
        section: &dyn Section,
        given: DiscreteStiffness,
    ) -> Self {
        let total: f64 = frames.iter().map(|frame| frame.area).sum();
        let edges_by_area = lengths.iter().sum::<f64>() / total;
        // E h / (1 − ν²) and ν times that.
        let moduli: Vec<[f64; 2]> = (0..frames.len())
            .map(|face| {
                let tangent = section.stretch(face, &Vector3::zeros()).tangent;
                [tangent[(0, 0)], tangent[(0, 1)]]
            })
            .collect();
        let of_edge = |faces: &[Option<FaceId>; 2]| {
            let (mut sum, mut weight) = (0.0, 0.0);
            for FaceId(face) in faces.iter().flatten() {
                let ([along, across], area) = (moduli[*face as usize], frames[*face as usize].area);
                sum += 2.0 * (along - across) / edges_by_area * area;
                weight += area;
            }
            sum / weight
        };
        let of_face = |[along, across]: &[f64; 2]| (0.75 * across - 0.25 * along).max(0.0);
        Self {
            edges: match given.edges {
                Some(stiffness) => vec![stiffness; lengths.len()],
                None => mesh.edge_faces().iter().map(of_edge).collect(),
            },
            areas: match given.areas {
                Some(stiffness) => vec![stiffness; frames.len()],
                None => moduli.iter().map(of_face).collect(),
            },
        }
    }
}

/// Rest lengths of all edges [m]: the mean of both faces, should a prescribed rest metric let them disagree.
pub fn rest_lengths(mesh: &TriMesh, frames: &[RestFrame]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); mesh.num_edges()];
    for (frame, edges) in frames.iter().zip(mesh.face_edges()) {
        for (length, edge) in frame.edge_lengths().into_iter().zip(edges) {
            let (sum, count) = &mut sums[edge.0 as usize];
            (*sum, *count) = (*sum + length, *count + 1.0);
        }
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}
