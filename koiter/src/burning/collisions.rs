//! Planes and balls that particles stay out of.

use crate::Vec3;

/// A body that acts on particles and is not acted upon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collider {
    /// Its shape.
    pub shape: ColliderShape,
    /// How fast it moves [m/s].
    pub velocity: Vec3,
    /// The share of its motion along the surface that a touching particle loses in a step.
    pub friction: f64,
}

/// The shape of a [`Collider`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColliderShape {
    /// Everything on the side away from the normal of unit length.
    HalfSpace {
        /// A point of the plane [m].
        point: Vec3,
        /// Unit normal, out of the body.
        normal: Vec3,
    },
    /// A ball.
    Ball {
        /// Centre [m].
        center: Vec3,
        /// Radius [m].
        radius: f64,
    },
}

impl Collider {
    /// The same at a distance: a ball so much larger that flat quads with corners on it, of half the diagonal `clearance`
    /// [m], stay out of it.
    pub fn with_clearance(self, clearance: f64) -> Self {
        match self.shape {
            ColliderShape::HalfSpace { .. } => self,
            ColliderShape::Ball { center, radius } => Self {
                shape: ColliderShape::Ball {
                    center,
                    radius: radius.hypot(clearance),
                },
                ..self
            },
        }
    }

    /// How deep a point is within [m], and the direction out of it.
    fn depth(&self, x: &Vec3) -> (f64, Vec3) {
        match self.shape {
            ColliderShape::HalfSpace { point, normal } => (normal.dot(&(point - x)), normal),
            ColliderShape::Ball { center, radius } => {
                let (from_center, distance) = (x - center, (x - center).norm());
                // The centre itself goes up.
                let normal = match distance > 0.0 {
                    true => from_center / distance,
                    false => Vec3::z(),
                };
                (radius - distance, normal)
            }
        }
    }

    /// Moves particles that can move, by `mobility`, to the surface.
    pub fn push_out(&self, positions: &mut [Vec3], mobility: &[f64]) {
        for (x, &mobility) in positions.iter_mut().zip(mobility) {
            let (depth, normal) = self.depth(x);
            if depth > 0.0 && mobility > 0.0 {
                *x += depth * normal;
            }
        }
    }

    /// Takes from the velocities of touching particles what points into the body, and its share of what runs along it.
    pub fn slow(
        &self,
        positions: &[Vec3],
        mobility: &[f64],
        touching: f64,
        velocities: &mut [Vec3],
    ) {
        for ((x, &mobility), velocity) in positions.iter().zip(mobility).zip(velocities) {
            let (depth, normal) = self.depth(x);
            if depth < -touching || !(mobility > 0.0) {
                continue;
            }
            let relative = *velocity - self.velocity;
            let speed = relative.dot(&normal);
            let along = relative - speed * normal;
            *velocity = self.velocity + speed.max(0.0) * normal + (1.0 - self.friction) * along;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn particles_are_moved_to_the_surface_and_slide_by_friction() {
        let ball = Collider {
            shape: ColliderShape::Ball {
                center: Vec3::zeros(),
                radius: 1.0,
            },
            velocity: Vec3::zeros(),
            friction: 0.25,
        };
        let floor = Collider {
            shape: ColliderShape::HalfSpace {
                point: Vec3::zeros(),
                normal: Vec3::z(),
            },
            ..ball
        };
        let mut x = [
            Vec3::new(0.5, 0.0, 0.0),
            Vec3::zeros(),
            Vec3::new(2.0, 0.0, -1.0),
        ];
        ball.push_out(&mut x, &[1.0, 1.0, 1.0]);
        assert_eq!(x[..2], [Vec3::x(), Vec3::z()]);
        floor.push_out(&mut x, &[1.0, 1.0, 0.0]);
        assert_eq!(x[2].z, -1.0, "what is held stays");
        let mut v = [Vec3::new(-1.0, 2.0, 0.0), Vec3::zeros(), Vec3::x()];
        ball.slow(&x, &[1.0, 1.0, 0.0], 1e-9, &mut v);
        assert_eq!(v, [Vec3::new(0.0, 1.5, 0.0), Vec3::zeros(), Vec3::x()]);
    }

    #[test]
    fn flat_quads_on_an_enlarged_ball_stay_out_of_it() {
        let ball = Collider {
            shape: ColliderShape::Ball {
                center: Vec3::zeros(),
                radius: 1.0,
            },
            velocity: Vec3::zeros(),
            friction: 0.0,
        };
        let ColliderShape::Ball { radius, .. } = ball.with_clearance(0.1).shape else {
            unreachable!("a ball stays one");
        };
        // The centre of a quad whose corners lie on the enlarged ball.
        assert!(((radius * radius - 0.01).sqrt() - 1.0).abs() < 1e-15);
    }
}
