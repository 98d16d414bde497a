//! A spherical cap whose rim is turned inwards: the shape of a popper toy.

use super::revolution::cap_rings;
use super::rings::{Ring, join_rings};
use super::{GeneratorError, build, check_between, check_face_count, face_count};
use crate::mesh::Surface;

/// [`spherical_cap`](super::spherical_cap) with a flat band of width `inset` [m] in the plane of its rim, from the rim
/// towards the axis.
///
/// The band has rings about as far apart as those of the cap. Its inner edge comes first, the pole or hole last.
///
/// # Errors
/// Those of the cap; an inset not between 0 and the radius of the rim; too many faces.
pub fn inset_cap(
    radius: f64,
    angle: f64,
    hole_angle: Option<f64>,
    inset: f64,
    rings: usize,
) -> Result<Surface, GeneratorError> {
    let cap = cap_rings(radius, angle, hole_angle, rings)?;
    let rim = &cap[0];
    check_between("width of the inset", inset, 0.0, rim.radius)?;
    let hole = hole_angle.unwrap_or(0.0);
    check_face_count(face_count::inset_cap(radius, angle, hole, inset, rings))?;
    let bands = face_count::inset_bands(radius, angle, hole, inset, rings) as usize;
    let ring = |k: usize| {
        let ring_radius = rim.radius - inset * k as f64 / bands as f64;
        Ring {
            radius: ring_radius,
            z: rim.z,
            count: ((rim.count as f64 * (ring_radius / rim.radius)).round() as usize).max(6),
        }
    };
    let band: Vec<Ring> = (1..=bands).rev().map(ring).collect();
    let (positions, faces) = join_rings(&band.into_iter().chain(cap).collect::<Vec<_>>());
    build(positions, faces)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;
    use crate::Vec3;
    use crate::mesh::generate::spherical_cap;

    #[test]
    fn the_inset_is_a_flat_band_inside_the_rim() {
        let [angle, hole] = [72.0, 8.0].map(f64::to_radians);
        let cap = inset_cap(0.1, angle, Some(hole), 0.012, 16).unwrap();
        assert_eq!(cap.mesh.euler_characteristic(), 0);
        let loops = cap.mesh.boundary_loops();
        assert_eq!(loops.len(), 2);
        let (rim, height) = (0.1 * angle.sin(), 0.1 * angle.cos());
        let inner = cap.positions[0];
        assert!((inner.x.hypot(inner.y) - (rim - 0.012)).abs() < 1e-15 && inner.z == height);
        let band = cap.positions.iter().filter(|x| x.z == height);
        assert!(band.count() > 2 * 30, "two rings of the band and the rim");
        assert!(cap.min_angle().to_degrees() > 20.0);
    }

    #[test]
    fn normals_point_out_of_what_the_cap_encloses() {
        let cap = inset_cap(1.0, 1.2, None, 0.1, 8).unwrap();
        let inside = Vec3::new(0.0, 0.0, 0.7);
        for face in 0..cap.mesh.num_faces() {
            let [a, b, c] = cap.corners(face);
            let normal = (b - a).cross(&(c - a));
            assert!(
                normal.dot(&((a + b + c) / 3.0 - inside)) > 0.0,
                "face {face}"
            );
        }
    }

    #[test]
    fn its_area_is_that_of_cap_and_band() {
        let cap_alone = spherical_cap(1.0, PI / 2.0, None, 40).unwrap().area();
        let with_band = inset_cap(1.0, PI / 2.0, None, 0.25, 40).unwrap().area();
        let band = TAU / 2.0 * (1.0 - 0.75f64.powi(2));
        // Polygons of some 160 sides lose 1/4000 of a circle.
        assert!((with_band - cap_alone - band).abs() < 1e-3 * band);
    }

    #[test]
    fn an_inset_wider_than_the_rim_is_refused_and_a_huge_one_in_fine_rings_too() {
        let error = inset_cap(1.0, 1.0, None, 0.9, 5).unwrap_err().to_string();
        assert!(error.contains("width of the inset"), "{error}");
        let error = inset_cap(1.0, 1.0, Some(1.0 - 1e-9), 0.5, 1).unwrap_err();
        assert!(error.to_string().contains("coarser"), "{error}");
    }
}
