//! Contact of the fine surface, felt by the coarse shell.
//!
//! The barrier and its derivatives are those of the fine surface and of the obstacles; with J the derivative of the fine
//! positions by the unknowns of the nodes ([`super::map`])
//!
//! ```text
//! g = Jᵀ g_fine        H = Jᵀ H_fine J
//! ```
//!
//! The curvature of the map itself is left out of H. Between two poses the fine surface is taken to go straight, and this
//! way is searched for collisions: what is left free of intersections by it is free of them.

use std::sync::Arc;

use super::newton::Potential;
use super::{MappedSurface, Pose, Tangent};
use crate::Vec3;
use crate::assembly::{
    DofLayout, Energy, HessianBuilder, NodeId, Pattern, PatternBuilder, PsdProjection,
    SymmetricMatrix,
};
use crate::contact::{CollisionBody, CollisionMesh, Contact};
use crate::mesh::Surface;

/// An obstacle: a surface that stays rigid and is moved from outside.
#[derive(Clone, Debug)]
pub struct MovingObstacle {
    /// Name in messages.
    pub name: String,
    /// Its surface, where it is.
    pub surface: Surface,
    /// Half its thickness [m].
    pub offset: f64,
}

/// How contact acts.
#[derive(Clone, Copy, Debug)]
pub struct ContactOptions {
    /// Gap at which the barrier begins [m].
    pub d_hat: f64,
    /// Stiffness of the barrier an area [J/m²].
    pub kappa: f64,
    /// Half the thickness of the shell [m].
    pub offset: f64,
}

/// The barrier between a fine surface, itself and obstacles.
pub struct MappedContact {
    contact: Contact,
    mapped: MappedSurface,
    layout: DofLayout,
    /// Positions of the obstacles' vertices, one after the other [m].
    obstacles: Vec<Vec3>,
    /// Nodes that touch, coupled through the fine surface, since the last iteration began.
    coupled: Vec<[u32; 2]>,
    pattern: Option<Arc<Pattern>>,
}

/// An obstacle stops at this fraction of the way to where it would touch.
const SHORT_OF_TOUCHING: f64 = 0.8;

impl MappedContact {
    /// Contact of a fine surface with obstacles and itself; `pose` weighs areas.
    pub fn new(
        mapped: MappedSurface,
        obstacles: &[MovingObstacle],
        pose: &Pose,
        options: ContactOptions,
    ) -> Self {
        let mut layout = DofLayout::new();
        let rest_positions = mapped.positions(pose);
        let edges = |faces: &[[u32; 3]]| {
            let mut edges: Vec<[u32; 2]> = (faces.iter())
                .flat_map(|f| [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]])
                .map(|[a, b]| [a.min(b), a.max(b)])
                .collect();
            edges.sort_unstable();
            edges.dedup();
            edges
        };
        let mut bodies = vec![CollisionBody {
            name: "shell".to_owned(),
            first_dof: layout.push_nodes(rest_positions.len(), 3, true),
            num_vertices: rest_positions.len(),
            edges: edges(mapped.faces()),
            faces: mapped.faces().to_vec(),
            rest_positions,
            offset: options.offset,
            is_obstacle: false,
            friction: 0.0,
        }];
        for obstacle in obstacles {
            let surface = &obstacle.surface;
            bodies.push(CollisionBody {
                name: obstacle.name.clone(),
                first_dof: layout.push_nodes(surface.positions.len(), 3, false),
                num_vertices: surface.positions.len(),
                edges: surface.mesh.edges().to_vec(),
                faces: surface.mesh.faces().to_vec(),
                rest_positions: surface.positions.clone(),
                offset: obstacle.offset,
                is_obstacle: true,
                friction: 0.0,
            });
        }
        let mesh = CollisionMesh::new(bodies);
        Self {
            contact: Contact::new(
                mesh,
                Vec::new(),
                layout.clone(),
                options.d_hat,
                options.kappa,
            ),
            obstacles: (obstacles.iter())
                .flat_map(|o| o.surface.positions.clone())
                .collect(),
            mapped,
            layout,
            coupled: Vec::new(),
            pattern: None,
        }
    }

    /// Fine positions and obstacles, as contact sees them.
    fn unknowns(&self, pose: &Pose) -> Vec<f64> {
        let mapped = self.mapped.positions(pose);
        (mapped.iter().chain(&self.obstacles))
            .flat_map(|x| [x.x, x.y, x.z])
            .collect()
    }

    /// Moves the obstacles towards other positions, but not so far that they touch the shell; returns the fraction of the way.
    pub fn move_obstacles(&mut self, pose: &Pose, towards: &[Vec3]) -> f64 {
        let from = self.unknowns(pose);
        let shell = from.len() - 3 * self.obstacles.len();
        let mut motion = vec![0.0; from.len()];
        for (k, (to, at)) in towards.iter().zip(&self.obstacles).enumerate() {
            motion[shell + 3 * k..shell + 3 * k + 3].copy_from_slice((to - at).as_slice());
        }
        self.contact.prepare(&from);
        let allowed = self.contact.max_step(&from, &motion);
        let fraction = if allowed < 1.0 {
            SHORT_OF_TOUCHING * allowed
        } else {
            1.0
        };
        for (at, to) in self.obstacles.iter_mut().zip(towards) {
            *at += (to - *at) * fraction;
        }
        let now = self.unknowns(pose);
        self.contact.prepare(&now);
        fraction
    }

    /// Positions of the obstacles' vertices [m].
    pub fn obstacles(&self) -> &[Vec3] {
        &self.obstacles
    }

    /// The fine surface.
    pub fn mapped(&self) -> &MappedSurface {
        &self.mapped
    }

    /// Vertices of the fine surface that contact pushes at a pose, with the forces on them [N].
    pub fn forces(&self, pose: &Pose) -> Vec<(usize, Vec3)> {
        let q = self.unknowns(pose);
        let mut gradient = vec![0.0; q.len()];
        self.contact.add_gradient(&q, &mut gradient);
        (0..self.mapped.points().len())
            .map(|v| (v, -Vec3::from_column_slice(&gradient[3 * v..3 * v + 3])))
            .filter(|(_, force)| force.norm_squared() > 0.0)
            .collect()
    }

    /// The pairs of fine vertices that act, themselves included.
    fn make_pattern(&mut self, q: &[f64]) {
        let mut builder = PatternBuilder::default();
        self.contact.add_to_pattern(q, &mut builder);
        let pairs = builder.finish();
        self.coupled.clear();
        let solved = self.layout.num_solved_nodes() as u32;
        for (a, b) in pairs.iter().filter(|(a, b)| a.0 < solved && b.0 < solved) {
            let [first, second] = [a, b].map(|v| self.mapped.carried()[v.0 as usize].nodes);
            let between = |a: u32| second.into_iter().map(move |b| [a.min(b), a.max(b)]);
            (self.coupled).extend(first.into_iter().flat_map(between).filter(|[a, b]| a != b));
        }
        self.coupled.sort_unstable();
        self.coupled.dedup();
        self.pattern = Some(Arc::new(Pattern::new(&self.layout, &pairs)));
    }
}

impl Potential for MappedContact {
    fn begin(&mut self, pose: &Pose) {
        let q = self.unknowns(pose);
        if self.pattern.is_none() {
            self.contact.prepare(&q);
        }
        self.contact.begin_iteration(&q);
        self.make_pattern(&q);
    }

    fn value(&self, pose: &Pose) -> Option<f64> {
        let value = self.contact.value(&self.unknowns(pose));
        value.is_finite().then_some(value)
    }

    fn add_derivatives(
        &self,
        pose: &Pose,
        _tangent: Tangent,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        let pattern = self.pattern.as_ref().expect("an iteration was begun");
        let q = self.unknowns(pose);
        let mut matrix = SymmetricMatrix::zeros(Arc::clone(pattern));
        let (mut of_points, mut coupling) = (vec![0.0; q.len()], vec![0.0; q.len()]);
        let still = vec![0.0; 3 * self.obstacles.len()];
        let mut fine = HessianBuilder {
            matrix: &mut matrix,
            layout: &self.layout,
            prescribed_step: &still,
            coupling: &mut coupling,
        };
        (self.contact).add_derivatives(&q, PsdProjection::Clamp, &mut of_points, &mut fine);
        for (v, carried) in self.mapped.carried().iter().enumerate() {
            let force = Vec3::from_column_slice(&of_points[3 * v..3 * v + 3]);
            if force != Vec3::zeros() {
                carried.add_force(pose, &force, gradient);
                self.add_column(v, pose, &matrix, hessian);
            }
        }
    }

    fn add_to_pattern(&self, pattern: &mut PatternBuilder) {
        for pair in &self.coupled {
            pattern.couple(pair.map(NodeId));
        }
    }

    fn allowed(&mut self, from: &Pose, to: &Pose) -> f64 {
        let (from, to) = (self.unknowns(from), self.unknowns(to));
        let motion: Vec<f64> = to.iter().zip(&from).map(|(b, a)| b - a).collect();
        self.contact.max_step(&from, &motion)
    }
}

impl MappedContact {
    /// Adds JᵀHJ of the blocks below a vertex in the fine matrix.
    fn add_column(
        &self,
        v: usize,
        pose: &Pose,
        matrix: &SymmetricMatrix,
        hessian: &mut HessianBuilder<'_>,
    ) {
        let column = NodeId(v as u32);
        let of_column = &self.mapped.carried()[v];
        let right = of_column.jacobians(pose);
        let pattern = &matrix.pattern;
        let length = pattern.first_column_length(column) as usize;
        for &row in pattern.coupled(column) {
            let slot = pattern
                .slot(NodeId(row), column)
                .expect("the row is coupled") as usize;
            let is_diagonal = row == column.0;
            let mut block = nalgebra::Matrix3::zeros();
            for c in 0..3 {
                let start = slot + c * length - c * (c + 1) / 2;
                for r in if is_diagonal { c } else { 0 }..3 {
                    block[(r, c)] = matrix.values[start + r];
                    if is_diagonal {
                        block[(c, r)] = block[(r, c)];
                    }
                }
            }
            let of_row = &self.mapped.carried()[row as usize];
            let left = of_row.jacobians(pose);
            for i in 0..3 {
                for j in 0..if is_diagonal { i + 1 } else { 3 } {
                    let part = left[i].transpose() * block * right[j];
                    let same = is_diagonal && i == j;
                    let (a, b) = (NodeId(of_row.nodes[i]), NodeId(of_column.nodes[j]));
                    hessian.add(a, b, same, |r, c| part[(r, c)]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bezier::problems::{RoofEdges, roof};
    use crate::bezier::{Dynamics, ElementKind, NewtonLimits};
    use crate::mesh::generate::icosphere;

    #[test]
    fn a_ball_pushes_the_roof_in_without_touching_it() {
        let problem = roof(ElementKind::Bezier, 6, RoofEdges::Clamped).unwrap();
        let rest = problem.shell.rest_pose();
        let mapped = MappedSurface::subdivided(&problem.shell, 3);
        let mut ball = icosphere(3.0, 2).unwrap();
        let at = Vec3::new(8.0, 15.0, 28.2);
        ball.positions.iter_mut().for_each(|x| *x += at);
        let start = ball.positions.clone();
        let obstacle = MovingObstacle {
            name: "ball".to_owned(),
            surface: ball,
            offset: 0.0,
        };
        let options = ContactOptions {
            d_hat: 0.1,
            kappa: 1e5,
            offset: 0.125,
        };
        let mut contact = MappedContact::new(mapped, &[obstacle], &rest, options);
        let mut moving = Dynamics::new(problem.shell, problem.supports);
        let limits = NewtonLimits::for_edges(problem.edge);
        let mut pushed = 0;
        for step in 1..=10 {
            let down = Vec3::new(0.0, 0.0, -0.15 * step as f64);
            let towards: Vec<Vec3> = start.iter().map(|x| x + down).collect();
            for _ in 0..20 {
                let fraction = contact.move_obstacles(&moving.pose, &towards);
                let outcome = moving.settle(&mut [&mut contact], &limits).unwrap();
                assert!(outcome.iterations < 50, "{step}: {outcome:?}");
                if fraction == 1.0 {
                    break;
                }
            }
            pushed = contact.forces(&moving.pose).len();
        }
        assert!((contact.obstacles()[0] - start[0]).norm() > 1.49);
        assert!(pushed > 0);
        // No fine vertex is within the ball and the offset; between the facets of the ball it is smaller than its radius.
        let centre = at + Vec3::new(0.0, 0.0, -1.5);
        let nearest = (contact.mapped().positions(&moving.pose).iter())
            .map(|x| (x - centre).norm())
            .fold(f64::INFINITY, f64::min);
        assert!(nearest > 2.9, "{nearest}");
        // Contact pushes inwards, and the shell pushes back: loads are in balance, so forces on nodes are those of the map.
        let forces = contact.forces(&moving.pose);
        let total: Vec3 = forces.iter().map(|(_, f)| f).sum();
        assert!(total.z < 0.0, "{total}");
    }
}
