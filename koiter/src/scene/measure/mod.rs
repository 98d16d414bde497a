//! The elastic energy of a given shape: what `koiter energy` and the benchmarks print.
//!
//! One shell without mass, loads and contact, made by the same code as the shells of scenes. Its positions are held, so
//! only the unknowns that the bending model adds are solved for.

mod directors;
mod free;
mod refinement;
pub mod shapes;

pub use directors::{Directors, natural_directors};
pub use free::FreeBending;
pub use refinement::{Refinement, Trend};

use std::ops::Range;

use super::assemble::{BuildError, Unknowns, write_points};
use super::bending_caveats::bending_caveat;
use super::composition_error::CompositionError;
use super::elastic::Elastic;
use super::model::{
    BendingModel, Composition, ContactOptions, IntegratorKind, Model, Shell, SolverOptions,
};
use crate::Vec3;
use crate::assembly::Energy;
use crate::energy::bending::ExtraUnknowns;
use crate::integrate::{relax_directors, relax_edge_points};
use crate::mesh::Surface;
use crate::rest::RestError;

/// A shape with its rest shape and what it is made of.
#[derive(Clone, Copy, Debug)]
pub struct Measurement<'a> {
    /// The shape whose energy is asked for.
    pub deformed: &'a Surface,
    /// Rest positions of its vertices [m]: they give the rest metric.
    pub rest_positions: &'a [Vec3],
    /// Whether the rest curvature is that of the rest positions (else zero: rest flat).
    pub rest_curved: bool,
    /// Bending model.
    pub model: BendingModel,
    /// Thickness [m].
    pub thickness: f64,
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
}

/// Energies of a shape.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// Membrane energy [J].
    pub membrane: f64,
    /// Bending energy [J]; 0 without a bending model.
    pub bending: f64,
    /// The directors: the unknowns that the model adds, node by node; empty for models of positions alone.
    pub directors: Vec<f64>,
}

/// First derivatives of the energies of a shape.
#[derive(Clone, Debug, Default)]
pub struct MeasuredGradient {
    /// Of the membrane energy by the positions [N], one a vertex.
    pub membrane: Vec<Vec3>,
    /// Of the bending energy by the positions [N], one a vertex.
    pub bending: Vec<Vec3>,
    /// Of the bending energy by the directors, in their order.
    pub directors: Vec<f64>,
}

/// A shape ready to be evaluated: its energies, and the unknowns at which they are taken.
pub struct MeasuredShape {
    membrane: Box<dyn Energy>,
    /// None without a bending model, two with DS(2nd).
    bending: Vec<Box<dyn Energy>>,
    q: Vec<f64>,
    vertices: Range<usize>,
    directors: Range<usize>,
}

impl Measurement<'_> {
    /// Finds the rest directors, which always minimise the bending energy of the rest shape, and those of the deformed
    /// shape as `directors` says.
    ///
    /// # Errors
    /// A rest face without area, directors that do not converge.
    ///
    /// # Panics
    /// If rest positions or given directors are not as many as the mesh and the model have.
    pub fn prepare(&self, directors: &Directors) -> Result<MeasuredShape, RestError> {
        let mesh = &self.deformed.mesh;
        assert_eq!(self.rest_positions.len(), mesh.num_vertices());
        let (unknowns, elastic, mut q) = self.build(Unknowns::with_held_vertices)?;
        let mut energies = elastic.energies.into_iter();
        let part = &elastic.parts[0];
        let (range, first_vertex) = (part.extra_dofs(), part.first_vertex);
        let membrane = energies.next().expect("every shell has a membrane");
        let mut bending: Vec<_> = energies.collect();
        write_points(&mut q, first_vertex, &self.deformed.positions);
        // Building the rest state found its directors, but not the points of edges, which have no rest state.
        let is_found = self.is_at_rest() && part.extra != ExtraUnknowns::EdgePoints;
        match directors {
            Directors::Zero => q[range.clone()].copy_from_slice(&natural_directors(
                self.model.info().unknowns,
                self.deformed,
            )),
            Directors::Given(values) => q[range.clone()].copy_from_slice(values),
            Directors::Minimise if is_found || range.is_empty() => {}
            Directors::Minimise => {
                let start = natural_directors(self.model.info().unknowns, self.deformed);
                q[range.clone()].copy_from_slice(&start);
                let (layout, range) = (&unknowns.layout, range.clone());
                let relaxed = if part.extra == ExtraUnknowns::EdgePoints {
                    let edge = self.deformed.mean_edge_length();
                    relax_edge_points(&mut bending, layout, range, edge, &mut q)
                } else {
                    relax_directors(bending[0].as_mut(), layout, range, &[], &mut q)
                };
                relaxed.map_err(RestError::of_shape_itself)?;
            }
        }
        Ok(MeasuredShape {
            membrane,
            bending,
            q,
            vertices: part.vertex_dofs(),
            directors: range,
        })
    }

    /// The energies at the directors of least bending energy.
    ///
    /// # Errors
    /// As [`Measurement::prepare`].
    pub fn energies(&self) -> Result<Measured, RestError> {
        Ok(self.prepare(&Directors::Minimise)?.energies())
    }

    /// What the bending model does not do here, in words, and what helps: quadratic bending on a curved rest shape, and
    /// models that are here for study only. Scenes warn of the same.
    pub fn caveat(&self) -> Option<(String, &'static str)> {
        bending_caveat(&self.at_rest().shells[0])
    }

    /// The shell in its rest shape: what it takes to build it is then what its rest state takes, whatever is asked of
    /// the deformed one.
    fn build(
        &self,
        unknowns: impl Fn(&Model) -> Unknowns,
    ) -> Result<(Unknowns, Elastic, Vec<f64>), RestError> {
        let model = self.at_rest();
        let unknowns = unknowns(&model);
        let (mut q, _) = unknowns.start(&model);
        let elastic = Elastic::new(&model, &unknowns, &mut q).map_err(|error| match error {
            // The shape itself, as its own rest shape.
            BuildError::Rest { error, .. } if self.is_at_rest() => error.of_shape_itself(),
            BuildError::Rest { error, .. }
            | BuildError::Composition {
                error: CompositionError::Rest(error),
                ..
            } => error,
            other => unreachable!("a single shell without contact: {other}"),
        })?;
        Ok((unknowns, elastic, q))
    }

    fn is_at_rest(&self) -> bool {
        self.deformed.positions == self.rest_positions
    }

    /// A model of one shell in its rest shape, without anything else.
    fn at_rest(&self) -> Model {
        let shell = Shell {
            name: "shape".into(),
            surface: Surface {
                mesh: self.deformed.mesh.clone(),
                positions: self.rest_positions.to_vec(),
            },
            velocities: vec![Vec3::zeros(); self.rest_positions.len()],
            rest_positions: self.rest_positions.to_vec(),
            rest_curved: self.rest_curved,
            thickness: self.thickness,
            density: 0.0,
            youngs_modulus: self.youngs_modulus,
            poissons_ratio: self.poissons_ratio,
            composition: Composition::default(),
            bending: self.model,
            friction: 0.0,
            contact_offset: 0.0,
        };
        Model {
            shells: vec![shell],
            double_layers: Vec::new(),
            heated_shells: Vec::new(),
            bezier: None,
            heat_sources: Vec::new(),
            obstacles: Vec::new(),
            constraints: Vec::new(),
            gravity: Vec3::zeros(),
            gravity_scale: None,
            loads: Vec::new(),
            energies: Vec::new(),
            processes: Vec::new(),
            symmetry_planes: Vec::new(),
            contact: ContactOptions {
                enabled: false,
                ..ContactOptions::default()
            },
            solver: SolverOptions::default(),
            integrator: IntegratorKind::QuasiStatic,
            phases: Vec::new(),
        }
    }
}

impl MeasuredShape {
    /// The energies.
    pub fn energies(&self) -> Measured {
        Measured {
            membrane: self.membrane.value(&self.q),
            bending: self.bending.iter().map(|e| e.value(&self.q)).sum(),
            directors: self.q[self.directors.clone()].to_vec(),
        }
    }

    /// Whether the bending energy is defined here: that of BAC is not where a director is tilted by π/2.
    pub fn is_admissible(&self) -> bool {
        self.bending.iter().all(|e| e.is_admissible(&self.q))
    }

    /// The gradients.
    pub fn gradient(&self) -> MeasuredGradient {
        let points = |gradient: &[f64]| -> Vec<Vec3> {
            let components = gradient[self.vertices.clone()].chunks_exact(3);
            components.map(Vec3::from_column_slice).collect()
        };
        let mut membrane = vec![0.0; self.q.len()];
        self.membrane.add_gradient(&self.q, &mut membrane);
        let mut bending = vec![0.0; self.q.len()];
        for energy in &self.bending {
            energy.add_gradient(&self.q, &mut bending);
        }
        MeasuredGradient {
            membrane: points(&membrane),
            bending: points(&bending),
            directors: bending[self.directors.clone()].to_vec(),
        }
    }
}

#[cfg(test)]
mod tests;
