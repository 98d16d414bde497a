//! The bending energy of a given shape over all its unknowns, positions included: for measuring what evaluations cost.

use super::{Measurement, natural_directors};
use crate::assembly::{DofLayout, Energy};
use crate::rest::RestError;
use crate::scene::assemble::{Unknowns, write_points};

/// Bending energies of a shape, their unknowns and the shape as a point among them.
pub struct FreeBending {
    /// The energies that make up the bending model: two for DS(2nd), with vertex directors one that holds their length.
    pub energies: Vec<Box<dyn Energy>>,
    /// Grouping of the unknowns, all of which are solved for.
    pub layout: DofLayout,
    /// The shape, with its natural directors.
    pub q: Vec<f64>,
}

impl Measurement<'_> {
    /// The bending energy as a solver sees it.
    ///
    /// # Errors
    /// A rest face without area, rest directors that do not converge.
    pub fn free_bending(&self) -> Result<FreeBending, RestError> {
        let (unknowns, elastic, mut q) = self.build(Unknowns::new)?;
        let part = &elastic.parts[0];
        write_points(&mut q, part.first_vertex, &self.deformed.positions);
        q[part.extra_dofs()].copy_from_slice(&natural_directors(
            self.model.info().unknowns,
            self.deformed,
        ));
        Ok(FreeBending {
            energies: elastic.energies.into_iter().skip(1).collect(),
            layout: unknowns.layout,
            q,
        })
    }
}
