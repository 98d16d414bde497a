//! Friction coefficients of pairs of bodies.

use super::active::Contact;
use super::collision_mesh::CollisionMesh;
use super::plane::CollisionPlane;

/// A coefficient for every pair of a body with a body or a plane.
#[derive(Clone, Debug)]
pub(super) struct FrictionTable {
    num_bodies: usize,
    /// Of a body with all bodies, then with all planes; a row a body.
    rows: Vec<Vec<f64>>,
}

/// A name that no body of a scene has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("friction is given for '{name}', but there is no such shell or obstacle")]
pub struct UnknownBody {
    /// The name.
    pub name: String,
}

impl FrictionTable {
    /// Geometric means: a body without friction slides on everything.
    pub(super) fn new(mesh: &CollisionMesh, planes: &[CollisionPlane]) -> Self {
        let bodies = mesh.bodies.iter().map(|body| body.friction);
        let all: Vec<f64> = (bodies.clone())
            .chain(planes.iter().map(|plane| plane.friction))
            .collect();
        let row = |a: f64| all.iter().map(|b| (a * b).sqrt()).collect();
        Self {
            num_bodies: mesh.bodies.len(),
            rows: bodies.map(row).collect(),
        }
    }

    pub(super) fn of_bodies(&self, a: u32, b: u32) -> f64 {
        self.rows[a as usize][b as usize]
    }

    pub(super) fn with_plane(&self, body: u32, plane: usize) -> f64 {
        self.rows[body as usize][self.num_bodies + plane]
    }
}

impl Contact {
    /// Sets the friction coefficient of two bodies, or of a body and a plane, by their names.
    ///
    /// # Errors
    /// A name that there is not.
    pub fn set_friction(
        &mut self,
        names: &[String; 2],
        coefficient: f64,
    ) -> Result<(), UnknownBody> {
        let bodies = self.mesh.bodies.iter().map(|body| &body.name);
        let all: Vec<&String> = bodies
            .chain(self.planes.iter().map(|plane| &plane.name))
            .collect();
        let find = |name: &String| {
            let index = all.iter().position(|known| *known == name);
            index.ok_or_else(|| UnknownBody { name: name.clone() })
        };
        let (a, b) = (find(&names[0])?, find(&names[1])?);
        for (row, column) in [(a, b), (b, a)] {
            // Planes have no rows: they touch no planes.
            if let Some(row) = self.friction.rows.get_mut(row) {
                row[column] = coefficient;
            }
        }
        Ok(())
    }
}
