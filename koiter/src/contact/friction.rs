//! Lagged, smoothed Coulomb friction.
//!
//! ```text
//! D = Σ μ λ f₀(|u|),   u = (1 − n nᵀ) Σ_i w_i (x_i − x_i,start)
//! f₀(y) = y²/η − y³/(3η²) + η/3 for y < η = ε_v dt, else y
//! ```
//!
//! Normal force λ [N], direction n and weights w are those of the last lag; u is the sliding over the step [m], ε_v the
//! speed at which static friction begins [m/s]. Reference: "Incremental Potential Contact" (2020), section 5.

use nalgebra::Matrix3;

use super::active::Contact;
use super::pair::{PairKind, mollify};
use crate::Vec3;
use crate::assembly::{
    Dof, DofLayout, Energy, HessianBuilder, PatternBuilder, PsdProjection, ordered_sum,
    parallel_map,
};

/// One lagged contact.
#[derive(Clone, Copy, Debug)]
pub struct FrictionContact {
    /// First unknown of each point; unused points have weight zero.
    pub points: [Dof; 4],
    /// Weights of the points.
    pub weights: [f64; 4],
    /// Unit normal.
    pub normal: Vec3,
    /// μ λ [N].
    pub limit: f64,
}

/// Friction of one step.
#[derive(Clone, Debug, Default)]
pub struct Friction {
    /// Lagged contacts.
    pub contacts: Vec<FrictionContact>,
    /// Configuration at the start of the step.
    pub start: Vec<f64>,
    /// η [m].
    pub smoothing: f64,
    /// Grouping of the unknowns.
    pub layout: DofLayout,
}

impl Friction {
    fn sliding(&self, contact: &FrictionContact, q: &[f64]) -> Vec3 {
        let mut u = Vec3::zeros();
        for (point, weight) in contact.points.iter().zip(contact.weights) {
            let start = point.0 as usize;
            for axis in 0..3 {
                u[axis] += weight * (q[start + axis] - self.start[start + axis]);
            }
        }
        u - contact.normal * contact.normal.dot(&u)
    }

    fn potential(&self, y: f64) -> f64 {
        let eta = self.smoothing;
        if y < eta {
            y * y / eta - y * y * y / (3.0 * eta * eta) + eta / 3.0
        } else {
            y
        }
    }

    /// f₀'(y)/y and f₀''(y).
    fn slopes(&self, y: f64) -> [f64; 2] {
        let eta = self.smoothing;
        if y < eta {
            [(2.0 - y / eta) / eta, 2.0 * (1.0 - y / eta) / eta]
        } else {
            [1.0 / y, 0.0]
        }
    }

    /// Second derivatives by the sliding: `f₁/y (1 − n nᵀ − û ûᵀ) + f₀'' û ûᵀ`, positive semidefinite.
    fn stiffness(&self, contact: &FrictionContact, u: &Vec3) -> Matrix3<f64> {
        let y = u.norm();
        let [ratio, second] = self.slopes(y);
        let plane = Matrix3::identity() - contact.normal * contact.normal.transpose();
        let along = if y > 0.0 {
            u * u.transpose() / (y * y)
        } else {
            Matrix3::zeros()
        };
        (plane * ratio + along * (second - ratio)) * contact.limit
    }
}

impl Contact {
    /// Normal forces and tangents at `q`, that of the last refresh, as the friction of the coming step.
    pub fn lag(&self, q: &[f64], friction: &mut Friction) {
        let body = |v: u32| self.mesh.body[v as usize];
        friction.contacts.clear();
        for pair in &self.active {
            let active = self.activate(pair, q);
            let other = if pair.kind == PairKind::VertexFace {
                1
            } else {
                2
            };
            let [a, b] = [0, other].map(|i| body(pair.vertices[i]));
            let mu = self.friction.of_bodies(a, b);
            let distance = active.closest.distance_squared.sqrt();
            let slope = active.barrier.derivatives(active.closest.distance_squared)[1];
            let m = mollify(&active.positions, active.threshold);
            let force = -2.0 * self.kappa * active.area * m * slope * distance;
            if mu * force > 0.0 {
                friction.contacts.push(FrictionContact {
                    points: pair.vertices.map(|v| self.mesh.vertices[v as usize]),
                    weights: active.closest.weights,
                    normal: active.closest.separation / distance,
                    limit: mu * force,
                });
            }
        }
        for near in &self.active_planes {
            let plane = &self.planes[near.plane];
            let mu = self.friction.with_plane(body(near.vertex), near.plane);
            let limit = mu * -self.plane_derivatives(near)[0];
            if limit > 0.0 {
                let vertex = self.mesh.vertices[near.vertex as usize];
                friction.contacts.push(FrictionContact {
                    points: [vertex, plane.point, plane.point, plane.point],
                    weights: [1.0, -1.0, 0.0, 0.0],
                    normal: plane.normal,
                    limit,
                });
            }
        }
    }
}

impl Energy for Friction {
    fn name(&self) -> &'static str {
        "friction"
    }

    fn value(&self, q: &[f64]) -> f64 {
        ordered_sum(self.contacts.len(), |i| {
            let contact = &self.contacts[i];
            contact.limit * self.potential(self.sliding(contact, q).norm())
        })
    }

    fn add_gradient(&self, q: &[f64], gradient: &mut [f64]) {
        for contact in &self.contacts {
            let u = self.sliding(contact, q);
            let force = u * (contact.limit * self.slopes(u.norm())[0]);
            for (point, weight) in contact.points.iter().zip(contact.weights) {
                for axis in 0..3 {
                    gradient[point.0 as usize + axis] += weight * force[axis];
                }
            }
        }
    }

    fn add_derivatives(
        &self,
        q: &[f64],
        _: PsdProjection,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        self.add_gradient(q, gradient);
        let blocks = parallel_map(self.contacts.len(), |i| {
            self.stiffness(&self.contacts[i], &self.sliding(&self.contacts[i], q))
        });
        for (contact, block) in self.contacts.iter().zip(&blocks) {
            for i in (0..4).filter(|&i| contact.weights[i] != 0.0) {
                for j in (0..=i).filter(|&j| contact.weights[j] != 0.0) {
                    let scale = contact.weights[i] * contact.weights[j];
                    let (a, b) = (
                        self.layout.node(contact.points[i]),
                        self.layout.node(contact.points[j]),
                    );
                    hessian.add(a, b, i == j, |r, c| scale * block[(r, c)]);
                }
            }
        }
    }

    fn add_to_pattern(&self, _q: &[f64], pattern: &mut PatternBuilder) {
        for contact in &self.contacts {
            let used = (0..4).filter(|&i| contact.weights[i] != 0.0);
            pattern.couple(used.map(|i| self.layout.node(contact.points[i])));
        }
    }

    fn has_changing_pattern(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_forces_are_the_derivative_of_their_potential() {
        let mut layout = DofLayout::new();
        layout.push_nodes(4, 3, true);
        let normal = Vec3::new(0.3, -0.2, 0.9).normalize();
        let contact = FrictionContact {
            points: [0, 3, 6, 9].map(Dof),
            weights: [1.0, -0.2, -0.5, -0.3],
            normal,
            limit: 2.5,
        };
        let friction = Friction {
            contacts: vec![contact],
            start: vec![0.0; 12],
            smoothing: 0.05,
            layout,
        };
        for scale in [0.01, 0.2] {
            let q: Vec<f64> = (0..12)
                .map(|i| scale * ((i * 3 + 1) as f64).sin())
                .collect();
            let mut gradient = vec![0.0; 12];
            friction.add_gradient(&q, &mut gradient);
            for i in 0..12 {
                let at = |h: f64| {
                    let mut moved = q.clone();
                    moved[i] += h;
                    friction.value(&moved)
                };
                let difference = (at(1e-6) - at(-1e-6)) / 2e-6;
                assert!((gradient[i] - difference).abs() < 1e-8);
            }
            let u = friction.sliding(&friction.contacts[0], &q);
            let stiffness = friction.stiffness(&friction.contacts[0], &u);
            for axis in 0..3 {
                let at = |h: f64| {
                    let mut v = u;
                    v[axis] += h;
                    let v = v - normal * normal.dot(&v);
                    v * (2.5 * friction.slopes(v.norm())[0])
                };
                let column = (at(1e-7) - at(-1e-7)) / 2e-7;
                assert!((stiffness.column(axis) - column).norm() < 1e-5 * stiffness.norm());
            }
        }
    }
}
