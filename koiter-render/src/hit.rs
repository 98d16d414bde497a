//! The point of a surface that is seen through a point of the picture.

use crate::raster::{GROUND, NOTHING, View};
use crate::surface::Surface;
use crate::vector::{Vec3, vec3};

/// A seen point.
#[derive(Clone, Copy)]
pub(crate) struct Hit {
    pub(crate) position: Vec3,
    /// From where to start rays: on the curved surface that the normals suggest, so that the facets do not shade
    /// themselves where light grazes (Hanika 2021, "Hacking the Shadow Terminator").
    pub(crate) lifted: Vec3,
    /// Smooth normal on the side of the eye.
    pub(crate) normal: Vec3,
    /// Normal of the face on the side of the eye.
    pub(crate) face_normal: Vec3,
    /// Weights of corners 0, 1, 2.
    pub(crate) weights: [f32; 3],
    pub(crate) is_front: bool,
    /// Part, or [`GROUND`]: light is not blurred from one to another.
    pub(crate) group: u32,
}

impl Hit {
    /// `None` where nothing is seen.
    pub(crate) fn find(surface: &Surface, view: &View, face: u32, x: f32, y: f32) -> Option<Self> {
        match face {
            NOTHING => None,
            GROUND => Self::on_ground(view, surface.ground?, view.direction(x, y)),
            face => Some(Self::on_face(surface, view, face, view.direction(x, y))),
        }
    }

    fn on_ground(view: &View, height: f32, direction: Vec3) -> Option<Self> {
        let depth = (height - view.eye.z) / direction.z;
        if !(depth > 0.0 && depth < 1e6) {
            return None;
        }
        let (position, up) = (view.eye + direction * depth, vec3(0.0, 0.0, 1.0));
        let weights = [1.0, 0.0, 0.0];
        Some(Self {
            position,
            lifted: position,
            normal: up,
            face_normal: up,
            weights,
            is_front: true,
            group: GROUND,
        })
    }

    fn on_face(surface: &Surface, view: &View, face: u32, direction: Vec3) -> Self {
        let corners = surface.corners(face);
        let weights = weights(corners, view.eye, direction);
        let blend = |v: [Vec3; 3]| v[0] * weights[0] + v[1] * weights[1] + v[2] * weights[2];
        let position = blend(corners);
        let outward = (corners[1] - corners[0])
            .cross(corners[2] - corners[0])
            .normalized_or(-direction);
        let is_front = outward.dot(direction) <= 0.0;
        let side = if is_front { 1.0 } else { -1.0 };
        let face_normal = outward * side;
        let normals = surface.corner_normals[face as usize].map(|normal| normal * side);
        let normal = blend(normals).normalized_or(face_normal);
        let lifted = blend(
            [0, 1, 2]
                .map(|i| position - normals[i] * (position - corners[i]).dot(normals[i]).min(0.0)),
        );
        let group = surface.part_of_face[face as usize];
        Self {
            position,
            lifted,
            normal,
            face_normal,
            weights,
            is_front,
            group,
        }
    }
}

/// Barycentric weights of the point where a ray meets the plane of a triangle, moved into the triangle: a sample on the
/// rim, or a grazing view, would otherwise extrapolate.
fn weights(corners: [Vec3; 3], eye: Vec3, direction: Vec3) -> [f32; 3] {
    let (edge_1, edge_2, offset) = (
        corners[1] - corners[0],
        corners[2] - corners[0],
        eye - corners[0],
    );
    let p = direction.cross(edge_2);
    let determinant = edge_1.dot(p);
    let u = offset.dot(p) / determinant;
    let v = direction.dot(offset.cross(edge_1)) / determinant;
    if !(u.is_finite() && v.is_finite()) {
        return [1.0 / 3.0; 3];
    }
    let inside = [(1.0 - u - v).max(0.0), u.max(0.0), v.max(0.0)];
    let sum: f32 = inside.iter().sum();
    inside.map(|weight| weight / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_find_the_point_on_the_ray_and_stay_in_the_triangle() {
        let corners = [
            vec3(0.0, 0.0, 0.0),
            vec3(1.0, 0.0, 0.0),
            vec3(0.0, 1.0, 0.0),
        ];
        let w = weights(corners, vec3(0.25, 0.5, 2.0), vec3(0.0, 0.0, -1.0));
        assert!(
            (w[0] - 0.25).abs() < 1e-6 && (w[1] - 0.25).abs() < 1e-6 && (w[2] - 0.5).abs() < 1e-6
        );
        let w = weights(corners, vec3(-1.0, 0.5, 2.0), vec3(0.0, 0.0, -1.0));
        assert!(w.iter().all(|&w| (0.0..=1.0).contains(&w)));
        let w = weights(corners, vec3(5.0, 0.5, 0.0), vec3(-1.0, 0.0, 0.0));
        assert!(w.iter().all(|w| w.is_finite()));
    }
}
