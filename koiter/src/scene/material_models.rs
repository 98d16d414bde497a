//! What is to be said of each material model.

/// A law between strain and stress, by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Deserialize, serde::Serialize, schemars::JsonSchema),
    serde(rename_all = "kebab-case")
)]
#[non_exhaustive]
pub enum MaterialModel {
    /// Isotropic, quadratic in the Green strain.
    #[default]
    StVenantKirchhoff,
    /// Isotropic rubber, which resists collapse.
    NeoHookean,
    /// Two moduli along the axes of the material.
    Orthotropic,
    /// Isotropic without compressive stress.
    TensionField,
    /// Layers that may grow differently.
    Layered,
}

/// A material model in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialModelInfo {
    /// Name in scene files.
    pub name: &'static str,
    /// What it is, in a line.
    pub what: &'static str,
    /// Its keys beside young, poisson and density.
    pub keys: &'static [&'static str],
    /// A key of docs/references.bib.
    pub source: &'static str,
}

impl MaterialModel {
    /// All models.
    pub const ALL: [Self; 5] = [
        Self::StVenantKirchhoff,
        Self::NeoHookean,
        Self::Orthotropic,
        Self::TensionField,
        Self::Layered,
    ];

    /// What is to be said of the model.
    pub fn info(self) -> MaterialModelInfo {
        match self {
            Self::StVenantKirchhoff => MaterialModelInfo {
                name: "st-venant-kirchhoff",
                what: "isotropic, quadratic in the Green strain: small strain, any rotation",
                keys: &[],
                source: "better-bending-2026",
            },
            Self::NeoHookean => MaterialModelInfo {
                name: "neo-hookean",
                what: "isotropic rubber in plane stress: large strain, faces never collapse; poisson from 0 to 0.5",
                keys: &[],
                source: "bonet-2008",
            },
            Self::Orthotropic => MaterialModelInfo {
                name: "orthotropic",
                what: "young along the material's axis (warp), young_across (weft), poisson along to across, shear",
                keys: &["young_across", "shear", "axis"],
                source: "jones-1999",
            },
            Self::TensionField => MaterialModelInfo {
                name: "tension-field",
                what: "isotropic without compressive stress: taut, wrinkled or slack",
                keys: &[],
                source: "pipkin-1986",
            },
            Self::Layered => MaterialModelInfo {
                name: "layered",
                what: "layers with thickness, young and growth each, one poisson: bimetals, leaves that curl",
                keys: &["layers", "axis"],
                source: "van-rees-2017",
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(feature = "serde")]
    #[test]
    fn names_are_those_of_scene_files_and_sources_are_in_the_bibliography() {
        let bibliography = include_str!("../../../docs/references.bib");
        for model in MaterialModel::ALL {
            let info = model.info();
            assert_eq!(serde_json::to_value(model).unwrap(), info.name);
            assert!(
                bibliography.contains(&format!("{{{},", info.source)),
                "{}",
                info.source
            );
        }
    }
}
