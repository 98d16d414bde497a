//! From strain to energy density, stress and tangent, and from materials to the law of a shell. Knows no mesh.

mod by_face;
mod layered;
mod moduli_error;
mod neo_hookean;
mod orthotropic;
pub mod presets;
mod section;
mod st_venant_kirchhoff;
mod tension_field;

pub use by_face::ByFace;
pub use layered::{Layer, Layered};
pub use moduli_error::ModuliError;
use moduli_error::positive;
pub use neo_hookean::NeoHookean;
pub use orthotropic::{Orthotropic, OrthotropicModuli};
pub use section::{Homogeneous, Section};
pub use st_venant_kirchhoff::StVenantKirchhoff;
pub use tension_field::{TensionField, TensionState};

use std::fmt::Debug;

use nalgebra::{Matrix3, Vector3};

use crate::geometry::Real;

/// A response at one strain: density w, stress ∂w/∂ε, tangent ∂²w/∂ε². Of a material w is in Pa, of a [`Section`] in
/// J/m².
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// w.
    pub density: f64,
    /// ∂w/∂(ε₁₁, ε₂₂, ε₁₂).
    pub stress: Vector3<f64>,
    /// Second derivatives in the same order.
    pub tangent: Matrix3<f64>,
}

impl Response {
    /// Of the density `½ εᵀ T ε`.
    #[inline]
    pub fn quadratic(tangent: Matrix3<f64>, strain: &Vector3<f64>) -> Self {
        let stress = tangent * strain;
        Self {
            density: 0.5 * stress.dot(strain),
            stress,
            tangent,
        }
    }

    /// The response of `factor` times the density.
    #[inline]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            density: self.density * factor,
            stress: self.stress * factor,
            tangent: self.tangent * factor,
        }
    }
}

/// An elastic material in plane stress, in an orthonormal basis of the rest face.
pub trait Material: Send + Sync + Debug {
    /// The response of face `face` at the Green strain with components `(ε₁₁, ε₂₂, ε₁₂)`.
    fn response(&self, face: usize, strain: &Vector3<f64>) -> Response;
    /// The response of the quadratic density with this material's tangent at zero strain.
    fn linearized(&self, face: usize, strain: &Vector3<f64>) -> Response {
        Response::quadratic(self.response(face, &Vector3::zeros()).tangent, strain)
    }
    /// Whether the density is finite at this strain.
    fn is_admissible(&self, _face: usize, _strain: &Vector3<f64>) -> bool {
        true
    }
}

/// A density over any numbers: the oracle of the tests.
pub trait Density: Material {
    /// w [Pa].
    fn formula<R: Real>(&self, face: usize, strain: [R; 3]) -> R;
}
