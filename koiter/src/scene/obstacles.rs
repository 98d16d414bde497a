//! Obstacles in time: their points deform, then follow the motion.

use super::model::{Obstacle, ObstacleShape};
use crate::Vec3;
use crate::contact::{CollisionObstacle, ObstacleBody};

impl Obstacle {
    /// What contact sees of it, with its points at `points` [m].
    pub(super) fn collision(&self, points: Vec<Vec3>) -> CollisionObstacle {
        let thickened = |edges, faces, offset| ObstacleBody::Thickened {
            edges,
            faces,
            offset,
        };
        CollisionObstacle {
            name: self.name.clone(),
            body: match &self.shape {
                ObstacleShape::Plane { normal, .. } => ObstacleBody::Plane { normal: *normal },
                ObstacleShape::Sphere { radius, .. } => thickened(vec![], vec![], *radius),
                ObstacleShape::Capsule { radius, .. } => thickened(vec![[0, 1]], vec![], *radius),
                ObstacleShape::Mesh(surface) => {
                    let mesh = &surface.mesh;
                    thickened(mesh.edges().to_vec(), mesh.faces().to_vec(), 0.0)
                }
            },
            points,
            friction: self.friction,
        }
    }

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
