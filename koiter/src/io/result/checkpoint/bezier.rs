//! Bézier shells in a checkpoint.

use nalgebra::{Quaternion, UnitQuaternion};

use super::{Bytes, list, numbers, vectors};
use crate::bezier::Pose;
use crate::io::bytes::ByteReader;
use crate::scene::BezierState;

/// Turns of a quaternion that is not a rotation would shear: the file is damaged.
const LARGEST_DRIFT: f64 = 1e-6;

impl Bytes {
    pub(super) fn bezier(&mut self, state: &BezierState) {
        self.list(&state.done, |out, pose| out.pose(pose));
        self.pose(&state.pose);
        self.numbers(&state.velocities);
        self.list(&state.couplings, |out, [a, b]| {
            out.u32(*a);
            out.u32(*b);
        });
        self.f64(state.kappa);
        self.vectors(&state.obstacles);
    }

    fn pose(&mut self, pose: &Pose) {
        self.vectors(&pose.positions);
        self.list(&pose.rotations, |out, rotation| {
            rotation.coords.iter().for_each(|c| out.f64(*c));
        });
    }
}

pub(super) fn bezier(reader: &mut ByteReader) -> Option<BezierState> {
    Some(BezierState {
        done: list(reader, 16, pose)?,
        pose: pose(reader)?,
        velocities: numbers(reader)?,
        couplings: list(reader, 8, |reader| Some([reader.u32()?, reader.u32()?]))?,
        kappa: reader.f64()?,
        obstacles: vectors(reader)?,
    })
}

fn pose(reader: &mut ByteReader) -> Option<Pose> {
    Some(Pose {
        positions: vectors(reader)?,
        rotations: list(reader, 32, |reader| {
            let [i, j, k, w] = [reader.f64()?, reader.f64()?, reader.f64()?, reader.f64()?];
            let rotation = Quaternion::new(w, i, j, k);
            let is_unit = (rotation.norm() - 1.0).abs() < LARGEST_DRIFT;
            // Not normalised again: the bits are those that were written.
            is_unit.then(|| UnitQuaternion::new_unchecked(rotation))
        })?,
    })
}
