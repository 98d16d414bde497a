//! Processes of a model: what moves the rest curvatures of its shells over time.

use std::f64::consts::PI;
use std::fmt;

use nalgebra::Vector3;

use super::assemble::write_points;
use super::elastic::rest_surface;
use super::model::{BendingModel, Model, Shell};
use super::schedule::Schedule;
use crate::Vec3;
use crate::assembly::RestMeasures;
use crate::energy::bending::{AngleProfile, Identity, Sine, Tangent, rest_forms_of_hinges};
use crate::integrate::{ShellPart, System};
use crate::mesh::{EdgeId, Surface};
use crate::process::{
    Bent, Crease, Curl, Fold, Measure, Process, RestState, Window, Yielding, on_cylinder,
};

/// What changes the rest curvature of a shell over time.
#[derive(Clone, Debug)]
pub struct RestProcess {
    /// Name, unique in the scene.
    pub name: String,
    /// Index of the shell.
    pub shell: usize,
    /// What it does.
    pub kind: ProcessKind,
    /// Factor over time on what is prescribed (`None`: 1, from the start).
    pub scale: Option<Schedule<f64>>,
}

/// Kinds of processes.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum ProcessKind {
    /// The shell curls to a cylinder; its radius is this over the factor.
    Curl {
        /// Radius [m], positive where normals fan out.
        radius: f64,
        /// Direction of the axis.
        axis: Vec3,
    },
    /// The shell is creased along edges.
    Crease {
        /// The edges.
        edges: Vec<EdgeId>,
        /// Angle by which normals turn across them [rad], positive where they fan out.
        angle: f64,
    },
    /// The shell yields where it is bent too far.
    Yield {
        /// Distance from the rest value at which flow begins: [rad] of hinges, else [1/m].
        threshold: f64,
        /// Rate of the flow [1/s]; infinite: at once.
        rate: f64,
        /// By how much the threshold grows with the flow.
        hardening: f64,
    },
}

impl fmt::Display for ProcessKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Curl { radius, .. } => write!(f, "curls to a radius of {radius} m"),
            Self::Crease { edges, angle } => {
                let (degrees, count) = (angle.to_degrees(), edges.len());
                write!(f, "is creased by {degrees:.1}° along {count} edges")
            }
            Self::Yield {
                rate, hardening, ..
            } if rate.is_finite() => {
                write!(f, "yields at a rate of {rate} 1/s, hardening {hardening}")
            }
            Self::Yield { hardening, .. } => write!(f, "yields at once, hardening {hardening}"),
        }
    }
}

/// Why a process cannot act on its shell.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProcessError {
    /// A bending model without rest values.
    #[error(
        "bending model '{0}' compares no measure of curvature with a rest value that could move: take one that does, such as \
         bac or ds-theta"
    )]
    NoMeasures(&'static str),
    /// A bending model that has no creases.
    #[error(
        "bending model '{0}' has no crease at a single edge: take ds-theta, ds-tan, bac, dcs or dso"
    )]
    NoCrease(&'static str),
    /// A shape that has no cylinder.
    #[error(
        "a shell whose bending model is '{0}' curls from a flat rest shape, about an axis in its plane; bac, dcs, dso, dkt and \
         me-average curl any shape"
    )]
    NotFlat(&'static str),
    /// A cylinder that an edge would go around.
    #[error(
        "a radius of {radius:.3e} m is too small for this mesh: an edge of {widest:.3e} m around the axis would turn by half a circle \
         or more; take a radius above {:.3e} m, or smaller triangles",
        .widest / PI
    )]
    TooTight {
        /// Of the cylinder [m].
        radius: f64,
        /// The longest way of an edge around the axis [m].
        widest: f64,
    },
}

/// The processes of a simulation, and what they have done so far.
#[derive(Default)]
pub(super) struct Processes {
    acting: Vec<Acting>,
    /// One a shell; `None`: no process acts on it.
    rests: Vec<Option<RestState>>,
    /// Of every shell.
    models: Vec<BendingModel>,
}

struct Acting {
    process: Box<dyn Process>,
    shell: usize,
    scale: Option<Schedule<f64>>,
}

impl Acting {
    fn factor(&self, time: f64) -> f64 {
        self.scale.as_ref().map_or(1.0, |scale| scale.at(time))
    }
}

impl Processes {
    /// Processes of a system that stands at `q` at time 0: what is prescribed from the start is there.
    pub(super) fn new(
        model: &Model,
        system: &mut System,
        q: &[f64],
    ) -> Result<Self, (String, ProcessError)> {
        let mut processes = Self {
            acting: Vec::new(),
            rests: vec![None; model.shells.len()],
            models: model.shells.iter().map(|shell| shell.bending).collect(),
        };
        for heated in &model.heated_shells {
            let part = &system.space.shells[heated.shell];
            let membranes = &system.elastic[part.membranes.clone()];
            let strains = membranes.iter().filter_map(|energy| energy.rest_measures());
            processes.rests[heated.shell] = Some(RestState {
                curvature: measures(system, part).map_or(Vec::new(), |measures| measures.rest()),
                flow: Vec::new(),
                strain: strains.flat_map(|measures| measures.rest()).collect(),
            });
        }
        for process in &model.processes {
            let shell = &model.shells[process.shell];
            let name = shell.bending.info().name;
            let refuse = |error| (process.name.clone(), error);
            let part = &system.space.shells[process.shell];
            let measures = measures(system, part).ok_or(refuse(ProcessError::NoMeasures(name)))?;
            let made = make(&process.kind, shell, part, measures, q).map_err(refuse)?;
            processes.rests[process.shell].get_or_insert_with(|| RestState {
                curvature: measures.rest(),
                ..RestState::default()
            });
            processes.acting.push(Acting {
                process: made,
                shell: process.shell,
                scale: process.scale.clone(),
            });
        }
        let prescribed = |kind: &ProcessKind| !matches!(kind, ProcessKind::Yield { .. });
        for (acting, process) in processes.acting.iter().zip(&model.processes) {
            if let Some(rest) = processes.rests[acting.shell]
                .as_mut()
                .filter(|_| prescribed(&process.kind))
            {
                let window = Window {
                    measured: &[],
                    factors: [0.0, acting.factor(0.0)],
                    dt: 0.0,
                };
                acting.process.advance(rest, &window);
            }
        }
        processes.write(system);
        Ok(processes)
    }

    /// Moves the rest values of a system that stands at `q` to those of a step over a window of time [s].
    pub(super) fn advance(
        &mut self,
        system: &mut System,
        q: &[f64],
        [start, end]: [f64; 2],
        dt: f64,
    ) {
        for shell in 0..self.rests.len() {
            let mut acts = self.acting.iter().map(|acting| acting.shell);
            let Some(rest) = (self.rests[shell].as_mut()).filter(|_| acts.any(|of| of == shell))
            else {
                continue;
            };
            let part = &system.space.shells[shell];
            let measured =
                measures(system, part).map_or(Vec::new(), |measures| measures.measure(q));
            let before = rest.curvature.clone();
            for acting in self.acting.iter().filter(|acting| acting.shell == shell) {
                let window = Window {
                    measured: &measured,
                    factors: [start, end].map(|time| acting.factor(time)),
                    dt,
                };
                acting.process.advance(rest, &window);
            }
            let change = rest.curvature.iter().zip(&before);
            let change: Vec<f64> = change.map(|(after, before)| after - before).collect();
            let index = part
                .bending
                .expect("a shell with processes has rest measures");
            system.damping.set_rest_change(index, &change, dt);
        }
        self.write(system);
    }

    /// Writes the rest values into the energies, and for display.
    fn write(&self, system: &mut System) {
        for (shell, rest) in self.rests.iter().enumerate() {
            let Some(rest) = rest else {
                continue;
            };
            write_strains(system, shell, &rest.strain);
            let Some(index) = system.space.shells[shell].bending else {
                continue;
            };
            if let Some(measures) = system.elastic[index].rest_measures_mut() {
                measures.set_rest(&rest.curvature);
            }
            show(
                &mut system.space.shells[shell],
                self.models[shell],
                &rest.curvature,
            );
        }
    }

    /// What has become of the rest state of every shell on which a process acts.
    pub(super) fn rests(&self) -> Vec<RestState> {
        self.rests.iter().flatten().cloned().collect()
    }

    /// The rest state of a shell, if something moves it.
    pub(super) fn rest_mut(&mut self, shell: usize) -> Option<&mut RestState> {
        self.rests[shell].as_mut()
    }

    /// Goes back to other rest states.
    pub(super) fn restore(&mut self, system: &mut System, rests: &[RestState]) {
        for (rest, saved) in self.rests.iter_mut().flatten().zip(rests) {
            rest.clone_from(saved);
        }
        self.write(system);
    }
}

/// Rest strains of the membranes of a shell, one after the other; none: they stay.
fn write_strains(system: &mut System, shell: usize, strains: &[f64]) {
    if strains.is_empty() {
        return;
    }
    let mut left = strains;
    for index in system.space.shells[shell].membranes.clone() {
        if let Some(measures) = system.elastic[index].rest_measures_mut() {
            let (own, others) = left.split_at(measures.rest().len());
            measures.set_rest(own);
            left = others;
        }
    }
}

/// How the measures of a bending model follow layers that shrink, from rest values at first.
pub(super) fn bent(bending: BendingModel, first: Vec<f64>) -> Bent {
    match (samples(bending), bending) {
        (Some(samples), _) => Bent::Forms(first, samples),
        (None, BendingModel::DsTheta | BendingModel::DsTan) => Bent::Hinges,
        (None, _) => Bent::Nothing,
    }
}

fn measures<'a>(system: &'a System, part: &ShellPart) -> Option<&'a dyn RestMeasures> {
    system.elastic[part.bending?].rest_measures()
}

/// Whether a model's measures are forms, and how many a face; else they are numbers.
pub(super) fn samples(bending: BendingModel) -> Option<usize> {
    match bending {
        BendingModel::Bac | BendingModel::Dcs | BendingModel::Dso | BendingModel::MeAverage => {
            Some(1)
        }
        BendingModel::Dkt => Some(3),
        _ => None,
    }
}

fn make(
    kind: &ProcessKind,
    shell: &Shell,
    part: &ShellPart,
    measures: &dyn RestMeasures,
    q: &[f64],
) -> Result<Box<dyn Process>, ProcessError> {
    let name = shell.bending.info().name;
    match kind {
        ProcessKind::Curl { radius, axis } => {
            let rest = rest_surface(shell);
            if let Some(samples) = samples(shell.bending) {
                let curl = Curl::of_forms(&rest, &part.frames, samples, *radius, axis);
                return Ok(Box::new(curl));
            }
            let laid = on_cylinder(&rest, *radius, axis).ok_or(ProcessError::NotFlat(name))?;
            check_curl(&rest, *radius, axis)?;
            let mut curled = q.to_vec();
            write_points(&mut curled, part.first_vertex, &laid);
            let change = measures.measure(&curled);
            Ok(Box::new(Curl { change }))
        }
        ProcessKind::Crease { edges, angle } => {
            let crease = crease(edges, *angle, shell.bending, part);
            Ok(Box::new(crease.ok_or(ProcessError::NoCrease(name))?))
        }
        ProcessKind::Yield {
            threshold,
            rate,
            hardening,
        } => Ok(Box::new(Yielding {
            measure: match samples(shell.bending) {
                Some(_) => Measure::Form,
                None => Measure::Number,
            },
            threshold: *threshold,
            rate: *rate,
            hardening: *hardening,
        })),
    }
}

impl BendingModel {
    /// Whether rest values can be those of a crease at a single edge.
    pub(super) fn has_creases(self) -> bool {
        use BendingModel::{Bac, Dcs, DsTan, DsTheta, Dso};
        matches!(self, DsTheta | DsTan | Bac | Dcs | Dso)
    }
}

/// Refuses a cylinder around which an edge would go by half a turn: its hinges have no angles for that.
fn check_curl(rest: &Surface, radius: f64, axis: &Vec3) -> Result<(), ProcessError> {
    let axis = axis.normalize();
    let ends = rest.mesh.edges().iter();
    let widest = ends
        .map(|&[u, v]| {
            let edge = rest.positions[v as usize] - rest.positions[u as usize];
            (edge - axis * edge.dot(&axis)).norm()
        })
        .fold(0.0, f64::max);
    match widest < PI * radius {
        true => Ok(()),
        false => Err(ProcessError::TooTight { radius, widest }),
    }
}

/// `None` for a bending model without creases.
fn crease(edges: &[EdgeId], angle: f64, bending: BendingModel, part: &ShellPart) -> Option<Crease> {
    let of_faces = |profile| Crease {
        folds: folds_of_faces(edges, part),
        angle,
        profile,
    };
    match bending {
        BendingModel::DsTheta | BendingModel::DsTan => Some(Crease {
            folds: folds_of_hinges(edges, part),
            angle,
            profile: |half| half,
        }),
        BendingModel::Bac => Some(of_faces(|tilt| Tangent::eval(tilt)[0])),
        BendingModel::Dcs => Some(of_faces(|tilt| Sine::eval(tilt)[0])),
        BendingModel::Dso => Some(of_faces(|tilt| Identity::eval(tilt)[0])),
        _ => None,
    }
}

/// Hinges are the inner edges in their order.
fn folds_of_hinges(edges: &[EdgeId], part: &ShellPart) -> Vec<Fold> {
    let inner = (0..part.mesh.num_edges() as u32)
        .map(EdgeId)
        .filter(|&edge| !part.mesh.is_boundary_edge(edge));
    let folded = inner.enumerate().filter(|(_, edge)| edges.contains(edge));
    folded
        .map(|(place, _)| Fold { place, weight: 2.0 })
        .collect()
}

fn folds_of_faces(edges: &[EdgeId], part: &ShellPart) -> Vec<Fold> {
    let mut folds = Vec::new();
    for (face, of_face) in part.mesh.face_edges().iter().enumerate() {
        let frame = &part.frames[face];
        let rows = frame.second_form_matrix();
        for (corner, edge) in of_face
            .iter()
            .enumerate()
            .filter(|(_, edge)| edges.contains(edge))
        {
            if part.mesh.is_boundary_edge(*edge) {
                continue;
            }
            let altitude = 2.0 * frame.area / frame.edge_lengths()[corner];
            folds.extend((0..3).map(|component| Fold {
                place: 3 * face + component,
                weight: 2.0 * altitude * rows[component][corner],
            }));
        }
    }
    folds
}

/// The rest forms that are shown and written; those of corotational hinges stay what they were.
fn show(part: &mut ShellPart, bending: BendingModel, curvature: &[f64]) {
    if let Some(samples) = samples(bending) {
        let of_faces = curvature.chunks_exact(3 * samples);
        for (form, values) in part.rest_forms.iter_mut().zip(of_faces) {
            let forms = values.chunks_exact(3).map(Vector3::from_column_slice);
            *form = forms.sum::<Vector3<f64>>() / samples as f64;
        }
    } else if matches!(bending, BendingModel::DsTheta | BendingModel::DsTan) {
        part.rest_forms = rest_forms_of_hinges(&part.mesh, &part.frames, curvature);
    }
}
