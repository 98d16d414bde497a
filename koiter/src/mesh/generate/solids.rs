//! Closed bodies: the icosphere and the box.

use std::collections::HashMap;

use super::{GeneratorError, build, check_face_count, check_positive, face_count};
use crate::Vec3;
use crate::mesh::Surface;

/// A sphere about the origin: an icosahedron whose faces are split in four `subdivisions` times, normals outward.
///
/// `20 · 4^subdivisions` faces; all vertices lie on the sphere of `radius` [m].
///
/// # Errors
/// A radius that is not positive, too many faces.
pub fn icosphere(radius: f64, subdivisions: usize) -> Result<Surface, GeneratorError> {
    check_positive("radius of the sphere", radius)?;
    check_face_count(face_count::icosphere(subdivisions))?;
    let g = f64::midpoint(1.0, 5f64.sqrt());
    let mut directions: Vec<Vec3> = Vec::new();
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        directions.extend([
            Vec3::new(a, b, 0.0),
            Vec3::new(0.0, a, b),
            Vec3::new(b, 0.0, a),
        ]);
    }
    let mut faces = icosahedron_faces(&directions);
    for direction in &mut directions {
        direction.normalize_mut();
    }
    for _ in 0..subdivisions {
        let mut midpoints: HashMap<[u32; 2], u32> = HashMap::new();
        let mut finer = Vec::with_capacity(4 * faces.len());
        for [a, b, c] in faces {
            let mut midpoint = |u: u32, v: u32| {
                *midpoints.entry([u.min(v), u.max(v)]).or_insert_with(|| {
                    let sum = directions[u as usize] + directions[v as usize];
                    directions.push(sum.normalize());
                    directions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (midpoint(a, b), midpoint(b, c), midpoint(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        faces = finer;
    }
    build(directions.iter().map(|d| d * radius).collect(), faces)
}

/// The 20 triples of mutually adjacent corners, outward; corners of the icosahedron of edge 2 are adjacent at distance 2.
fn icosahedron_faces(corners: &[Vec3]) -> Vec<[u32; 3]> {
    let adjacent = |i: usize, j: usize| (corners[i] - corners[j]).norm() < 2.1;
    let mut faces = Vec::with_capacity(20);
    for i in 0..12 {
        for j in (i + 1..12).filter(|&j| adjacent(i, j)) {
            for k in (j + 1..12).filter(|&k| adjacent(i, k) && adjacent(j, k)) {
                let outward = corners[i].dot(&corners[j].cross(&corners[k])) > 0.0;
                faces.push(
                    [i, if outward { j } else { k }, if outward { k } else { j }].map(|v| v as u32),
                );
            }
        }
    }
    faces
}

/// A closed box about the origin with edges of `size` [m] along x, y, z: 8 vertices, 12 faces, normals outward.
///
/// Vertex bits tell its side: vertex `x + 2 y + 4 z` with 0 for the low and 1 for the high side.
///
/// # Errors
/// A size that is not positive.
pub fn box_mesh(size: [f64; 3]) -> Result<Surface, GeneratorError> {
    for (what, value) in [
        "size of the box along x",
        "size of the box along y",
        "size of the box along z",
    ]
    .into_iter()
    .zip(size)
    {
        check_positive(what, value)?;
    }
    let mut positions = Vec::with_capacity(8);
    for v in 0..8 {
        let side = |axis: usize| {
            if v >> axis & 1 == 1 {
                size[axis] / 2.0
            } else {
                -size[axis] / 2.0
            }
        };
        positions.push(Vec3::new(side(0), side(1), side(2)));
    }
    let mut faces = Vec::with_capacity(12);
    for [a, b, c, d] in [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ] {
        faces.extend([[a, b, c], [a, c, d]]);
    }
    build(positions, faces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn icosphere_is_a_closed_sphere() {
        let sphere = icosphere(2.0, 2).unwrap();
        assert_eq!(sphere.mesh.num_faces(), 320);
        assert_eq!(sphere.mesh.euler_characteristic(), 2);
        assert!(
            sphere
                .positions
                .iter()
                .all(|x| (x.norm() - 2.0).abs() < 1e-14)
        );
        assert!(sphere.signed_volume() > 0.0);
        assert!(sphere.min_angle().to_degrees() > 50.0);
    }

    #[test]
    fn icosphere_area_and_volume_converge_in_second_order() {
        let errors = [1, 2, 3].map(|k| {
            let sphere = icosphere(1.0, k).unwrap();
            [
                4.0 * PI - sphere.area(),
                4.0 / 3.0 * PI - sphere.signed_volume(),
            ]
        });
        for i in 0..2 {
            for k in 0..2 {
                let ratio = errors[k][i] / errors[k + 1][i];
                assert!((3.6..4.4).contains(&ratio), "ratio {ratio}");
            }
        }
    }

    #[test]
    fn box_is_closed_and_outward() {
        let body = box_mesh([1.0, 2.0, 3.0]).unwrap();
        assert_eq!(body.mesh.num_vertices(), 8);
        assert_eq!(body.mesh.num_faces(), 12);
        assert_eq!(body.mesh.euler_characteristic(), 2);
        assert!((body.signed_volume() - 6.0).abs() < 1e-14);
        assert_eq!(body.area(), 22.0);
        for f in 0..12 {
            let [a, b, c] = body.corners(f);
            assert!((b - a).cross(&(c - a)).dot(&(a + b + c)) > 0.0);
        }
    }

    #[test]
    fn impossible_bodies_are_refused_with_the_value() {
        assert!(
            icosphere(f64::INFINITY, 1)
                .unwrap_err()
                .to_string()
                .contains("inf")
        );
        assert!(
            icosphere(1.0, 400)
                .unwrap_err()
                .to_string()
                .contains("coarser")
        );
        assert!(
            box_mesh([1.0, -2.0, 1.0])
                .unwrap_err()
                .to_string()
                .contains("along y")
        );
    }
}
