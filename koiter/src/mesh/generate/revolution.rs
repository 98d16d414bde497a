//! Surfaces of revolution about the z axis.

use std::f64::consts::{PI, TAU};

use super::rings::{Ring, join_rings};
use super::{
    GeneratorError, build, check_at_least, check_between, check_face_count, check_positive,
    face_count,
};
use crate::Vec3;
use crate::mesh::Surface;

/// A flat disc of `radius` [m] in the plane z = 0, normals along +z.
///
/// Ring k of `rings` has 6k vertices, so there are `6 rings²` faces; no angle is below 30°. The rim comes first, the
/// centre is the last vertex.
///
/// # Errors
/// A radius that is not positive, no rings, too many faces.
pub fn disc(radius: f64, rings: usize) -> Result<Surface, GeneratorError> {
    check_positive("radius of the disc", radius)?;
    check_at_least("number of rings", rings, 1)?;
    check_face_count(face_count::disc(rings))?;
    // From the rim inwards, for normals along +z.
    let ring = |k: usize| Ring {
        radius: radius * k as f64 / rings as f64,
        z: 0.0,
        count: (6 * k).max(1),
    };
    let (positions, faces) = join_rings(&(0..=rings).rev().map(ring).collect::<Vec<_>>());
    build(positions, faces)
}

/// An open tube along z of `radius` and `height` [m], from z = −height/2 to height/2, normals outward.
///
/// `around` × `along` cells of two triangles; vertex `k around + i` is number i of ring k, counted from below.
///
/// # Errors
/// A size that is not positive, fewer than 3 cells around or 1 along, too many faces.
pub fn cylinder(
    radius: f64,
    height: f64,
    around: usize,
    along: usize,
) -> Result<Surface, GeneratorError> {
    check_positive("radius of the cylinder", radius)?;
    check_positive("height of the cylinder", height)?;
    check_at_least("number of cells around", around, 3)?;
    check_at_least("number of cells along the axis", along, 1)?;
    check_face_count(face_count::cells(around, along))?;
    let ring = |k: usize| Ring {
        radius,
        z: height * (2.0 * k as f64 - along as f64) / (2.0 * along as f64),
        count: around,
    };
    let (positions, faces) = join_rings(&(0..=along).map(ring).collect::<Vec<_>>());
    build(positions, faces)
}

/// A cylinder closed by two flat caps: an obstacle. Each cap is a fan about a centre vertex.
///
/// # Errors
/// A size that is not positive, fewer than 3 sides, too many faces.
pub fn solid_cylinder(radius: f64, height: f64, sides: usize) -> Result<Surface, GeneratorError> {
    check_positive("radius of the cylinder", radius)?;
    check_positive("height of the cylinder", height)?;
    check_at_least("number of sides", sides, 3)?;
    check_face_count(4.0 * sides as f64)?;
    let (low, high) = (-height / 2.0, height / 2.0);
    let (positions, faces) = join_rings(&[
        Ring {
            radius: 0.0,
            z: low,
            count: 1,
        },
        Ring {
            radius,
            z: low,
            count: sides,
        },
        Ring {
            radius,
            z: high,
            count: sides,
        },
        Ring {
            radius: 0.0,
            z: high,
            count: 1,
        },
    ]);
    build(positions, faces)
}

/// A cone without base: `base_radius` [m] at z = 0, narrowing to `top_radius` at z = `height`, normals outward.
///
/// Without a `top_radius` it ends in an apex, the last vertex. The base has `around` vertices; rings above have fewer
/// in proportion to their radius (at least 6), so that triangles keep their shape.
///
/// # Errors
/// A size that is not positive, a top not narrower than the base, fewer than 6 cells around or 1 along, too many faces.
pub fn cone(
    base_radius: f64,
    height: f64,
    top_radius: Option<f64>,
    around: usize,
    along: usize,
) -> Result<Surface, GeneratorError> {
    check_positive("base radius of the cone", base_radius)?;
    check_positive("height of the cone", height)?;
    if let Some(top) = top_radius {
        check_between("top radius of the cone", top, 0.0, base_radius)?;
    }
    check_at_least("number of cells around", around, 6)?;
    check_at_least("number of cells along the axis", along, 1)?;
    check_face_count(face_count::cells(around, along))?;
    let top = top_radius.unwrap_or(0.0);
    let ring = |k: usize| {
        let t = k as f64 / along as f64;
        let radius = base_radius * (1.0 - t) + top * t;
        let is_apex = top_radius.is_none() && k == along;
        // The ratio first: the product with a radius near the largest number would be infinite.
        let count = ((around as f64 * (radius / base_radius)).round() as usize).max(6);
        Ring {
            radius,
            z: height * t,
            count: if is_apex { 1 } else { count },
        }
    };
    let (positions, faces) = join_rings(&(0..=along).map(ring).collect::<Vec<_>>());
    build(positions, faces)
}

/// The part of a sphere within polar `angle` [rad] of the north pole, about the origin, normals outward.
///
/// `hole_angle` [rad], if given, cuts a round hole about the pole. `rings` bands of equal width lie between hole (or
/// pole) and rim; each ring has as many vertices as make edges of about equal length (at least 6). The rim comes
/// first, the pole or hole last. A hemisphere has `angle` = π/2.
///
/// # Errors
/// A radius that is not positive, an `angle` not between 0 and π, a hole not between 0 and `angle`, no rings, too many
/// faces.
pub fn spherical_cap(
    radius: f64,
    angle: f64,
    hole_angle: Option<f64>,
    rings: usize,
) -> Result<Surface, GeneratorError> {
    let (positions, faces) = join_rings(&cap_rings(radius, angle, hole_angle, rings)?);
    build(positions, faces)
}

/// The rings of [`spherical_cap`], from the rim.
pub(super) fn cap_rings(
    radius: f64,
    angle: f64,
    hole_angle: Option<f64>,
    rings: usize,
) -> Result<Vec<Ring>, GeneratorError> {
    check_positive("radius of the cap", radius)?;
    check_between("polar angle of the cap in radians", angle, 0.0, PI)?;
    if let Some(hole) = hole_angle {
        check_between("polar angle of the hole in radians", hole, 0.0, angle)?;
    }
    check_at_least("number of rings", rings, 1)?;
    let hole = hole_angle.unwrap_or(0.0);
    let step = (angle - hole) / rings as f64;
    check_face_count(face_count::spherical_cap(angle, hole, rings))?;
    let ring = |k: usize| {
        let polar = hole + step * k as f64;
        let is_pole = hole_angle.is_none() && k == 0;
        let count = ((TAU * polar.sin() / step).round() as usize).max(6);
        Ring {
            radius: radius * polar.sin(),
            z: radius * polar.cos(),
            count: if is_pole { 1 } else { count },
        }
    };
    Ok((0..=rings).rev().map(ring).collect())
}

/// A torus about the z axis: a tube of `minor_radius` [m] whose centre runs on a circle of `major_radius`, normals
/// outward.
///
/// `around` cells along the large circle, `tube` around the tube; vertex `i tube + j`, with `j = 0` on the outer
/// equator.
///
/// # Errors
/// A radius that is not positive, a tube as wide as its circle, fewer than 3 cells either way, too many faces.
pub fn torus(
    major_radius: f64,
    minor_radius: f64,
    around: usize,
    tube: usize,
) -> Result<Surface, GeneratorError> {
    check_positive("major radius of the torus", major_radius)?;
    check_between("minor radius of the torus", minor_radius, 0.0, major_radius)?;
    check_at_least("number of cells around", around, 3)?;
    check_at_least("number of cells around the tube", tube, 3)?;
    check_face_count(face_count::cells(around, tube))?;
    let mut positions = Vec::with_capacity(around * tube);
    let mut faces = Vec::with_capacity(2 * around * tube);
    for i in 0..around {
        let (sin, cos) = (TAU * i as f64 / around as f64).sin_cos();
        for j in 0..tube {
            let (tube_sin, tube_cos) = (TAU * j as f64 / tube as f64).sin_cos();
            let r = major_radius + minor_radius * tube_cos;
            positions.push(Vec3::new(r * cos, r * sin, minor_radius * tube_sin));
            let vertex = |i: usize, j: usize| ((i % around) * tube + j % tube) as u32;
            let (a, b) = (vertex(i, j), vertex(i + 1, j));
            let (c, d) = (vertex(i + 1, j + 1), vertex(i, j + 1));
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    build(positions, faces)
}

#[cfg(test)]
mod tests;
