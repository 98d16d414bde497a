//! Loads, and the linear equilibrium under them.

use nalgebra::Matrix3;

use super::newton::Potential;
use super::pose::NODE_UNKNOWNS;
use super::{BezierError, BezierShell, NewtonLimits, Pose, Solver, Supports, Tangent};
use crate::Vec3;
use crate::assembly::{HessianBuilder, NodeId, ordered_sum};

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
/// began. A triangle with the edges e_i opposite to its corners pushes each of them by `p/6 (x_1 − x_0) × (x_2 − x_0)`, and the
/// symmetric part of the change with the pose is
///
/// ```text
/// ∂f_i/∂x_j → p/12 [e_j − e_i]×
/// ```
///
/// The other part cancels between triangles; what is left of it at a free boundary is left out of the stiffness.
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

    /// The blocks of the second derivative below the diagonal, by displacements of two nodes; those on it are zero.
    fn blocks(&self, pose: &Pose) -> impl Iterator<Item = ([u32; 2], Matrix3<f64>)> {
        self.faces.iter().flat_map(move |face| {
            let x = face.map(|v| pose.positions[v as usize]);
            let opposite = [0, 1, 2].map(|i| x[(i + 2) % 3] - x[(i + 1) % 3]);
            [[1, 0], [2, 0], [2, 1]].map(|[i, j]| {
                let arm = (opposite[j] - opposite[i]) * (-self.pressure / 12.0);
                ([face[i], face[j]], arm.cross_matrix())
            })
        })
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
        // It is indefinite: where that of the shell is mixed with one that never is, so is this.
        let share = tangent.share();
        for (nodes, block) in self.blocks(pose).filter(|_| share > 0.0) {
            let nodes = nodes.map(NodeId);
            hessian.add(nodes[0], nodes[1], false, |r, c| {
                if r < 3 && c < 3 {
                    share * block[(r, c)]
                } else {
                    0.0
                }
            });
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a closed surface the tangent is that of the forces, by differences.
    #[test]
    fn the_stiffness_of_pressure_is_the_change_of_its_forces_inside_a_boundary() {
        let x = [
            [0.0, 0.0, 0.0],
            [1.0, 0.1, 0.0],
            [0.2, 0.9, 0.1],
            [0.3, 0.2, 0.8],
        ];
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let pressure = Pressure {
            pressure: 2.5,
            faces: faces.to_vec(),
            load: DeadLoad::none(4),
        };
        let pose = Pose::at(x.map(Vec3::from).to_vec());
        let mut tangent = nalgebra::DMatrix::<f64>::zeros(12, 12);
        for (nodes, block) in pressure.blocks(&pose) {
            for (nodes, block) in [(nodes, block), ([nodes[1], nodes[0]], block.transpose())] {
                let [i, j] = nodes.map(|v| 3 * v as usize);
                let mut view = tangent.fixed_view_mut::<3, 3>(i, j);
                view += block;
            }
        }
        let h = 1e-6;
        for j in 0..12 {
            let at = |step: f64| {
                let mut moved = pose.clone();
                moved.positions[j / 3][j % 3] += step;
                pressure.at(&moved)
            };
            let (ahead, behind) = (at(h), at(-h));
            for i in 0..12 {
                let k = NODE_UNKNOWNS * (i / 3) + i % 3;
                let change = (ahead.values()[k] - behind.values()[k]) / (2.0 * h);
                // Forces are quadratic: round-off alone.
                assert!((tangent[(i, j)] + change).abs() < 1e-8, "{i} {j}");
            }
        }
    }
}
