//! Sums over all that moves: energy and momenta.

use super::simulation::Simulation;
use crate::Vec3;
use crate::mesh::VertexId;

impl Simulation {
    /// The sum of all energies, the kinetic one included [J].
    pub fn total_energy(&self) -> f64 {
        self.energies().iter().map(|(_, energy)| energy).sum()
    }

    /// Momentum `Σ m v` [N·s] and angular momentum `Σ m (x − shift a) × v` [N·m·s] about the origin, of all vertices of shells.
    ///
    /// With β dt² for `shift` [s²] the latter is what Newmark's method conserves; 0 is the usual one.
    pub fn momenta(&self, shift: f64) -> [Vec3; 2] {
        let (state, masses) = (self.state(), self.masses());
        let mut sums = [Vec3::zeros(); 2];
        for (shell, description) in self.model().shells.iter().enumerate() {
            for vertex in 0..description.surface.positions.len() {
                let dof = self.vertex(shell, VertexId(vertex as u32)).0 as usize;
                let at = |values: &[f64]| Vec3::from_column_slice(&values[dof..dof + 3]);
                let momentum = at(&state.velocities) * masses[dof];
                let arm = at(&state.q) - at(&state.accelerations) * shift;
                sums[0] += momentum;
                sums[1] += arm.cross(&momentum);
            }
        }
        sums
    }
}
