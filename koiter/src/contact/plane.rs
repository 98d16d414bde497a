//! Half-spaces.

use crate::Vec3;
use crate::assembly::Dof;

/// A plane that moves by translation; the free side is where its normal points. Only vertices are tested: a face is on
/// the free side if its corners are.
#[derive(Clone, Debug)]
pub struct CollisionPlane {
    /// Name for reports.
    pub name: String,
    /// First unknown of a point of the plane.
    pub point: Dof,
    /// Unit normal.
    pub normal: Vec3,
    /// Friction coefficient.
    pub friction: f64,
}

impl CollisionPlane {
    /// Signed distance of a position at the configuration `q`.
    #[inline]
    pub fn distance(&self, position: &Vec3, q: &[f64]) -> f64 {
        let start = self.point.0 as usize;
        self.normal
            .dot(&(position - Vec3::new(q[start], q[start + 1], q[start + 2])))
    }

    /// Signed rate of a motion of a vertex and the plane's point.
    #[inline]
    pub fn approach(&self, motion: &Vec3, direction: &[f64]) -> f64 {
        self.distance(motion, direction)
    }
}
