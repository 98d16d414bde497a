//! What is to be said of each membrane.

/// How a shell resists stretching.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Deserialize, serde::Serialize, schemars::JsonSchema),
    serde(rename_all = "kebab-case")
)]
#[non_exhaustive]
pub enum MembraneModel {
    /// Constant strain in every triangle, any material.
    #[default]
    Koiter,
    /// Springs on the lengths of edges and on the areas of triangles.
    DiscreteShells,
}

/// A membrane in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MembraneModelInfo {
    /// Name in scene files.
    pub name: &'static str,
    /// What it is, in a line.
    pub what: &'static str,
    /// Its keys in the table of a shell.
    pub keys: &'static [&'static str],
    /// A key of docs/references.bib, and the equation.
    pub source: &'static str,
}

impl MembraneModel {
    /// All membranes.
    pub const ALL: [Self; 2] = [Self::Koiter, Self::DiscreteShells];

    /// What is to be said of the membrane.
    pub fn info(self) -> MembraneModelInfo {
        match self {
            Self::Koiter => MembraneModelInfo {
                name: "koiter",
                what: "constant strain in every triangle: the stiffness of any material on any mesh",
                keys: &[],
                source: "better-bending-2026, Eq. 4",
            },
            Self::DiscreteShells => MembraneModelInfo {
                name: "discrete-shells",
                what: "springs on lengths of edges and areas of triangles: poisson below 1/3 acts as 1/3, stiffness depends on the mesh",
                keys: &[
                    "discrete_shells.edge_stiffness",
                    "discrete_shells.area_stiffness",
                ],
                source: "grinspun-2003, section 4",
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
        for model in MembraneModel::ALL {
            let info = model.info();
            assert_eq!(serde_json::to_value(model).unwrap(), info.name);
            let (key, _) = info.source.split_once(", ").unwrap();
            assert!(bibliography.contains(&format!("{{{key},")), "{key}");
        }
    }
}
