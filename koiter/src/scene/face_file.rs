//! What a file says of single faces: thickness, moduli, axes and rest forms, one value a face in the order of the mesh.
//!
//! ```json
//! {"thickness": [1e-3, 2e-3], "second_form": [[1e-4, 0.0, 1e-4], [0.0, 0.0, 0.0]]}
//! ```

use serde::Deserialize;

use super::error::{SceneError, SceneErrorKind as Kind};
use super::nearest::nearest;

/// The lists of a face file; all are optional.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct FaceFile {
    /// Thickness [m].
    pub(super) thickness: Option<Vec<f64>>,
    /// Young's modulus [Pa].
    pub(super) young: Option<Vec<f64>>,
    /// Poisson's ratio.
    pub(super) poisson: Option<Vec<f64>>,
    /// Density [kg/m³].
    pub(super) density: Option<Vec<f64>>,
    /// Young's modulus across the axis [Pa].
    pub(super) young_across: Option<Vec<f64>>,
    /// Shear modulus [Pa].
    pub(super) shear: Option<Vec<f64>>,
    /// The material's axis.
    pub(super) axis: Option<Vec<[f64; 3]>>,
    /// ā `[11, 12, 22]` in the basis of the edges x₁ − x₀, x₂ − x₀ [m²].
    pub(super) first_form: Option<Vec<[f64; 3]>>,
    /// b̄ in the same basis [m].
    pub(super) second_form: Option<Vec<[f64; 3]>>,
}

const KEYS: [&str; 9] = [
    "thickness",
    "young",
    "poisson",
    "density",
    "young_across",
    "shear",
    "axis",
    "first_form",
    "second_form",
];

impl FaceFile {
    /// Reads the text of the file `name`.
    pub(super) fn parse(name: &str, text: &str) -> Result<Self, SceneError> {
        serde_json::from_str(text).map_err(|error| {
            let message = error.to_string();
            let unknown = message
                .strip_prefix("unknown field `")
                .and_then(|rest| rest.split_once('`'));
            let help = match unknown.and_then(|(key, _)| nearest(key, KEYS)) {
                Some(key) => format!("did you mean '{key}'? there are: {}", KEYS.join(", ")),
                None => format!(
                    "a face file is one JSON object of lists: {}",
                    KEYS.join(", ")
                ),
            };
            let message = match unknown {
                Some((key, _)) => format!(
                    "{name}: unknown key '{key}' in line {}, column {}",
                    error.line(),
                    error.column()
                ),
                None => format!("{name}: {message}"),
            };
            let kind = if unknown.is_some() {
                Kind::UnknownKey
            } else {
                Kind::WrongType
            };
            SceneError::new(kind, message).with_help(help)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_are_told_with_their_line_and_the_nearest_key() {
        let error = FaceFile::parse("a.json", "{\n\"thicknes\": [1]}").unwrap_err();
        assert!(
            error
                .message
                .starts_with("a.json: unknown key 'thicknes' in line 2"),
            "{error}"
        );
        assert!(error.help.unwrap().starts_with("did you mean 'thickness'?"));
        let error = FaceFile::parse("a.json", "{\"axis\": [[1, 0]]}").unwrap_err();
        assert!(error.message.contains("line 1"), "{error}");
        let sound = FaceFile::parse("a.json", "{\"poisson\": [0.3, 0.2]}").unwrap();
        assert_eq!(sound.poisson, Some(vec![0.3, 0.2]));
    }
}
