//! From `[[energy]]` to an expression on a shell.

use super::{Builder, vertices};
use crate::scene::error::{SceneError, SceneErrorKind as Kind};
use crate::scene::expressions::TextEnergy;
use crate::scene::model::Shell;
use crate::scene::spec::EnergySpec;

impl Builder<'_> {
    pub(super) fn energies(&self, shells: &[Shell]) -> Result<Vec<TextEnergy>, SceneError> {
        let energies = self.spec.energy.iter();
        energies.map(|energy| self.energy(energy, shells)).collect()
    }

    fn energy(&self, energy: &EnergySpec, shells: &[Shell]) -> Result<TextEnergy, SceneError> {
        let path = format!("energy.{}", energy.name);
        let shell = self.shell_index(&format!("{path}.shell"), &energy.shell)?;
        let missing =
            || SceneError::new(Kind::MissingKey, "the energy has no expression").inside(&path);
        let made = energy.to_text_energy(shell).ok_or_else(missing)?;
        let vertices = match &energy.select {
            Some(select) => Some(vertices(&format!("{path}.select"), select, &shells[shell])?),
            None => None,
        };
        Ok(TextEnergy { vertices, ..made })
    }
}
