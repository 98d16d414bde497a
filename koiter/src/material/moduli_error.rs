//! Constants that no material has.

/// Why a material cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModuliError {
    /// A number that must be positive.
    #[error("{what} must be larger than 0, but it is {value}")]
    NotPositive {
        /// What it is.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A Poisson's ratio for which the energy is not positive definite, or not unique.
    #[error("Poisson's ratio must lie between {low} and {high}, but it is {value}")]
    PoissonsRatio {
        /// Its value.
        value: f64,
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
    },
    /// A layered material without layers.
    #[error("there must be at least one layer")]
    NoLayers,
}

/// Passes a finite number above 0.
pub(super) fn positive(what: &'static str, value: f64) -> Result<(), ModuliError> {
    match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(ModuliError::NotPositive { what, value }),
    }
}
