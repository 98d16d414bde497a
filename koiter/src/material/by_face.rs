//! A material of its own on every face.

use nalgebra::Vector3;

use super::{Density, Material, Response};
use crate::geometry::Real;

/// The material of every face: moduli that vary, or axes turned into the frames of the faces.
#[derive(Clone, Debug, PartialEq)]
pub struct ByFace<M>(pub Vec<M>);

impl<M: Material> Material for ByFace<M> {
    fn response(&self, face: usize, strain: &Vector3<f64>) -> Response {
        self.0[face].response(face, strain)
    }
    fn linearized(&self, face: usize, strain: &Vector3<f64>) -> Response {
        self.0[face].linearized(face, strain)
    }
    fn is_admissible(&self, face: usize, strain: &Vector3<f64>) -> bool {
        self.0[face].is_admissible(face, strain)
    }
}

impl<M: Density> Density for ByFace<M> {
    fn formula<R: Real>(&self, face: usize, strain: [R; 3]) -> R {
        self.0[face].formula(face, strain)
    }
}
