//! Obstacles in time: their points deform, then follow the motion.

use super::model::{Obstacle, ObstacleShape};
use crate::Vec3;

impl Obstacle {
    /// The points that are unknowns of a simulation, at time 0 before any motion: a point of a plane, the centre of a
    /// sphere, the ends of a capsule, the vertices of a mesh.
    pub(super) fn start_points(&self) -> Vec<Vec3> {
        match &self.shape {
            ObstacleShape::Plane { point, .. } => vec![*point],
            ObstacleShape::Sphere { center, .. } => vec![*center],
            ObstacleShape::Capsule { ends, .. } => ends.to_vec(),
            ObstacleShape::Mesh(surface) => surface.positions.clone(),
        }
    }

    /// Where points that belong to the obstacle and start at `start` are at a time [s]; of a mesh that deforms, all its
    /// vertices.
    pub(super) fn points_at(&self, start: &[Vec3], time: f64) -> Vec<Vec3> {
        match &self.deformation {
            Some(shapes) => self.motion.positions_at(&shapes.points_at(time), time),
            None => self.motion.positions_at(start, time),
        }
    }
}
