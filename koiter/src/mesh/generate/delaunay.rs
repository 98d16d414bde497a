//! A rectangle refined to Delaunay triangles whose boundary is given.

use spade::{ConstrainedDelaunayTriangulation, Point2};

use super::irregular::{IRREGULAR_MIN_ANGLE_DEGREES, boundary_points, in_bands};
use super::refinement::Refinement;
use super::{GeneratorError, build, check_at_least, check_face_count, check_positive, face_count};
use crate::mesh::Surface;

/// A `width` × `depth` rectangle [m] in the plane z = 0, centred, with `nx` and `ny` equal segments on its sides and
/// Delaunay triangles of at most `max_area` [m²] inside; normals along +z.
///
/// Refinement adds no points on the boundary. A triangle beside it stays as it is where the point that would improve it
/// encroaches on a boundary segment: such triangles may have angles below [`IRREGULAR_MIN_ANGLE_DEGREES`], all others
/// not. The mean area is about 0.65 of `max_area`.
///
/// Reference: "Better Bending" (2026), section 8.2, which uses Shewchuk's Triangle (1996) with the switches `qDYa` for
/// this. The rules and their order are the same, so that meshes agree in their statistics; they do not in their points,
/// as the first triangles are met in another order.
///
/// # Errors
/// A size or area that is not positive, no segments, too many faces.
pub fn delaunay(
    width: f64,
    depth: f64,
    [nx, ny]: [usize; 2],
    max_area: f64,
) -> Result<Surface, GeneratorError> {
    check_positive("width of the rectangle", width)?;
    check_positive("depth of the rectangle", depth)?;
    check_positive("largest triangle area", max_area)?;
    check_at_least("number of segments along x", nx, 1)?;
    check_at_least("number of segments along y", ny, 1)?;
    let expected_faces = face_count::delaunay(width, depth, [nx, ny], max_area);
    check_face_count(expected_faces)?;

    let (points, segments) = boundary_points(width, depth, [nx, ny]);
    let triangulation = ConstrainedDelaunayTriangulation::<Point2<f64>>::bulk_load_cdt(
        points, segments,
    )
    .map_err(|_| {
        // Spade refuses coordinates whose products would under- or overflow.
        let (low, high) = (1e-40, 1e60);
        GeneratorError::OutOfRange {
            what: "size of the rectangle",
            value: width,
            low,
            high,
        }
    })?;
    let min_angle = IRREGULAR_MIN_ANGLE_DEGREES.to_radians();
    let mut refinement = Refinement::new(&triangulation, max_area, min_angle);
    // Far above what is needed, so that only a refinement that does not end meets it.
    let is_complete = refinement.run(10 * expected_faces as usize + 1000);
    let Refinement {
        points, triangles, ..
    } = refinement;
    let (positions, faces) = in_bands(
        points.into_iter(),
        triangles.into_iter(),
        (2.0 * max_area).sqrt(),
    );
    let surface = build(positions, faces)?;
    if is_complete {
        return Ok(surface);
    }
    Err(GeneratorError::Quality {
        min_angle_degrees: surface.min_angle().to_degrees(),
        wanted_degrees: IRREGULAR_MIN_ANGLE_DEGREES,
        faces: surface.mesh.num_faces(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::VertexId;

    #[test]
    fn the_boundary_has_the_given_segments_and_the_inside_good_triangles() {
        let (width, depth, area) = (2.0, 1.0, 1e-3);
        let sheet = delaunay(width, depth, [44, 22], area).unwrap();
        assert!((sheet.area() - width * depth).abs() < 1e-12);
        assert_eq!(sheet.mesh.boundary_loops()[0].len(), 2 * (44 + 22));
        let on_boundary = |v: &u32| sheet.mesh.is_boundary_vertex(VertexId(*v));
        for (f, face) in sheet.mesh.faces().iter().enumerate() {
            assert!(sheet.face_area(f) < 2.0 * area, "face {f}");
            if face.iter().any(on_boundary) {
                continue;
            }
            let x = sheet.corners(f);
            for c in 0..3 {
                let (a, b) = (x[(c + 1) % 3] - x[c], x[(c + 2) % 3] - x[c]);
                let degrees = a.angle(&b).to_degrees();
                assert!(degrees > 20.0 - 1e-6, "face {f}: {degrees}°");
            }
        }
        assert_eq!(sheet, delaunay(width, depth, [44, 22], area).unwrap());
    }

    #[test]
    fn a_mesh_scales_with_its_size() {
        // By a power of two, which does not round.
        let scale = 2f64.powi(-9);
        let large = delaunay(2.0, 1.0, [20, 10], 5e-3).unwrap();
        let small = delaunay(2.0 * scale, scale, [20, 10], 5e-3 * scale * scale).unwrap();
        assert_eq!(large.mesh.faces(), small.mesh.faces());
        for (x, y) in large.positions.iter().zip(&small.positions) {
            assert_eq!(x * scale, *y);
        }
    }

    #[test]
    fn areas_and_angles_are_distributed_as_in_triangle() {
        // Triangle 1.6, `pqDYa`, on the same boundary: mean area and percent of angles in 20° to 30°, …, 100° to 110°.
        // On this boundary, on its mirror image and at a quarter of the area its figures differ by up to 0.2 % and 0.3.
        let (mean_area, percent) = (
            0.6460,
            [0.49, 9.52, 20.93, 22.98, 21.18, 12.02, 7.57, 3.51, 1.50],
        );
        let (width, depth, area) = (2.0, 1.0, 4e-5_f64);
        let edge = (2.0 * area).sqrt();
        let counts = [(width / edge) as usize, (depth / edge) as usize];
        let sheet = delaunay(width, depth, counts, area).unwrap();
        let faces = sheet.mesh.num_faces();
        let mean = width * depth / faces as f64 / area;
        assert!((mean / mean_area - 1.0).abs() < 0.005, "{mean}");
        let mut found = [0.0; 18];
        for f in 0..faces {
            let x = sheet.corners(f);
            for c in 0..3 {
                let (a, b) = (x[(c + 1) % 3] - x[c], x[(c + 2) % 3] - x[c]);
                found[(a.angle(&b).to_degrees() / 10.0) as usize] += 100.0 / (3 * faces) as f64;
            }
        }
        for (found, wanted) in found[2..].iter().zip(percent) {
            assert!((found - wanted).abs() < 0.4, "{found} % for {wanted} %");
        }
    }

    #[test]
    fn impossible_rectangles_are_refused_with_the_value() {
        let message = |w, n, a| delaunay(w, 1.0, n, a).unwrap_err().to_string();
        assert!(message(-1.0, [1, 1], 1.0).contains("width"));
        assert!(message(1.0, [1, 0], 1.0).contains("segments along y"));
        assert!(message(1.0, [1, 1], f64::NAN).contains("NaN"));
        assert!(message(1.0, [1, 1], 1e-12).contains("coarser"));
    }
}
