//! `material` of a shell, and what of it can be checked without a mesh.

use schemars::JsonSchema;
use serde::Deserialize;

use super::ShellSpec;
use super::check::{Checked, all_finite, error, optional_positive, positive};
use crate::material::presets;
use crate::scene::document::suggest;
use crate::scene::error::SceneErrorKind as Kind;
use crate::scene::material_models::MaterialModel;

/// `material`: `"cotton"` is short for `{ preset = "cotton" }`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialSpec {
    /// Name of a preset.
    #[serde(default)]
    #[schemars(schema_with = "crate::scene::schema::preset_name")]
    pub preset: Option<String>,
    /// How stress follows from strain.
    #[serde(default)]
    pub model: MaterialModel,
    /// Young's modulus [Pa]; of an orthotropic material that along its axis (warp).
    #[serde(default)]
    pub young: Option<f64>,
    /// Poisson's ratio; of an orthotropic material the contraction across its axis by tension along it.
    #[serde(default)]
    pub poisson: Option<f64>,
    /// Density [kg/m³].
    #[serde(default)]
    pub density: Option<f64>,
    /// Young's modulus across the axis (weft) [Pa], of an orthotropic material.
    #[serde(default)]
    pub young_across: Option<f64>,
    /// Shear modulus [Pa], of an orthotropic material.
    #[serde(default)]
    pub shear: Option<f64>,
    /// The material's axis: a direction in the space of the rest mesh, projected on each face; default: along x.
    #[serde(default)]
    pub axis: Option<[f64; 3]>,
    /// Layers of a layered material, the first below: on the side that normals point away from.
    #[serde(default)]
    pub layers: Vec<LayerSpec>,
}

/// One of `material.layers`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LayerSpec {
    /// Thickness [m].
    pub thickness: f64,
    /// Young's modulus [Pa].
    pub young: f64,
    /// Poisson's ratio; it must be that of the material.
    #[serde(default)]
    pub poisson: Option<f64>,
    /// Growth of lengths along the material's axis and across it: 0.01 is one in a hundred.
    #[serde(default)]
    pub growth: [f64; 2],
}

/// Checks material, thickness and prescribed rest values of a shell.
pub(super) fn check_material(path: &str, shell: &ShellSpec) -> Checked {
    let at = |key: &str| format!("{path}.{key}");
    let material = &shell.material;
    if let Some(name) = &material.preset {
        let names: Vec<&str> = presets::ALL.iter().map(|preset| preset.name).collect();
        if !names.contains(&name.as_str()) {
            let message = format!("there is no material '{name}'");
            return Err(error(Kind::UnknownName, &at("material.preset"), message)
                .with_help(suggest(name, &names)));
        }
    }
    let is_layered = material.model == MaterialModel::Layered;
    let needed = [
        ("material.young", material.young, !is_layered),
        ("material.poisson", material.poisson, true),
        ("material.density", material.density, true),
        ("thickness", shell.thickness, !is_layered),
    ];
    for (key, value, is_needed) in needed {
        if is_needed && value.is_none() && material.preset.is_none() {
            let message = format!("the shell has neither a material preset nor '{key}'");
            return Err(error(Kind::MissingKey, &at(key), message).with_help(
                "write material = \"cotton\", or give young, poisson, density and thickness",
            ));
        }
    }
    optional_positive(&at("material.young"), material.young, "Pa")?;
    optional_positive(&at("material.density"), material.density, "kg/m³")?;
    optional_positive(&at("thickness"), shell.thickness, "m")?;
    check_poisson(&at("material.poisson"), material)?;
    check_keys_of_model(path, shell)?;
    if let Some(axis) = material.axis
        && axis == [0.0; 3]
    {
        let message = "a direction must not be [0, 0, 0]".to_owned();
        return Err(error(Kind::OutOfRange, &at("material.axis"), message));
    }
    for (index, stretch) in shell.rest_stretch.iter().enumerate() {
        positive(&at(&format!("rest_stretch.{index}")), *stretch, "")?;
    }
    all_finite(&at("rest_curvature"), &shell.rest_curvature)
}

fn check_poisson(path: &str, material: &MaterialSpec) -> Checked {
    let Some(poisson) = material.poisson else {
        return Ok(());
    };
    let (is_sound, bounds) = match material.model {
        // Its bounds depend on the moduli.
        MaterialModel::Orthotropic => return Ok(()),
        MaterialModel::NeoHookean => ((0.0..=0.5).contains(&poisson), "between 0 and 0.5"),
        _ => (
            -1.0 < poisson && poisson <= 0.5,
            "above -1 and at most at 0.5",
        ),
    };
    let message = format!("Poisson's ratio must lie {bounds}, but it is {poisson}");
    match is_sound {
        true => Ok(()),
        false => Err(error(Kind::OutOfRange, path, message)),
    }
}

/// Keys that a model needs, and those it does not know.
fn check_keys_of_model(path: &str, shell: &ShellSpec) -> Checked {
    let material = &shell.material;
    let at = |key: &str| format!("{path}.material.{key}");
    let name = material.model.info().name;
    let own = [
        ("young_across", material.young_across.is_some()),
        ("shear", material.shear.is_some()),
        ("layers", !material.layers.is_empty()),
    ];
    for (key, given) in own {
        let known = material.model.info().keys.contains(&key);
        if given && !known {
            let of = MaterialModel::ALL.map(MaterialModel::info);
            let of = of.iter().find(|info| info.keys.contains(&key));
            let message = format!("a material of model {name} has no '{key}'");
            let help = of.map_or(String::new(), |info| {
                format!("'{key}' is of model = \"{}\"", info.name)
            });
            return Err(error(Kind::Conflict, &at(key), message).with_help(help));
        }
        if known && !given {
            let message =
                format!("the key '{key}' is missing: a material of model {name} needs it");
            return Err(error(Kind::MissingKey, &at(key), message));
        }
    }
    optional_positive(&at("young_across"), material.young_across, "Pa")?;
    optional_positive(&at("shear"), material.shear, "Pa")?;
    if material.model == MaterialModel::Layered {
        check_layers(path, shell)?;
    }
    Ok(())
}

fn check_layers(path: &str, shell: &ShellSpec) -> Checked {
    let material = &shell.material;
    let conflicts = [
        ("thickness", shell.thickness.is_some()),
        ("material.young", material.young.is_some()),
    ];
    for (key, given) in conflicts {
        if given {
            let message = format!("layers have their own: '{key}' of the shell says nothing");
            return Err(error(Kind::Conflict, &format!("{path}.{key}"), message));
        }
    }
    let preset = material.preset.as_deref().and_then(presets::find);
    let common = material.poisson.or(preset.map(|p| p.poissons_ratio));
    for (index, layer) in material.layers.iter().enumerate() {
        let at = |key: &str| format!("{path}.material.layers.{index}.{key}");
        positive(&at("thickness"), layer.thickness, "m")?;
        positive(&at("young"), layer.young, "Pa")?;
        if let Some(poisson) = layer.poisson
            && Some(poisson) != common
        {
            let message = "layers must share Poisson's ratio, that of the material: with different ones stretching and \
                           bending mix, which no model here knows";
            return Err(error(Kind::Conflict, &at("poisson"), message.into()));
        }
        for (axis, growth) in layer.growth.iter().enumerate() {
            if !(*growth > -1.0) {
                let message = format!("growth must lie above -1, but it is {growth}");
                return Err(error(
                    Kind::OutOfRange,
                    &at(&format!("growth.{axis}")),
                    message,
                ));
            }
        }
    }
    Ok(())
}
