//! From the loads of a model to their energies, and along their schedules.

use std::fmt;

use super::assemble::BuildError;
use super::elastic::rest_surface;
use super::model::{self, LoadKind, Model, Phase};
use crate::Vec3;
use crate::assembly::{Assembled, Dof, DofLayout};
use crate::energy::bending::ExtraUnknowns;
use crate::energy::loads::{
    DeadLoad, DirectorMoment, EdgeMoment, Load, Loads, Pressure, TurnedDirectors, TurnedEdge,
    VertexForce,
};
use crate::integrate::ShellPart;
use crate::mesh::{EdgeId, Surface, TriMesh, VertexId};

/// All loads at time 0; directors of `q` are where turning is measured from.
pub(super) fn loads(
    model: &Model,
    parts: &[ShellPart],
    layout: &DofLayout,
    q: &[f64],
) -> Result<Loads, BuildError> {
    let made = model
        .loads
        .iter()
        .map(|load| one(model, load, parts, layout));
    let mut loads = Loads {
        loads: made.collect::<Result<_, _>>()?,
    };
    loads.restore_turned(&vec![0.0; loads.turned().len()], q);
    set_factors(model, &model.all_phases()[0], 0.0, &mut loads);
    Ok(loads)
}

/// Sets all factors to those of a time [s] in a phase.
pub(super) fn set_factors(model: &Model, phase: &Phase, time: f64, loads: &mut Loads) {
    let acting = model.loads.iter().zip(&phase.loads);
    for ((spec, acts), load) in acting.zip(&mut loads.loads) {
        load.set_factor(match (acts, &spec.scale) {
            (false, _) => 0.0,
            (true, Some(scale)) => scale.at(time),
            (true, None) => 1.0,
        });
    }
}

fn one(
    model: &Model,
    load: &model::Load,
    parts: &[ShellPart],
    layout: &DofLayout,
) -> Result<Load, BuildError> {
    let (shell, part) = (&model.shells[load.shell], &parts[load.shell]);
    Ok(match &load.kind {
        LoadKind::Pressure { pressure, origin } => {
            let corner = |v: u32| Dof(part.first_vertex.0 + 3 * v);
            let pressure = Pressure {
                faces: part
                    .mesh
                    .faces()
                    .iter()
                    .map(|face| face.map(corner))
                    .collect(),
                pressure: *pressure,
                origin: *origin,
                factor: 1.0,
            };
            Load::Pressure(Assembled::new(pressure, layout))
        }
        LoadKind::Moment { edges, moment } => {
            let rest = rest_surface(shell);
            let moments = edges.iter().map(|edge| {
                let length = rest.edge_length(edge.0 as usize);
                (*edge, moment * length)
            });
            match part.extra {
                ExtraUnknowns::EdgeAngles => {
                    let edges = moments.map(|(edge, moment)| turned_edge(part, edge, moment));
                    let edges = edges.collect();
                    Load::Moment(Assembled::new(EdgeMoment { edges, factor: 1.0 }, layout))
                }
                ExtraUnknowns::VertexDirectors => {
                    let edges = moments.map(|(edge, moment)| turned_directors(part, edge, moment));
                    let edges = edges.collect();
                    let moment = DirectorMoment { edges, factor: 1.0 };
                    Load::DirectorMoment(Assembled::new(moment, layout))
                }
                ExtraUnknowns::None | ExtraUnknowns::EdgePoints => {
                    return Err(BuildError::MomentWithoutDirectors {
                        load: load.name.clone(),
                        shell: shell.name.clone(),
                    });
                }
            }
        }
        dead => {
            let rest = rest_surface(shell);
            let start = &shell.surface.positions;
            let forces = vertex_forces(dead, &rest).into_iter().enumerate();
            let on_vertices = forces.filter(|(_, force)| *force != Vec3::zeros());
            let forces = on_vertices.map(|(v, force)| VertexForce {
                vertex: Dof(part.first_vertex.0 + 3 * v as u32),
                force,
                start: start[v],
            });
            Load::Dead(DeadLoad {
                forces: forces.collect(),
                factor: 1.0,
            })
        }
    })
}

/// The force on every vertex [N] of a dead load.
pub(super) fn vertex_forces(kind: &LoadKind, rest: &Surface) -> Vec<Vec3> {
    let mut forces = vec![Vec3::zeros(); rest.positions.len()];
    match kind {
        LoadKind::Point { vertices, force } => {
            for VertexId(vertex) in vertices {
                forces[*vertex as usize] += force;
            }
        }
        LoadKind::Edge { edges, force } => {
            for EdgeId(edge) in edges {
                let half = force * (0.5 * rest.edge_length(*edge as usize));
                for end in rest.mesh.edges()[*edge as usize] {
                    forces[end as usize] += half;
                }
            }
        }
        LoadKind::Area { faces, force } => {
            for face in faces {
                let third = force * (rest.face_area(face.0 as usize) / 3.0);
                for corner in rest.mesh.faces()[face.0 as usize] {
                    forces[corner as usize] += third;
                }
            }
        }
        LoadKind::Pressure { .. } | LoadKind::Moment { .. } | LoadKind::Turning { .. } => {}
    }
    forces
}

/// The edge as seen from its face, or, of two, from that which traverses it from the smaller to the larger vertex.
fn turned_edge(part: &ShellPart, edge: EdgeId, moment: f64) -> TurnedEdge {
    let (face, corner) = side(&part.mesh, edge);
    let stencil = &part.stencils[face];
    let ends = [(corner + 1) % 3, (corner + 2) % 3];
    TurnedEdge {
        corners: [
            stencil.corners[ends[0]],
            stencil.corners[ends[1]],
            stencil.corners[corner],
        ],
        across: stencil.across[corner],
        angle: stencil.angles[corner],
        sign: stencil.signs[corner],
        moment,
        // Both are set when turning is first measured.
        reference: Vec3::zeros(),
        turned: 0.0,
        vertices: part.mesh.edges()[edge.0 as usize],
    }
}

/// The edge with the directors of its ends, which are seen like in [`turned_edge`].
fn turned_directors(part: &ShellPart, edge: EdgeId, moment: f64) -> TurnedDirectors {
    let (face, corner) = side(&part.mesh, edge);
    let corners = part.mesh.faces()[face];
    let vertices = [corners[(corner + 1) % 3], corners[(corner + 2) % 3]];
    TurnedDirectors {
        ends: vertices.map(|v| Dof(part.first_vertex.0 + 3 * v)),
        directors: vertices.map(|v| Dof(part.first_extra.0 + 3 * v)),
        moment,
        // Both are set when turning is first measured.
        references: [Vec3::zeros(); 2],
        turned: 0.0,
        vertices: part.mesh.edges()[edge.0 as usize],
    }
}

/// The face of the first side of an edge that has one, and its corner opposite the edge.
pub(super) fn side(mesh: &TriMesh, edge: EdgeId) -> (usize, usize) {
    let [first, second] = mesh.edge_faces()[edge.0 as usize];
    let face = first.or(second).expect("every edge has a face").0 as usize;
    let corner = mesh.face_edges()[face].iter().position(|e| *e == edge);
    (face, corner.expect("the face has the edge"))
}

/// What a load adds up to at a factor of 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum LoadTotal {
    /// Sum of the forces [N].
    Force(Vec3),
    /// Pressure [Pa].
    Pressure(f64),
    /// Sum of the moments of all edges, whatever their directions [N·m].
    Moment(f64),
}

impl Model {
    /// What a load adds up to.
    pub fn load_total(&self, load: &model::Load) -> LoadTotal {
        let rest = rest_surface(self.observed_shell(load.shell));
        match &load.kind {
            LoadKind::Pressure { pressure, .. } => LoadTotal::Pressure(*pressure),
            LoadKind::Moment { edges, moment } => {
                let lengths = edges.iter().map(|edge| rest.edge_length(edge.0 as usize));
                LoadTotal::Moment(moment * lengths.sum::<f64>())
            }
            LoadKind::Turning { vertices, moment } => {
                LoadTotal::Moment(moment.norm() * vertices.len() as f64)
            }
            dead => LoadTotal::Force(vertex_forces(dead, &rest).iter().sum()),
        }
    }

    /// The shell with an index, which is that of a Bézier shell where there are such.
    pub fn observed_shell(&self, index: usize) -> &model::Shell {
        match &self.bezier {
            Some(bezier) => &bezier.parts[index].shell,
            None => &self.shells[index],
        }
    }
}

impl fmt::Display for LoadTotal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Force(v) => write!(f, "[{:.4e}, {:.4e}, {:.4e}] N in all", v.x, v.y, v.z),
            Self::Pressure(pressure) => write!(f, "a pressure of {pressure:.4e} Pa"),
            Self::Moment(moment) => write!(f, "moments of {moment:.4e} N·m in all"),
        }
    }
}
