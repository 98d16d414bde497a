//! What a program outside reads and changes between steps: derivatives of the elastic energies, positions, velocities.

use super::simulation::Simulation;
use super::snapshot::RestoreError;
use crate::Vec3;
use crate::assembly::SymmetricMatrix;
use crate::contact::TouchingPair;
use crate::integrate::{LinearError, Memory};

/// Positions or velocities that a simulation cannot take.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChangeError {
    /// Not one a vertex, or not numbers.
    #[error(transparent)]
    Values(#[from] RestoreError),
    /// There are other many vertices.
    #[error("shell '{shell}' has {expected} vertices, but {found} values were given")]
    Count {
        /// Name of the shell.
        shell: String,
        /// Vertices of the shell.
        expected: usize,
        /// Values given.
        found: usize,
    },
    /// Surfaces would touch or cross there.
    #[error("the surfaces would touch or cross there: {} (gap {:.3e} m)", .0.description, .0.gap)]
    Touching(TouchingPair),
}

impl Simulation {
    /// Gradient of the elastic energies by the solved unknowns [J a unit of each]: three coordinates a vertex, shell by
    /// shell, then what the bending models add.
    pub fn elastic_gradient(&self) -> Vec<f64> {
        let mut gradient = vec![0.0; self.state.q.len()];
        for energy in &self.system.elastic {
            energy.add_gradient(&self.state.q, &mut gradient);
        }
        gradient.truncate(self.system.layout.num_solved_dofs());
        gradient
    }

    /// Exact second derivatives of the elastic energies by the solved unknowns, clamps and symmetry included.
    ///
    /// # Errors
    /// [`LinearError::Dense`] where an energy couples all vertices, as one of a shell's volume does.
    pub fn elastic_hessian(&mut self) -> Result<SymmetricMatrix, LinearError> {
        self.system.elastic_hessian(&self.state.q)
    }

    /// Moves the vertices of a shell [m]; its directors stay as they are. What integrators remember is forgotten: the next
    /// step begins as a first one does.
    ///
    /// # Errors
    /// Values that are not one finite position a vertex; a place where surfaces touch or cross. The simulation is then as
    /// it was.
    pub fn set_shell_positions(
        &mut self,
        shell: usize,
        positions: &[Vec3],
    ) -> Result<(), ChangeError> {
        let mut changed = self.snapshot();
        self.write_vertices(shell, positions, &mut changed.state.q)?;
        changed.state.memory = Memory::None;
        let before = self.snapshot();
        self.restore(&changed)?;
        let touching = (self.system.contact.as_mut())
            .and_then(|contact| contact.touching(&changed.state.q).into_iter().next());
        match touching {
            None => Ok(()),
            Some(pair) => {
                self.restore(&before)?;
                Err(ChangeError::Touching(pair))
            }
        }
    }

    /// Sets the velocities of the vertices of a shell [m/s].
    ///
    /// # Errors
    /// Values that are not one finite velocity a vertex.
    pub fn set_shell_velocities(
        &mut self,
        shell: usize,
        velocities: &[Vec3],
    ) -> Result<(), ChangeError> {
        let mut changed = self.snapshot();
        self.write_vertices(shell, velocities, &mut changed.state.velocities)?;
        changed.state.memory = Memory::None;
        Ok(self.restore(&changed)?)
    }

    fn write_vertices(
        &self,
        shell: usize,
        values: &[Vec3],
        into: &mut [f64],
    ) -> Result<(), ChangeError> {
        let part = &self.system.space.shells[shell];
        let expected = part.mesh.num_vertices();
        if values.len() != expected {
            return Err(ChangeError::Count {
                shell: self.model.shells[shell].name.clone(),
                expected,
                found: values.len(),
            });
        }
        for (slot, value) in into[part.vertex_dofs()].chunks_exact_mut(3).zip(values) {
            slot.copy_from_slice(value.as_slice());
        }
        Ok(())
    }
}
