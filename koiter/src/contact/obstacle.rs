//! What surfaces run into: bodies and planes whose points are moved from outside.

use super::collision_mesh::CollisionBody;
use super::plane::CollisionPlane;
use crate::Vec3;
use crate::assembly::Dof;

/// Shape of a [`CollisionObstacle`] on its points.
#[derive(Clone, Debug)]
pub enum ObstacleBody {
    /// A half-space: one point of its plane, and the unit normal towards the free side.
    Plane {
        /// Unit normal.
        normal: Vec3,
    },
    /// Vertices, edges and faces that are thickened: a ball is a vertex, a capsule an edge.
    Thickened {
        /// Edges.
        edges: Vec<[u32; 2]>,
        /// Faces.
        faces: Vec<[u32; 3]>,
        /// Half the thickness, or the radius [m].
        offset: f64,
    },
}

/// An obstacle: it pushes and is not pushed.
#[derive(Clone, Debug)]
pub struct CollisionObstacle {
    /// Name for reports.
    pub name: String,
    /// What it is on its points.
    pub body: ObstacleBody,
    /// Its points at the start [m].
    pub points: Vec<Vec3>,
    /// Friction coefficient.
    pub friction: f64,
}

impl CollisionObstacle {
    /// Adds it to the bodies or planes of a collision mesh; `first` is the first unknown of its points.
    pub fn add_to(
        self,
        first: Dof,
        bodies: &mut Vec<CollisionBody>,
        planes: &mut Vec<CollisionPlane>,
    ) {
        match self.body {
            ObstacleBody::Plane { normal } => planes.push(CollisionPlane {
                name: self.name,
                point: first,
                normal,
                friction: self.friction,
            }),
            ObstacleBody::Thickened {
                edges,
                faces,
                offset,
            } => bodies.push(CollisionBody {
                name: self.name,
                first_dof: first,
                num_vertices: self.points.len(),
                edges,
                faces,
                rest_positions: self.points,
                offset,
                is_obstacle: true,
                friction: self.friction,
            }),
        }
    }
}
