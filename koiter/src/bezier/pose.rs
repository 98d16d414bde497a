//! Where the nodes of a Bézier shell are and how they are turned, and which of that is held.

use nalgebra::UnitQuaternion;

use crate::Vec3;

/// Unknowns of a node: three of its displacement, three of its rotation.
pub const NODE_UNKNOWNS: usize = 6;

/// Positions and rotations of all nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Positions [m].
    pub positions: Vec<Vec3>,
    /// Rotations from the rest shape.
    pub rotations: Vec<UnitQuaternion<f64>>,
}

impl Pose {
    /// Nodes at `positions`, not turned.
    pub fn at(positions: Vec<Vec3>) -> Self {
        let rotations = vec![UnitQuaternion::identity(); positions.len()];
        Self {
            positions,
            rotations,
        }
    }

    /// The nodes of this pose and then those of another.
    pub fn followed_by(&self, other: &Self) -> Self {
        Self {
            positions: [&self.positions[..], &other.positions].concat(),
            rotations: [&self.rotations[..], &other.rotations].concat(),
        }
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// `x_i + δx_i`, `exp(δθ_i) R_i` for `motion` = (δx_0, δθ_0, δx_1, …) times `factor`.
    pub fn moved(&self, motion: &[f64], factor: f64) -> Self {
        let mut moved = self.clone();
        for (node, change) in motion.chunks_exact(NODE_UNKNOWNS).enumerate() {
            let [x, y, z, rx, ry, rz] = [0, 1, 2, 3, 4, 5].map(|k| factor * change[k]);
            moved.positions[node] += Vec3::new(x, y, z);
            moved.rotations[node] =
                UnitQuaternion::from_scaled_axis(Vec3::new(rx, ry, rz)) * moved.rotations[node];
            // Thousands of products drift off the sphere otherwise.
            moved.rotations[node].renormalize_fast();
        }
        moved
    }

    /// The motion from this pose to another: displacements [m] and rotation vectors [rad] of every node.
    pub fn motion_to(&self, other: &Self) -> Vec<f64> {
        let mut motion = Vec::with_capacity(NODE_UNKNOWNS * self.len());
        for node in 0..self.len() {
            motion.extend_from_slice((other.positions[node] - self.positions[node]).as_slice());
            let turn = other.rotations[node] * self.rotations[node].inverse();
            motion.extend_from_slice(turn.scaled_axis().as_slice());
        }
        motion
    }

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        let positions = (self.positions.iter()).all(|x| x.iter().all(|c| c.is_finite()));
        positions && (self.rotations.iter()).all(|r| r.coords.iter().all(|c| c.is_finite()))
    }
}

/// Which unknowns are held where they are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Supports {
    held: Vec<bool>,
}

impl Supports {
    /// Six a node.
    pub(super) fn of(held: Vec<bool>) -> Self {
        Self { held }
    }

    /// Nothing is held.
    pub fn none(nodes: usize) -> Self {
        Self {
            held: vec![false; NODE_UNKNOWNS * nodes],
        }
    }

    /// Holds position and rotation of a node.
    pub fn clamp(&mut self, node: usize) {
        self.held[NODE_UNKNOWNS * node..NODE_UNKNOWNS * (node + 1)].fill(true);
    }

    /// Holds the position of a node.
    pub fn pin(&mut self, node: usize) {
        self.held[NODE_UNKNOWNS * node..NODE_UNKNOWNS * node + 3].fill(true);
    }

    /// Holds the displacement of a node along an axis (0, 1, 2).
    pub fn hold_displacement(&mut self, node: usize, axis: usize) {
        self.held[NODE_UNKNOWNS * node + axis] = true;
    }

    /// Holds the rotation of a node.
    pub fn hold_rotation(&mut self, node: usize) {
        self.held[NODE_UNKNOWNS * node + 3..NODE_UNKNOWNS * (node + 1)].fill(true);
    }

    /// Puts a node on a plane of symmetry whose normal is an axis (0, 1, 2): no motion along it, no rotation about the
    /// others.
    pub fn mirror(&mut self, node: usize, axis: usize) {
        self.hold_displacement(node, axis);
        for other in (0..3).filter(|&other| other != axis) {
            self.held[NODE_UNKNOWNS * node + 3 + other] = true;
        }
    }

    /// These, and so many nodes more that are free.
    pub fn with_free(mut self, nodes: usize) -> Self {
        self.held
            .resize(self.held.len() + NODE_UNKNOWNS * nodes, false);
        self
    }

    /// Whether each unknown is held: six a node.
    pub fn held(&self) -> &[bool] {
        &self.held
    }
}
