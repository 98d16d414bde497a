//! Whether a segment and a triangle share a point, decided exactly.
//!
//! Signs of volumes and areas come from adaptive-precision arithmetic (crate `robust`) and are right for every input, so
//! the answer is too: segment and triangle are closed, may have no length or no area, and may lie in one plane.

use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::Vec3;

/// Whether the closed segment `p q` and the closed triangle `a b c` share a point.
pub fn segment_meets_triangle(p: &Vec3, q: &Vec3, [a, b, c]: [&Vec3; 3]) -> bool {
    let (above, below) = (volume(a, b, c, p), volume(a, b, c, q));
    if (above > 0.0 && below > 0.0) || (above < 0.0 && below < 0.0) {
        return false;
    }
    if above == 0.0 && below == 0.0 {
        return meets_in_plane(p, q, [a, b, c]);
    }
    let around = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    around.iter().all(|s| *s >= 0.0) || around.iter().all(|s| *s <= 0.0)
}

/// Sign of the volume of the tetrahedron `a b c d`.
fn volume(a: &Vec3, b: &Vec3, c: &Vec3, d: &Vec3) -> f64 {
    let coord = |p: &Vec3| Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    };
    orient3d(coord(a), coord(b), coord(c), coord(d))
}

/// The coordinate planes; points are projected by leaving one coordinate out, which rounds nothing.
const PLANES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// Sign of the area of the triangle `a b c`, projected.
fn area([i, j]: [usize; 2], a: &Vec3, b: &Vec3, c: &Vec3) -> f64 {
    let coord = |p: &Vec3| Coord { x: p[i], y: p[j] };
    orient2d(coord(a), coord(b), coord(c))
}

/// The segment crosses an edge of the triangle, or lies inside it.
fn meets_in_plane(p: &Vec3, q: &Vec3, corners: [&Vec3; 3]) -> bool {
    let meets_edge = |k: usize| segments_meet(p, q, corners[k], corners[(k + 1) % 3]);
    if (0..3).any(meets_edge) {
        return true;
    }
    let [a, b, c] = corners;
    // A triangle without area is its edges.
    let Some(&plane) = PLANES.iter().find(|plane| area(**plane, a, b, c) != 0.0) else {
        return false;
    };
    let sides = [
        area(plane, a, b, p),
        area(plane, b, c, p),
        area(plane, c, a, p),
    ];
    sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
}

/// Whether two closed segments in space share a point: if they lie in one plane, they do so exactly where all three
/// projections do, for one of them is one-to-one on that plane.
fn segments_meet(p: &Vec3, q: &Vec3, a: &Vec3, b: &Vec3) -> bool {
    volume(p, q, a, b) == 0.0
        && PLANES
            .iter()
            .all(|&plane| projections_meet(plane, p, q, a, b))
}

fn projections_meet(plane: [usize; 2], p: &Vec3, q: &Vec3, a: &Vec3, b: &Vec3) -> bool {
    let apart =
        |first: f64, second: f64| (first > 0.0 && second > 0.0) || (first < 0.0 && second < 0.0);
    let of_pq = [area(plane, p, q, a), area(plane, p, q, b)];
    let of_ab = [area(plane, a, b, p), area(plane, a, b, q)];
    if apart(of_pq[0], of_pq[1]) || apart(of_ab[0], of_ab[1]) {
        return false;
    }
    // On one line their extents decide; elsewhere they hold nothing back.
    plane
        .iter()
        .all(|&k| p[k].min(q[k]) <= a[k].max(b[k]) && a[k].min(b[k]) <= p[k].max(q[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn v(x: f64, y: f64, z: f64) -> Vec3 {
        Vec3::new(x, y, z)
    }

    /// The same question with the points in every order, which must not change the answer.
    fn meets(p: Vec3, q: Vec3, corners: [Vec3; 3]) -> bool {
        let [a, b, c] = &corners;
        let answer = segment_meets_triangle(&p, &q, [a, b, c]);
        for order in [[a, b, c], [b, c, a], [c, b, a]] {
            assert_eq!(segment_meets_triangle(&p, &q, order), answer);
            assert_eq!(segment_meets_triangle(&q, &p, order), answer);
        }
        answer
    }

    fn triangle() -> [Vec3; 3] {
        [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)]
    }

    #[test]
    fn a_segment_through_a_triangle_meets_it_and_one_beside_it_does_not() {
        assert!(meets(v(0.2, 0.2, -1.0), v(0.2, 0.2, 1.0), triangle()));
        assert!(!meets(v(0.8, 0.8, -1.0), v(0.8, 0.8, 1.0), triangle()));
        assert!(!meets(v(0.2, 0.2, 1e-300), v(0.2, 0.2, 1.0), triangle()));
        assert!(meets(v(0.2, 0.2, 0.0), v(0.2, 0.2, 1.0), triangle()));
        // Through a corner and through the middle of an edge.
        assert!(meets(v(0.0, 0.0, -1.0), v(0.0, 0.0, 1.0), triangle()));
        assert!(meets(v(0.5, 0.5, -1.0), v(0.5, 0.5, 1.0), triangle()));
        let just_outside = 0.5 + f64::EPSILON;
        assert!(!meets(
            v(0.5, just_outside, -1.0),
            v(0.5, just_outside, 1.0),
            triangle()
        ));
    }

    #[test]
    fn in_one_plane_overlap_decides() {
        assert!(
            meets(v(0.1, 0.1, 0.0), v(0.2, 0.2, 0.0), triangle()),
            "inside"
        );
        assert!(
            meets(v(-1.0, 0.2, 0.0), v(1.0, 0.2, 0.0), triangle()),
            "across"
        );
        assert!(
            meets(v(1.0, 0.0, 0.0), v(2.0, 0.0, 0.0), triangle()),
            "at a corner"
        );
        assert!(
            !meets(v(1.1, 0.0, 0.0), v(2.0, 0.0, 0.0), triangle()),
            "on the line of an edge"
        );
        assert!(
            !meets(v(0.6, 0.6, 0.0), v(2.0, 0.0, 0.0), triangle()),
            "beside"
        );
        // In a plane that no coordinate plane is parallel to.
        let tilted = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 1.0), v(0.0, 1.0, 1.0)];
        assert!(meets(v(0.125, 0.125, 0.25), v(0.25, 0.25, 0.5), tilted));
        assert!(!meets(v(0.75, 0.75, 1.5), v(2.0, 2.0, 4.0), tilted));
    }

    #[test]
    fn what_has_no_area_or_length_is_met_where_it_is() {
        let line = [v(0.0, 0.0, 0.0), v(1.0, 1.0, 1.0), v(2.0, 2.0, 2.0)];
        assert!(meets(v(0.0, 2.0, 1.0), v(2.0, 0.0, 1.0), line));
        assert!(!meets(v(0.0, 2.0, 1.5), v(2.0, 0.0, 1.0), line));
        assert!(!meets(v(3.0, 3.0, 3.0), v(4.0, 4.0, 4.0), line));
        let point = v(0.25, 0.25, 0.0);
        assert!(meets(point, point, triangle()));
        assert!(!meets(v(2.0, 0.0, 0.0), v(2.0, 0.0, 0.0), triangle()));
    }
}
