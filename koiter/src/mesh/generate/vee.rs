//! A sheet folded along its middle line.

use super::{GeneratorError, GridDiagonals, build, check_at_least, check_between, grid};
use crate::Vec3;
use crate::mesh::Surface;

/// Two rectangles of `length` × `width` [m] that meet in a crease on the x axis at the dihedral `angle` [rad]; it opens
/// upwards, symmetrically about y = 0.
///
/// `along` cells in the crease's direction, `across` on each side, of two triangles whose diagonals change from cell to
/// cell. Vertex `j (along + 1) + i` is number i of row j, counted along x and from low to high y; row `across` is the
/// crease.
///
/// # Errors
/// A size that is not positive, no cells, an angle outside (0, π), too many faces.
pub fn vee(
    length: f64,
    width: f64,
    angle: f64,
    along: usize,
    across: usize,
) -> Result<Surface, GeneratorError> {
    check_at_least("number of cells across each side", across, 1)?;
    check_between("angle of the vee [rad]", angle, 0.0, std::f64::consts::PI)?;
    let rows = across.saturating_mul(2);
    let flat = grid(
        length,
        2.0 * width,
        along,
        rows,
        GridDiagonals::Checkerboard,
    )?;
    let (sin, cos) = (0.5 * angle).sin_cos();
    let fold = |x: &Vec3| Vec3::new(x.x, x.y * sin, x.y.abs() * cos);
    build(
        flat.positions.iter().map(fold).collect(),
        flat.mesh.faces().to_vec(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_plane_sides_meet_at_the_angle_in_a_straight_crease() {
        let angle: f64 = 1.1;
        let sheet = vee(0.3, 0.02, angle, 6, 2).unwrap();
        assert_eq!(
            (sheet.mesh.num_vertices(), sheet.mesh.num_faces()),
            (35, 48)
        );
        assert!((sheet.area() - 2.0 * 0.3 * 0.02).abs() < 1e-16);
        let (low, high) = sheet.bounding_box();
        let (half, rise) = (0.02 * (angle / 2.0).sin(), 0.02 * (angle / 2.0).cos());
        assert!((low - Vec3::new(-0.15, -half, 0.0)).norm() < 1e-16, "{low}");
        assert!(
            (high - Vec3::new(0.15, half, rise)).norm() < 1e-16,
            "{high}"
        );
        // Every triangle lies in one side, whose normal leans towards the other one by half the turn, (π − angle)/2.
        for f in 0..sheet.mesh.num_faces() {
            let [a, b, c] = sheet.corners(f);
            let normal = (b - a).cross(&(c - a)).normalize();
            let side = -(a + b + c).y.signum();
            let expected = Vec3::new(0.0, side * (angle / 2.0).cos(), (angle / 2.0).sin());
            assert!((normal - expected).norm() < 1e-14, "face {f}: {normal}");
        }
        assert!((14..21).all(|v| sheet.positions[v].yz().norm() == 0.0));
    }

    #[test]
    fn impossible_vees_are_refused_with_the_value() {
        let message =
            |width, angle, across| vee(1.0, width, angle, 1, across).unwrap_err().to_string();
        assert!(message(1.0, 1.0, 0).contains("across each side must be at least 1"));
        assert!(message(1.0, 4.0, 1).contains("angle of the vee"));
        assert!(message(1.0, f64::NAN, 1).contains("NaN"));
        assert!(message(-1.0, 1.0, 1).contains("must be a positive"));
        assert!(message(1.0, 1.0, usize::MAX).contains("make it coarser"));
    }
}
