//! What belongs to the nodes and elements of Bézier shells, and goes along when they are cut and sewn.

use super::BezierModel;
use crate::Vec3;
use crate::bezier::{BezierShell, Change, DeadLoad, Lips};
use crate::mesh::{Surface, VertexId};
use crate::scene::loads::{side, vertex_forces};
use crate::scene::model::{Load, LoadKind};

/// Lists over nodes and elements, in their present numbering.
#[derive(Clone, Debug)]
pub(super) struct Tracked {
    /// Where each vertex of each start shape is now.
    pub(super) present: Vec<Vec<u32>>,
    /// Which part each element is of; a patch is of the part that was cut.
    pub(super) owners: Vec<usize>,
    /// Where each node was at the start [m].
    pub(super) start: Vec<Vec3>,
    /// For each constraint, whether it is on a node.
    pub(super) held: Vec<Vec<bool>>,
    /// For each plane of symmetry, whether a node is on it.
    pub(super) mirrored: Vec<Vec<bool>>,
    /// For each load its forces and moments at a factor of 1, but pressure.
    pub(super) loads: Vec<DeadLoad>,
    /// For each procedure, the forces that it began.
    pub(super) pulls: Vec<Option<DeadLoad>>,
    /// For each procedure, the lips of the cut that it made.
    pub(super) lips: Vec<Option<Lips>>,
}

impl Tracked {
    /// At the start; `shell` is all parts beside each other.
    pub(super) fn new(model: &BezierModel, shell: &BezierShell) -> Self {
        let nodes = shell.mesh().num_vertices();
        let (mut first, mut present, mut owners) = (0u32, Vec::new(), Vec::new());
        for (index, part) in model.parts.iter().enumerate() {
            let mesh = &part.shell.surface.mesh;
            let next = first + mesh.num_vertices() as u32;
            present.push((first..next).collect::<Vec<u32>>());
            owners.extend(std::iter::repeat_n(index, mesh.num_faces()));
            first = next;
        }
        let group = |(part, vertices): (usize, &[VertexId])| -> Vec<bool> {
            let mut belongs = vec![false; nodes];
            for vertex in vertices {
                belongs[present[part][vertex.0 as usize] as usize] = true;
            }
            belongs
        };
        let held = model
            .constraints
            .iter()
            .map(|c| group((c.shell, &c.vertices)));
        let planes = model.symmetry_planes.iter();
        let mirrored = planes.map(|plane| group((plane.shell, &plane.vertices)));
        let loads = model.loads.iter().map(|load| {
            let surface = &model.parts[load.shell].shell.surface;
            on_nodes(load, surface, present[load.shell][0] as usize, nodes)
        });
        Self {
            held: held.collect(),
            mirrored: mirrored.collect(),
            loads: loads.collect(),
            present: present.clone(),
            owners,
            start: shell.rest_pose().positions,
            pulls: vec![None; model.procedures.len()],
            lips: vec![None; model.procedures.len()],
        }
    }

    /// On the shell after a change.
    pub(super) fn carried(&self, change: &Change) -> Self {
        let groups = |of: &[Vec<bool>]| of.iter().map(|group| change.group(group)).collect();
        let now = |v: &u32| change.present[*v as usize];
        Self {
            present: (self.present.iter())
                .map(|of_part| of_part.iter().map(now).collect())
                .collect(),
            owners: (change.parents.iter())
                .map(|parent| self.owners[parent.element])
                .collect(),
            start: change.positions(&self.start),
            held: groups(&self.held),
            mirrored: groups(&self.mirrored),
            loads: self.loads.iter().map(|load| change.load(load)).collect(),
            pulls: (self.pulls.iter())
                .map(|pull| pull.as_ref().map(|load| change.load(load)))
                .collect(),
            lips: (self.lips.iter())
                .map(|lips| lips.as_ref().map(|lips| lips.carried(&change.present)))
                .collect(),
        }
    }

    /// With nodes and elements of a patch behind the others.
    pub(super) fn with_patch(&self, patch: &BezierShell, owner: usize) -> Self {
        let nodes = patch.mesh().num_vertices();
        let groups = |of: &[Vec<bool>]| -> Vec<Vec<bool>> {
            let longer = |group: &Vec<bool>| [&group[..], &vec![false; nodes]].concat();
            of.iter().map(longer).collect()
        };
        let longer = |load: &DeadLoad| load.clone().with_free(nodes);
        let mut with = Self {
            held: groups(&self.held),
            mirrored: groups(&self.mirrored),
            loads: self.loads.iter().map(longer).collect(),
            pulls: (self.pulls.iter().map(|pull| pull.as_ref().map(longer))).collect(),
            ..self.clone()
        };
        let elements = patch.elements().len();
        with.owners.extend(std::iter::repeat_n(owner, elements));
        with.start.extend(patch.rest_pose().positions);
        with
    }
}

/// Forces and moments of a load at a factor of 1; those of a pressure are made at every step.
fn on_nodes(load: &Load, surface: &Surface, first: usize, nodes: usize) -> DeadLoad {
    let mut made = DeadLoad::none(nodes);
    for (vertex, force) in vertex_forces(&load.kind, surface).into_iter().enumerate() {
        made.add_force(first + vertex, force);
    }
    match &load.kind {
        LoadKind::Turning { vertices, moment } => {
            for vertex in vertices {
                made.add_moment(first + vertex.0 as usize, *moment);
            }
        }
        LoadKind::Moment { edges, moment } => {
            for edge in edges {
                let (face, corner) = side(&surface.mesh, *edge);
                let face = surface.mesh.faces()[face];
                let ends = [1, 2].map(|k| face[(corner + k) % 3] as usize);
                let [from, to] = ends.map(|v| surface.positions[v]);
                for v in ends {
                    made.add_moment(first + v, (to - from) * (0.5 * moment));
                }
            }
        }
        _ => {}
    }
    made
}
