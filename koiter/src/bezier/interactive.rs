//! A loop with a deadline a frame, fed with drags and forces.
//!
//! Every frame is one implicit step, begun at the pose before it. If time runs out it takes fewer iterations: each lowers the
//! sum that a step minimises, so the shell lags behind but does not gain energy. A frame that cannot be solved at all leaves
//! the shell where it was, at rest, and says so.

use std::time::{Duration, Instant};

use super::change::Change;
use super::dynamics::Dynamics;
use super::map::{Carried, SurfacePoint};
use super::newton::Potential;
use super::pose::NODE_UNKNOWNS;
use super::{BezierError, BezierShell, DeadLoad, MappedContact, NewtonLimits, Pose, Tangent};
use crate::Vec3;
use crate::assembly::{HessianBuilder, NodeId};

/// A point of the surface pulled towards another by a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    /// What is pulled.
    pub point: SurfacePoint,
    /// Where to [m].
    pub target: Vec3,
    /// Stiffness of the spring [N/m].
    pub stiffness: f64,
}

/// All drags, as carried by the shell.
pub struct Drags(Vec<(Carried, Drag)>);

impl Drags {
    /// Drags of points of a shell. A drag of an element that a cut took away pulls at nothing.
    pub fn new(shell: &BezierShell, drags: &[Drag]) -> Self {
        let elements = shell.elements().len();
        let held = drags.iter().filter(|drag| drag.point.element < elements);
        Self(
            held.map(|drag| (Carried::new(shell, &drag.point), *drag))
                .collect(),
        )
    }
}

impl Potential for Drags {
    fn value(&self, pose: &Pose) -> Option<f64> {
        let energy = |(carried, drag): &(Carried, Drag)| {
            0.5 * drag.stiffness * (carried.position(pose) - drag.target).norm_squared()
        };
        Some(self.0.iter().map(energy).sum())
    }

    fn add_derivatives(
        &self,
        pose: &Pose,
        _tangent: Tangent,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        for (carried, drag) in &self.0 {
            let pull = (carried.position(pose) - drag.target) * drag.stiffness;
            carried.add_force(pose, &pull, gradient);
            let jacobians = carried.jacobians(pose);
            for i in 0..3 {
                for j in 0..=i {
                    let block = jacobians[i].transpose() * jacobians[j] * drag.stiffness;
                    let nodes = [i, j].map(|k| NodeId(carried.nodes[k]));
                    hessian.add(nodes[0], nodes[1], i == j, |r, c| block[(r, c)]);
                }
            }
        }
    }
}

/// What became of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameReport {
    /// Iterations of Newton's method.
    pub iterations: usize,
    /// Whether the step was solved to its tolerance.
    pub converged: bool,
    /// Whether it ended for want of time.
    pub late: bool,
    /// Whether nothing could be solved and the shell stayed where it was.
    pub held: bool,
    /// Seconds it took.
    pub seconds: f64,
}

/// A shell that is played with.
pub struct Interaction {
    /// Shell, supports, pose, velocities.
    pub dynamics: Dynamics,
    /// What pulls on it.
    pub drags: Vec<Drag>,
    /// Forces and moments on its nodes, gravity among them.
    pub load: DeadLoad,
    /// What it touches, if anything.
    pub contact: Option<MappedContact>,
    /// Time of a frame in the simulation [s].
    pub dt: f64,
    /// Most iterations a frame.
    pub iterations: usize,
}

impl Interaction {
    /// A shell without drags, loads and contact.
    pub fn new(dynamics: Dynamics, dt: f64) -> Self {
        Self {
            drags: Vec::new(),
            contact: None,
            load: DeadLoad::none(dynamics.pose.len()),
            dynamics,
            dt,
            iterations: 8,
        }
    }

    /// Advances by one frame within `budget` of real time, or in one iteration if that is longer.
    pub fn frame(&mut self, budget: Duration) -> FrameReport {
        let start = Instant::now();
        let shell = &self.dynamics.shell;
        let edge = (shell.area() / shell.elements().len() as f64).sqrt();
        let limits = NewtonLimits {
            iterations: self.iterations,
            // A thousandth of an edge cannot be seen, but gaps are smaller.
            tolerance: (self.contact.as_ref())
                .map_or(f64::INFINITY, MappedContact::tolerance)
                .min(1e-3 * edge),
            deadline: Some(start + budget),
            tangent: Tangent::Corotated,
            ..NewtonLimits::for_edges(edge)
        };
        let mut drags = Drags::new(shell, &self.drags);
        let mut load = self.load.clone();
        let mut others: Vec<&mut dyn Potential> = vec![&mut drags, &mut load];
        if let Some(contact) = &mut self.contact {
            contact.begin_step(&self.dynamics.pose, self.dt);
            others.push(contact);
        }
        let mut report = FrameReport::default();
        match self.dynamics.step(&mut others, self.dt, &limits) {
            Ok(outcome) => {
                report.iterations = outcome.iterations;
                report.converged = outcome.converged;
                report.late = outcome.late;
            }
            Err(error) => {
                log::warn!("a frame is left out: {error}");
                self.dynamics.velocities.fill(0.0);
                report.held = true;
            }
        }
        report.seconds = start.elapsed().as_secs_f64();
        report
    }

    /// Goes on with a shell that was cut or sewn; drags, loads and contact go along. `pose` is that after sewing; without one it is
    /// that of the cut.
    ///
    /// # Errors
    /// As [`MappedContact::after`]; nothing is changed then.
    pub fn change(&mut self, change: &Change, pose: Option<Pose>) -> Result<(), BezierError> {
        let dynamics = self.dynamics.changed(change, pose);
        if let Some(contact) = &self.contact {
            let (surface, _) = change.surface(contact.mapped());
            let after = contact.after(surface, &dynamics.pose, &change.near())?;
            self.contact = Some(after);
        }
        let points: Vec<SurfacePoint> = self.drags.iter().map(|d| d.point).collect();
        for (drag, point) in self.drags.iter_mut().zip(change.points(&points)) {
            drag.point = point;
        }
        self.load = change.load(&self.load);
        self.dynamics = dynamics;
        Ok(())
    }

    /// Pulls on the point of a drag no more.
    pub fn release(&mut self) {
        self.drags.clear();
    }

    /// Adds a force on a point of the surface [N] until [`Self::clear_forces`].
    ///
    /// # Errors
    /// A point of no element.
    pub fn push(&mut self, point: &SurfacePoint, force: &Vec3) -> Result<(), BezierError> {
        let (element, elements) = (point.element, self.dynamics.shell.elements().len());
        if element >= elements {
            return Err(BezierError::NoSuchElement { element, elements });
        }
        let carried = Carried::new(&self.dynamics.shell, point);
        let mut loads = vec![0.0; NODE_UNKNOWNS * self.dynamics.pose.len()];
        carried.add_force(&self.dynamics.pose, force, &mut loads);
        self.load.add(&loads);
        Ok(())
    }

    /// Takes all forces away.
    pub fn clear_forces(&mut self) {
        self.load = DeadLoad::none(self.dynamics.pose.len());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bezier::problems::{RoofEdges, roof};
    use crate::bezier::{ContactOptions, ElementKind, MappedSurface, SurfacePath};

    fn interaction() -> Interaction {
        let problem = roof(ElementKind::Bezier, 4, RoofEdges::Clamped).unwrap();
        let mut dynamics = Dynamics::new(problem.shell, problem.supports);
        dynamics.damping = 1.0;
        Interaction::new(dynamics, 0.04)
    }

    fn drag(target: Vec3) -> Drag {
        let point = SurfacePoint {
            element: 31,
            barycentric: [0.2, 0.3, 0.5],
        };
        Drag {
            point,
            target,
            stiffness: 1e6,
        }
    }

    #[test]
    fn a_drag_brings_its_point_to_the_target_within_the_frames_it_has() {
        let mut played = interaction();
        let point = drag(Vec3::zeros()).point;
        let carried = Carried::new(&played.dynamics.shell, &point);
        let target = carried.position(&played.dynamics.pose) + Vec3::new(0.0, 0.0, -1.0);
        played.drags.push(drag(target));
        for _ in 0..60 {
            let report = played.frame(Duration::from_secs(10));
            assert!(report.converged && !report.held, "{report:?}");
        }
        let at = carried.position(&played.dynamics.pose);
        let mut still = Dynamics::at(
            played.dynamics.shell.clone(),
            played.dynamics.supports.clone(),
            played.dynamics.pose.clone(),
        );
        let mut drags = Drags(vec![(carried, played.drags[0])]);
        let settled = still
            .settle(&mut [&mut drags], &NewtonLimits::for_edges(1.0))
            .unwrap();
        assert!(settled.converged);
        let there = carried.position(&still.pose);
        // Frames stop at a thousandth of an edge, 6 mm, and some motion is left.
        assert!((at - there).norm() < 0.05, "{at} {there}");
        assert!((there - target).norm() < 0.9, "{there} {target}");
    }

    #[test]
    fn without_time_a_frame_takes_one_iteration_and_energy_stays_bounded() {
        let mut played = interaction();
        let start = played.dynamics.pose.clone();
        let point = drag(Vec3::zeros()).point;
        let at = Carried::new(&played.dynamics.shell, &point).position(&start);
        // Pulled far out and back and forth, with no time for any frame.
        let mut worst: f64 = 0.0;
        for frame in 0..60 {
            let side = if frame / 10 % 2 == 0 { 1.0 } else { -1.0 };
            played.drags = vec![drag(at + Vec3::new(10.0 * side, 0.0, 8.0))];
            let report = played.frame(Duration::ZERO);
            assert!(report.iterations <= 1, "{report:?}");
            assert!(played.dynamics.pose.is_finite());
            let elastic = played.dynamics.shell.energy(&played.dynamics.pose).unwrap();
            worst = worst.max(elastic + played.dynamics.kinetic_energy());
        }
        // The springs hold at most ½ k |target − x|² when a drag begins, and six begin.
        assert!(worst < 6.0 * 0.5 * 1e6 * 30f64.powi(2), "{worst}");
    }

    #[test]
    fn a_cut_while_it_is_dragged_takes_drags_and_contact_along() {
        let mut played = interaction();
        let shell = &played.dynamics.shell;
        let rest = shell.rest_pose();
        let options = ContactOptions {
            d_hat: 0.05,
            kappa: 1e4,
            offset: 0.0,
            friction: 0.0,
            friction_speed: 1e-3,
        };
        let fine = MappedSurface::subdivided(shell, 2);
        played.contact = Some(MappedContact::new("roof", fine, Vec::new(), &rest, options));
        // Across the middle, from the second row of nodes to the last but one.
        let ends = [6, 18].map(|node| shell.nearest(&rest.positions[node], |_| true).unwrap().1);
        let path = SurfacePath::between(shell, &rest.positions, &ends[0], &ends[1]).unwrap();
        let change = shell.cut(&path).unwrap();
        let lip = change.seam[0][0];
        played.drags.push(drag(Vec3::zeros()));
        let at = Carried::new(shell, &played.drags[0].point).position(&rest);
        played.change(&change, None).unwrap();
        let carried = Carried::new(&played.dynamics.shell, &played.drags[0].point);
        // A divided element has normals in between: another cubic, by less than the sagitta of a cell of 6 m.
        assert!((carried.position(&played.dynamics.pose) - at).norm() < 0.1);
        let asleep = |played: &Interaction| played.contact.as_ref().unwrap().num_asleep();
        let all = asleep(&played);
        assert!(all > 0);
        played.drags.clear();
        played
            .load
            .add_force(lip as usize, Vec3::new(0.0, 0.0, 3e5));
        for _ in 0..20 {
            let report = played.frame(Duration::from_secs(10));
            assert!(!report.held, "{report:?}");
        }
        assert!(asleep(&played) < all, "{all}");
    }

    #[test]
    fn a_force_on_no_element_is_refused() {
        let mut played = interaction();
        let point = SurfacePoint {
            element: 99,
            barycentric: [1.0, 0.0, 0.0],
        };
        let refused = played.push(&point, &Vec3::z());
        assert_eq!(
            refused,
            Err(BezierError::NoSuchElement {
                element: 99,
                elements: 32
            })
        );
    }
}
