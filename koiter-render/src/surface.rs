//! The triangles of all parts in one list, scaled to unit size, with smooth normals and colours ready to look up.

use rayon::prelude::*;

use crate::color::{ColorMap, Rgb};
use crate::options::{ColorBy, RenderOptions};
use crate::scene::{Bounds, FieldView, Ground, PartKind, Scene};
use crate::vector::{Vec3, vec3};

/// Faces that meet at a larger angle keep their edge (cosine): 40° keeps the edges of boxes and cylinders, 66° those of
/// folded paper while coarse cloth stays smooth.
const OBSTACLE_CREASE: f32 = 0.766;
const SHELL_CREASE: f32 = 0.407;

/// Everything that is drawn, in a frame where the centre of the scene is the origin and the radius of what the camera was
/// fitted to is one.
pub(crate) struct Surface {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) faces: Vec<[u32; 3]>,
    /// Unit normals at the corners of each face, averaged over the faces of the same smooth piece.
    pub(crate) corner_normals: Vec<[Vec3; 3]>,
    pub(crate) parts: Vec<Part>,
    /// For each face its part.
    pub(crate) part_of_face: Vec<u32>,
    /// Height of the ground in the unit frame, `None` as well when the camera is below it.
    pub(crate) ground: Option<f32>,
    /// All vertices are in the sphere of this radius about the origin.
    pub(crate) radius: f32,
    center: [f64; 3],
    scale: f64,
}

/// What the faces of a part have in common.
pub(crate) struct Part {
    pub(crate) kind: PartKind,
    front: Vec3,
    back: Vec3,
    paint: Option<Paint>,
    first_vertex: usize,
    first_face: usize,
}

/// A field, normalised so that the map's ends are 0 and 1.
struct Paint {
    values: Vec<f32>,
    per_face: bool,
    map: ColorMap,
}

impl Surface {
    /// Gathers a scene that passed its check. `range` are the field values at the ends of the colour map.
    pub(crate) fn gather(
        scene: &Scene,
        bounds: &Bounds,
        options: &RenderOptions,
        range: (f64, f64),
    ) -> Self {
        let center = bounds.center();
        let scale = 1.0 / options.camera.unit;
        let mut surface = Self {
            positions: Vec::new(),
            faces: Vec::new(),
            corner_normals: Vec::new(),
            parts: Vec::new(),
            part_of_face: Vec::new(),
            ground: match scene.ground {
                // Seen from below, the ground would hide the scene.
                Ground::At(height) if options.camera.eye[2] > height => {
                    Some(((height - center[2]) * scale) as f32)
                }
                _ => None,
            },
            radius: (bounds.radius() * scale) as f32,
            center,
            scale,
        };
        for (index, view) in scene.parts.iter().enumerate() {
            let first_vertex = surface.positions.len();
            let positions: Vec<Vec3> = view
                .positions
                .par_iter()
                .map(|&p| surface.to_unit(p))
                .collect();
            let crease = if view.kind == PartKind::Shell {
                SHELL_CREASE
            } else {
                OBSTACLE_CREASE
            };
            surface
                .corner_normals
                .extend(corner_normals(&positions, view.faces, crease));
            surface.positions.extend(positions);
            let first_face = surface.faces.len();
            surface.faces.extend(
                view.faces
                    .iter()
                    .map(|face| face.map(|v| v + first_vertex as u32)),
            );
            surface
                .part_of_face
                .resize(surface.faces.len(), index as u32);
            let front = view.color.to_linear();
            let back = if view.kind == PartKind::Shell {
                back_of(view.color)
            } else {
                front
            };
            let paint = match (&options.color, view.field) {
                (ColorBy::Field { map, .. }, Some(field)) => Some(Paint::new(field, *map, range)),
                _ => None,
            };
            surface.parts.push(Part {
                kind: view.kind,
                front,
                back,
                paint,
                first_vertex,
                first_face,
            });
        }
        surface
    }

    /// A point of the scene in the unit frame.
    pub(crate) fn to_unit(&self, point: [f64; 3]) -> Vec3 {
        Vec3::from_f64(std::array::from_fn(|axis| {
            (point[axis] - self.center[axis]) * self.scale
        }))
    }

    /// The corners of a face.
    pub(crate) fn corners(&self, face: u32) -> [Vec3; 3] {
        self.faces[face as usize].map(|v| self.positions[v as usize])
    }

    /// Linear colour at the barycentric weights of corners 0, 1, 2, and whether it shows a field.
    pub(crate) fn color(&self, face: u32, weights: [f32; 3], is_front: bool) -> (Vec3, bool) {
        let part = &self.parts[self.part_of_face[face as usize] as usize];
        let Some(paint) = &part.paint else {
            return (if is_front { part.front } else { part.back }, false);
        };
        let value = if paint.per_face {
            paint.values[face as usize - part.first_face]
        } else {
            let corners =
                self.faces[face as usize].map(|v| paint.values[v as usize - part.first_vertex]);
            corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
        };
        (paint.map.at(f64::from(value)).to_linear(), true)
    }
}

/// The colour of the back of cloth: paler and warmer than the front.
fn back_of(front: Rgb) -> Vec3 {
    let front = front.to_linear();
    let grey = front.dot(vec3(0.2126, 0.7152, 0.0722));
    front.lerp(vec3(1.25 * grey, 1.12 * grey, 1.0 * grey), 0.45)
}

impl Paint {
    fn new(field: FieldView, map: ColorMap, (low, high): (f64, f64)) -> Self {
        let width = high - low;
        let normalised = |&value: &f64| {
            if width == 0.0 {
                0.5
            } else {
                ((value - low) / width) as f32
            }
        };
        let finite = |value: &f64| {
            if value.is_finite() {
                normalised(value)
            } else {
                f32::NAN
            }
        };
        Self {
            values: field.values().iter().map(finite).collect(),
            per_face: matches!(field, FieldView::PerFace(_)),
            map,
        }
    }
}

/// Normals at the corners of the faces: the sum over the faces around the vertex, weighted by their angle there
/// (Thürmer and Wüthrich 1998), of those whose normal is within the crease angle of this face's.
fn corner_normals(positions: &[Vec3], faces: &[[u32; 3]], crease: f32) -> Vec<[Vec3; 3]> {
    let normals: Vec<Vec3> = faces
        .par_iter()
        .map(|face| {
            let [a, b, c] = face.map(|v| positions[v as usize]);
            (b - a).cross(c - a).normalized_or(Vec3::default())
        })
        .collect();
    let (starts, around) = faces_around_vertices(positions.len(), faces);
    let angle_at = |face: usize, vertex: u32| {
        let corners = faces[face];
        let i = corners.iter().position(|&v| v == vertex).unwrap_or(0);
        let [a, b, c] = [i, (i + 1) % 3, (i + 2) % 3].map(|j| positions[corners[j] as usize]);
        let (u, v) = (
            (b - a).normalized_or(Vec3::default()),
            (c - a).normalized_or(Vec3::default()),
        );
        u.cross(v).length().atan2(u.dot(v))
    };
    // One angle for each entry of `around`: the same corner is asked for by every face of the fan.
    let angles: Vec<f32> = (0..positions.len())
        .flat_map(|vertex| {
            (starts[vertex]..starts[vertex + 1]).map(move |entry| (vertex as u32, entry))
        })
        .map(|(vertex, entry)| angle_at(around[entry] as usize, vertex))
        .collect();
    (0..faces.len())
        .into_par_iter()
        .map(|face| {
            faces[face].map(|vertex| {
                let mut sum = Vec3::default();
                for entry in starts[vertex as usize]..starts[vertex as usize + 1] {
                    let normal = normals[around[entry] as usize];
                    if normal.dot(normals[face]) > crease {
                        sum += normal * angles[entry];
                    }
                }
                sum.normalized_or(normals[face])
            })
        })
        .collect()
}

/// For each vertex `v`, the faces around it are `faces[starts[v]..starts[v + 1]]`.
fn faces_around_vertices(num_vertices: usize, faces: &[[u32; 3]]) -> (Vec<usize>, Vec<u32>) {
    let mut starts = vec![0; num_vertices + 1];
    faces
        .iter()
        .flatten()
        .for_each(|&v| starts[v as usize + 1] += 1);
    for vertex in 0..num_vertices {
        starts[vertex + 1] += starts[vertex];
    }
    let mut next = starts.clone();
    let mut around = vec![0; 3 * faces.len()];
    for (face, corners) in faces.iter().enumerate() {
        for &v in corners {
            around[next[v as usize]] = face as u32;
            next[v as usize] += 1;
        }
    }
    (starts, around)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two squares that share the edge x = 1 and meet at `angle` from flat.
    fn folded(angle: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let (s, c) = angle.sin_cos();
        let positions = vec![
            vec3(0.0, 0.0, 0.0),
            vec3(1.0, 0.0, 0.0),
            vec3(1.0, 1.0, 0.0),
            vec3(0.0, 1.0, 0.0),
            vec3(1.0 + c, 0.0, s),
            vec3(1.0 + c, 1.0, s),
        ];
        (positions, vec![[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]])
    }

    #[test]
    fn a_shallow_fold_is_smooth_and_a_sharp_one_keeps_its_edge() {
        let (positions, faces) = folded(0.3);
        let normals = corner_normals(&positions, &faces, OBSTACLE_CREASE);
        assert!((normals[0][1] - normals[2][0]).length() < 1e-6);
        let (positions, faces) = folded(1.5);
        let normals = corner_normals(&positions, &faces, OBSTACLE_CREASE);
        assert!((normals[0][1] - vec3(0.0, 0.0, 1.0)).length() < 1e-6);
    }

    #[test]
    fn the_normal_does_not_depend_on_how_squares_are_cut() {
        // Vertex 1 has one face on the left and two on the right: with weights by angle both sides count the same.
        let (positions, faces) = folded(0.4);
        let normal = corner_normals(&positions, &faces, SHELL_CREASE)[0][1];
        let expected = vec3(-(0.2f32.sin()), 0.0, 0.2f32.cos());
        assert!((normal - expected).length() < 1e-6, "{normal:?}");
    }

    #[test]
    fn faces_without_area_have_no_nan_normals() {
        let positions = vec![Vec3::default(); 3];
        assert_eq!(
            corner_normals(&positions, &[[0, 1, 2]], 0.5)[0],
            [Vec3::default(); 3]
        );
    }
}
