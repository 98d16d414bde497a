//! What constraints hold: which unknowns in a step, and where they are to be at its end.

use super::clamps::Clamps;
use super::model::{Model, Phase};
use super::schedule::MotionPart;
use crate::Vec3;
use crate::assembly::Dof;
use crate::energy::bending::DirectorClamp;
use crate::integrate::{Prescribed, ShellPart};

/// Where things were when constraints began during a run: they are held from there.
#[derive(Clone, Debug, PartialEq)]
pub struct Anchor {
    /// Indices of the constraints.
    pub constraints: Vec<usize>,
    /// When they began [s].
    pub time: f64,
    /// All unknowns then, and the positions of obstacles after them.
    pub q: Vec<f64>,
}

/// The constraints of a model in time.
#[derive(Clone)]
pub(super) struct Holds {
    pub(super) clamps: Clamps,
    starts: Vec<Start>,
    is_acting: Vec<bool>,
    anchors: Vec<Anchor>,
}

/// The vertices of a constraint when it began.
#[derive(Clone)]
struct Start {
    /// When [s]; `None`: it was there from the start.
    since: Option<f64>,
    positions: Vec<Vec3>,
}

impl Holds {
    pub(super) fn new(model: &Model, clamps: Clamps) -> Self {
        let starts = model.constraints.iter().map(|constraint| {
            let positions = &model.shells[constraint.shell].surface.positions;
            let held = constraint.vertices.iter();
            Start {
                since: None,
                positions: held.map(|v| positions[v.0 as usize]).collect(),
            }
        });
        Self {
            clamps,
            starts: starts.collect(),
            is_acting: acting_at_start(model, &model.all_phases()[0]),
            anchors: Vec::new(),
        }
    }

    /// Whether a constraint held its vertices in the last step.
    pub(super) fn is_acting(&self, constraint: usize) -> bool {
        self.is_acting[constraint]
    }

    /// Where constraints that act took over from free motion.
    pub(super) fn anchors(&self) -> &[Anchor] {
        &self.anchors
    }

    /// Constraints that are due in the step from `q` at the time `since` to the time `until` [s] begin, others end.
    pub(super) fn switch(
        &mut self,
        model: &Model,
        phase: &Phase,
        parts: &[ShellPart],
        q: &[f64],
        [since, until]: [f64; 2],
    ) {
        let due = acting_at(model, phase, until);
        let begins = |&i: &usize| due[i] && !self.is_acting[i];
        let constraints: Vec<usize> = (0..due.len()).filter(begins).collect();
        for anchor in &mut self.anchors {
            anchor.constraints.retain(|&i| due[i]);
        }
        self.anchors.retain(|anchor| !anchor.constraints.is_empty());
        self.is_acting = due;
        if !constraints.is_empty() {
            self.begin(
                model,
                parts,
                Anchor {
                    constraints,
                    time: since,
                    q: q.to_vec(),
                },
            );
        }
    }

    /// The constraints as they acted at the end of a step at `time` [s], which began where the anchors say.
    pub(super) fn restore(
        &mut self,
        model: &Model,
        phase: &Phase,
        parts: &[ShellPart],
        time: f64,
        anchors: &[Anchor],
    ) {
        self.anchors.clear();
        self.is_acting = match time > 0.0 {
            true => acting_at(model, phase, time),
            false => acting_at_start(model, phase),
        };
        for anchor in anchors {
            self.begin(model, parts, anchor.clone());
        }
    }

    fn begin(&mut self, model: &Model, parts: &[ShellPart], anchor: Anchor) {
        for &index in &anchor.constraints {
            let constraint = &model.constraints[index];
            let part = &parts[constraint.shell];
            let held = constraint.vertices.iter();
            self.starts[index] = Start {
                since: Some(anchor.time),
                positions: held
                    .map(|v| part.position(v.0 as usize, &anchor.q))
                    .collect(),
            };
            self.clamps.begin(index, part, &anchor.q);
            self.is_acting[index] = true;
        }
        self.anchors.push(anchor);
    }

    /// The motion of a constraint since it began, if it acts.
    fn motion<'a>(&self, model: &'a Model, constraint: usize, time: f64) -> Option<MotionPart<'a>> {
        let motion = &model.constraints[constraint].motion;
        let part = motion.between(self.starts[constraint].since, time);
        self.is_acting[constraint].then_some(part)
    }

    /// Moves clamped edges to a time [s].
    pub(super) fn move_clamps(&self, model: &Model, time: f64, clamp: &mut DirectorClamp) {
        let motion = |constraint| self.motion(model, constraint, time);
        self.clamps.advance(motion, clamp);
    }

    /// Marks the unknowns that constraints hold, and writes where they are to be at a time [s].
    pub(super) fn prescribe(
        &self,
        model: &Model,
        parts: &[ShellPart],
        time: f64,
        prescribed: &mut Prescribed,
    ) {
        let Prescribed { is_fixed, target } = prescribed;
        for (index, constraint) in model.constraints.iter().enumerate() {
            let Some(motion) = self.motion(model, index, time) else {
                continue;
            };
            let first = parts[constraint.shell].first_vertex.0 as usize;
            let held = constraint.vertices.iter();
            for (vertex, start) in held.zip(&self.starts[index].positions) {
                let x = motion.point(*start);
                for axis in (0..3).filter(|&axis| constraint.axes[axis]) {
                    let dof = first + 3 * vertex.0 as usize + axis;
                    is_fixed[dof] = true;
                    target[dof] = x[axis];
                }
            }
        }
        let mut hold = |constraint, dof: Dof, place: &dyn Fn(MotionPart) -> Vec3| {
            if let Some(motion) = self.motion(model, constraint, time) {
                let range = dof.0 as usize..dof.0 as usize + 3;
                is_fixed[range.clone()].fill(true);
                target[range].copy_from_slice(place(motion).as_slice());
            }
        };
        for held in &self.clamps.held_directors {
            hold(held.constraint, held.dof, &|motion| {
                motion.normal(held.start)
            });
        }
        for held in &self.clamps.held_points {
            hold(held.constraint, held.dof, &|motion| {
                motion.point(held.start)
            });
        }
    }
}

/// Which constraints act in a step that ends at a time [s].
fn acting_at(model: &Model, phase: &Phase, time: f64) -> Vec<bool> {
    let constraints = model.constraints.iter().zip(&phase.constraints);
    constraints
        .map(|(constraint, holds)| *holds && constraint.is_due(time))
        .collect()
}

/// Which constraints hold the start shape.
fn acting_at_start(model: &Model, phase: &Phase) -> Vec<bool> {
    let constraints = model.constraints.iter().zip(&phase.constraints);
    constraints
        .map(|(constraint, holds)| *holds && constraint.from <= 0.0)
        .collect()
}
