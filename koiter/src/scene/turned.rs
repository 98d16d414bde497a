//! The same scene in a world that is turned: nothing that it does may depend on where the axes point.

use nalgebra::Rotation3;

use super::composition::Composition;
use super::model::{
    Constraint, Load, LoadKind, Model, Motion, Obstacle, ObstacleShape, Phase, Schedule, Shell,
};
use crate::Vec3;

impl Model {
    /// Everything turned about the origin. `None` where the scene is tied to the axes: by constraints that leave some of
    /// them free, or by planes of symmetry.
    pub fn turned(&self, rotation: &Rotation3<f64>) -> Option<Self> {
        let is_tied = |constraint: &Constraint| constraint.axes != [true; 3];
        // Bézier shells have constraints and planes of their own.
        if self.bezier.is_some()
            || !self.symmetry_planes.is_empty()
            || self.constraints.iter().any(is_tied)
        {
            return None;
        }
        let turn = |v: Vec3| rotation * v;
        let constraint = |constraint: &Constraint| Constraint {
            motion: turned_motion(&constraint.motion, rotation),
            ..constraint.clone()
        };
        let phase = |phase: &Phase| Phase {
            gravity: turn(phase.gravity),
            ..phase.clone()
        };
        Some(Self {
            shells: self
                .shells
                .iter()
                .map(|s| turned_shell(s, rotation))
                .collect(),
            obstacles: (self.obstacles.iter())
                .map(|o| turned_obstacle(o, rotation))
                .collect(),
            constraints: self.constraints.iter().map(constraint).collect(),
            loads: self
                .loads
                .iter()
                .map(|l| turned_load(l, rotation))
                .collect(),
            gravity: turn(self.gravity),
            phases: self.phases.iter().map(phase).collect(),
            ..self.clone()
        })
    }
}

fn turned_points(points: &[Vec3], rotation: &Rotation3<f64>) -> Vec<Vec3> {
    points.iter().map(|x| rotation * x).collect()
}

fn turned_shell(shell: &Shell, rotation: &Rotation3<f64>) -> Shell {
    let mut turned = shell.clone();
    turned.surface.positions = turned_points(&shell.surface.positions, rotation);
    turned.rest_positions = turned_points(&shell.rest_positions, rotation);
    turned.velocities = turned_points(&shell.velocities, rotation);
    turned.composition = Composition {
        axes: match shell.composition.axes.is_empty() {
            // Without an axis it is that of x.
            true => vec![rotation * Vec3::x()],
            false => turned_points(&shell.composition.axes, rotation),
        },
        ..shell.composition.clone()
    };
    turned
}

fn turned_obstacle(obstacle: &Obstacle, rotation: &Rotation3<f64>) -> Obstacle {
    let shape = match &obstacle.shape {
        ObstacleShape::Plane { point, normal } => ObstacleShape::Plane {
            point: rotation * point,
            normal: rotation * normal,
        },
        ObstacleShape::Sphere { center, radius } => ObstacleShape::Sphere {
            center: rotation * center,
            radius: *radius,
        },
        ObstacleShape::Capsule { ends, radius } => ObstacleShape::Capsule {
            ends: ends.map(|end| rotation * end),
            radius: *radius,
        },
        ObstacleShape::Mesh(surface) => {
            let mut surface = surface.clone();
            surface.positions = turned_points(&surface.positions, rotation);
            ObstacleShape::Mesh(surface)
        }
    };
    let deformation = obstacle.deformation.as_ref();
    Obstacle {
        shape,
        deformation: deformation
            .map(|schedule| turned_schedule(schedule, |points| turned_points(points, rotation))),
        motion: turned_motion(&obstacle.motion, rotation),
        ..obstacle.clone()
    }
}

fn turned_motion(motion: &Motion, rotation: &Rotation3<f64>) -> Motion {
    let mut turned = motion.clone();
    if let Some(scaling) = &mut turned.scaling {
        scaling.pivot = rotation * scaling.pivot;
        scaling.along = scaling.along.map(|along| rotation * along);
    }
    if let Some(turning) = &mut turned.rotation {
        turning.pivot = rotation * turning.pivot;
        turning.axis = rotation * turning.axis;
    }
    let translation = motion.translation.as_ref();
    turned.translation = translation.map(|schedule| turned_schedule(schedule, |v| rotation * v));
    turned
}

fn turned_schedule<T>(schedule: &Schedule<T>, turn: impl Fn(&T) -> T) -> Schedule<T> {
    Schedule {
        times: schedule.times.clone(),
        values: schedule.values.iter().map(turn).collect(),
    }
}

fn turned_load(load: &Load, rotation: &Rotation3<f64>) -> Load {
    let mut turned = load.clone();
    match &mut turned.kind {
        LoadKind::Point { force, .. }
        | LoadKind::Edge { force, .. }
        | LoadKind::Area { force, .. } => *force = rotation * *force,
        LoadKind::Pressure { origin, .. } => *origin = rotation * *origin,
        LoadKind::Turning { moment, .. } => *moment = rotation * *moment,
        LoadKind::Moment { .. } => {}
    }
    turned
}
