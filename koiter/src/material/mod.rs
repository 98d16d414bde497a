//! From strain to energy density, stress and tangent. Knows no mesh.

pub mod presets;
mod st_venant_kirchhoff;

pub use st_venant_kirchhoff::StVenantKirchhoff;

use nalgebra::{Matrix3, Vector3};

/// A response at one strain: density w [Pa], stress ∂w/∂ε, tangent ∂²w/∂ε².
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// w.
    pub density: f64,
    /// ∂w/∂(ε₁₁, ε₂₂, ε₁₂).
    pub stress: Vector3<f64>,
    /// Second derivatives in the same order.
    pub tangent: Matrix3<f64>,
}

/// An elastic material in plane stress, in an orthonormal basis of the rest face.
///
/// The same density serves both parts of a shell of thickness h: `h w(E)` with the Green strain E for the membrane and
/// `(h³/12) w(κ)` with the change of curvature κ for bending.
pub trait Material: Send + Sync {
    /// The response of face `face` at the symmetric strain with components `(ε₁₁, ε₂₂, ε₁₂)`.
    fn response(&self, face: usize, strain: &Vector3<f64>) -> Response;
}
