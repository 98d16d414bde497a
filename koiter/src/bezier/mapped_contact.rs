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
//!
//! After a cut or a suture contact begins anew on the fine surface there is then ([`MappedContact::after`]).

use std::sync::Arc;

use super::map::edges_of;
use super::newton::Potential;
use super::{BezierError, MappedSurface, Pose, Tangent};
use crate::Vec3;
use crate::assembly::{
    DofLayout, Energy, HessianBuilder, NodeId, Pattern, PatternBuilder, PsdProjection,
    SymmetricMatrix,
};
use crate::contact::{
    CollisionBody, CollisionMesh, CollisionObstacle, Contact, ContactStatistics, Friction, Pair,
    StartError, UnknownBody,
};

/// How contact acts.
#[derive(Clone, Copy, Debug)]
pub struct ContactOptions {
    /// Gap at which the barrier begins [m].
    pub d_hat: f64,
    /// Stiffness of the barrier an area [J/m²].
    pub kappa: f64,
    /// Half the distance at which two midsurfaces touch [m].
    pub offset: f64,
    /// Friction coefficient of the shell.
    pub friction: f64,
    /// Sliding speed below which friction is smoothed [m/s].
    pub friction_speed: f64,
}

/// Barrier and friction between a fine surface, itself and obstacles.
pub struct MappedContact {
    contact: Contact,
    friction: Friction,
    mapped: MappedSurface,
    made_of: MadeOf,
    layout: DofLayout,
    /// Points of the obstacles, one after the other [m].
    obstacles: Vec<Vec3>,
    /// Nodes that touch, coupled through the fine surface, since the last iteration began.
    coupled: Vec<[u32; 2]>,
    pattern: Option<Arc<Pattern>>,
}

/// What contact was made of, apart from the fine surface.
#[derive(Clone)]
struct MadeOf {
    name: String,
    obstacles: Vec<CollisionObstacle>,
    options: ContactOptions,
    /// Friction between two bodies by name.
    friction_of_pairs: Vec<([String; 2], f64)>,
}

/// What a contact owes to its past.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactState {
    /// Stiffness of the barrier [J/m²]: it grows where gaps shrink.
    pub kappa: f64,
    /// Points of the obstacles [m].
    pub obstacles: Vec<Vec3>,
    /// Pairs at cuts and seams that have not been apart since, in order.
    pub asleep: Vec<Pair>,
}

/// What is held and the obstacles stop at this fraction of the way to where they would touch.
const SHORT_OF_TOUCHING: f64 = 0.8;

/// Trials of how far they may go: each is at most nine tenths of the one before.
const MOST_TRIALS: usize = 60;

impl MappedContact {
    /// Contact of a fine surface with obstacles and itself; `pose` weighs areas. `name` is what messages call the shell.
    pub fn new(
        name: &str,
        mapped: MappedSurface,
        obstacles: Vec<CollisionObstacle>,
        pose: &Pose,
        options: ContactOptions,
    ) -> Self {
        let made_of = MadeOf {
            name: name.to_owned(),
            obstacles,
            options,
            friction_of_pairs: Vec::new(),
        };
        Self::of(made_of, mapped, pose)
    }

    fn of(made_of: MadeOf, mapped: MappedSurface, pose: &Pose) -> Self {
        let options = made_of.options;
        let mut layout = DofLayout::new();
        let rest_positions = mapped.positions(pose);
        let faces = without_slivers(mapped.faces(), &rest_positions);
        let mut bodies = vec![CollisionBody {
            name: made_of.name.clone(),
            first_dof: layout.push_nodes(rest_positions.len(), 3, true),
            num_vertices: rest_positions.len(),
            edges: edges_of(&faces),
            faces,
            rest_positions,
            offset: options.offset,
            is_obstacle: false,
            friction: options.friction,
        }];
        let (mut planes, mut points) = (Vec::new(), Vec::new());
        for obstacle in made_of.obstacles.iter().cloned() {
            points.extend_from_slice(&obstacle.points);
            let first = layout.push_nodes(obstacle.points.len(), 3, false);
            obstacle.add_to(first, &mut bodies, &mut planes);
        }
        let mesh = CollisionMesh::new(bodies);
        let contact = Contact::new(mesh, planes, layout.clone(), options.d_hat, options.kappa);
        Self {
            contact,
            friction: Friction {
                layout: layout.clone(),
                ..Friction::default()
            },
            obstacles: points,
            mapped,
            made_of,
            layout,
            coupled: Vec::new(),
            pattern: None,
        }
    }

    /// Begins a step of `dt` [s]: friction acts with the normal forces there are at `pose`, on what slides from there.
    /// Nothing is kept of the steps before but [`Self::state`].
    pub fn begin_step(&mut self, pose: &Pose, dt: f64) {
        let q = self.unknowns(pose);
        self.contact.wake(&q);
        self.contact.begin_step(&q);
        self.friction.smoothing = self.made_of.options.friction_speed * dt;
        self.contact.lag(&q, &mut self.friction);
        self.friction.start = q;
    }

    /// Energy of the barrier at a pose [J].
    pub fn barrier(&self, pose: &Pose) -> f64 {
        self.contact.value(&self.unknowns(pose))
    }

    /// What it owes to its past.
    pub fn state(&self) -> ContactState {
        ContactState {
            kappa: self.contact.kappa(),
            obstacles: self.obstacles.clone(),
            asleep: self.contact.asleep().to_vec(),
        }
    }

    /// Takes up the state of an earlier moment; false for one of other bodies, or with numbers that are not finite, which is not
    /// taken up.
    pub fn restore(&mut self, state: &ContactState) -> bool {
        let vertices = self.contact.mesh().vertices.len();
        let is_vertex = |v: &u32| (*v as usize) < vertices;
        let is_point = |x: &Vec3| x.iter().all(|c| c.is_finite());
        let fits = state.kappa.is_finite()
            && state.obstacles.len() == self.obstacles.len()
            && state.obstacles.iter().all(is_point)
            && (state.asleep.iter()).all(|pair| pair.vertices.iter().all(is_vertex));
        if fits {
            self.contact.set_kappa(state.kappa);
            self.obstacles.copy_from_slice(&state.obstacles);
            self.contact.set_asleep(state.asleep.clone());
        }
        fits
    }

    /// The same contact over another fine surface: stiffness and obstacles stay, nothing sleeps. `pose` weighs areas.
    pub fn over(&self, mapped: MappedSurface, pose: &Pose) -> Self {
        let mut over = Self::of(self.made_of.clone(), mapped, pose);
        for (bodies, friction) in &self.made_of.friction_of_pairs {
            (over.contact.set_friction(bodies, *friction)).expect("the bodies are the same");
        }
        over.contact.set_kappa(self.contact.kappa());
        over.obstacles.clone_from(&self.obstacles);
        over
    }

    /// This contact over the fine surface after a cut or a suture. What lies on each other there sleeps ([`Contact::put_to_sleep`]);
    /// `is_near` says which nodes are at the cut or the seam ([`super::Change::near`]).
    ///
    /// # Errors
    /// A surface that then touches an obstacle, or crosses itself.
    pub fn after(
        &self,
        mapped: MappedSurface,
        pose: &Pose,
        is_near: &[bool],
    ) -> Result<Self, BezierError> {
        let mut over = self.over(mapped, pose);
        let carried = over.mapped.carried();
        let is_fresh: Vec<bool> = (carried.iter())
            .map(|vertex| vertex.nodes.iter().any(|node| is_near[*node as usize]))
            .collect();
        let q = over.unknowns(pose);
        let is_fresh = |v: u32| is_fresh.get(v as usize) == Some(&true);
        over.contact.put_to_sleep(&q, is_fresh);
        over.contact.check_start(&q)?;
        Ok(over)
    }

    /// A motion that changes gaps by little, a hundredth of the barrier's width [m]: beyond it, Newton's method has not converged.
    pub fn tolerance(&self) -> f64 {
        0.01 * self.made_of.options.d_hat
    }

    /// How many pairs at cuts and seams have not been apart since.
    pub fn num_asleep(&self) -> usize {
        self.contact.asleep().len()
    }

    /// Pairs that push, and the smallest gap, as of the last iteration.
    pub fn statistics(&self) -> ContactStatistics {
        self.contact.statistics()
    }

    /// Friction between two bodies by name, in place of the mean of their coefficients.
    ///
    /// # Errors
    /// A body that there is not.
    pub fn set_friction(&mut self, bodies: &[String; 2], friction: f64) -> Result<(), UnknownBody> {
        self.contact.set_friction(bodies, friction)?;
        (self.made_of.friction_of_pairs).push((bodies.clone(), friction));
        Ok(())
    }

    /// Refuses a pose in which something touches or intersects.
    ///
    /// # Errors
    /// What touches.
    pub fn check_start(&mut self, pose: &Pose) -> Result<(), StartError> {
        let q = self.unknowns(pose);
        self.contact.check_start(&q)
    }

    /// Fine positions and obstacles, as contact sees them.
    fn unknowns(&self, pose: &Pose) -> Vec<f64> {
        let mapped = self.mapped.positions(pose);
        (mapped.iter().chain(&self.obstacles))
            .flat_map(|x| [x.x, x.y, x.z])
            .collect()
    }

    /// Moves the obstacles towards other points and the shell from a pose towards another, but not so far that anything
    /// touches; returns the fraction of the way, and the pose there.
    pub fn approach(&mut self, from: &Pose, to: &Pose, towards: &[Vec3]) -> (f64, Pose) {
        if to == from && towards == self.obstacles {
            return (1.0, to.clone());
        }
        let start = self.unknowns(from);
        let (before, motion) = (self.obstacles.clone(), from.motion_to(to));
        let mut fraction = 1.0;
        for _ in 0..MOST_TRIALS {
            // All of the way ends at the very pose: a motion to it would round.
            let pose = if fraction == 1.0 {
                to.clone()
            } else {
                from.moved(&motion, fraction)
            };
            for (at, (from, to)) in self.obstacles.iter_mut().zip(before.iter().zip(towards)) {
                *at = from + (to - from) * fraction;
            }
            let end = self.unknowns(&pose);
            let way: Vec<f64> = end.iter().zip(&start).map(|(b, a)| b - a).collect();
            let allowed = self.contact.max_step(&start, &way);
            if allowed >= 1.0 {
                return (fraction, pose);
            }
            fraction *= (SHORT_OF_TOUCHING * allowed).min(0.9);
        }
        self.obstacles = before;
        (0.0, from.clone())
    }

    /// Points of the obstacles [m].
    pub fn obstacles(&self) -> &[Vec3] {
        &self.obstacles
    }

    /// The fine surface.
    pub fn mapped(&self) -> &MappedSurface {
        &self.mapped
    }

    /// Vertices of the fine surface that contact or friction pushes at a pose, with the forces on them [N].
    pub fn forces(&self, pose: &Pose) -> Vec<(usize, Vec3)> {
        let q = self.unknowns(pose);
        let mut gradient = vec![0.0; q.len()];
        self.contact.add_gradient(&q, &mut gradient);
        self.friction.add_gradient(&q, &mut gradient);
        (0..self.mapped.points().len())
            .map(|v| (v, -Vec3::from_column_slice(&gradient[3 * v..3 * v + 3])))
            .filter(|(_, force)| force.norm_squared() > 0.0)
            .collect()
    }

    /// The pairs of fine vertices that act, themselves included.
    fn make_pattern(&mut self, q: &[f64]) {
        let mut builder = PatternBuilder::default();
        self.contact.add_to_pattern(q, &mut builder);
        self.friction.add_to_pattern(q, &mut builder);
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
        let q = self.unknowns(pose);
        let value = self.contact.value(&q) + self.friction.value(&q);
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
        (self.friction).add_derivatives(&q, PsdProjection::Clamp, &mut of_points, &mut fine);
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

/// A triangle flatter than this fraction of its longest edge does not collide: its distances have no derivatives, and its neighbours
/// are where it is. A cut leaves such ones where it passes a vertex of the fine surface.
const SLIVER: f64 = 1e-3;

fn without_slivers(faces: &[[u32; 3]], x: &[Vec3]) -> Vec<[u32; 3]> {
    let is_solid = |face: &&[u32; 3]| {
        let [a, b, c] = face.map(|v| x[v as usize]);
        let longest = [b - a, c - b, a - c].map(|e| e.norm_squared());
        let longest = longest.into_iter().fold(0.0, f64::max);
        (b - a).cross(&(c - a)).norm() > SLIVER * longest
    };
    faces.iter().filter(is_solid).copied().collect()
}

#[cfg(test)]
mod tests;
