//! Positions of the vertices of a mesh over time, as files of other programs have them.

use crate::Vec3;

/// Positions of the same vertices in some frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointCache {
    /// Times of the frames [s], if the file has them.
    pub times: Option<Vec<f64>>,
    /// Positions, frame by frame, in the units of the file.
    pub frames: Vec<Vec<Vec3>>,
}
