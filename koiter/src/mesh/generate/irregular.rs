//! An irregular Delaunay mesh of a rectangle: no direction is preferred, as no grid can offer.

use spade::{
    AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation,
};

use super::split_mix::SplitMix64;
use super::{GeneratorError, build, check_face_count, check_positive, face_count};
use crate::Vec3;
use crate::mesh::Surface;

/// Smallest angle of [`irregular`] meshes [°]: what Ruppert's refinement guarantees (it is proven up to 20.7°).
pub const IRREGULAR_MIN_ANGLE_DEGREES: f64 = 20.0;

/// A `width` × `depth` rectangle [m] in the plane z = 0, centred, of irregular triangles no larger than `max_area`
/// [m²] and with no angle below [`IRREGULAR_MIN_ANGLE_DEGREES`]; normals along +z.
///
/// The boundary is split into equal segments of about `√(2 max_area)`, the legs of a right triangle of that area.
/// Random points, about one for every eight triangles, are scattered inside (from a square alone, refinement would
/// produce a symmetric pattern); Ruppert's Delaunay refinement does the rest. The same `seed` gives the same mesh.
/// The mean area is about 0.65 of `max_area`.
///
/// Reference: "Better Bending" (2026), section 8.2, whose irregular meshes have boundary segments and target areas in
/// this relation; there refinement adds no points on the boundary, here it may where the angle needs it.
///
/// # Errors
/// A size or area that is not positive, too many faces, a refinement that missed the angle.
pub fn irregular(
    width: f64,
    depth: f64,
    max_area: f64,
    seed: u64,
) -> Result<Surface, GeneratorError> {
    check_positive("width of the rectangle", width)?;
    check_positive("depth of the rectangle", depth)?;
    check_positive("largest triangle area", max_area)?;
    let spacing = (2.0 * max_area).sqrt();
    let expected_faces = face_count::irregular(width, depth, max_area);
    check_face_count(expected_faces)?;

    let segments_along = |length: f64| (length / spacing).round().max(1.0) as usize;
    let counts = [segments_along(width), segments_along(depth)];
    let (mut points, segments) = boundary_points(width, depth, counts);
    scatter_inside(width, depth, spacing, seed, &mut points);
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
            // Far above what is needed, so that only a refinement that does not end meets it.
            .with_max_additional_vertices(10 * expected_faces as usize + 1000),
    );

    let points = triangulation.vertices().map(|v| v.position().into());
    // Spade's faces are counter-clockwise.
    let faces = triangulation.inner_faces();
    let faces = faces.map(|f| f.vertices().map(|v| v.fix().index() as u32));
    let (positions, faces) = in_bands(points, faces, spacing);
    let surface = build(positions, faces)?;
    let min_angle_degrees = surface.min_angle().to_degrees();
    // The refinement compares radius and edge, this an angle: allow for round-off.
    if !result.refinement_complete || min_angle_degrees < IRREGULAR_MIN_ANGLE_DEGREES - 1e-6 {
        return Err(GeneratorError::Quality {
            min_angle_degrees,
            wanted_degrees: IRREGULAR_MIN_ANGLE_DEGREES,
            faces: surface.mesh.num_faces(),
        });
    }
    Ok(surface)
}

/// Points that split the sides along x and y into so many equal segments, counter-clockwise, and these segments.
pub(super) fn boundary_points(
    width: f64,
    depth: f64,
    counts: [usize; 2],
) -> (Vec<Point2<f64>>, Vec<[usize; 2]>) {
    let (x, y) = (width / 2.0, depth / 2.0);
    let corners = [[-x, -y], [x, -y], [x, y], [-x, y]];
    let mut points = Vec::new();
    for side in 0..4 {
        let ([x0, y0], [x1, y1]) = (corners[side], corners[(side + 1) % 4]);
        let count = counts[side % 2];
        for i in 0..count {
            let t = i as f64 / count as f64;
            // Exact on axis-parallel sides: the coordinate that does not change is not computed.
            let along = |from: f64, to: f64| {
                if from == to {
                    from
                } else {
                    from + t * (to - from)
                }
            };
            points.push(Point2::new(along(x0, x1), along(y0, y1)));
        }
    }
    let count = points.len();
    (points, (0..count).map(|i| [i, (i + 1) % count]).collect())
}

/// Random points no closer than `spacing` to each other and to the boundary.
fn scatter_inside(width: f64, depth: f64, spacing: f64, seed: u64, points: &mut Vec<Point2<f64>>) {
    let (inner_width, inner_depth) = (width - 2.0 * spacing, depth - 2.0 * spacing);
    if inner_width <= 0.0 || inner_depth <= 0.0 {
        return;
    }
    // One trial for every 8 triangles of area spacing²/2; the cells hold at most one point.
    let trials = (width * depth / (4.0 * spacing * spacing)).ceil() as usize;
    let cell = spacing / std::f64::consts::SQRT_2;
    let (columns, rows) = (
        (inner_width / cell) as usize + 1,
        (inner_depth / cell) as usize + 1,
    );
    let mut occupied: Vec<Option<Point2<f64>>> = vec![None; columns * rows];
    let mut random = SplitMix64(seed);
    for _ in 0..trials {
        let (u, v) = (random.unit() * inner_width, random.unit() * inner_depth);
        let (column, row) = ((u / cell) as usize, (v / cell) as usize);
        let point = Point2::new(u - inner_width / 2.0, v - inner_depth / 2.0);
        let mut is_free = true;
        for r in row.saturating_sub(2)..=(row + 2).min(rows - 1) {
            for c in column.saturating_sub(2)..=(column + 2).min(columns - 1) {
                if let Some(other) = occupied[r * columns + c] {
                    is_free &= (other.x - point.x).hypot(other.y - point.y) >= spacing;
                }
            }
        }
        if is_free {
            occupied[row * columns + column] = Some(point);
            points.push(point);
        }
    }
}

/// Vertices and counter-clockwise faces ordered in bands along x, so that neighbours in space are near in memory.
pub(super) fn in_bands(
    points: impl Iterator<Item = [f64; 2]>,
    faces: impl Iterator<Item = [u32; 3]>,
    band: f64,
) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut order: Vec<(i64, f64, f64, usize)> = points
        .enumerate()
        .map(|(index, [x, y])| ((y / band).floor() as i64, x, y, index))
        .collect();
    order.sort_by(|a, b| {
        a.0.cmp(&b.0)
            .then(a.1.total_cmp(&b.1))
            .then(a.2.total_cmp(&b.2))
    });
    let mut new_index = vec![0u32; order.len()];
    let mut positions = Vec::with_capacity(order.len());
    for (new, &(_, x, y, old)) in order.iter().enumerate() {
        new_index[old] = new as u32;
        positions.push(Vec3::new(x, y, 0.0));
    }
    let mut faces: Vec<[u32; 3]> = faces
        .map(|face| {
            // Start at the smallest index.
            let [a, b, c] = face.map(|vertex| new_index[vertex as usize]);
            if a < b && a < c {
                [a, b, c]
            } else if b < c {
                [b, c, a]
            } else {
                [c, a, b]
            }
        })
        .collect();
    faces.sort_unstable();
    (positions, faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_good_small_and_cover_the_rectangle() {
        for (width, depth, max_area) in [
            (1.0, 1.0, 1e-3),
            (3.0, 0.2, 1e-3),
            (1e-3, 2e-3, 1e-9),
            (1.0, 1.0, 10.0),
            (1.0, 0.01, 0.1),
        ] {
            let sheet = irregular(width, depth, max_area, 1).unwrap();
            let area = width * depth;
            assert_eq!(sheet.mesh.euler_characteristic(), 1);
            assert!((sheet.area() - area).abs() < 1e-12 * area);
            assert!(sheet.min_angle().to_degrees() > 20.0 - 1e-6);
            let largest = (0..sheet.mesh.num_faces())
                .map(|f| sheet.face_area(f))
                .fold(0.0, f64::max);
            assert!(largest <= max_area * (1.0 + 1e-12));
            assert!((0..sheet.mesh.num_faces()).all(|f| {
                let [a, b, c] = sheet.corners(f);
                (b - a).cross(&(c - a)).z > 0.0
            }));
            let (low, high) = sheet.bounding_box();
            assert_eq!(
                (low.x, high.x, low.y, high.y),
                (-width / 2.0, width / 2.0, -depth / 2.0, depth / 2.0)
            );
        }
    }

    #[test]
    fn mean_area_is_as_documented() {
        let sheet = irregular(1.0, 1.0, 2e-4, 7).unwrap();
        let mean = 1.0 / sheet.mesh.num_faces() as f64;
        assert!((0.5..0.7).contains(&(mean / 2e-4)), "{}", mean / 2e-4);
    }

    #[test]
    fn same_seed_gives_the_same_mesh_and_another_seed_another() {
        let [a, b, c] = [3, 3, 4].map(|seed| irregular(1.0, 1.0, 2e-3, seed).unwrap());
        assert_eq!(a, b);
        assert_ne!(a.positions, c.positions);
    }

    #[test]
    fn edges_prefer_no_direction() {
        let sheet = irregular(1.0, 1.0, 2e-4, 5).unwrap();
        // Edge directions in four bins of 45° about 0°, 45°, 90°, 135°, a quarter each up to chance (σ ≈ 0.5 %) and
        // the boundary (2 %); in a uniform grid the bins hold 1/3, 1/3, 1/3, 0.
        let mut bins = [0.0f64; 4];
        for &[u, v] in sheet.mesh.edges() {
            let d = sheet.positions[v as usize] - sheet.positions[u as usize];
            let turns =
                d.y.atan2(d.x).rem_euclid(std::f64::consts::PI) / std::f64::consts::FRAC_PI_4;
            bins[turns.round() as usize % 4] += 1.0 / sheet.mesh.num_edges() as f64;
        }
        assert!(
            bins.iter().all(|share| (share - 0.25).abs() < 0.03),
            "{bins:?}"
        );
    }

    #[test]
    fn large_meshes_take_seconds() {
        let start = std::time::Instant::now();
        let sheet = irregular(1.0, 1.0, 1.0 / 105_000.0, 1).unwrap();
        assert!(
            sheet.mesh.num_faces() > 150_000,
            "{}",
            sheet.mesh.num_faces()
        );
        // About 1 s on a laptop; the margin is for busy machines, the test for a quadratic method (hours).
        assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
    }

    #[test]
    fn impossible_rectangles_are_refused_with_the_value() {
        let message = |w, d, a| irregular(w, d, a, 0).unwrap_err().to_string();
        assert!(message(0.0, 1.0, 1.0).contains("width"));
        assert!(message(1.0, 1.0, -1.0).contains("largest triangle area"));
        assert!(message(1.0, 1.0, 1e-12).contains("coarser"));
        assert!(message(1e70, 1e70, 1e140).contains("size of the rectangle"));
    }
}
