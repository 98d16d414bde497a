//! Materials by name, with their source.
//!
//! All are those of Table 6 of "Better Bending" (2026): isotropic values for simulation examples, not measurements of
//! a particular product. Where the table gives a range, the preset takes the value named at the constant and
//! [`MaterialPreset::remark`] tells the range.

/// A material by name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialPreset {
    /// Name in scene files.
    pub name: &'static str,
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Density [kg/m³].
    pub density: f64,
    /// Thickness unless the shell says otherwise [m].
    pub thickness: f64,
    /// Ranges and choices.
    pub remark: &'static str,
    /// Where the numbers come from: a key of docs/references.bib, and the place.
    pub source: &'static str,
}

const TABLE_6: &str = "better-bending-2026, Table 6";

/// All presets.
pub const ALL: [MaterialPreset; 5] = [
    MaterialPreset {
        name: "cotton",
        youngs_modulus: 1e6,
        poissons_ratio: 0.3,
        density: 500.0,
        thickness: 1e-3,
        remark: "thickness 0.1 to 1 mm",
        source: TABLE_6,
    },
    MaterialPreset {
        name: "aluminium-can",
        youngs_modulus: 7e10,
        poissons_ratio: 0.33,
        density: 2710.0,
        thickness: 0.4e-3,
        remark: "elastic only: real cans yield",
        source: TABLE_6,
    },
    MaterialPreset {
        name: "silicone-rubber",
        youngs_modulus: 3e7,
        poissons_ratio: 0.47,
        density: 1000.0,
        thickness: 2e-3,
        remark: "Young's modulus 3e7 to 5e7 Pa, Poisson's ratio 0.4 to 0.47, thickness 2 to 10 mm",
        source: TABLE_6,
    },
    MaterialPreset {
        name: "latex-rubber",
        youngs_modulus: 1e6,
        poissons_ratio: 0.4,
        density: 500.0,
        thickness: 1e-3,
        remark: "",
        source: TABLE_6,
    },
    MaterialPreset {
        name: "paper",
        youngs_modulus: 3e9,
        poissons_ratio: 0.38,
        density: 800.0,
        thickness: 0.1e-3,
        remark: "",
        source: TABLE_6,
    },
];

/// The preset of this name.
pub fn find(name: &str) -> Option<&'static MaterialPreset> {
    ALL.iter().find(|preset| preset.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_have_distinct_names_and_physical_values() {
        for (i, preset) in ALL.iter().enumerate() {
            assert_eq!(find(preset.name), Some(preset));
            assert!(ALL[..i].iter().all(|other| other.name != preset.name));
            assert!(preset.youngs_modulus > 0.0 && preset.density > 0.0 && preset.thickness > 0.0);
            assert!((0.0..=0.5).contains(&preset.poissons_ratio));
        }
        assert_eq!(find("cottton"), None);
    }
}
