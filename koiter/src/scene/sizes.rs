//! How large a simulation is, and what a step of it takes.

use super::model::{BendingModel, Shell};
use super::simulation::Simulation;
use crate::bezier::NODE_UNKNOWNS;

/// Sizes of a simulation.
#[derive(Clone, Debug, Default)]
pub struct SystemStats {
    /// Vertices of shells.
    pub vertices: usize,
    /// Faces of shells.
    pub faces: usize,
    /// Unknowns that are solved for.
    pub dofs: usize,
    /// Entries of the Hessian without contact, both triangles.
    pub hessian_nonzeros: usize,
    /// Memory a step takes, estimated [bytes].
    pub estimated_memory_bytes: usize,
    /// Names of the energies.
    pub energies: Vec<String>,
}

/// Peaks of runs with BAC: 38 MB at 2.6k unknowns, 187 MB at 14k, 234 MB at 30k, 2.9 GB at 483k. Most is the factor.
pub(super) const BYTES_A_DOF: usize = 6_000;
/// Ten springs with their rows of a matrix, two particles, four triangles.
pub(super) const BYTES_A_QUAD: usize = 4_000;
/// The program itself, with its scene and pictures.
pub(super) const PROGRAM_BYTES: usize = 40_000_000;

/// Blocks of 6 × 6: half a node a triangle, which meets itself and six others.
const NONZEROS_AN_ELEMENT: usize = 126;

/// Entries of the Hessian a face, both triangles, counted on large Delaunay meshes.
fn nonzeros_a_face(bending: BendingModel) -> usize {
    match bending {
        // The membrane alone: 3 × 3 entries for a vertex with itself and six neighbours.
        BendingModel::None => 31,
        // Hinges add the six vertices opposite the edges around.
        BendingModel::QbCr | BendingModel::DsTheta | BendingModel::DsTan | BendingModel::ChEs => 58,
        // All within two edges.
        BendingModel::QbPl | BendingModel::QbInt | BendingModel::ChFs | BendingModel::MeAverage => {
            86
        }
        BendingModel::Bac | BendingModel::Dcs | BendingModel::Dso => 166,
        // Six unknowns a vertex, which meets itself and six others.
        BendingModel::Dkt => 126,
        BendingModel::Ds2nd => 448,
    }
}

impl Simulation {
    /// Sizes and costs.
    pub fn stats(&self) -> SystemStats {
        let sum = |f: &dyn Fn(&crate::mesh::TriMesh) -> usize| -> usize {
            self.model.shells.iter().map(|s| f(&s.surface.mesh)).sum()
        };
        let dofs = self.system.layout.num_solved_dofs();
        let nonzeros = |s: &Shell| s.surface.mesh.num_faces() * nonzeros_a_face(s.bending);
        let of_shells: usize = self.model.shells.iter().map(nonzeros).sum();
        let mut energies: Vec<String> = self.energies().into_iter().map(|(name, _)| name).collect();
        energies.dedup();
        if !self.burning.is_empty() {
            // Springs that are projected have none.
            energies.clear();
        }
        let layers = self.burning.shells.iter().map(|shell| &shell.setup().shell);
        let quads: usize = layers.clone().map(|layer| layer.mesh.quads().len()).sum();
        let particles: usize = layers.clone().map(|layer| layer.particles.len()).sum();
        let bezier = self.bezier.as_ref().map(|body| body.sizes());
        let [nodes, elements] = bezier.unwrap_or_default();
        SystemStats {
            // A double layer shows its corners and the centres of its quads, as many as it has particles.
            vertices: sum(&|m| m.num_vertices()) + particles + nodes,
            faces: sum(&|m| m.num_faces()) + 4 * quads + elements,
            dofs: dofs + 3 * particles + NODE_UNKNOWNS * nodes,
            hessian_nonzeros: of_shells + NONZEROS_AN_ELEMENT * elements,
            estimated_memory_bytes: PROGRAM_BYTES
                + (dofs + NODE_UNKNOWNS * nodes) * BYTES_A_DOF
                + quads * BYTES_A_QUAD,
            energies,
        }
    }
}
