//! A tube whose radius goes in waves along its axis: a hose.

use std::f64::consts::TAU;

use super::rings::{Ring, join_rings};
use super::{
    GeneratorError, build, check_at_least, check_between, check_face_count, check_positive,
    face_count,
};
use crate::mesh::Surface;

/// Cells that a wave needs at least: with two, all rings could lie where it crosses the mean.
const CELLS_BY_WAVE: usize = 4;

/// The waves of a [`corrugated_tube`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corrugation {
    /// Whole waves on the length of the tube.
    pub waves: usize,
    /// From trough to crest [m].
    pub depth: f64,
}

/// [`cylinder`](super::cylinder) with the radius `r(t) = radius − ½ depth cos(2π waves t)`, t from 0 to 1 along the axis: it
/// begins and ends in a trough, and `radius` is the mean.
///
/// # Errors
/// Those of the cylinder; no waves, a depth not between 0 and twice the radius, fewer than four cells a wave.
pub fn corrugated_tube(
    radius: f64,
    height: f64,
    corrugation: Corrugation,
    around: usize,
    along: usize,
) -> Result<Surface, GeneratorError> {
    let Corrugation { waves, depth } = corrugation;
    check_positive("radius of the tube", radius)?;
    check_positive("height of the tube", height)?;
    check_between("depth of the waves", depth, 0.0, 2.0 * radius)?;
    check_at_least("number of waves", waves, 1)?;
    check_at_least("number of cells around", around, 3)?;
    let least = CELLS_BY_WAVE.saturating_mul(waves);
    check_at_least("number of cells along the axis", along, least)?;
    check_face_count(face_count::cells(around, along))?;
    let ring = |k: usize| {
        let t = k as f64 / along as f64;
        Ring {
            radius: radius - 0.5 * depth * (TAU * waves as f64 * t).cos(),
            z: height * (t - 0.5),
            count: around,
        }
    };
    let (positions, faces) = join_rings(&(0..=along).map(ring).collect::<Vec<_>>());
    build(positions, faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WAVES: Corrugation = Corrugation {
        waves: 3,
        depth: 0.1,
    };

    #[test]
    fn the_radius_goes_from_trough_to_crest_and_back_about_its_mean() {
        let tube = corrugated_tube(0.5, 3.0, WAVES, 12, 24).unwrap();
        assert_eq!(tube.mesh.num_faces(), 2 * 12 * 24);
        assert_eq!(tube.mesh.boundary_loops().len(), 2);
        let radius = |ring: usize| {
            let x = tube.positions[12 * ring];
            x.x.hypot(x.y)
        };
        let expected = [(0, 0.45), (2, 0.5), (4, 0.55), (8, 0.45), (24, 0.45)];
        for (ring, r) in expected {
            assert!((radius(ring) - r).abs() < 1e-14, "ring {ring}");
        }
        let (low, high) = tube.bounding_box();
        assert_eq!((low.z, high.z), (-1.5, 1.5));
    }

    #[test]
    fn its_area_is_that_of_the_wave_turned_round_the_axis() {
        let n = 20_000;
        let exact: f64 = (0..n)
            .map(|i| {
                let phase = TAU * 3.0 * (f64::from(i) + 0.5) / f64::from(n);
                let slope = 0.05 * TAU * 3.0 / 3.0 * phase.sin();
                TAU * (0.5 - 0.05 * phase.cos()) * slope.hypot(1.0) * 3.0 / f64::from(n)
            })
            .sum();
        let error = |n| exact - corrugated_tube(0.5, 3.0, WAVES, n, 4 * n).unwrap().area();
        // Chords lose area in the second order.
        let (coarse, fine) = (error(24), error(48));
        assert!(
            fine > 0.0 && (3.6..4.4).contains(&(coarse / fine)),
            "{coarse} {fine}"
        );
    }

    #[test]
    fn waves_deeper_than_the_tube_or_finer_than_its_cells_are_refused() {
        let message = |corrugation, along| {
            let made = corrugated_tube(0.5, 3.0, corrugation, 12, along);
            made.unwrap_err().to_string()
        };
        let deep = Corrugation {
            depth: 1.0,
            ..WAVES
        };
        assert!(message(deep, 24).contains("depth of the waves"));
        assert!(message(WAVES, 11).contains("at least 12, but it is 11"));
        let none = Corrugation { waves: 0, ..WAVES };
        assert!(message(none, 24).contains("number of waves"));
        let many = Corrugation {
            waves: usize::MAX,
            ..WAVES
        };
        assert!(message(many, 24).contains("cells along"));
    }
}
