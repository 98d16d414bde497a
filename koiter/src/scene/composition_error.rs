//! What a shell cannot be made of.

use crate::material::ModuliError;
use crate::rest::RestError;

/// Why a shell cannot be made as it is described.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompositionError {
    /// A list that does not fit the mesh.
    #[error("'{what}' has {found} values, but the mesh has {faces} faces")]
    Count {
        /// Name of the list.
        what: &'static str,
        /// Its length.
        found: usize,
        /// Faces of the mesh.
        faces: usize,
    },
    /// A value of a face out of its range.
    #[error("'{what}' of face {face} is {value}: {expected}")]
    Value {
        /// Name of the list.
        what: &'static str,
        /// The face.
        face: usize,
        /// The value.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// Constants that no material has.
    #[error("face {face}: {error}")]
    Moduli {
        /// The face.
        face: usize,
        /// What is wrong.
        error: ModuliError,
    },
    /// An axis that has no direction on a face.
    #[error("the material's axis stands upright on face {face}: it has no direction there")]
    Axis {
        /// The face.
        face: usize,
    },
    /// A first form that measures no lengths.
    #[error("the rest first form of face {face} is not positive definite")]
    Metric {
        /// The face.
        face: usize,
    },
    /// A rest mesh that cannot be used.
    #[error(transparent)]
    Rest(#[from] RestError),
    /// Values of faces that layers have themselves.
    #[error("layers have their own thickness and modulus: '{what}' cannot be given by face")]
    Layers {
        /// Name of the list.
        what: &'static str,
    },
    /// A membrane of springs.
    #[error(
        "membrane 'discrete-shells' resists alike in all directions, in tension and compression: a material that is \
         {material} needs membrane 'koiter'"
    )]
    Springs {
        /// The law.
        material: &'static str,
    },
    /// A bending model of hinges.
    #[error(
        "bending model '{model}' knows isotropic rigidities and the angles of the rest mesh, not {what}: take one that has \
         a second fundamental form, such as bac"
    )]
    Hinges {
        /// Name of the model.
        model: &'static str,
        /// What it does not know.
        what: &'static str,
    },
}
