//! glTF 2.0, binary: what browsers, Blender and phones open, a still or a film in one file.
//!
//! A film is a shape a frame (a morph target): the first frame is the mesh, every further one is added to it with a
//! weight that is 1 at its time and 0 at those of the others, so that shapes between frames are linear in time. Shells
//! have normals at their vertices; obstacles have none, by which the format means flat triangles: boxes keep their
//! edges. The format is y up and in metres; one node above all parts turns them.

mod container;

use std::path::Path;

use serde_json::{Value, json};

use super::{WriteError, write_file};
use crate::Vec3;
use crate::io::result::{Frame, Part, PartKind, ResultReader, UpAxis};
use container::Arrays;

/// How a result looks.
#[derive(Clone, Debug)]
pub struct GlbLook {
    /// Linear red, green and blue of each part, 0 to 1.
    pub part_colors: Vec<[f32; 3]>,
    /// Linear colours of all vertices instead, where the part's colour is white.
    pub vertex_colors: Option<Vec<[f32; 3]>>,
}

/// Most frames of a film: browsers keep the shapes in layers of a texture, of which all have 256.
pub const MAX_GLB_FRAMES: usize = 200;

/// The frames of a film that are written: all of `count`, or every second, third, …, and always the first.
pub fn glb_frames(count: usize) -> Vec<usize> {
    let stride = count.div_ceil(MAX_GLB_FRAMES).max(1);
    (0..count).step_by(stride).collect()
}

/// The GLB file of some frames of a result: of one, a still; of several, a film.
///
/// # Errors
/// A frame that cannot be read, a coordinate beyond single precision, more than 4 GiB.
///
/// # Panics
/// No frames, or colours that are not one a part and one a vertex.
pub fn glb_bytes(
    result: &ResultReader,
    frames: &[usize],
    look: &GlbLook,
) -> Result<Vec<u8>, WriteError> {
    assert!(!frames.is_empty(), "a GLB file has at least one frame");
    let first = read(result, frames[0])?;
    if frames.len() > 1 && first.topology.is_some() {
        return Err(WriteError::ChangingFaces { format: "GLB" });
    }
    let parts = result.parts_in(&first);
    assert_eq!(look.part_colors.len(), parts.len(), "one colour a part");
    let times = frame_times(result, frames)?;
    let mut arrays = Arrays::default();
    let mut shapes: Vec<Shape> = parts
        .iter()
        .map(|part| Shape::new(part, result, &first, look, &mut arrays))
        .collect();
    let moving = moving_parts(result, frames, &first)?;
    for &index in &frames[1..] {
        let frame = read(result, index)?;
        for (shape, _) in shapes.iter_mut().zip(&moving).filter(|(_, moves)| **moves) {
            shape.add_target(&frame, &mut arrays);
        }
    }
    let document = document(result, &shapes, &times, look, &mut arrays);
    arrays.into_file(document).ok_or(WriteError::TooLarge {
        what: "a GLB file holds at most 4 GiB",
    })
}

/// Writes [`glb_bytes`] to a file.
///
/// # Errors
/// Those of [`glb_bytes`], a refusal of the system.
pub fn write_glb(
    path: &Path,
    result: &ResultReader,
    frames: &[usize],
    look: &GlbLook,
) -> Result<(), WriteError> {
    write_file(path, &glb_bytes(result, frames, look)?)
}

/// A frame whose coordinates are finite in single precision.
fn read(result: &ResultReader, index: usize) -> Result<Frame, WriteError> {
    let frame = result.frame(index)?;
    let limit = f64::from(f32::MAX) / 4.0;
    match frame.positions.iter().position(|x| x.amax() > limit) {
        None => Ok(frame),
        Some(_) => Err(WriteError::TooLarge {
            what: "a coordinate is beyond the single precision of GLB",
        }),
    }
}

fn frame_times(result: &ResultReader, frames: &[usize]) -> Result<Vec<f32>, WriteError> {
    let mut times: Vec<f32> = Vec::with_capacity(frames.len());
    for &index in frames {
        let time = result.frame_info(index)?.time as f32;
        // Times must increase, also those of steps that single precision cannot tell apart.
        times.push(times.last().map_or(time, |last| time.max(last.next_up())));
    }
    Ok(times)
}

/// Which parts are not where they are in the first frame.
fn moving_parts(
    result: &ResultReader,
    frames: &[usize],
    first: &Frame,
) -> Result<Vec<bool>, WriteError> {
    let parts = &result.manifest().parts;
    let mut moving = vec![false; parts.len()];
    for &index in &frames[1..] {
        let frame = result.frame(index)?;
        for (part, moving) in parts.iter().zip(&mut moving) {
            let range = part.vertices.clone();
            *moving |= frame.positions[range.clone()] != first.positions[range];
        }
    }
    Ok(moving)
}

/// One part as it is written.
struct Shape<'a> {
    part: &'a Part,
    /// Faces by the part's own vertex numbers.
    faces: Vec<[u32; 3]>,
    positions: Vec<[f32; 3]>,
    /// Empty for an obstacle.
    normals: Vec<[f32; 3]>,
    attributes: Value,
    indices: usize,
    targets: Vec<Value>,
}

impl<'a> Shape<'a> {
    fn new(
        part: &'a Part,
        result: &ResultReader,
        frame: &Frame,
        look: &GlbLook,
        arrays: &mut Arrays,
    ) -> Self {
        let offset = part.vertices.start as u32;
        let faces: Vec<[u32; 3]> = result.faces_in(frame)[part.faces.clone()]
            .iter()
            .map(|corners| corners.map(|vertex| vertex - offset))
            .collect();
        let mut shape = Self {
            part,
            indices: arrays.push_indices(faces.as_flattened()),
            faces,
            positions: Vec::new(),
            normals: Vec::new(),
            attributes: json!({}),
            targets: Vec::new(),
        };
        (shape.positions, shape.normals) = shape.at(frame);
        shape.attributes["POSITION"] = json!(arrays.push_positions(&shape.positions));
        if !shape.normals.is_empty() {
            shape.attributes["NORMAL"] = json!(arrays.push_normals(&shape.normals));
        }
        if let Some(colors) = &look.vertex_colors {
            let level = |light: f32| (light.clamp(0.0, 1.0) * 65535.0).round() as u16;
            let colors: Vec<[u16; 4]> = colors[part.vertices.clone()]
                .iter()
                .map(|&[r, g, b]| [level(r), level(g), level(b), u16::MAX])
                .collect();
            shape.attributes["COLOR_0"] = json!(arrays.push_colors(&colors));
        }
        shape
    }

    /// Positions and normals of a frame.
    fn at(&self, frame: &Frame) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
        let positions = &frame.positions[self.part.vertices.clone()];
        let normals = match self.part.kind {
            PartKind::Shell => vertex_normals(positions, &self.faces),
            PartKind::Obstacle => Vec::new(),
        };
        let single = |x: &Vec3| [x.x as f32, x.y as f32, x.z as f32];
        (
            positions.iter().map(single).collect(),
            normals.iter().map(single).collect(),
        )
    }

    /// Adds the differences to the first frame.
    fn add_target(&mut self, frame: &Frame, arrays: &mut Arrays) {
        let difference = |to: &[[f32; 3]], from: &[[f32; 3]]| -> Vec<[f32; 3]> {
            let pairs = to.iter().zip(from);
            pairs
                .map(|(to, from)| std::array::from_fn(|axis| to[axis] - from[axis]))
                .collect()
        };
        let (positions, normals) = self.at(frame);
        let positions = difference(&positions, &self.positions);
        let mut target = json!({ "POSITION": arrays.push_positions(&positions) });
        if !normals.is_empty() {
            let normals = difference(&normals, &self.normals);
            target["NORMAL"] = json!(arrays.push_normals(&normals));
        }
        self.targets.push(target);
    }

    fn mesh(&self, material: usize, target_names: &[String]) -> Value {
        let mut primitive = json!({
            "attributes": self.attributes,
            "indices": self.indices,
            "material": material,
        });
        let mut mesh = json!({ "name": self.part.name });
        if !self.targets.is_empty() {
            primitive["targets"] = json!(self.targets);
            // Where Blender and three.js look for names of shapes.
            mesh["extras"] = json!({ "targetNames": target_names });
        }
        mesh["primitives"] = json!([primitive]);
        mesh
    }
}

/// Unit normals at vertices, the mean of their faces by area; up where there is none.
fn vertex_normals(positions: &[Vec3], faces: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::zeros(); positions.len()];
    for face in faces {
        let [a, b, c] = face.map(|vertex| positions[vertex as usize]);
        let doubled = (b - a).cross(&(c - a));
        face.iter()
            .for_each(|&vertex| sums[vertex as usize] += doubled);
    }
    sums.into_iter()
        .map(|sum| sum.try_normalize(0.0).unwrap_or(Vec3::z()))
        .collect()
}

fn document(
    result: &ResultReader,
    shapes: &[Shape],
    times: &[f32],
    look: &GlbLook,
    arrays: &mut Arrays,
) -> Value {
    let manifest = result.manifest();
    let names: Vec<String> = times[1..].iter().map(|t| format!("t = {t} s")).collect();
    let each = |item: &dyn Fn(usize) -> Value| (0..shapes.len()).map(item).collect::<Vec<_>>();
    let materials = each(&|part| material(&manifest.parts[part], look.part_colors[part], look));
    let mut nodes = each(&|part| json!({ "name": manifest.parts[part].name, "mesh": part }));
    let root = nodes.len();
    let mut above = json!({ "name": "Koiter", "children": (0..root).collect::<Vec<_>>() });
    if let Some(rotation) = rotation_to_y_up(manifest.up_axis) {
        above["rotation"] = json!(rotation);
    }
    nodes.push(above);
    let mut document = json!({
        "asset": { "version": "2.0", "generator": format!("Koiter {}", manifest.version) },
        "scene": 0,
        "scenes": [{ "name": manifest.title, "nodes": [root], "extras": { "times": times } }],
        "nodes": nodes,
        "meshes": each(&|part| shapes[part].mesh(part, &names)),
        "materials": materials,
    });
    if shapes.iter().any(|shape| !shape.targets.is_empty()) {
        document["animations"] = json!([animation(shapes, times, arrays)]);
    }
    document
}

fn material(part: &Part, [r, g, b]: [f32; 3], look: &GlbLook) -> Value {
    let color = match look.vertex_colors {
        Some(_) => [1.0, 1.0, 1.0, 1.0],
        None => [r, g, b, 1.0],
    };
    json!({
        "name": part.name,
        "doubleSided": true,
        "pbrMetallicRoughness": {
            "baseColorFactor": color,
            "metallicFactor": 0.0,
            "roughnessFactor": 0.8,
        },
    })
}

/// At each time the weights of all shapes: of the one of this time 1, of the others 0.
fn animation(shapes: &[Shape], times: &[f32], arrays: &mut Arrays) -> Value {
    let num_targets = times.len() - 1;
    let mut weights = vec![0.0; times.len() * num_targets];
    for target in 0..num_targets {
        weights[(target + 1) * num_targets + target] = 1.0;
    }
    let input = arrays.push_times(times);
    let output = arrays.push_weights(&weights);
    let moving = (0..shapes.len()).filter(|&part| !shapes[part].targets.is_empty());
    let channels: Vec<Value> = moving
        .map(|node| json!({ "sampler": 0, "target": { "node": node, "path": "weights" } }))
        .collect();
    json!({
        "name": "run",
        "channels": channels,
        "samplers": [{ "input": input, "interpolation": "LINEAR", "output": output }],
    })
}

/// The quaternion (x, y, z, w) that turns the up axis to y.
fn rotation_to_y_up(up: UpAxis) -> Option<[f64; 4]> {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    match up {
        UpAxis::X => Some([0.0, 0.0, half, half]),
        UpAxis::Y => None,
        UpAxis::Z => Some([-half, 0.0, 0.0, half]),
    }
}

#[cfg(test)]
mod tests;
