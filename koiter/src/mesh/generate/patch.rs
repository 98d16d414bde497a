//! Four-sided patches of cylinders and spheres: a grid, bent.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::{GeneratorError, GridDiagonals, check_between, check_positive, grid};
use crate::Vec3;
use crate::mesh::Surface;

/// Part of a cylinder of `radius` [m] about the y axis, from y = 0 to `length` [m], between two `angles` [rad] from the
/// top (+z) towards +x; normals outward.
///
/// `cells` around and along. Numbered like [`grid`]: around first.
///
/// # Errors
/// A size that is not positive, angles that do not increase or span more than a turn, no cells, too many faces.
pub fn cylinder_panel(
    radius: f64,
    length: f64,
    angles: [f64; 2],
    cells: [usize; 2],
    diagonals: GridDiagonals,
) -> Result<Surface, GeneratorError> {
    check_positive("radius of the panel", radius)?;
    check_positive("length of the panel", length)?;
    let span = angles[1] - angles[0];
    check_between("angle of the panel in radians", span, 0.0, TAU)?;
    bent(cells, diagonals, |s, t| {
        let (sin, cos) = (angles[0] + s * span).sin_cos();
        Vec3::new(radius * sin, t * length, radius * cos)
    })
}

/// Part of a sphere of `radius` [m] about the origin, between two `longitudes` [rad] from +x towards +y and two
/// `latitudes` [rad] from the equator towards +z; normals outward.
///
/// `cells` around and up. Numbered like [`grid`]: around first.
///
/// # Errors
/// A size that is not positive, angles that do not increase, span more than a turn or reach a pole, no cells, too many
/// faces.
pub fn sphere_zone(
    radius: f64,
    longitudes: [f64; 2],
    latitudes: [f64; 2],
    cells: [usize; 2],
    diagonals: GridDiagonals,
) -> Result<Surface, GeneratorError> {
    check_positive("radius of the zone", radius)?;
    let (around, up) = (longitudes[1] - longitudes[0], latitudes[1] - latitudes[0]);
    check_between("longitudes of the zone in radians", around, 0.0, TAU)?;
    check_between("height of the zone in radians", up, 0.0, PI)?;
    for latitude in latitudes {
        check_between(
            "latitude of the zone in radians",
            latitude,
            -FRAC_PI_2,
            FRAC_PI_2,
        )?;
    }
    bent(cells, diagonals, |s, t| {
        let (east, north) = (
            (longitudes[0] + s * around).sin_cos(),
            (latitudes[0] + t * up).sin_cos(),
        );
        Vec3::new(
            radius * north.1 * east.1,
            radius * north.1 * east.0,
            radius * north.0,
        )
    })
}

/// A grid on the unit square, moved to `place(s, t)`.
fn bent(
    [along_s, along_t]: [usize; 2],
    diagonals: GridDiagonals,
    place: impl Fn(f64, f64) -> Vec3,
) -> Result<Surface, GeneratorError> {
    let flat = grid(1.0, 1.0, along_s, along_t, diagonals)?;
    let positions = flat
        .positions
        .iter()
        .map(|x| place(x.x + 0.5, x.y + 0.5))
        .collect();
    Ok(Surface::from_mesh(flat.mesh, positions)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_lie_where_they_should_and_face_outwards() {
        let roof = cylinder_panel(2.0, 3.0, [0.0, 0.5], [8, 6], GridDiagonals::Uniform).unwrap();
        assert!(
            roof.positions
                .iter()
                .all(|x| (x.x.hypot(x.z) - 2.0).abs() < 1e-15)
        );
        assert!((roof.positions[0] - Vec3::new(0.0, 0.0, 2.0)).norm() < 1e-15);
        let zone =
            sphere_zone(3.0, [0.0, 1.0], [0.0, 1.2], [8, 6], GridDiagonals::Uniform).unwrap();
        assert!(
            zone.positions
                .iter()
                .all(|x| (x.norm() - 3.0).abs() < 1e-14)
        );
        assert!((zone.positions[0] - Vec3::new(3.0, 0.0, 0.0)).norm() < 1e-15);
        // Areas fall short of R α L and R² Δλ Δ(sin φ) by the sagitta of the cells, less than a hundredth.
        for (surface, area) in [(&roof, 3.0), (&zone, 9.0 * 1.2f64.sin())] {
            assert!(
                (0.99..1.0).contains(&(surface.area() / area)),
                "{}",
                surface.area()
            );
        }
        for (surface, center) in [(roof, Vec3::new(0.0, 1.5, 0.0)), (zone, Vec3::zeros())] {
            for face in 0..surface.mesh.num_faces() {
                let [a, b, c] = surface.corners(face);
                assert!((b - a).cross(&(c - a)).dot(&(a - center)) > 0.0);
            }
        }
    }

    #[test]
    fn angles_that_make_no_patch_are_refused() {
        let message = |latitudes| {
            let zone = sphere_zone(1.0, [0.0, 1.0], latitudes, [4, 4], GridDiagonals::Uniform);
            zone.unwrap_err().to_string()
        };
        assert!(message([0.5, 0.2]).contains("height of the zone"));
        assert!(message([0.0, 2.0]).contains("latitude of the zone"));
    }
}
