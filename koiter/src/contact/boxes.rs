//! Axis-aligned boxes, exact and as the tree keeps them.

use crate::Vec3;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lowest coordinates.
    pub low: [f64; 3],
    /// Highest coordinates.
    pub high: [f64; 3],
}

impl Aabb {
    /// The empty box.
    pub const EMPTY: Self = Self {
        low: [f64::INFINITY; 3],
        high: [f64::NEG_INFINITY; 3],
    };

    /// The smallest box around points, grown by `margin` on all sides.
    #[inline]
    pub fn around(points: impl IntoIterator<Item = Vec3>, margin: f64) -> Self {
        let mut out = Self::EMPTY;
        for p in points {
            for axis in 0..3 {
                out.low[axis] = out.low[axis].min(p[axis]);
                out.high[axis] = out.high[axis].max(p[axis]);
            }
        }
        for axis in 0..3 {
            out.low[axis] -= margin;
            out.high[axis] += margin;
        }
        out
    }

    /// The smallest box around both.
    #[inline]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|k| self.low[k].min(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].max(other.high[k])),
        }
    }

    /// Whether two boxes share a point.
    #[inline]
    pub fn overlaps(&self, other: &Self) -> bool {
        let axis = |k: usize| (self.low[k] <= other.high[k]) & (other.low[k] <= self.high[k]);
        axis(0) & axis(1) & axis(2)
    }
}

/// A box of the tree, in single precision and rounded outwards: half the memory, and four lanes at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct TreeBox {
    pub(super) low: [f32; 4],
    pub(super) high: [f32; 4],
}

impl TreeBox {
    pub(super) const EMPTY: Self = Self {
        low: [f32::INFINITY; 4],
        high: [f32::NEG_INFINITY; 4],
    };

    #[inline]
    pub(super) fn containing(from: &Aabb) -> Self {
        let below = |x: f64| {
            let near = x as f32;
            if f64::from(near) > x {
                near.next_down()
            } else {
                near
            }
        };
        let mut out = Self {
            low: [0.0; 4],
            high: [0.0; 4],
        };
        for k in 0..3 {
            out.low[k] = below(from.low[k]);
            out.high[k] = -below(-from.high[k]);
        }
        out
    }

    #[inline]
    pub(super) fn union(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|k| self.low[k].min(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].max(other.high[k])),
        }
    }

    #[inline]
    pub(super) fn overlaps(&self, other: &Self) -> bool {
        // Without short circuits, for lanes: most tests of a traversal are mispredicted otherwise.
        let lane = |k: usize| (self.low[k] <= other.high[k]) & (other.low[k] <= self.high[k]);
        lane(0) & lane(1) & lane(2) & lane(3)
    }
}
