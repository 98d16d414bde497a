//! A rectangle of right triangles.

use super::{GeneratorError, build, check_at_least, check_face_count, check_positive, face_count};
use crate::Vec3;
use crate::mesh::Surface;

/// Which way the diagonals of the grid cells run.
///
/// ```text
/// Uniform        Alternating     Checkerboard
/// +---+---+      +---+---+       +---+---+
/// | / | / |      | \ | \ |       | \ | / |
/// +---+---+      +---+---+       +---+---+
/// | / | / |      | / | / |       | / | \ |
/// +---+---+      +---+---+       +---+---+
/// ```
///
/// Uniform diagonals make a sheet that bends more easily across one diagonal than across the other; checkerboard
/// diagonals have no preferred direction on the scale of two cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum GridDiagonals {
    /// All run from low x, low y to high x, high y.
    Uniform,
    /// The direction changes from row to row (along y).
    Alternating,
    /// The direction changes from cell to cell in both directions.
    #[default]
    Checkerboard,
}

/// A `width` × `depth` rectangle [m] in the plane z = 0, centred at the origin, normals along +z.
///
/// `nx` × `ny` cells of two triangles. Vertices run along x first: vertex `j (nx + 1) + i` lies at
/// `(−width/2 + i width/nx, −depth/2 + j depth/ny, 0)`. Faces `2c` and `2c + 1` belong to cell `c = j nx + i`.
///
/// # Errors
/// A size that is not positive, no cells, too many faces.
pub fn grid(
    width: f64,
    depth: f64,
    nx: usize,
    ny: usize,
    diagonals: GridDiagonals,
) -> Result<Surface, GeneratorError> {
    check_positive("width of the grid", width)?;
    check_positive("depth of the grid", depth)?;
    check_at_least("number of cells along x", nx, 1)?;
    check_at_least("number of cells along y", ny, 1)?;
    check_face_count(face_count::cells(nx, ny))?;

    let mut positions = Vec::with_capacity((nx + 1) * (ny + 1));
    for j in 0..=ny {
        for i in 0..=nx {
            // Exactly ±width/2 at the ends and exactly symmetric about 0.
            let x = width * (2.0 * i as f64 - nx as f64) / (2.0 * nx as f64);
            let y = depth * (2.0 * j as f64 - ny as f64) / (2.0 * ny as f64);
            positions.push(Vec3::new(x, y, 0.0));
        }
    }
    let mut faces = Vec::with_capacity(2 * nx * ny);
    for j in 0..ny {
        for i in 0..nx {
            let row = (nx + 1) as u32;
            let a = j as u32 * row + i as u32;
            let (b, c, d) = (a + 1, a + row + 1, a + row);
            let rising = match diagonals {
                GridDiagonals::Uniform => true,
                GridDiagonals::Alternating => j % 2 == 0,
                GridDiagonals::Checkerboard => (i + j) % 2 == 0,
            };
            faces.extend(if rising {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, b, d], [b, c, d]]
            });
        }
    }
    build(positions, faces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::VertexId;

    const ALL: [GridDiagonals; 3] = [
        GridDiagonals::Uniform,
        GridDiagonals::Alternating,
        GridDiagonals::Checkerboard,
    ];

    #[test]
    fn grid_is_a_centred_disc_facing_up() {
        for diagonals in ALL {
            let sheet = grid(2.0, 1.0, 6, 5, diagonals).unwrap();
            assert_eq!(sheet.mesh.num_vertices(), 42);
            assert_eq!(sheet.mesh.num_faces(), 60);
            assert_eq!(sheet.mesh.euler_characteristic(), 1);
            assert!((sheet.area() - 2.0).abs() < 1e-14);
            assert_eq!(
                sheet.bounding_box(),
                (Vec3::new(-1.0, -0.5, 0.0), Vec3::new(1.0, 0.5, 0.0))
            );
            for f in 0..60 {
                let [a, b, c] = sheet.corners(f);
                assert!((b - a).cross(&(c - a)).z > 0.0);
            }
        }
    }

    #[test]
    fn diagonals_run_as_drawn() {
        let diagonal_of = |diagonals, cell: [u32; 2]| {
            let sheet = grid(1.0, 1.0, 2, 2, diagonals).unwrap();
            let a = cell[1] * 3 + cell[0];
            sheet.mesh.find_edge(VertexId(a), VertexId(a + 4)).is_some()
        };
        let rising =
            |diagonals| [[0, 0], [1, 0], [0, 1], [1, 1]].map(|cell| diagonal_of(diagonals, cell));
        assert_eq!(rising(GridDiagonals::Uniform), [true; 4]);
        assert_eq!(
            rising(GridDiagonals::Alternating),
            [true, true, false, false]
        );
        assert_eq!(
            rising(GridDiagonals::Checkerboard),
            [true, false, false, true]
        );
    }

    #[test]
    fn impossible_grids_are_refused_with_the_value() {
        let message = |w, d, nx, ny| {
            grid(w, d, nx, ny, GridDiagonals::Uniform)
                .unwrap_err()
                .to_string()
        };
        assert!(message(-1.0, 1.0, 1, 1).contains("width of the grid must be a positive"));
        assert!(message(1.0, f64::NAN, 1, 1).contains("NaN"));
        assert!(message(1.0, 1.0, 0, 1).contains("at least 1, but it is 0"));
        assert!(message(1.0, 1.0, usize::MAX, usize::MAX).contains("make it coarser"));
        assert!(message(1.0, 1e-9, 1, 1).contains("degenerate"));
    }
}
