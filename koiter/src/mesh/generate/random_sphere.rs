//! A sphere through random points.

use std::f64::consts::TAU;

use spade::{DelaunayTriangulation, Point2, Triangulation};

use super::split_mix::SplitMix64;
use super::{GeneratorError, build, check_at_least, check_face_count, check_positive};
use crate::Vec3;
use crate::mesh::Surface;

/// Fewest points of a [`random_sphere`]: with fewer, the hull may miss the centre by most of the radius.
const FEWEST_POINTS: usize = 8;

/// The convex hull of `num_vertices` independent, uniformly distributed points on the sphere of the given `radius` [m]
/// about the origin; normals outward. The same `seed` gives the same mesh.
///
/// Stereographic projection from one of the points turns circles on the sphere into circles in the plane. So the faces
/// away from that point are the Delaunay triangles of the projected others, and it sees their outline. Its neighbours
/// lie far out in the plane, where the projection is as accurate, relatively, as anywhere.
///
/// # Errors
/// A radius that is not positive, fewer than 8 points, too many of them.
pub fn random_sphere(
    radius: f64,
    num_vertices: usize,
    seed: u64,
) -> Result<Surface, GeneratorError> {
    check_positive("radius of the sphere", radius)?;
    check_at_least(
        "number of points on the sphere",
        num_vertices,
        FEWEST_POINTS,
    )?;
    check_face_count(2.0 * num_vertices as f64)?;
    let mut random = SplitMix64(seed);
    // From south to north in bands, so that neighbours in space are near in memory.
    let mut points: Vec<Vec3> = (0..num_vertices)
        .map(|_| random_direction(&mut random))
        .collect();
    let bands = (0.5 * num_vertices as f64).sqrt().ceil();
    let band = |x: &Vec3| (0.5 * (x.z + 1.0) * bands) as u32;
    points.sort_by(|a, b| {
        let (turn_a, turn_b) = (a.y.atan2(a.x), b.y.atan2(b.x));
        band(a).cmp(&band(b)).then(turn_a.total_cmp(&turn_b))
    });
    let faces = spherical_delaunay(&points);
    build(points.iter().map(|x| x * radius).collect(), faces)
}

/// Uniform on the unit sphere: three normal deviates of Box and Muller (1958), normalised.
fn random_direction(random: &mut SplitMix64) -> Vec3 {
    loop {
        let mut normal = || {
            let (u, v) = (1.0 - random.unit(), random.unit());
            (-2.0 * u.ln()).sqrt() * (TAU * v).cos()
        };
        let x = Vec3::new(normal(), normal(), normal());
        if x.norm() > 1e-6 {
            return x.normalize();
        }
    }
}

/// Faces of the convex hull of points on the unit sphere.
fn spherical_delaunay(points: &[Vec3]) -> Vec<[u32; 3]> {
    let pole = points.len() - 1;
    let axis = points[pole];
    let side = if axis.x.abs() < 0.6 {
        Vec3::x()
    } else {
        Vec3::y()
    };
    let e1 = axis.cross(&side).normalize();
    let e2 = axis.cross(&e1);
    let project = |x: &Vec3| {
        // 1 − x·axis without cancellation near the pole.
        let height = 0.5 * (x - axis).norm_squared();
        Point2::new(x.dot(&e1) / height, x.dot(&e2) / height)
    };
    let projected = points[..pole].iter().map(project).collect();
    let triangulation = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(projected)
        .expect("projected points are finite and of moderate size");
    let mut faces: Vec<[u32; 3]> = triangulation
        .inner_faces()
        .map(|face| face.vertices().map(|v| v.fix().index() as u32))
        .collect();
    faces.extend(
        triangulation
            .convex_hull()
            .map(|edge| {
                // The outline has the outer face on its left; the pole is there.
                [edge.from(), edge.to()].map(|v| v.fix().index() as u32)
            })
            .map(|[a, b]| [a, b, pole as u32]),
    );
    // Seen from the pole the plane is mirrored, or not, as its axes are chosen: turn all faces outward alike.
    let outward = |&[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(|v| points[v as usize]);
        (b - a).cross(&(c - a)).dot(&(a + b + c)) > 0.0
    };
    let inward = faces.iter().filter(|face| !outward(face)).count();
    if 2 * inward > faces.len() {
        faces.iter_mut().for_each(|face| face.swap(1, 2));
    }
    for face in &mut faces {
        let first = (0..3).min_by_key(|&c| face[c]).unwrap_or(0);
        face.rotate_left(first);
    }
    faces.sort_unstable();
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_convex_hull_of_points_on_the_sphere() {
        for (num_vertices, seed) in [(8, 3), (50, 1), (400, 2)] {
            let ball = random_sphere(2.0, num_vertices, seed).unwrap();
            assert_eq!(ball.mesh.num_vertices(), num_vertices);
            assert_eq!(ball.mesh.num_faces(), 2 * num_vertices - 4);
            assert_eq!(ball.mesh.euler_characteristic(), 2);
            assert!(
                ball.positions
                    .iter()
                    .all(|x| (x.norm() - 2.0).abs() < 1e-14)
            );
            for f in 0..ball.mesh.num_faces() {
                let [a, b, c] = ball.corners(f);
                let normal = (b - a).cross(&(c - a)).normalize();
                // Round-off of coordinates of size 2, in thin triangles.
                let highest = ball
                    .positions
                    .iter()
                    .map(|x| (x - a).dot(&normal))
                    .fold(0.0, f64::max);
                assert!(highest < 1e-9, "{num_vertices} points, face {f}: {highest}");
            }
        }
    }

    #[test]
    fn points_prefer_no_place() {
        let ball = random_sphere(1.0, 20_000, 7).unwrap();
        // Means of 20 000 coordinates of variance 1/3: five standard deviations.
        let mean: Vec3 = ball.positions.iter().sum::<Vec3>() / 20_000.0;
        assert!(mean.amax() < 5.0 * (1.0f64 / 60_000.0).sqrt(), "{mean}");
        let tops = ball.positions.iter().filter(|x| x.z > 0.8).count() as f64 / 20_000.0;
        assert!(
            (tops - 0.1).abs() < 5.0 * (0.09f64 / 20_000.0).sqrt(),
            "{tops}"
        );
    }

    #[test]
    fn impossible_spheres_are_refused_with_the_value() {
        let message = |r, n| random_sphere(r, n, 0).unwrap_err().to_string();
        assert!(message(0.0, 100).contains("radius of the sphere"));
        assert!(message(1.0, 7).contains("at least 8, but it is 7"));
        assert!(message(1.0, usize::MAX).contains("make it coarser"));
    }
}
