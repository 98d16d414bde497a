//! Clamped edges: from constraints to prescribed directors, and along their motions.

use super::model::{BendingModel, Constraint, Model};
use super::schedule::MotionPart;
use super::vertex_directors::HeldDirector;
use crate::Vec3;
use crate::assembly::Dof;
use crate::energy::bending::{ClampedEdge, DirectorClamp, ExtraUnknowns};
use crate::integrate::ShellPart;
use crate::mesh::{EdgeId, FaceId};

/// Stiffness of a clamp, in units of the bending stiffness of its face: the director of a clamped edge is then wrong by
/// 10⁻⁴ of what the face itself bends, and the matrix is no worse conditioned than by the membrane.
const STIFFNESS: f64 = 1e4;

/// The same for models without directors: half a cell between a clamped edge and the normal of its face, which bends as the
/// face would: curvature 2 ψ/a over the distance a/2.
const HALF_CELL: f64 = 2.0;

/// Where a clamped edge came from.
#[derive(Clone)]
struct Source {
    constraint: usize,
    /// A face that sees the edge, and its corner there.
    face: usize,
    corner: usize,
    start_ends: [Vec3; 2],
    start_director: Vec3,
    stiffness: f64,
}

impl Source {
    fn begin(&mut self, part: &ShellPart, q: &[f64]) {
        (self.start_ends, self.start_director) = edge_and_director(part, self.face, self.corner, q);
    }
}

/// Ends of an edge as its face traverses it, and its unit director.
fn edge_and_director(part: &ShellPart, face: usize, corner: usize, q: &[f64]) -> ([Vec3; 2], Vec3) {
    let vertices = part.mesh.faces()[face];
    let ends = [vertices[(corner + 1) % 3], vertices[(corner + 2) % 3]];
    let director = part.directors(face, q)[corner].normalize();
    (ends.map(|v| part.position(v as usize, q)), director)
}

/// The point of an edge between clamped vertices: it moves with them.
#[derive(Clone)]
pub(super) struct HeldPoint {
    /// The point.
    pub(super) dof: Dof,
    /// Index of the constraint.
    pub(super) constraint: usize,
    /// When the clamp begins [m].
    pub(super) start: Vec3,
}

impl HeldPoint {
    fn of_constraint(
        index: usize,
        constraint: &Constraint,
        part: &ShellPart,
        q: &[f64],
    ) -> Vec<Self> {
        let held = |(edge, ..): (usize, usize, usize)| {
            let dof = Dof(part.first_extra.0 + 3 * edge as u32);
            Self {
                dof,
                constraint: index,
                start: Self::read(dof, q),
            }
        };
        held_edges(constraint, part).into_iter().map(held).collect()
    }

    fn read(dof: Dof, q: &[f64]) -> Vec3 {
        let start = dof.0 as usize;
        Vec3::from_column_slice(&q[start..start + 3])
    }
}

/// All clamped edges and vertices of a scene.
#[derive(Clone)]
pub(super) struct Clamps {
    sources: Vec<Source>,
    /// Directors of clamped vertices.
    pub(super) held_directors: Vec<HeldDirector>,
    /// Points of edges between clamped vertices.
    pub(super) held_points: Vec<HeldPoint>,
}

impl Clamps {
    /// Edges between vertices whose three coordinates a clamping constraint holds, and the directors of such vertices.
    pub(super) fn new(model: &Model, parts: &[ShellPart], q: &[f64]) -> (Self, DirectorClamp) {
        let mut sources = Vec::new();
        let mut held_directors = Vec::new();
        let mut held_points = Vec::new();
        let mut edges = Vec::new();
        for (index, constraint) in model.constraints.iter().enumerate() {
            let part = &parts[constraint.shell];
            let is_membrane = model.shells[constraint.shell].bending == BendingModel::None;
            if !constraint.clamp_directors || constraint.axes != [true; 3] || is_membrane {
                continue;
            }
            match part.extra {
                ExtraUnknowns::EdgeAngles | ExtraUnknowns::None => {}
                ExtraUnknowns::VertexDirectors => {
                    held_directors.extend(
                        constraint.vertices.iter().map(|v| {
                            HeldDirector::new(index, Dof(part.first_extra.0 + 3 * v.0), q)
                        }),
                    );
                    continue;
                }
                ExtraUnknowns::EdgePoints => {
                    held_points.extend(HeldPoint::of_constraint(index, constraint, part, q));
                    continue;
                }
            }
            let has_angles = part.extra == ExtraUnknowns::EdgeAngles;
            let factor = if has_angles { STIFFNESS } else { HALF_CELL };
            // Between two faces a model without directors has a hinge already.
            let of_model = |(edge, ..): &(usize, usize, usize)| {
                has_angles || part.mesh.is_boundary_edge(EdgeId(*edge as u32))
            };
            for (edge, face, corner) in held_edges(constraint, part).into_iter().filter(of_model) {
                let (start_ends, start_director) = edge_and_director(part, face, corner, q);
                let along = start_ends[1] - start_ends[0];
                let apex = part.face_corners(face, q)[corner] - start_ends[0];
                let altitude = along.cross(&apex).norm() / along.norm();
                let rigidity = part.section.flexural_rigidity(face);
                let stiffness = clamp_stiffness(rigidity, factor, along.norm(), altitude);
                let stencil = &part.stencils[face];
                sources.push(Source {
                    constraint: index,
                    face,
                    corner,
                    start_ends,
                    start_director,
                    stiffness,
                });
                edges.push(ClampedEdge {
                    apex: stencil.corners[corner],
                    across: stencil.across[corner],
                    angle: has_angles.then_some(stencil.angles[corner]),
                    sign: stencil.signs[corner],
                    ends: start_ends,
                    director: start_director,
                    stiffness,
                    vertices: part.mesh.edges()[edge],
                });
            }
        }
        let clamps = Self {
            sources,
            held_directors,
            held_points,
        };
        (clamps, DirectorClamp { edges })
    }

    /// The part of a clamp that one constraint makes.
    pub(super) fn of_constraint(&self, constraint: usize, clamp: &DirectorClamp) -> DirectorClamp {
        let edges = self.sources.iter().zip(&clamp.edges);
        let own = edges.filter(|(source, _)| source.constraint == constraint);
        DirectorClamp {
            edges: own.map(|(_, edge)| *edge).collect(),
        }
    }

    /// A constraint begins: what it holds is held from where it is in `q`.
    pub(super) fn begin(&mut self, constraint: usize, part: &ShellPart, q: &[f64]) {
        for source in &mut self.sources {
            if source.constraint == constraint {
                source.begin(part, q);
            }
        }
        for held in &mut self.held_directors {
            if held.constraint == constraint {
                held.begin(q);
            }
        }
        for held in &mut self.held_points {
            if held.constraint == constraint {
                held.start = HeldPoint::read(held.dof, q);
            }
        }
    }

    /// Moves the prescribed edges by the motion of their constraint; it is `None` for one that does not act.
    pub(super) fn advance<'a>(
        &self,
        motion: impl Fn(usize) -> Option<MotionPart<'a>>,
        clamp: &mut DirectorClamp,
    ) {
        for (source, edge) in self.sources.iter().zip(&mut clamp.edges) {
            let Some(motion) = motion(source.constraint) else {
                edge.stiffness = 0.0;
                continue;
            };
            edge.ends = source.start_ends.map(|x| motion.point(x));
            edge.director = motion.normal(source.start_director);
            edge.stiffness = source.stiffness;
        }
    }
}

/// `factor` times the stiffness [J/rad²] with which a face of this rigidity [N·m] and altitude [m] resists a turning of
/// its edge of this length [m].
pub(super) fn clamp_stiffness(rigidity: f64, factor: f64, length: f64, altitude: f64) -> f64 {
    factor * rigidity * length / altitude
}

/// Edges with both ends held, each with a face that sees it and its corner there.
fn held_edges(constraint: &Constraint, part: &ShellPart) -> Vec<(usize, usize, usize)> {
    let mut held = vec![false; part.mesh.num_vertices()];
    for vertex in &constraint.vertices {
        held[vertex.0 as usize] = true;
    }
    let mut found = Vec::new();
    for (edge, [u, v]) in part.mesh.edges().iter().enumerate() {
        if held[*u as usize] && held[*v as usize] {
            let [first, second] = part.mesh.edge_faces()[edge];
            let FaceId(face) = first.or(second).expect("every edge has a face");
            let edges = part.mesh.face_edges()[face as usize];
            let corner = edges
                .iter()
                .position(|e| *e == EdgeId(edge as u32))
                .expect("the face has the edge");
            found.push((edge, face as usize, corner));
        }
    }
    found
}
