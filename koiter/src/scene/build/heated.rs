//! From `[shell.burning]` to what is heated.

use super::Builder;
use super::burning::{burning_options, number_error};
use crate::burning::{HeatedSetup, Texture};
use crate::mesh::Surface;
use crate::scene::elastic::rest_surface;
use crate::scene::error::SceneError;
use crate::scene::heated::HeatedPart;
use crate::scene::model::Shell;
use crate::scene::spec::{BurningSpec, ROOM_TEMPERATURE};

impl Builder<'_> {
    pub(super) fn heated_shells(&self, shells: &[Shell]) -> Result<Vec<HeatedPart>, SceneError> {
        let typed = self.spec.shell.iter().enumerate();
        let burning = typed.filter_map(|(index, spec)| Some((index, spec.burning.as_ref()?)));
        burning
            .map(|(index, spec)| {
                let temperature = self.spec.shell[index].temperature;
                let setup = self.heated_setup(spec, &shells[index], temperature)?;
                Ok(HeatedPart {
                    shell: index,
                    setup,
                })
            })
            .collect()
    }

    fn heated_setup(
        &self,
        spec: &BurningSpec,
        shell: &Shell,
        temperature: Option<f64>,
    ) -> Result<HeatedSetup, SceneError> {
        let path = format!("shell.{}", shell.name);
        let factors = |key: &str, file: &Option<String>| {
            let path = format!("{path}.burning.{key}");
            self.shell_factors(&path, file.as_deref(), &shell.surface)
        };
        let setup = HeatedSetup {
            loss_factors: factors("loss_texture", &spec.loss_texture)?,
            diffusivity_factors: factors("diffusivity_texture", &spec.diffusivity_texture)?,
            rest: rest_surface(shell),
            thickness: shell.thickness,
            temperature: temperature.unwrap_or(ROOM_TEMPERATURE),
            ambient_temperature: spec.ambient_temperature,
            cooling_rate: spec.cooling_rate,
            diffusivity: spec.diffusivity,
            exchange_rate: spec.exchange_rate,
            burning: burning_options(spec),
            strength: spec.strength.unwrap_or(f64::INFINITY),
        };
        setup.check().map_err(|error| number_error(&error, &path))?;
        Ok(setup)
    }

    /// Brightness of a texture at the vertices of a shell; without a texture none.
    pub(super) fn shell_factors(
        &self,
        path: &str,
        file: Option<&str>,
        surface: &Surface,
    ) -> Result<Vec<f64>, SceneError> {
        let texture = self.texture(path, file)?;
        Ok(texture.map_or(Vec::new(), |texture| laid_on(&texture, surface)))
    }
}

/// Values of a texture that is laid over the two longest sides of the box around a surface, in the order x, y, z.
fn laid_on(texture: &Texture, surface: &Surface) -> Vec<f64> {
    let (low, high) = surface.bounding_box();
    let size = high - low;
    let shortest = (0..3).rev().min_by(|&a, &b| size[a].total_cmp(&size[b]));
    let mut axes = (0..3).filter(|&axis| Some(axis) != shortest);
    let axes = [axes.next().unwrap_or(0), axes.next().unwrap_or(1)];
    let at = |x: &crate::Vec3| texture.at(axes.map(|axis| (x[axis] - low[axis]) / size[axis]));
    surface.positions.iter().map(at).collect()
}
