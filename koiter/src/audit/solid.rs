//! Half-spaces, balls and capsules, and how deep a triangle reaches into them.

use crate::Vec3;
use crate::geometry::segment_meets_triangle;

/// The exact shape of an obstacle that is drawn with faces.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Solid {
    /// What lies behind a plane.
    HalfSpace {
        /// A point of the plane [m].
        point: [f64; 3],
        /// Unit normal, to the free side.
        normal: [f64; 3],
    },
    /// A ball.
    Ball {
        /// Centre [m].
        center: [f64; 3],
        /// Radius [m].
        radius: f64,
    },
    /// A ball swept along a segment.
    Capsule {
        /// Ends of the axis [m].
        ends: [[f64; 3]; 2],
        /// Radius [m].
        radius: f64,
    },
}

/// Depths below this share of the solid's size are round-off of where it stands.
const ROUND_OFF: f64 = 1e-12;

impl Solid {
    /// Where the solid is when points that were at `from` are at `to`, moved as a rigid body. The first three must not
    /// lie on a line.
    pub(super) fn carried(&self, from: &[Vec3], to: &[Vec3]) -> Self {
        let (start, end) = (axes(from), axes(to));
        let turn = |x: Vec3| (0..3).map(|k| end[k] * start[k].dot(&x)).sum::<Vec3>();
        let place = |x: &[f64; 3]| (to[0] + turn(Vec3::from(*x) - from[0])).into();
        match self {
            Self::HalfSpace { point, normal } => Self::HalfSpace {
                point: place(point),
                normal: turn(Vec3::from(*normal)).into(),
            },
            Self::Ball { center, radius } => Self::Ball {
                center: place(center),
                radius: *radius,
            },
            Self::Capsule { ends, radius } => Self::Capsule {
                ends: [place(&ends[0]), place(&ends[1])],
                radius: *radius,
            },
        }
    }

    /// How deep a triangle reaches inside [m]; 0 if it does not.
    pub(super) fn depth(&self, triangle: &[Vec3; 3]) -> f64 {
        let (depth, size) = match self {
            Self::HalfSpace { point, normal } => {
                let (point, normal) = (Vec3::from(*point), Vec3::from(*normal));
                let heights = triangle.map(|x| normal.dot(&(x - point)));
                let size = triangle.iter().map(Vec3::amax).fold(point.amax(), f64::max);
                (-heights.into_iter().fold(f64::INFINITY, f64::min), size)
            }
            Self::Ball { center, radius } => {
                let center = Vec3::from(*center);
                if is_far(triangle, &center, &center, *radius) {
                    return 0.0;
                }
                (
                    radius - from_point(&center, triangle),
                    radius + center.amax(),
                )
            }
            Self::Capsule { ends, radius } => {
                let [a, b] = ends.map(Vec3::from);
                if is_far(triangle, &a, &b, *radius) {
                    return 0.0;
                }
                let size = radius + a.amax().max(b.amax());
                (radius - from_segment(&a, &b, triangle), size)
            }
        };
        if depth > ROUND_OFF * size { depth } else { 0.0 }
    }
}

/// Orthonormal axes that three points carry along.
fn axes(points: &[Vec3]) -> [Vec3; 3] {
    let first = (points[1] - points[0]).normalize();
    let third = first.cross(&(points[2] - points[0])).normalize();
    [first, third.cross(&first), third]
}

/// Whether the boxes of a triangle and of a capsule are apart.
fn is_far(triangle: &[Vec3; 3], a: &Vec3, b: &Vec3, radius: f64) -> bool {
    let [p, q, r] = triangle;
    let (low, high) = (p.inf(q).inf(r), p.sup(q).sup(r));
    let (first, last) = (a.inf(b), a.sup(b));
    (0..3).any(|k| low[k] > last[k] + radius || high[k] < first[k] - radius)
}

/// Distance of a point and a triangle: to its plane above the inside, else to the nearest edge.
fn from_point(p: &Vec3, [a, b, c]: &[Vec3; 3]) -> f64 {
    let normal = (b - a).cross(&(c - a));
    let inside = |from: &Vec3, to: &Vec3| normal.dot(&(to - from).cross(&(p - from))) >= 0.0;
    if normal.norm() > 0.0 && inside(a, b) && inside(b, c) && inside(c, a) {
        return (normal.dot(&(p - a)) / normal.norm()).abs();
    }
    let edges = [[a, b], [b, c], [c, a]].map(|[from, to]| to_segment(p, from, to));
    edges.into_iter().fold(f64::INFINITY, f64::min)
}

/// Distance of a segment and a triangle: at a corner of one of them, or between the segment and an edge.
fn from_segment(p: &Vec3, q: &Vec3, triangle: &[Vec3; 3]) -> f64 {
    let [a, b, c] = triangle;
    if segment_meets_triangle(p, q, [a, b, c]) {
        return 0.0;
    }
    let ends = from_point(p, triangle).min(from_point(q, triangle));
    let edges = [[a, b], [b, c], [c, a]].map(|[from, to]| {
        (to_segment(from, p, q)).min(between_lines(p, q, from, to).unwrap_or(f64::INFINITY))
    });
    edges.into_iter().fold(ends, f64::min)
}

/// Distance of a point and a segment.
fn to_segment(p: &Vec3, a: &Vec3, b: &Vec3) -> f64 {
    let along = b - a;
    let length_squared = along.norm_squared();
    let t = if length_squared > 0.0 {
        (along.dot(&(p - a)) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (p - a - along * t).norm()
}

/// Distance of the lines of two segments, if they are closest to each other within both.
fn between_lines(p: &Vec3, q: &Vec3, a: &Vec3, b: &Vec3) -> Option<f64> {
    let (u, v) = (q - p, b - a);
    let normal = u.cross(&v);
    let squared = normal.norm_squared();
    let s = (a - p).cross(&v).dot(&normal) / squared;
    let t = (a - p).cross(&u).dot(&normal) / squared;
    let within = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
    within.then(|| (normal.dot(&(a - p)) / squared.sqrt()).abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn v(x: f64, y: f64, z: f64) -> Vec3 {
        Vec3::new(x, y, z)
    }

    /// Distance from a segment (or a point) by looking everywhere.
    fn by_sampling(p: Vec3, q: Vec3, [a, b, c]: &[Vec3; 3]) -> f64 {
        const N: usize = 120;
        let mut least = f64::INFINITY;
        for i in 0..=N {
            for j in 0..=N - i {
                let (s, t) = (i as f64 / N as f64, j as f64 / N as f64);
                least = least.min(to_segment(&(a + (b - a) * s + (c - a) * t), &p, &q));
            }
        }
        least
    }

    #[test]
    fn distances_from_triangles_are_the_least_over_all_their_points() {
        let triangle = [v(0.0, 0.0, 0.0), v(1.0, 0.1, 0.2), v(0.3, 0.9, -0.1)];
        for (p, q) in [
            (v(0.4, 0.3, 0.5), v(0.4, 0.3, 0.5)),
            (v(1.5, 0.1, 0.3), v(1.5, 0.1, 0.3)),
            (v(0.5, -0.6, 0.3), v(0.5, -0.6, 0.3)),
            (v(0.3, 0.3, 0.4), v(0.4, 0.2, 1.0)),
            (v(0.4, -0.5, 0.4), v(0.5, 0.5, 0.6)),
            (v(0.4, -0.5, -0.3), v(0.9, 0.2, 0.6)),
            (v(2.0, 0.0, 0.0), v(1.2, 0.3, 0.1)),
            (v(0.3, 0.3, -0.5), v(0.4, 0.2, 0.5)),
        ] {
            let exact = if p == q {
                from_point(&p, &triangle)
            } else {
                from_segment(&p, &q, &triangle)
            };
            let sampled = by_sampling(p, q, &triangle);
            // The nearest sample is within a cell of edge 1/120 of the nearest point.
            assert!(
                exact <= sampled + 1e-14 && sampled < exact + 0.01,
                "{exact} {sampled}"
            );
        }
    }

    #[test]
    fn depths_are_those_of_the_nearest_point() {
        let triangle = [v(-1.0, -1.0, 0.9), v(1.0, -1.0, 0.9), v(0.0, 1.0, 0.9)];
        let ball = Solid::Ball {
            center: [0.0; 3],
            radius: 1.0,
        };
        assert!((ball.depth(&triangle) - 0.1).abs() < 1e-15);
        assert_eq!(ball.depth(&triangle.map(|x| x + Vec3::z() * 0.1)), 0.0);
        let capsule = Solid::Capsule {
            ends: [[0.0, 0.0, -2.0], [0.0, 0.0, 0.0]],
            radius: 1.0,
        };
        assert!((capsule.depth(&triangle) - 0.1).abs() < 1e-15);
        let floor = Solid::HalfSpace {
            point: [5.0, 0.0, 1.0],
            normal: [0.0, 0.0, 1.0],
        };
        assert!((floor.depth(&triangle) - 0.1).abs() < 1e-15);
    }

    #[test]
    fn solids_go_where_their_faces_go() {
        let from = [v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.3), v(-0.5, 0.2, 1.0)];
        // A quarter of a turn about z, and a shift.
        let moved = |x: Vec3| v(2.0 - x.y, x.x, x.z - 1.0);
        let capsule = Solid::Capsule {
            ends: [[1.0, 2.0, 3.0], [0.0, 0.0, 1.0]],
            radius: 0.2,
        };
        let Solid::Capsule { ends, .. } = capsule.carried(&from, &from.map(moved)) else {
            panic!("a capsule stays one");
        };
        for (end, start) in ends.into_iter().zip([v(1.0, 2.0, 3.0), v(0.0, 0.0, 1.0)]) {
            assert!((Vec3::from(end) - moved(start)).norm() < 1e-14);
        }
    }
}
