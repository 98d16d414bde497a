//! From strain to energy density, stress and tangent, and from materials to the law of a shell. Knows no mesh.

pub mod presets;
mod section;
mod st_venant_kirchhoff;

pub use section::{Homogeneous, Section};
pub use st_venant_kirchhoff::StVenantKirchhoff;

use std::fmt::Debug;

use nalgebra::{Matrix3, Vector3};

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
        let tangent = self.response(face, &Vector3::zeros()).tangent;
        let stress = tangent * strain;
        Response {
            density: 0.5 * stress.dot(strain),
            stress,
            tangent,
        }
    }
}
