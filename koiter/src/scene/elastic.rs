//! From the shells of a model to their membranes, bending energies and masses.

use std::sync::Arc;

use nalgebra::Vector3;

use super::assemble::{BuildError, Unknowns, write_points};
use super::composition::Composed;
use super::composition_error::CompositionError;
use super::damping::dampers;
use super::model::{BendingModel, MembraneModel, Model, Shell};
use super::position_bending::PositionBending;
use super::symmetry::held_directors;
use super::vertex_directors::kirchhoff_bending;
use crate::Vec3;
use crate::assembly::{Assembled, Dof, DofLayout, Energy};
use crate::energy::bending::{
    AngleProfile, DirectorShape, ExtraUnknowns, Identity, LaplacianMesh, MidEdgeBending, Sine,
    Tangent, bending_stencils,
};
use crate::energy::{EdgeLengths, FaceAreas, Membrane, StrainLimit};
use crate::integrate::{Damping, ShellPart, relax_directors};
use crate::material::Section;
use crate::mesh::Surface;
use crate::rest::RestError;

/// What the shells are made of.
pub(super) struct Elastic {
    pub(super) energies: Vec<Box<dyn Energy>>,
    /// Of every solved unknown [kg, or kg·m² for directors].
    pub(super) masses: Vec<f64>,
    pub(super) damping: Damping,
    pub(super) parts: Vec<ShellPart>,
}

impl Elastic {
    /// Membranes, bending and masses of all shells; relaxes the directors in `q`.
    pub(super) fn new(
        model: &Model,
        unknowns: &Unknowns,
        q: &mut [f64],
    ) -> Result<Self, BuildError> {
        let mut elastic = Self {
            energies: Vec::new(),
            masses: vec![0.0; unknowns.layout.num_dofs()],
            damping: Damping::default(),
            parts: Vec::new(),
        };
        let firsts = unknowns.vertices.iter().zip(&unknowns.extras);
        for (index, (&first_vertex, &first_extra)) in firsts.enumerate() {
            let shell = &model.shells[index];
            let part = shell_part(shell, first_vertex, first_extra).map_err(|error| {
                BuildError::Composition {
                    shell: shell.name.clone(),
                    error,
                }
            })?;
            elastic.add_strain_limit(shell, &part, &unknowns.layout, q)?;
            let held = |part: &ShellPart, q: &[f64]| held_directors(model, index, part, q);
            elastic
                .add(shell, part, &held, &unknowns.layout, q)
                .map_err(|error| BuildError::Rest {
                    shell: shell.name.clone(),
                    error,
                })?;
        }
        elastic.masses.truncate(unknowns.layout.num_solved_dofs());
        elastic.add_drag(model);
        Ok(elastic)
    }

    /// The barrier of a shell whose stretch is limited.
    fn add_strain_limit(
        &mut self,
        shell: &Shell,
        part: &ShellPart,
        layout: &DofLayout,
        q: &[f64],
    ) -> Result<(), BuildError> {
        let Some(limit) = shell.composition.stretch_limit else {
            return Ok(());
        };
        let frames = part.frames.iter().enumerate();
        let volumes: Vec<f64> = frames
            .map(|(face, frame)| frame.area * shell.face_thickness(face))
            .collect();
        let first = part.first_vertex;
        let energy = StrainLimit::new(&part.mesh, first, part.frames.clone(), limit, &volumes);
        if let Some((face, stretch)) = energy.first_beyond(|face| part.face_corners(face, q)) {
            return Err(BuildError::StretchedStart {
                shell: shell.name.clone(),
                face,
                stretch,
                limit: limit.stretch,
            });
        }
        self.energies.push(Box::new(Assembled::new(energy, layout)));
        Ok(())
    }

    /// Drag by mass, where some shell has it.
    fn add_drag(&mut self, model: &Model) {
        let rates = (model.shells.iter()).map(|shell| shell.composition.damping.mass);
        if rates.clone().all(|rate| rate == 0.0) {
            return;
        }
        let mut drag = vec![0.0; self.masses.len()];
        for (part, rate) in self.parts.iter().zip(rates) {
            for dof in part.vertex_dofs().chain(part.extra_dofs()) {
                // Measured shapes hold their vertices: these have no place among the solved unknowns.
                if let Some(mass) = self.masses.get(dof) {
                    drag[dof] = rate * mass;
                }
            }
        }
        self.damping.drag = drag;
    }

    fn add(
        &mut self,
        shell: &Shell,
        mut part: ShellPart,
        held: &HeldDirectors<'_>,
        layout: &DofLayout,
        q: &mut [f64],
    ) -> Result<(), RestError> {
        let masses = &mut self.masses;
        add_vertex_masses(shell, &part, masses);
        let first_membrane = self.energies.len();
        self.energies.extend(membrane(shell, &part, layout));
        part.membranes = first_membrane..self.energies.len();
        let bending = bending_energy(shell, &mut part, held, layout, q, masses)?;
        part.bending = (shell.bending.measures_curvature()).then_some(self.energies.len());
        self.energies.extend(bending);
        (self.damping.dampers).extend(dampers(shell, &part, layout));
        if shell.rest_curved && part.extra == ExtraUnknowns::None {
            // Without directors the forms are for display only, by bisectors at rest as deformed.
            let mut rest_q = q.to_vec();
            write_points(&mut rest_q, part.first_vertex, &shell.rest_positions);
            for face in 0..part.mesh.num_faces() {
                let of_shape = part.second_form(face, &rest_q);
                part.rest_forms[face] += of_shape;
            }
        }
        self.parts.push(part);
        Ok(())
    }
}

/// The membrane of a shell.
pub(super) fn membrane(
    shell: &Shell,
    part: &ShellPart,
    layout: &DofLayout,
) -> Vec<Box<dyn Energy>> {
    let (mesh, first, frames, section) = (
        &part.mesh,
        part.first_vertex,
        &part.frames,
        part.section.clone(),
    );
    match shell.composition.membrane {
        MembraneModel::Koiter => {
            let faces = Membrane::new(mesh, first, frames.clone(), section);
            vec![Box::new(Assembled::new(faces, layout))]
        }
        MembraneModel::DiscreteShells => {
            let given = shell.composition.springs;
            let lengths = EdgeLengths::new(mesh, first, frames, &section, given);
            let areas = FaceAreas::new(mesh, first, frames, &section, given);
            vec![
                Box::new(Assembled::new(lengths, layout)),
                Box::new(Assembled::new(areas, layout)),
            ]
        }
    }
}

/// Which directors of a shell are held at the positions of a configuration, and their values.
pub(super) type HeldDirectors<'a> = dyn Fn(&ShellPart, &[f64]) -> Vec<(usize, f64)> + 'a;

/// The bending energy of a shell by its model.
fn bending_energy(
    shell: &Shell,
    part: &mut ShellPart,
    held: &HeldDirectors<'_>,
    layout: &DofLayout,
    q: &mut [f64],
    masses: &mut [f64],
) -> Result<Vec<Box<dyn Energy>>, RestError> {
    let positions = |part| PositionBending::new(shell, part, layout);
    let energy = match shell.bending {
        BendingModel::Bac => director_bending::<Tangent>(shell, part, held, layout, q, masses)?,
        BendingModel::Dcs => director_bending::<Sine>(shell, part, held, layout, q, masses)?,
        BendingModel::Dso => director_bending::<Identity>(shell, part, held, layout, q, masses)?,
        BendingModel::Dkt => Some(kirchhoff_bending(shell, part, held, layout, q, masses)?),
        BendingModel::MeAverage => Some(positions(part).mid_edge_average()),
        BendingModel::DsTheta => Some(positions(part).discrete_shells::<Identity>()),
        BendingModel::DsTan => Some(positions(part).discrete_shells::<Tangent>()),
        BendingModel::ChEs => Some(positions(part).corotational_edge()),
        BendingModel::ChFs => Some(positions(part).corotational_face()),
        BendingModel::QbCr => Some(positions(part).quadratic_hinge()),
        BendingModel::QbPl => Some(positions(part).quadratic_vertex(LaplacianMesh::Extrinsic)),
        BendingModel::QbInt => {
            Some(positions(part).quadratic_vertex(LaplacianMesh::IntrinsicDelaunay))
        }
        BendingModel::Ds2nd => {
            start_edge_points(part, q);
            return Ok(positions(part).second_order());
        }
        BendingModel::None => None,
    };
    Ok(energy.into_iter().collect())
}

/// Points of edges start at the middles of the edges: each patch is then the triangle, and the first step finds better.
fn start_edge_points(part: &ShellPart, q: &mut [f64]) {
    let middle = |[u, v]: &[u32; 2]| {
        let [u, v] = [u, v].map(|v| part.position(*v as usize, q));
        (u + v) * 0.5
    };
    let middles: Vec<Vec3> = part.mesh.edges().iter().map(middle).collect();
    write_points(q, part.first_extra, &middles);
}

/// How the directors of edges depend on tilts.
fn director_shape(bending: BendingModel) -> DirectorShape {
    match bending {
        BendingModel::Bac => DirectorShape::Tangent,
        BendingModel::Dcs | BendingModel::Dso => DirectorShape::Unit,
        BendingModel::Dkt
        | BendingModel::Ds2nd
        | BendingModel::MeAverage
        | BendingModel::DsTheta
        | BendingModel::DsTan
        | BendingModel::ChEs
        | BendingModel::ChFs
        | BendingModel::QbCr
        | BendingModel::QbPl
        | BendingModel::QbInt
        | BendingModel::None => DirectorShape::Bisector,
    }
}

fn shell_part(
    shell: &Shell,
    first_vertex: Dof,
    first_extra: Dof,
) -> Result<ShellPart, CompositionError> {
    let Composed {
        frames,
        rest_forms,
        section,
    } = shell.compose()?;
    Ok(ShellPart {
        name: shell.name.clone(),
        mesh: shell.surface.mesh.clone(),
        first_vertex,
        extra: shell.bending.info().unknowns,
        first_extra,
        frames,
        rest_forms,
        thickness: shell.thickness,
        section,
        director_shape: director_shape(shell.bending),
        stencils: bending_stencils(&shell.surface.mesh, first_vertex, first_extra),
        membranes: 0..0,
        bending: None,
    })
}

pub(super) fn rest_surface(shell: &Shell) -> Surface {
    Surface {
        mesh: shell.surface.mesh.clone(),
        positions: shell.rest_positions.clone(),
    }
}

/// Every vertex takes a third of the mass of its rest faces.
fn add_vertex_masses(shell: &Shell, part: &ShellPart, masses: &mut [f64]) {
    for (face, frame) in part.frames.iter().enumerate() {
        let third = shell.face_density(face) * shell.face_thickness(face) * frame.area / 3.0;
        for v in part.mesh.faces()[face] {
            let start = part.first_vertex.0 as usize + 3 * v as usize;
            masses[start..start + 3]
                .iter_mut()
                .for_each(|m| *m += third);
        }
    }
}

/// Bending with mid-edge directors and these rest forms.
pub(super) fn mid_edge_bending<P: AngleProfile>(
    part: &ShellPart,
    rest_forms: Vec<Vector3<f64>>,
    layout: &DofLayout,
) -> Assembled<MidEdgeBending<P, Arc<dyn Section>>, 21, 9> {
    let (stencils, frames) = (part.stencils.clone(), part.frames.clone());
    let bending = MidEdgeBending::new(stencils, frames, rest_forms, part.section.clone());
    Assembled::new(bending, layout)
}

/// Bending with mid-edge directors: finds the rest directors where the rest shape is curved, relaxes the directors of
/// the start shape in `q`, and adds their inertia.
fn director_bending<P: AngleProfile + 'static>(
    shell: &Shell,
    part: &mut ShellPart,
    held: &HeldDirectors<'_>,
    layout: &DofLayout,
    q: &mut [f64],
    masses: &mut [f64],
) -> Result<Option<Box<dyn Energy>>, RestError> {
    let num_faces = part.mesh.num_faces();
    let angles = part.extra_dofs();
    let flat = vec![Vector3::zeros(); num_faces];
    let mut rest_q = q.to_vec();
    write_points(&mut rest_q, part.first_vertex, &shell.rest_positions);
    let mut at_rest = mid_edge_bending::<P>(part, flat, layout);
    let held_at_rest = held(part, &rest_q);
    relax_directors(
        &mut at_rest,
        layout,
        angles.clone(),
        &held_at_rest,
        &mut rest_q,
    )?;
    if shell.rest_curved {
        for (face, form) in part.rest_forms.iter_mut().enumerate() {
            *form += (at_rest.local()).second_form(face, &at_rest.gather(face, &rest_q));
        }
    }
    add_director_inertia(shell, part, &at_rest, &rest_q, masses);
    let mut energy = mid_edge_bending::<P>(part, part.rest_forms.clone(), layout);
    // From the rest directors: where the start shape is the rest shape this is the exact minimum, round-off included.
    q[angles.clone()].copy_from_slice(&rest_q[angles.clone()]);
    let starts_at_rest =
        shell.surface.positions == shell.rest_positions && !shell.has_prescribed_curvature();
    if !starts_at_rest {
        relax_directors(&mut energy, layout, angles, &held(part, q), q)
            .map_err(RestError::of_shape_itself)?;
    }
    Ok(Some(Box::new(energy)))
}

/// "Better Bending", Eq. (52): every face gives its three edges ρ h³ Ā / 36, for BAC over cos⁴ of the rest tilt.
fn add_director_inertia<P: AngleProfile>(
    shell: &Shell,
    part: &ShellPart,
    bending: &Assembled<MidEdgeBending<P, Arc<dyn Section>>, 21, 9>,
    rest_q: &[f64],
    masses: &mut [f64],
) {
    for face in 0..part.mesh.num_faces() {
        let shares = bending
            .local()
            .director_inertia(face, &bending.gather(face, rest_q));
        let scale = shell.face_density(face) * shell.face_thickness(face).powi(3) / 12.0;
        for (edge, share) in part.mesh.face_edges()[face].iter().zip(shares) {
            masses[(part.first_extra.0 + edge.0) as usize] += scale * share;
        }
    }
}
