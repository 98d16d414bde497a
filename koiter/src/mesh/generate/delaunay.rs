//! A rectangle refined to Delaunay triangles whose boundary is given.

use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters};

use super::irregular::{IRREGULAR_MIN_ANGLE_DEGREES, boundary_points, in_bands};
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
/// this: the same rules in another order, so that meshes agree in their statistics and not in their points.
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
    let mut triangulation = ConstrainedDelaunayTriangulation::<Point2<f64>>::bulk_load_cdt(
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
    let result = triangulation.refine(
        RefinementParameters::new()
            .with_angle_limit(AngleLimit::from_deg(IRREGULAR_MIN_ANGLE_DEGREES))
            .with_max_allowed_area(max_area)
            .keep_constraint_edges()
            // Far above what is needed, so that only a refinement that does not end meets it.
            .with_max_additional_vertices(10 * expected_faces as usize + 1000),
    );
    let (positions, faces) = in_bands(&triangulation, (2.0 * max_area).sqrt());
    let surface = build(positions, faces)?;
    if result.refinement_complete {
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
        let mean = width * depth / sheet.mesh.num_faces() as f64 / area;
        assert!((0.6..0.7).contains(&mean), "{mean}");
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
