//! A hat: a crown closed at its top, and a brim around it.

use std::f64::consts::FRAC_PI_2;

use super::rings::{Ring, join_rings};
use super::{
    GeneratorError, build, check_at_least, check_between, check_face_count, check_positive,
    face_count,
};
use crate::mesh::Surface;

/// Between an ellipse, which is pointed for a crown, and a rectangle, which has a sharp edge: Piet Hein's superellipse.
const EXPONENT: f64 = 2.5;

/// Pieces of the profile of which its length is summed: chords are short by 1e-8 of it.
const PIECES: usize = 4096;

/// The sizes of a [`hat`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HatSize {
    /// Radius of the crown at its foot [m].
    pub radius: f64,
    /// Height of the crown above its foot [m].
    pub height: f64,
    /// Width of the brim across, seen from above [m].
    pub brim: f64,
    /// By how much the brim falls outwards, over its width.
    pub slope: f64,
}

/// A hat along z that stands on the rim of its brim at z = 0, normals outward.
///
/// The crown is the surface of revolution of `(r / radius)^2.5 + (z / height)^2.5 = 1`. `around` vertices on each of `rings`
/// rings, in equal distances along the brim and along the crown, the foot of the crown one of them. The rim comes first,
/// the top of the crown is the last vertex.
///
/// # Errors
/// A size that is not positive, a slope not between 0 and 1, fewer than 3 cells around or 2 rings, too many faces.
pub fn hat(size: HatSize, around: usize, rings: usize) -> Result<Surface, GeneratorError> {
    check_positive("radius of the crown", size.radius)?;
    check_positive("height of the crown", size.height)?;
    check_positive("width of the brim", size.brim)?;
    // Written so that a level brim is allowed.
    if size.slope != 0.0 {
        check_between("slope of the brim", size.slope, 0.0, 1.0)?;
    }
    check_at_least("number of cells around", around, 3)?;
    check_at_least("number of rings", rings, 2)?;
    check_face_count(face_count::hat(around, rings))?;
    let drop = size.slope * size.brim;
    let (lengths, points) = crown(&size);
    let length = lengths[PIECES];
    let brim_length = size.brim.hypot(drop);
    let share = brim_length / (brim_length + length);
    let on_brim = ((rings as f64 * share).round() as usize).clamp(1, rings - 1);
    let ring = |k: usize| {
        let (radius, z) = if k < on_brim {
            let t = k as f64 / on_brim as f64;
            (size.radius + size.brim * (1.0 - t), drop * t)
        } else {
            let t = (k - on_brim) as f64 / (rings - on_brim) as f64;
            let [radius, z] = at_length(&lengths, &points, t * length);
            (radius, drop + z)
        };
        let is_top = k == rings;
        Ring {
            radius: if is_top { 0.0 } else { radius },
            z,
            count: if is_top { 1 } else { around },
        }
    };
    let (positions, faces) = join_rings(&(0..=rings).map(ring).collect::<Vec<_>>());
    build(positions, faces)
}

/// Points of the profile of the crown from its foot to its top, radius and height [m], and the lengths up to them [m].
fn crown(size: &HatSize) -> (Vec<f64>, Vec<[f64; 2]>) {
    let power = 2.0 / EXPONENT;
    let point = |k: usize| {
        let (sin, cos) = (FRAC_PI_2 * k as f64 / PIECES as f64).sin_cos();
        [
            size.radius * cos.max(0.0).powf(power),
            size.height * sin.powf(power),
        ]
    };
    let points: Vec<[f64; 2]> = (0..=PIECES).map(point).collect();
    let mut lengths = vec![0.0];
    for pair in points.windows(2) {
        let step = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
        lengths.push(lengths[lengths.len() - 1] + step);
    }
    (lengths, points)
}

/// The point of a polygon at a length along it.
fn at_length(lengths: &[f64], points: &[[f64; 2]], length: f64) -> [f64; 2] {
    let last = points.len() - 1;
    let next = lengths.partition_point(|&l| l <= length).clamp(1, last);
    let (low, high) = (lengths[next - 1], lengths[next]);
    let share = (length - low) / (high - low);
    [0, 1].map(|i| points[next - 1][i] + share * (points[next][i] - points[next - 1][i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;

    const FELT: HatSize = HatSize {
        radius: 0.09,
        height: 0.11,
        brim: 0.06,
        slope: 0.1,
    };

    #[test]
    fn a_hat_stands_on_its_rim_and_is_closed_above() {
        let surface = hat(FELT, 36, 16).unwrap();
        let (vertices, faces) = (surface.mesh.num_vertices(), surface.mesh.num_faces());
        assert_eq!((vertices, faces), (577, 1116));
        assert_eq!(surface.mesh.boundary_loops().len(), 1);
        assert_eq!(surface.mesh.euler_characteristic(), 1);
        let (low, high) = surface.bounding_box();
        assert!((low - Vec3::new(-0.15, -0.15, 0.0)).norm() < 1e-15, "{low}");
        assert!((high.z - 0.116).abs() < 1e-15, "{high}");
        let radius = |v: usize| surface.positions[v].xy().norm();
        // Four rings of the brim, and then the foot of the crown.
        assert!((radius(0) - 0.15).abs() < 1e-15 && (radius(4 * 36) - 0.09).abs() < 1e-15);
        assert!((surface.positions[4 * 36].z - 0.006).abs() < 1e-15);
        for face in 0..faces {
            let [a, b, c] = surface.corners(face);
            let normal = (b - a).cross(&(c - a));
            let inside = Vec3::new(0.0, 0.0, -0.05);
            assert!(
                normal.dot(&((a + b + c) / 3.0 - inside)) > 0.0,
                "face {face}"
            );
        }
    }

    #[test]
    fn rings_of_the_crown_lie_on_its_profile_in_equal_distances() {
        let surface = hat(FELT, 24, 40).unwrap();
        let ring = |k: usize| match k {
            40 => Vec3::new(0.0, 0.0, 0.116),
            _ => surface.positions[24 * k],
        };
        let on_brim = (0..40).filter(|&k| ring(k).z < 0.006 - 1e-12).count();
        let steps: Vec<f64> = (on_brim..40)
            .map(|k| (ring(k + 1) - ring(k)).norm())
            .collect();
        for k in on_brim..=40 {
            let [r, z] = [ring(k).x / 0.09, (ring(k).z - 0.006) / 0.11];
            // Between points of the profile its chord stands for it.
            assert!(
                (r.powf(2.5) + z.max(0.0).powf(2.5) - 1.0).abs() < 1e-5,
                "{k}"
            );
        }
        for step in &steps {
            // Chords of arcs that turn by a tenth of a radian.
            assert!((step / steps[0] - 1.0).abs() < 5e-3, "{steps:?}");
        }
    }

    #[test]
    fn impossible_hats_are_refused_with_the_value() {
        let message = |size, around, rings| hat(size, around, rings).unwrap_err().to_string();
        let steep = HatSize { slope: 1.5, ..FELT };
        assert!(message(steep, 36, 16).contains("slope of the brim"));
        let bare = HatSize { brim: 0.0, ..FELT };
        assert!(message(bare, 36, 16).contains("width of the brim"));
        assert!(message(FELT, 2, 16).contains("cells around"));
        assert!(message(FELT, 36, 1).contains("number of rings"));
        assert!(message(FELT, usize::MAX, 2).contains("coarser"));
        let level = HatSize { slope: 0.0, ..FELT };
        assert!(hat(level, 36, 16).is_ok());
    }
}
