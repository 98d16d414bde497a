//! Bézier shells in a checkpoint.

use nalgebra::{Quaternion, UnitQuaternion};

use super::{Bytes, list, numbers, vectors};
use crate::bezier::{ContactState, Pose};
use crate::contact::{Pair, PairKind};
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
        self.list(state.contact.as_slice(), |out, contact| {
            out.f64(contact.kappa);
            out.vectors(&contact.obstacles);
            out.list(&contact.asleep, |out, pair| {
                out.0.push((pair.kind == PairKind::EdgeEdge).into());
                pair.vertices.iter().for_each(|v| out.u32(*v));
            });
        });
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
        contact: {
            let mut all = list(reader, 24, contact)?;
            let first = all.pop();
            all.is_empty().then_some(first)?
        },
    })
}

fn contact(reader: &mut ByteReader) -> Option<ContactState> {
    Some(ContactState {
        kappa: reader.f64()?,
        obstacles: vectors(reader)?,
        asleep: list(reader, 17, |reader| {
            let kind = match reader.u8()? {
                0 => PairKind::VertexFace,
                1 => PairKind::EdgeEdge,
                _ => return None,
            };
            let vertices = [reader.u32()?, reader.u32()?, reader.u32()?, reader.u32()?];
            Some(Pair { kind, vertices })
        })?,
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
