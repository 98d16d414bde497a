//! What a shell is made of: from a law and numbers to the section of every face.

use std::sync::Arc;

use super::model::Shell;
use crate::material::{Homogeneous, Section, StVenantKirchhoff};

/// What sets a shell apart from one isotropic St. Venant–Kirchhoff material of one thickness; the default is nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Composition {
    /// How stress follows from strain.
    pub law: MaterialLaw,
}

/// How stress follows from strain, with the constants that not all laws have.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum MaterialLaw {
    /// Isotropic, quadratic in the Green strain.
    #[default]
    StVenantKirchhoff,
}

impl Shell {
    /// What the shell resists with.
    pub fn section(&self) -> Arc<dyn Section> {
        let num_faces = self.surface.mesh.num_faces();
        match &self.composition.law {
            MaterialLaw::StVenantKirchhoff => {
                let material = StVenantKirchhoff::new(self.youngs_modulus, self.poissons_ratio);
                Arc::new(Homogeneous::uniform(material, self.thickness, num_faces))
            }
        }
    }
}
