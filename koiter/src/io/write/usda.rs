//! Universal Scene Description as text (`.usda`): a mesh a part, with points and fields over time.
//!
//! The stage says `metersPerUnit = 1` and its up axis. Time codes are seconds times [`FRAMES_PER_SECOND`], so that a player at
//! that rate shows the run in its own time; frames need not lie at whole codes. Fields are primvars, uniform at faces. Faces that
//! burn away are faces over time. Reference: the Universal Scene Description documentation, `UsdGeomMesh`.

use std::fmt::{Display, Write};
use std::path::Path;

use super::film::Film;
use super::{WriteError, as_word, write_file};
use crate::Vec3;
use crate::io::result::{Frame, ResultReader, UpAxis};

/// Time codes a second.
const FRAMES_PER_SECOND: f64 = 24.0;

/// Some frames of a result as a USDA file; of one frame, without times.
///
/// # Errors
/// A frame that cannot be read, fields that are not those of the first frame.
///
/// # Panics
/// No frames.
pub fn usda_bytes(result: &ResultReader, frames: &[usize]) -> Result<Vec<u8>, WriteError> {
    let film = Film::new(result, frames, "USD");
    let manifest = result.manifest();
    let mut meshes: Vec<Mesh> = Vec::new();
    let mut codes = Vec::new();
    film.visit(|frame| {
        let code = FRAMES_PER_SECOND * frame.time;
        codes.push(code);
        meshes.resize_with(manifest.parts.len(), Mesh::default);
        for (part, mesh) in meshes.iter_mut().enumerate() {
            mesh.add(result, frame, part, code);
        }
        Ok(())
    })?;
    let mut text = header(manifest.up_axis, &manifest.title, &codes);
    let names = distinct_names(manifest.parts.iter().map(|part| part.name.as_str()));
    for (name, mesh) in names.iter().zip(meshes) {
        mesh.write(&mut text, name);
    }
    text.push_str("}\n");
    Ok(text.into_bytes())
}

/// Writes [`usda_bytes`] to a file.
///
/// # Errors
/// Those of [`usda_bytes`], a refusal of the system.
///
/// # Panics
/// No frames.
pub fn write_usda(path: &Path, result: &ResultReader, frames: &[usize]) -> Result<(), WriteError> {
    write_file(path, &usda_bytes(result, frames)?)
}

fn header(up_axis: UpAxis, title: &str, codes: &[f64]) -> String {
    let axis = if up_axis == UpAxis::Y { "Y" } else { "Z" };
    let (first, last) = (codes[0], codes[codes.len() - 1]);
    let title: String = title.chars().filter(|c| !c.is_control()).collect();
    let title = title.replace('\\', "\\\\").replace('"', "\\\"");
    let mut text = format!(
        "#usda 1.0\n(\n    defaultPrim = \"Koiter\"\n    doc = \"Koiter: {title}\"\n    metersPerUnit = 1\n    upAxis = \"{axis}\"\n"
    );
    if codes.len() > 1 {
        let rate = FRAMES_PER_SECOND;
        text += &format!(
            "    startTimeCode = {first}\n    endTimeCode = {last}\n    timeCodesPerSecond = {rate}\n    framesPerSecond = {rate}\n"
        );
    }
    text += ")\n\ndef Xform \"Koiter\"\n{\n";
    if up_axis == UpAxis::X {
        // Stages are y up or z up: a turn about y takes x to z.
        text += "    float xformOp:rotateY = -90\n    uniform token[] xformOpOrder = [\"xformOp:rotateY\"]\n";
    }
    text
}

/// Names of prims: words that do not begin with a digit, each once.
fn distinct_names<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut distinct: Vec<String> = Vec::new();
    for name in names {
        let mut word = as_word(name);
        if word.is_empty() || word.starts_with(|c: char| c.is_ascii_digit()) {
            word.insert(0, '_');
        }
        while distinct.contains(&word) {
            word.push('_');
        }
        distinct.push(word);
    }
    distinct
}

/// The attributes of one part as they grow, frame after frame.
#[derive(Default)]
struct Mesh {
    faces: Samples,
    counts: Samples,
    points: Samples,
    extent: Samples,
    /// Primvar, interpolation, values.
    fields: Vec<(String, &'static str, Samples)>,
}

impl Mesh {
    fn add(&mut self, result: &ResultReader, frame: &Frame, part: usize, code: f64) {
        let part = &result.parts_in(frame)[part];
        let offset = part.vertices.start as u32;
        let faces = &result.faces_in(frame)[part.faces.clone()];
        let corners = faces.iter().flatten().map(|vertex| vertex - offset);
        self.faces.add(code, list(corners));
        self.counts.add(code, list(faces.iter().map(|_| 3)));
        let positions = &frame.positions[part.vertices.clone()];
        self.points.add(code, list(positions.iter().map(point)));
        self.extent
            .add(code, list(extent(positions).iter().map(point)));
        let fields = (frame
            .vertex_fields
            .iter()
            .map(|f| (f, "vertex", &part.vertices)))
        .chain(
            frame
                .face_fields
                .iter()
                .map(|f| (f, "uniform", &part.faces)),
        );
        let mut names = Vec::new();
        for (number, (field, interpolation, range)) in fields.enumerate() {
            names.push(field.name.as_str());
            if self.fields.len() == number {
                let name = distinct_names(names.iter().copied())
                    .pop()
                    .unwrap_or_default();
                self.fields.push((name, interpolation, Samples::default()));
            }
            let values = field.values[range.clone()]
                .iter()
                .map(|&value| float(value));
            self.fields[number].2.add(code, list(values));
        }
    }

    fn write(self, text: &mut String, name: &str) {
        *text += &format!("    def Mesh \"{name}\"\n    {{\n");
        *text += "        uniform token subdivisionScheme = \"none\"\n";
        *text += "        uniform bool doubleSided = 1\n";
        self.extent.write(text, "float3[] extent", "");
        self.counts.write(text, "int[] faceVertexCounts", "");
        self.faces.write(text, "int[] faceVertexIndices", "");
        self.points.write(text, "point3f[] points", "");
        for (field, interpolation, samples) in self.fields {
            let metadata =
                format!(" (\n            interpolation = \"{interpolation}\"\n        )");
            let attribute = format!("float[] primvars:{field}");
            samples.write(text, &attribute, &metadata);
        }
        *text += "    }\n";
    }
}

/// Values of an attribute at time codes. What stays the same is kept at its first and its last code: between samples USD goes
/// on linearly.
#[derive(Default)]
struct Samples {
    kept: Vec<(f64, String)>,
    /// Up to when the last one holds.
    until: Option<f64>,
}

impl Samples {
    fn add(&mut self, code: f64, value: String) {
        match self.kept.last() {
            Some((_, last)) if *last == value => self.until = Some(code),
            last => {
                if let (Some(until), Some((_, last))) = (self.until.take(), last) {
                    self.kept.push((until, last.clone()));
                }
                self.kept.push((code, value));
            }
        }
    }

    fn write(self, text: &mut String, attribute: &str, metadata: &str) {
        if let [(_, value)] = &self.kept[..] {
            *text += &format!("        {attribute} = {value}{metadata}\n");
            return;
        }
        if !metadata.is_empty() {
            *text += &format!("        {attribute}{metadata}\n");
        }
        *text += &format!("        {attribute}.timeSamples = {{\n");
        for (code, value) in self.kept {
            *text += &format!("            {code}: {value},\n");
        }
        *text += "        }\n";
    }
}

fn list<T: Display>(items: impl Iterator<Item = T>) -> String {
    let mut text = String::from("[");
    for (index, item) in items.enumerate() {
        let comma = if index == 0 { "" } else { ", " };
        write!(text, "{comma}{item}").expect("writing to a string cannot fail");
    }
    text.push(']');
    text
}

fn point(x: &Vec3) -> String {
    let [x, y, z] = [x.x, x.y, x.z].map(|value| float(value as f32));
    format!("({x}, {y}, {z})")
}

/// In single precision, as the schema has it; USD spells what is not a number in small letters.
fn float(value: f32) -> String {
    match value.is_nan() {
        true => "nan".to_string(),
        false => value.to_string(),
    }
}

/// The lowest and the highest corner of a box around points; two points at the origin where there are none.
fn extent(positions: &[Vec3]) -> [Vec3; 2] {
    let start = positions.first().copied().unwrap_or_default();
    positions
        .iter()
        .fold([start, start], |[low, high], x| [low.inf(x), high.sup(x)])
}
