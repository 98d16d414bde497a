//! Loads, and the linear equilibrium under them.

use super::newton::Potential;
use super::pose::NODE_UNKNOWNS;
use super::{BezierError, BezierShell, NewtonLimits, Pose, Solver, Supports, Tangent};
use crate::Vec3;
use crate::assembly::{HessianBuilder, ordered_sum};

/// Forces that keep their direction and moments about axes that stay: six numbers a node [N, N m].
///
/// The work of moments is counted from the pose at which an iteration began, to first order in how far it turns.
#[derive(Clone, Debug, PartialEq)]
pub struct DeadLoad {
    loads: Vec<f64>,
    origin: Option<Pose>,
}

impl DeadLoad {
    /// No load on so many nodes.
    pub fn none(nodes: usize) -> Self {
        Self {
            loads: vec![0.0; NODE_UNKNOWNS * nodes],
            origin: None,
        }
    }

    /// Adds a force on a node [N].
    pub fn add_force(&mut self, node: usize, force: Vec3) {
        for axis in 0..3 {
            self.loads[NODE_UNKNOWNS * node + axis] += force[axis];
        }
    }

    /// Adds a moment on a node [N m].
    pub fn add_moment(&mut self, node: usize, moment: Vec3) {
        for axis in 0..3 {
            self.loads[NODE_UNKNOWNS * node + 3 + axis] += moment[axis];
        }
    }

    /// Adds weight under an acceleration [m/s²].
    pub fn add_gravity(&mut self, shell: &BezierShell, acceleration: Vec3) {
        for (node, mass) in shell.masses().iter().enumerate() {
            self.add_force(node, acceleration * *mass);
        }
    }

    /// Adds six numbers a node.
    pub fn add(&mut self, loads: &[f64]) {
        for (sum, load) in self.loads.iter_mut().zip(loads) {
            *sum += load;
        }
    }

    /// These, and nothing on so many nodes more.
    pub fn with_free(mut self, nodes: usize) -> Self {
        let length = self.loads.len() + NODE_UNKNOWNS * nodes;
        self.loads.resize(length, 0.0);
        self.origin = None;
        self
    }

    /// All loads times a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            loads: self.loads.iter().map(|l| factor * l).collect(),
            origin: None,
        }
    }

    /// Six numbers a node.
    pub fn values(&self) -> &[f64] {
        &self.loads
    }
}

impl Potential for DeadLoad {
    fn begin(&mut self, pose: &Pose) {
        self.origin = Some(pose.clone());
    }

    fn value(&self, pose: &Pose) -> Option<f64> {
        let at = |node: usize| &self.loads[NODE_UNKNOWNS * node..NODE_UNKNOWNS * (node + 1)];
        let work = ordered_sum(pose.len(), |node| {
            let load = at(node);
            let moment = Vec3::new(load[3], load[4], load[5]);
            let mut work = Vec3::new(load[0], load[1], load[2]).dot(&pose.positions[node]);
            if let (Some(origin), true) = (&self.origin, moment != Vec3::zeros()) {
                let turn = pose.rotations[node] * origin.rotations[node].inverse();
                work += moment.dot(&turn.scaled_axis());
            }
            work
        });
        Some(-work)
    }

    fn add_derivatives(
        &self,
        _pose: &Pose,
        _tangent: Tangent,
        gradient: &mut [f64],
        _hessian: &mut HessianBuilder<'_>,
    ) {
        for (g, load) in gradient.iter_mut().zip(&self.loads) {
            *g -= load;
        }
    }
}

/// Pressure on the side the normals leave [Pa]: it follows the surface. Forces are those of the pose at which an iteration
/// began; their change with the pose is left out of the stiffness.
#[derive(Clone, Debug)]
pub struct Pressure {
    pressure: f64,
    faces: Vec<[u32; 3]>,
    load: DeadLoad,
}

impl Pressure {
    /// A pressure on all elements that pushes along their normals if it is positive.
    pub fn new(shell: &BezierShell, pressure: f64) -> Self {
        Self::on(shell, pressure, |_| true)
    }

    /// A pressure on some elements, by their numbers.
    pub fn on(shell: &BezierShell, pressure: f64, is_on: impl Fn(usize) -> bool) -> Self {
        let faces = shell.mesh().faces().iter().enumerate();
        Self {
            pressure,
            faces: (faces
                .filter(|(element, _)| is_on(*element))
                .map(|(_, face)| *face))
            .collect(),
            load: DeadLoad::none(shell.mesh().num_vertices()),
        }
    }

    /// Its forces at a pose.
    pub fn at(&self, pose: &Pose) -> DeadLoad {
        let mut load = DeadLoad::none(pose.len());
        for face in &self.faces {
            let [a, b, c] = face.map(|v| pose.positions[v as usize]);
            let third = (b - a).cross(&(c - a)) * (self.pressure / 6.0);
            for &v in face {
                load.add_force(v as usize, third);
            }
        }
        load
    }
}

impl Potential for Pressure {
    fn begin(&mut self, pose: &Pose) {
        self.load = self.at(pose);
    }

    fn value(&self, pose: &Pose) -> Option<f64> {
        self.load.value(pose)
    }

    fn add_derivatives(
        &self,
        pose: &Pose,
        tangent: Tangent,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        self.load.add_derivatives(pose, tangent, gradient, hessian);
    }
}

/// The motion `K⁻¹ f` of the rest shape, six numbers a node [m, rad].
///
/// # Errors
/// Supports that leave a motion free.
pub fn linear_static(
    shell: &mut BezierShell,
    load: &DeadLoad,
    supports: &Supports,
) -> Result<Vec<f64>, BezierError> {
    let rest = shell.rest_pose();
    let mut solver = Solver::new(shell.layout());
    let limits = NewtonLimits {
        tangent: Tangent::Corotated,
        ..NewtonLimits::for_edges(1.0)
    };
    let mut load = load.clone();
    solver.linear_step(&mut [shell, &mut load], supports, &rest, &limits)
}
