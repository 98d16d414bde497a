//! A curvature that grows with a factor: a flat sheet curls to a cylinder.
//!
//! ```text
//! s̄(t) = s̄(0) + f(t) (s* − s̄(0))
//! ```
//!
//! s* the measures of the sheet on a cylinder of radius R: second fundamental forms d dᵀ / R, d across the axis; or the hinge
//! angles of the sheet laid on the cylinder. On a mesh with edges along the axis the angles f s* are those of radius R/f, so
//! there is a shape without energy for every f.

use super::{Process, RestState, Window};
use crate::Vec3;
use crate::mesh::Surface;
use crate::rest::RestFrame;

/// Rest values on their way to a target.
#[derive(Clone, Debug, PartialEq)]
pub struct Curl {
    /// s* − s̄(0).
    pub change: Vec<f64>,
}

impl Curl {
    /// Second fundamental forms of a cylinder of this `radius` [m], positive where normals fan out, whose axis has this
    /// direction, projected on every face; each of a face's `samples` has the same.
    pub fn of_forms(
        rest: &Surface,
        frames: &[RestFrame],
        samples: usize,
        radius: f64,
        axis: &Vec3,
    ) -> Self {
        let mut change = Vec::with_capacity(3 * samples * frames.len());
        for (face, frame) in frames.iter().enumerate() {
            let [a, b, c] = rest.corners(face);
            let (e1, e2) = (b - a, c - a);
            let across = e1.cross(&e2).cross(axis).normalize();
            let [p, r] = [e1.dot(&across), e2.dot(&across)];
            let form = frame.components([p * p, p * r, r * r].map(|entry| entry / radius));
            (0..samples).for_each(|_| change.extend(form.iter()));
        }
        Self { change }
    }
}

impl Process for Curl {
    fn advance(&self, rest: &mut RestState, window: &Window<'_>) {
        let [before, after] = window.factors;
        for (value, change) in rest.curvature.iter_mut().zip(&self.change) {
            *value += (after - before) * change;
        }
    }
}

/// A sheet counts as flat if no vertex is further from its plane than this share of its size.
const FLAT: f64 = 1e-6;

/// The vertices of a flat sheet laid on a cylinder of this `radius` [m] along `axis` [m]; `None` if the sheet is not flat, or
/// the axis not in its plane. Lengths are kept; normals point out of the cylinder.
pub fn on_cylinder(rest: &Surface, radius: f64, axis: &Vec3) -> Option<Vec<Vec3>> {
    let (low, high) = rest.bounding_box();
    let center = (low + high) * 0.5;
    let size = (high - low).norm();
    let sum: Vec3 = (0..rest.mesh.num_faces())
        .map(|face| {
            let [a, b, c] = rest.corners(face);
            (b - a).cross(&(c - a))
        })
        .sum();
    let normal = sum.try_normalize(0.0)?;
    let axis = axis.try_normalize(0.0)?;
    let heights = (rest.positions.iter()).map(|x| (x - center).dot(&normal));
    let spread =
        heights.clone().fold(f64::NEG_INFINITY, f64::max) - heights.fold(f64::INFINITY, f64::min);
    if spread > FLAT * size || axis.dot(&normal).abs() > FLAT {
        return None;
    }
    let across = normal.cross(&axis);
    let laid = |x: &Vec3| {
        let arm = x - center;
        let (along, turned) = (arm.dot(&axis), arm.dot(&across) / radius);
        let (sin, cos) = turned.sin_cos();
        center + axis * along + across * (radius * sin) + normal * (radius * (cos - 1.0))
    };
    Some(rest.positions.iter().map(laid).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::generate::{GridDiagonals, grid};

    #[test]
    fn a_sheet_on_a_cylinder_keeps_lengths_along_and_around_it() {
        let rest = grid(0.2, 0.1, 20, 4, GridDiagonals::Uniform).unwrap();
        let laid = on_cylinder(&rest, 0.06, &Vec3::y()).unwrap();
        // The chord of an arc of one cell.
        let chord = 2.0 * 0.06 * (0.5 * 0.01 / 0.06f64).sin();
        assert!(((laid[1] - laid[0]).norm() - chord).abs() < 1e-15);
        assert!(((laid[21] - laid[0]).norm() - 0.025).abs() < 1e-15);
        for x in &laid {
            assert!((x.x.hypot(x.z + 0.06) - 0.06).abs() < 1e-15);
        }
        assert!(laid[0].z < laid[10].z, "normals, upwards, fan out");
    }

    #[test]
    fn a_folded_sheet_and_an_upright_axis_have_no_cylinder() {
        let mut rest = grid(0.2, 0.1, 4, 4, GridDiagonals::Uniform).unwrap();
        assert_eq!(on_cylinder(&rest, 0.06, &Vec3::z()), None);
        rest.positions[7].z = 1e-5;
        assert_eq!(on_cylinder(&rest, 0.06, &Vec3::y()), None);
    }
}
