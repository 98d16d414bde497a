//! Vertices that a hand pulls at while a simulation goes on.

use std::f64::consts::TAU;

use super::simulation::Simulation;
use crate::Vec3;
use crate::bezier::Drag;
use crate::energy::loads::{Load, Pull};
use crate::mesh::VertexId;

/// Everything, hung on the spring of a pull, would swing in this time: fast enough to feel firm, slow enough for a step [s].
const PERIOD: f64 = 0.25;

/// A vertex of what frames show, pulled to a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexPull {
    /// Number of the vertex, counted through all parts ([`Simulation::parts`]).
    pub vertex: usize,
    /// Where to [m].
    pub target: Vec3,
}

/// Why a vertex cannot be pulled.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PullError {
    /// There are not so many.
    #[error("there is no vertex {0}")]
    NoSuchVertex(usize),
    /// Of an obstacle or a double layer.
    #[error("vertex {vertex} belongs to '{part}', which cannot be pulled: only shells can")]
    NoShell {
        /// The vertex.
        vertex: usize,
        /// What it belongs to.
        part: String,
    },
    /// A place without a number.
    #[error("vertex {0} cannot be pulled to a place that is not finite")]
    NotFinite(usize),
}

impl Simulation {
    /// Pulls at these vertices from the next step on, and at no others, each by a spring as stiff as makes the mass of all
    /// shells swing in a quarter of a second. Checkpoints do not know of it.
    ///
    /// # Errors
    /// A vertex that there is not, or that belongs to no shell; the pulls are then those before.
    pub fn set_pulls(&mut self, pulls: &[VertexPull]) -> Result<(), PullError> {
        let stiffness = self.shell_mass() * (TAU / PERIOD).powi(2);
        let places = pulls.iter().map(|pull| self.place(pull));
        let places = places.collect::<Result<Vec<_>, _>>()?;
        self.system.loads.loads.truncate(self.model.loads.len());
        let mut drags = Vec::new();
        for (pull, place) in pulls.iter().zip(places) {
            match place {
                Place::Vertex(shell, vertex) => {
                    let vertex = self.vertex(shell, vertex);
                    self.system.loads.loads.push(Load::Pull(Pull {
                        vertex,
                        node: self.system.layout.node(vertex),
                        target: pull.target,
                        stiffness,
                    }));
                }
                Place::Bezier(shown) => drags.push((shown, pull.target)),
            }
        }
        if let Some(body) = &mut self.bezier {
            let drag = |(shown, target): (usize, Vec3)| Drag {
                point: body.shown_point(shown),
                target,
                stiffness,
            };
            body.drags = drags.into_iter().map(drag).collect();
        }
        Ok(())
    }

    fn place(&self, pull: &VertexPull) -> Result<Place, PullError> {
        if !pull.target.iter().all(|x| x.is_finite()) {
            return Err(PullError::NotFinite(pull.vertex));
        }
        let (shells, layers) = (self.model.shells.len(), self.model.double_layers.len());
        let mut local = pull.vertex;
        for (index, part) in self.parts().iter().enumerate() {
            if local >= part.num_vertices {
                local -= part.num_vertices;
                continue;
            }
            if index < shells {
                return Ok(Place::Vertex(index, VertexId(local as u32)));
            }
            if index < shells + layers || part.is_obstacle {
                return Err(PullError::NoShell {
                    vertex: pull.vertex,
                    part: part.name.clone(),
                });
            }
            // The parts of Bézier shells follow each other.
            let before = self.parts()[shells + layers..index].iter();
            let first: usize = before.map(|part| part.num_vertices).sum();
            return Ok(Place::Bezier(first + local));
        }
        Err(PullError::NoSuchVertex(pull.vertex))
    }

    /// Mass of all shells [kg].
    fn shell_mass(&self) -> f64 {
        let bezier = (self.bezier.as_ref()).map_or(0.0, |body| body.moving.shell.mass());
        let of_shell = |shell: usize| {
            let vertices = 0..self.model.shells[shell].surface.positions.len();
            let first = |v: usize| self.vertex(shell, VertexId(v as u32)).0 as usize;
            vertices.map(|v| self.masses()[first(v)]).sum::<f64>()
        };
        bezier + (0..self.model.shells.len()).map(of_shell).sum::<f64>()
    }
}

/// What carries a vertex that is shown.
enum Place {
    Vertex(usize, VertexId),
    /// By its number among the vertices of all Bézier shells.
    Bezier(usize),
}
