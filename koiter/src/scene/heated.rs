//! Elastic shells that burn: heat before each step, and what it does to rest forms, masses, faces and contact.
//!
//! Before a step [`HeatedShell`] heats, burns and tears at the shape of its start; then rest forms follow the lengths of the layers
//! ([`Shrinkage`]), masses those that are left, and faces that have gone take part in nothing. Vertices that belong to
//! none any more are held where they are, with their directors: unknowns stay numbered as they were. See `docs/decisions`.

use super::burning::heat_source;
use super::model::{MembraneModel, Model, Shell};
use super::processes::{Processes, bent, samples};
use super::simulation::Simulation;
use crate::Vec3;
use crate::assembly::Energy;
use crate::burning::{
    BurningError, HeatSource, HeatedMeasures, HeatedSetup, HeatedShell, HeatedState, Side,
};
use crate::energy::bending::{BendingStencil, ExtraUnknowns};
use crate::geometry::{Wing, hinge_angle};
use crate::integrate::{Prescribed, ShellPart, State, System};
use crate::process::{Shrinkage, Stretched};

/// A shell of a model that burns.
#[derive(Clone, Debug)]
pub struct HeatedPart {
    /// Index of the shell.
    pub shell: usize,
    /// How it burns.
    pub setup: HeatedSetup,
}

/// The burning shells of a simulation.
#[derive(Default)]
pub(super) struct Heated {
    shells: Vec<Acting>,
}

struct Acting {
    shell: usize,
    burning: HeatedShell,
    shrinkage: Shrinkage,
    /// Of the whole shell: masses of its vertices [kg], stencils of its faces.
    masses: Vec<f64>,
    stencils: Vec<BendingStencil>,
    thickness: Vec<f64>,
    /// Energies by their places, and what their elements are.
    energies: Vec<(usize, Elements)>,
    /// Place of its first vertex among all vertices.
    first_weight: usize,
    /// The faces that energies and contact know of.
    written: Vec<bool>,
}

/// What the elements of an energy are.
#[derive(Clone, Copy)]
enum Elements {
    Faces,
    Edges,
    InnerEdges,
}

impl Heated {
    /// The burning shells of a system that has just been made.
    pub(super) fn new(model: &Model, system: &System) -> Result<Self, (usize, BurningError)> {
        let make = |part: &HeatedPart| {
            let index = part.shell;
            let burning = HeatedShell::new(part.setup.clone()).map_err(|error| (index, error))?;
            let (shell, shown) = (&model.shells[index], &system.space.shells[index]);
            let num_faces = shown.mesh.num_faces();
            let thickness: Vec<f64> = (0..num_faces).map(|f| shell.face_thickness(f)).collect();
            let before = model.shells[..index].iter();
            Ok(Acting {
                shell: index,
                burning,
                shrinkage: shrinkage(shell, shown, system, thickness.clone()),
                masses: (shown.vertex_dofs().step_by(3).map(|dof| system.masses[dof])).collect(),
                stencils: shown.stencils.clone(),
                thickness,
                energies: energies(shell, shown),
                first_weight: before.map(|s| s.surface.mesh.num_vertices()).sum(),
                written: vec![true; num_faces],
            })
        };
        let shells = model.heated_shells.iter().map(make);
        Ok(Self {
            shells: shells.collect::<Result<_, _>>()?,
        })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.shells.is_empty()
    }

    /// The burning of a shell, if it burns.
    pub(super) fn of_shell(&self, shell: usize) -> Option<&HeatedShell> {
        let found = self.shells.iter().find(|acting| acting.shell == shell);
        found.map(|acting| &acting.burning)
    }

    pub(super) fn states(&self) -> Vec<HeatedState> {
        let states = self.shells.iter().map(|acting| acting.burning.state());
        states.cloned().collect()
    }

    /// Heats, burns and tears all shells over a window of time [s], from the shape at its start.
    pub(super) fn advance(
        &mut self,
        model: &Model,
        system: &mut System,
        state: &mut State,
        processes: &mut Processes,
        [start, end]: [f64; 2],
    ) -> Result<(), (usize, BurningError)> {
        for (index, acting) in self.shells.iter_mut().enumerate() {
            let part = &system.space.shells[acting.shell];
            let positions: Vec<Vec3> = (0..part.mesh.num_vertices())
                .map(|v| part.position(v, &state.q))
                .collect();
            let mut surround = |time: f64, sources: &mut [Vec<HeatSource>; 2]| {
                *sources = [Side::Bottom, Side::Top].map(|side| {
                    let heats = model.heat_sources.iter().filter(|s| s.side.heats(side));
                    heats
                        .map(|source| heat_source(source, index, time))
                        .collect()
                });
            };
            let before = acting.burning.length_factors();
            (acting
                .burning
                .burn(&positions, [start, end - start], &mut surround))
            .map_err(|error| (acting.shell, error))?;
            let now = acting.burning.length_factors();
            if acting.burning.setup().strength.is_finite() {
                let stresses = stresses(part, &acting.thickness, &now, &state.q);
                acting.burning.tear(&stresses);
            }
            if let Some(rest) = processes.rest_mut(acting.shell) {
                acting.shrinkage.advance(rest, &before, &now);
            }
        }
        self.keep_tilts(system, &mut state.q);
        self.write(system);
        Ok(())
    }

    /// Directors of edges whose neighbour goes stay where they are: what was measured from the bisector of two normals is
    /// measured from one.
    fn keep_tilts(&self, system: &System, q: &mut [f64]) {
        let point = |q: &[f64], dof: crate::assembly::Dof| {
            Vec3::from_column_slice(&q[dof.0 as usize..][..3])
        };
        for acting in &self.shells {
            let part = &system.space.shells[acting.shell];
            if part.extra != ExtraUnknowns::EdgeAngles {
                continue;
            }
            let cuts = cuts(part, acting.burning.faces_there());
            let cut_before = self::cuts(part, &acting.written);
            for (face, stencil) in acting.stencils.iter().enumerate() {
                for c in (0..3).filter(|&c| cuts[face][c] && !cut_before[face][c]) {
                    let Some(across) = stencil.across[c] else {
                        continue;
                    };
                    let [apex, a, b] = [c, c + 1, c + 2].map(|k| point(q, stencil.corners[k % 3]));
                    let (own, other) = (
                        Wing::new(&a, &b, &apex),
                        Wing::new(&b, &a, &point(q, across)),
                    );
                    let angle = stencil.angles[c].0 as usize;
                    q[angle] += 0.5 * stencil.signs[c] * hinge_angle(&own, &other);
                }
            }
        }
    }

    /// Masses, faces and contact as the states have them.
    fn write(&mut self, system: &mut System) {
        for acting in &mut self.shells {
            let part = &mut system.space.shells[acting.shell];
            let dofs = part.vertex_dofs().step_by(3);
            for (vertex, (dof, mass)) in dofs.zip(&acting.masses).enumerate() {
                let mass = mass * acting.burning.mass_ratio(vertex);
                system.masses[dof..dof + 3].fill(mass);
                system.gravity.masses[acting.first_weight + vertex].1 = mass;
            }
            let is_there = acting.burning.faces_there();
            if acting.written == is_there {
                continue;
            }
            acting.written = is_there.to_vec();
            let cuts = cuts(part, is_there);
            part.stencils.clone_from(&acting.stencils);
            for (stencil, cuts) in part.stencils.iter_mut().zip(&cuts) {
                for c in (0..3).filter(|&c| cuts[c]) {
                    stencil.across[c] = None;
                }
            }
            leave(&mut system.elastic, part, &acting.energies, &cuts, is_there);
            if let Some(contact) = &mut system.contact {
                contact.set_present(acting.shell, is_there);
            }
        }
    }

    /// Holds the unknowns that nothing acts on any more.
    pub(super) fn hold_the_rest(&self, system: &System, prescribed: &mut Prescribed) {
        for acting in &self.shells {
            let part = &system.space.shells[acting.shell];
            let mut is_used = vec![false; part.mesh.num_vertices()];
            let mut is_edge_used = vec![false; part.mesh.num_edges()];
            let faces = part.mesh.faces().iter().zip(part.mesh.face_edges());
            for ((corners, edges), _) in faces.zip(&acting.written).filter(|(_, there)| **there) {
                corners.iter().for_each(|&v| is_used[v as usize] = true);
                edges
                    .iter()
                    .for_each(|edge| is_edge_used[edge.0 as usize] = true);
            }
            let mut hold = |first: usize, width: usize, is_used: &[bool]| {
                for (index, _) in is_used.iter().enumerate().filter(|(_, is_used)| !**is_used) {
                    prescribed.is_fixed[first + width * index..][..width].fill(true);
                }
            };
            hold(part.first_vertex.0 as usize, 3, &is_used);
            let first_extra = part.first_extra.0 as usize;
            match part.extra {
                ExtraUnknowns::EdgeAngles => hold(first_extra, 1, &is_edge_used),
                ExtraUnknowns::VertexDirectors => hold(first_extra, 3, &is_used),
                ExtraUnknowns::None | ExtraUnknowns::EdgePoints => {}
            }
        }
    }

    /// Takes up states, all or none.
    pub(super) fn restore(
        &mut self,
        system: &mut System,
        states: &[HeatedState],
    ) -> Result<(), String> {
        if states.len() != self.shells.len() {
            let (given, needed) = (states.len(), self.shells.len());
            return Err(format!("it has {given} burning shells for {needed}"));
        }
        let before = self.states();
        for (acting, state) in self.shells.iter_mut().zip(states) {
            if let Err(reason) = acting.burning.restore(state) {
                self.put_back(system, &before);
                return Err(reason);
            }
        }
        self.write(system);
        Ok(())
    }

    /// Takes up states of a moment ago.
    pub(super) fn put_back(&mut self, system: &mut System, states: &[HeatedState]) {
        for (acting, state) in self.shells.iter_mut().zip(states) {
            acting.burning.put_back(state);
        }
        self.write(system);
    }
}

/// Energies of a shell without those of its faces that have gone, and of hinges between one that has and one that has not.
fn leave(
    elastic: &mut [Box<dyn Energy>],
    part: &ShellPart,
    energies: &[(usize, Elements)],
    cuts: &[[bool; 3]],
    is_there: &[bool],
) {
    let sides = part.mesh.edge_faces().iter().map(|faces| {
        let there = faces
            .iter()
            .flatten()
            .filter(|face| is_there[face.0 as usize]);
        (faces.iter().flatten().count(), there.count())
    });
    let edges: Vec<bool> = sides.clone().map(|(_, there)| there > 0).collect();
    let inner = sides.filter(|(all, _)| *all == 2);
    let hinges: Vec<bool> = inner.map(|(_, there)| there == 2).collect();
    for &(index, elements) in energies {
        let Some(measures) = elastic[index].rest_measures_mut() else {
            continue;
        };
        match elements {
            Elements::Faces => measures.set_present(is_there, cuts),
            Elements::Edges => measures.set_present(&edges, &[]),
            Elements::InnerEdges => measures.set_present(&hinges, &[]),
        }
    }
}

fn energies(shell: &Shell, part: &ShellPart) -> Vec<(usize, Elements)> {
    let of_membrane: &[Elements] = match shell.composition.membrane {
        MembraneModel::Koiter => &[Elements::Faces],
        MembraneModel::DiscreteShells => &[Elements::Edges, Elements::Faces],
    };
    let membranes = part.membranes.clone().zip(of_membrane.iter().copied());
    let of_bending = match samples(shell.bending) {
        Some(_) => Elements::Faces,
        None => Elements::InnerEdges,
    };
    membranes
        .chain(part.bending.map(|index| (index, of_bending)))
        .collect()
}

/// Edges of faces that are there across which a neighbour has gone.
fn cuts(part: &ShellPart, is_there: &[bool]) -> Vec<[bool; 3]> {
    let edges = part.mesh.face_edges().iter();
    let is_cut = |edge: crate::mesh::EdgeId| {
        let mut faces = part.mesh.edge_faces()[edge.0 as usize].iter().flatten();
        faces.any(|face| !is_there[face.0 as usize])
    };
    let cuts = edges
        .zip(is_there)
        .map(|(edges, there)| edges.map(|edge| *there && is_cut(edge)));
    cuts.collect()
}

/// Largest principal stress of the membrane of every face [Pa], whose layers have shrunk by these factors.
fn stresses(part: &ShellPart, thickness: &[f64], factors: &[[f64; 2]], q: &[f64]) -> Vec<f64> {
    let stress = |face: usize| {
        let x = part.face_corners(face, q);
        let [f1, f2] = part.frames[face].deformation_gradient(&(x[1] - x[0]), &(x[2] - x[0]));
        let [bottom, top] = factors[face];
        let shrunk = (0.5 * (bottom + top)).powi(2);
        let strain = [
            f1.norm_squared() - shrunk,
            f2.norm_squared() - shrunk,
            f1.dot(&f2),
        ];
        let force = part
            .section
            .stretch(face, &(nalgebra::Vector3::from(strain) * 0.5))
            .stress;
        // The last is twice the shear.
        let (mean, half) = (0.5 * (force.x + force.y), 0.5 * (force.x - force.y));
        (mean + half.hypot(0.5 * force.z)) / thickness[face]
    };
    (0..thickness.len()).map(stress).collect()
}

fn shrinkage(shell: &Shell, part: &ShellPart, system: &System, thickness: Vec<f64>) -> Shrinkage {
    let measures = part
        .bending
        .and_then(|index| system.elastic[index].rest_measures());
    let first = measures.map_or(Vec::new(), |measures| measures.rest());
    let stretched = match shell.composition.membrane {
        MembraneModel::Koiter => Stretched::Strains,
        MembraneModel::DiscreteShells => Stretched::LengthsAndAreas,
    };
    Shrinkage::new(
        &part.mesh,
        &part.frames,
        thickness,
        bent(shell.bending, first),
        stretched,
    )
}

impl Simulation {
    /// Burning of a shell, if it burns.
    pub fn heated_shell(&self, shell: usize) -> Option<&HeatedShell> {
        self.heated.of_shell(shell)
    }

    /// Figures of the burning shells: means over them, sums of pieces and tears, the highest temperature.
    pub fn heated_measures(&self) -> Vec<(&'static str, f64)> {
        let shells = self.heated.shells.iter();
        let all: Vec<HeatedMeasures> = shells
            .map(|acting| acting.burning.measures(&self.shell_positions(acting.shell)))
            .collect();
        if all.is_empty() {
            return Vec::new();
        }
        let sum = |value: fn(&HeatedMeasures) -> f64| all.iter().map(value).sum::<f64>();
        let mean = |value| sum(value) / all.len() as f64;
        let hottest = all
            .iter()
            .map(|m| m.highest_temperature)
            .fold(0.0, f64::max);
        vec![
            ("mean_mass_ratio", mean(|m| m.mean_mass)),
            ("kept_area", mean(|m| m.kept_area)),
            ("present_area", mean(|m| m.present_area)),
            ("pieces", sum(|m| m.pieces as f64)),
            ("highest_temperature", hottest),
            ("torn_faces", sum(|m| m.torn as f64)),
        ]
    }

    /// Temperature [K] and mass ratio at the faces of the shells that are shown; of shells that do not burn 0 and 1.
    pub(super) fn heated_fields(&self) -> [(&'static str, Vec<f32>); 2] {
        let of_faces = |cold: f32, value: fn(&HeatedShell, usize) -> f64| -> Vec<f32> {
            let shells = self.system.space.shells.iter().enumerate();
            shells
                .flat_map(|(shell, part)| match self.heated.of_shell(shell) {
                    None => vec![cold; part.mesh.num_faces()],
                    Some(burning) => at_faces(burning, value),
                })
                .collect()
        };
        [
            ("temperature", of_faces(0.0, HeatedShell::temperature)),
            ("mass_ratio", of_faces(1.0, HeatedShell::mass_ratio)),
        ]
    }
}

/// Mean of a value of vertices over the corners of each face that is shown.
fn at_faces(burning: &HeatedShell, value: fn(&HeatedShell, usize) -> f64) -> Vec<f32> {
    let surface = burning.surface();
    let vertices = surface.vertices.iter();
    let at: Vec<f64> = vertices
        .map(|vertex| vertex.mix(|node| value(burning, node)))
        .collect();
    let mean = |face: &[u32; 3]| face.map(|v| at[v as usize]).iter().sum::<f64>() / 3.0;
    surface.faces.iter().map(|face| mean(face) as f32).collect()
}
