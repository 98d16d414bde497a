//! Steps of Bézier shells: procedures that are due, supports, loads, and the step itself, in parts where contact bars the way.

use std::time::Instant;

use nalgebra::UnitQuaternion;

use super::body::BezierBody;
use super::{BezierModel, ProcedureKind};
use crate::Vec3;
use crate::bezier::{
    BezierError, DeadLoad, Drags, MappedContact, NODE_UNKNOWNS, NewtonLimits, NewtonOutcome, Pose,
    Potential, Pressure, Supports, linear_static,
};
use crate::integrate::{StepError, StepReport};
use crate::scene::model::{Constraint, IntegratorKind, Load, LoadKind, Model, Obstacle};
use crate::scene::simulation::Simulation;

/// A step is taken in this many parts at most: each ends where what is moved would touch the shell before it has given way.
const MOST_PARTS: usize = 40;

/// Rounding of times that are sums of steps [s/s].
const TIME_ROUNDING: f64 = 1e-9;

/// What a step came to.
#[derive(Default)]
pub(super) struct Effort {
    pub(super) outcome: NewtonOutcome,
    pub(super) iterations: usize,
    pub(super) parts: usize,
    /// The share of the way of obstacles and constraints that is left.
    pub(super) left: f64,
}

impl Simulation {
    /// One step of all Bézier shells.
    pub(in crate::scene) fn step_bezier(&mut self, dt: f64) -> Result<StepReport, StepError> {
        let (step, time) = (self.state.step + 1, self.state.time);
        let begun = Instant::now();
        let Self { model, bezier, .. } = self;
        let body = bezier.as_mut().expect("the scene has Bézier shells");
        let before = body.state();
        let result = body.advance(model, step, time, dt);
        let effort = match result {
            Ok(effort) => effort,
            Err(error) => {
                *body = BezierBody::restored(model, &before).expect("the state is its own");
                return Err(error);
            }
        };
        (self.state.step, self.state.time) = (step, time + dt);
        let mut report = body.report(model, &effort);
        report.residual = effort.outcome.last_step
            / if model.integrator.is_dynamic() {
                dt
            } else {
                1.0
            };
        report.seconds = vec![("bezier", begun.elapsed().as_secs_f64())];
        Ok(StepReport {
            step,
            time: self.state.time,
            dt,
            energies: self.energies(),
            ..report
        })
    }
}

impl BezierBody {
    fn advance(
        &mut self,
        model: &Model,
        step: usize,
        time: f64,
        dt: f64,
    ) -> Result<Effort, StepError> {
        let bezier = model.bezier.as_ref().expect("the shells are of the model");
        self.carry_out_due(bezier, step, time)?;
        let end = time + dt;
        self.moving.supports = self.supports(bezier, end);
        let mut load = self.load(model, end);
        let mut pressures = self.pressures(bezier, end);
        let failed = |error: BezierError| StepError::LinearSolve {
            step,
            reason: error.to_string(),
        };
        if model.integrator == IntegratorKind::LinearStatic {
            return self.linear(&load, &pressures).map_err(failed);
        }
        let towards = obstacle_points(model, end);
        let target = self.held_at(bezier, end);
        let mut effort = Effort {
            left: 1.0,
            ..Effort::default()
        };
        while effort.left > 0.0 && effort.parts < MOST_PARTS {
            let part = dt * effort.left;
            let held = self.with_held(&target);
            let mut contact = self.contact.take();
            let (fraction, pose) = match &mut contact {
                None => (1.0, held),
                Some(contact) => {
                    contact.begin_step(&self.moving.pose, part);
                    contact.approach(&self.moving.pose, &held, &towards)
                }
            };
            let limits = self.limits(model, part * fraction, contact.as_ref());
            let outcome = self.solve_part(
                model,
                pose,
                contact.as_mut(),
                &mut load,
                &mut pressures,
                part * fraction,
                &limits,
            );
            self.contact = contact;
            effort.outcome = outcome.map_err(failed)?;
            effort.iterations += effort.outcome.iterations;
            effort.parts += 1;
            effort.left *= 1.0 - fraction;
            if fraction == 0.0 {
                break;
            }
        }
        Ok(effort)
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "everything that acts in a part of a step"
    )]
    fn solve_part(
        &mut self,
        model: &Model,
        pose: Pose,
        contact: Option<&mut MappedContact>,
        load: &mut DeadLoad,
        pressures: &mut [Pressure],
        dt: f64,
        limits: &NewtonLimits,
    ) -> Result<NewtonOutcome, BezierError> {
        let mut drags = Drags::new(&self.moving.shell, &self.drags);
        let mut others: Vec<&mut dyn Potential> = vec![load, &mut drags];
        others.extend(pressures.iter_mut().map(|p| p as &mut dyn Potential));
        others.extend(contact.map(|c| c as &mut dyn Potential));
        match model.integrator.is_dynamic() {
            true if dt > 0.0 => self.moving.step_from(pose, &mut others, dt, limits),
            _ => self.moving.settle_from(pose, &mut others, limits),
        }
    }

    /// The response of the shell at rest.
    fn linear(&mut self, load: &DeadLoad, pressures: &[Pressure]) -> Result<Effort, BezierError> {
        let rest = self.moving.shell.rest_pose();
        let mut all = load.clone();
        for pressure in pressures {
            all.add(pressure.at(&rest).values());
        }
        let supports = self.moving.supports.clone();
        let motion = linear_static(&mut self.moving.shell, &all, &supports)?;
        self.moving.pose = rest.moved(&motion, 1.0);
        Ok(Effort {
            outcome: NewtonOutcome {
                converged: true,
                ..NewtonOutcome::default()
            },
            iterations: 1,
            parts: 1,
            left: 0.0,
        })
    }

    fn carry_out_due(
        &mut self,
        model: &BezierModel,
        step: usize,
        time: f64,
    ) -> Result<(), StepError> {
        let is_due = |at: f64| at <= time * (1.0 + TIME_ROUNDING) + f64::EPSILON;
        while let Some(procedure) = model.procedures.get(self.done.len())
            && is_due(procedure.at)
        {
            self.carry_out_next(model)
                .map_err(|error| StepError::Procedure {
                    step,
                    procedure: procedure.name.clone(),
                    reason: error.to_string(),
                })?;
        }
        Ok(())
    }

    /// When Newton's method stops: the tolerances of the scene on the motion of a node, finer where gaps are.
    fn limits(&self, model: &Model, dt: f64, contact: Option<&MappedContact>) -> NewtonLimits {
        let shell = &self.moving.shell;
        let edge = (shell.area() / shell.elements().len() as f64).sqrt();
        let solver = &model.solver;
        NewtonLimits {
            iterations: solver.max_iterations,
            tolerance: match model.integrator.is_dynamic() {
                true if dt > 0.0 => solver.velocity_tolerance * dt,
                _ => solver.displacement_tolerance,
            }
            .min(contact.map_or(f64::INFINITY, MappedContact::tolerance)),
            ..NewtonLimits::for_edges(edge)
        }
    }

    /// What is held at a time [s].
    pub(super) fn supports(&self, model: &BezierModel, time: f64) -> Supports {
        let mut supports = Supports::none(self.moving.pose.len());
        for (constraint, group) in acting(model, &self.tracked.held, time) {
            for node in members(group) {
                for axis in (0..3).filter(|&axis| constraint.axes[axis]) {
                    supports.hold_displacement(node, axis);
                }
                if constraint.clamp_directors {
                    supports.hold_rotation(node);
                }
            }
        }
        for (plane, group) in model.symmetry_planes.iter().zip(&self.tracked.mirrored) {
            members(group).for_each(|node| supports.mirror(node, plane.axis));
        }
        supports
    }

    /// For every unknown that a constraint moves, where it is at a time [s]: axes of positions, and rotations.
    fn held_at(&self, model: &BezierModel, time: f64) -> Held {
        let mut held = Held::default();
        for (constraint, group) in acting(model, &self.tracked.held, time) {
            let turn = constraint
                .motion
                .rotation
                .as_ref()
                .map(|rotation| rotation.turn(time));
            for node in members(group) {
                let place = constraint.motion.apply(self.tracked.start[node], time);
                held.positions.push((node, constraint.axes, place));
                if let (Some(turn), true) = (&turn, constraint.clamp_directors) {
                    held.rotations
                        .push((node, UnitQuaternion::from_rotation_matrix(turn)));
                }
            }
        }
        held
    }

    /// The present pose with what is held where it goes.
    fn with_held(&self, held: &Held) -> Pose {
        let mut pose = self.moving.pose.clone();
        for (node, axes, place) in &held.positions {
            for axis in (0..3).filter(|&axis| axes[axis]) {
                pose.positions[*node][axis] = place[axis];
            }
        }
        for (node, turn) in &held.rotations {
            pose.rotations[*node] = *turn;
        }
        pose
    }

    /// Weight, loads and pulls at a time [s].
    pub(super) fn load(&self, model: &Model, time: f64) -> DeadLoad {
        let bezier = model.bezier.as_ref().expect("the shells are of the model");
        let scale = model
            .gravity_scale
            .as_ref()
            .map_or(1.0, |scale| scale.at(time));
        let mut load = DeadLoad::none(self.moving.pose.len());
        load.add_gravity(&self.moving.shell, model.gravity * scale);
        for (spec, of_load) in bezier.loads.iter().zip(&self.tracked.loads) {
            let factor = spec.scale.as_ref().map_or(1.0, |scale| scale.at(time));
            load.add(of_load.scaled(factor).values());
        }
        for (procedure, pull) in bezier.procedures.iter().zip(&self.tracked.pulls) {
            if let (ProcedureKind::Open { ramp, until, .. }, Some(pull)) = (&procedure.kind, pull)
                && time <= until * (1.0 + TIME_ROUNDING)
            {
                let grown = match *ramp > 0.0 {
                    true => ((time - procedure.at) / ramp).clamp(0.0, 1.0),
                    false => 1.0,
                };
                load.add(pull.scaled(grown).values());
            }
        }
        load
    }

    /// Pressures at a time [s], each on the elements of its shell.
    fn pressures(&self, model: &BezierModel, time: f64) -> Vec<Pressure> {
        let pressure = |load: &Load| {
            let LoadKind::Pressure { pressure, .. } = load.kind else {
                return None;
            };
            let factor = load.scale.as_ref().map_or(1.0, |scale| scale.at(time));
            let is_on = |element: usize| self.tracked.owners[element] == load.shell;
            Some(Pressure::on(&self.moving.shell, pressure * factor, is_on))
        };
        model.loads.iter().filter_map(pressure).collect()
    }

    /// Energies by name [J].
    pub(in crate::scene) fn energies(&self, model: &Model, time: f64) -> Vec<(String, f64)> {
        let (moving, start) = (&self.moving, &self.tracked.start);
        let weight = {
            let scale = model
                .gravity_scale
                .as_ref()
                .map_or(1.0, |scale| scale.at(time));
            let mut load = DeadLoad::none(moving.pose.len());
            load.add_gravity(&moving.shell, model.gravity * scale);
            load
        };
        let mut loads = self.load(model, time);
        loads.add(weight.scaled(-1.0).values());
        let work = |load: &DeadLoad| -> f64 {
            let of_nodes = load.values().chunks_exact(NODE_UNKNOWNS);
            (of_nodes.zip(&moving.pose.positions).zip(start))
                .map(|((f, x), x0)| Vec3::from_column_slice(&f[..3]).dot(&(x - x0)))
                .sum()
        };
        let mut energies = vec![
            (
                "elastic".to_owned(),
                moving.shell.energy(&moving.pose).unwrap_or(f64::NAN),
            ),
            ("gravity".to_owned(), -work(&weight)),
            ("loads".to_owned(), -work(&loads)),
            ("kinetic".to_owned(), moving.kinetic_energy()),
        ];
        if let Some(contact) = &self.contact {
            energies.push(("contact".to_owned(), contact.barrier(&moving.pose)));
        }
        energies
    }

    /// Total force that a constraint exerts on its nodes [N]: what balances elasticity, loads and contact there; inertia of what it
    /// moves is left out.
    pub(in crate::scene) fn reaction(&self, model: &Model, constraint: usize, time: f64) -> Vec3 {
        let bezier = model.bezier.as_ref().expect("the shells are of the model");
        let spec = &bezier.constraints[constraint];
        let pose = &self.moving.pose;
        if !spec.is_due(time.max(f64::MIN_POSITIVE)) {
            return Vec3::zeros();
        }
        let shell = &self.moving.shell;
        let mut gradient = match model.integrator {
            IntegratorKind::LinearStatic => shell.linear_forces(&shell.rest_pose().motion_to(pose)),
            _ => shell.gradient(pose),
        };
        let mut load = self.load(model, time);
        for pressure in self.pressures(bezier, time) {
            load.add(pressure.at(pose).values());
        }
        for (g, f) in gradient.iter_mut().zip(load.values()) {
            *g -= f;
        }
        if let Some(contact) = &self.contact {
            let forces = contact.forces(pose);
            for (vertex, force) in forces {
                contact.mapped().carried()[vertex].add_force(pose, &-force, &mut gradient);
            }
        }
        let mut total = Vec3::zeros();
        for node in members(&self.tracked.held[constraint]) {
            for axis in (0..3).filter(|&axis| spec.axes[axis]) {
                total[axis] += gradient[NODE_UNKNOWNS * node + axis];
            }
        }
        total
    }
}

/// Where constraints want nodes to be.
#[derive(Default)]
struct Held {
    positions: Vec<(usize, [bool; 3], Vec3)>,
    rotations: Vec<(usize, UnitQuaternion<f64>)>,
}

/// The constraints that act at a time, with their nodes.
fn acting<'a>(
    model: &'a BezierModel,
    groups: &'a [Vec<bool>],
    time: f64,
) -> impl Iterator<Item = (&'a Constraint, &'a Vec<bool>)> {
    let all = model.constraints.iter().zip(groups);
    all.filter(move |(constraint, _)| constraint.is_due(time))
}

fn members(group: &[bool]) -> impl Iterator<Item = usize> + '_ {
    group
        .iter()
        .enumerate()
        .filter_map(|(node, belongs)| belongs.then_some(node))
}

/// Points of all obstacles at a time [s].
fn obstacle_points(model: &Model, time: f64) -> Vec<Vec3> {
    let at = |obstacle: &Obstacle| obstacle.points_at(&obstacle.start_points(), time);
    model.obstacles.iter().flat_map(at).collect()
}
