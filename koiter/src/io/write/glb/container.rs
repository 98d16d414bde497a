//! The container of glTF 2.0: arrays in one binary chunk, described by a JSON chunk before it.
//!
//! ```text
//! "glTF"  u32 version 2  u32 length
//! u32 length  "JSON"  JSON, padded with blanks
//! u32 length  "BIN\0"  arrays, padded with zeros
//! ```

use serde_json::{Value, json};

/// Codes of OpenGL that glTF took over.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const UNSIGNED_SHORT: u32 = 5123;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Arrays of one layout, which stand together in the file.
#[derive(Clone, Copy)]
enum View {
    Vectors,
    Colors,
    Indices,
    Scalars,
}

/// The arrays of a file, as they are collected.
#[derive(Default)]
pub(super) struct Arrays {
    views: [Vec<u8>; 4],
    accessors: Vec<Value>,
}

impl Arrays {
    /// Positions or what is added to them; the number of the array. They must be finite.
    pub(super) fn push_positions(&mut self, values: &[[f32; 3]]) -> usize {
        let bound = |pick: fn(f32, f32) -> f32| {
            let first = values.first().copied().unwrap_or_default();
            values.iter().fold(first, |bound, value| {
                std::array::from_fn(|axis| pick(bound[axis], value[axis]))
            })
        };
        let bounds = json!({ "min": bound(f32::min), "max": bound(f32::max) });
        self.push_vectors(values, bounds)
    }

    /// Normals or what is added to them.
    pub(super) fn push_normals(&mut self, values: &[[f32; 3]]) -> usize {
        self.push_vectors(values, json!({}))
    }

    fn push_vectors(&mut self, values: &[[f32; 3]], more: Value) -> usize {
        let bytes = values
            .iter()
            .flatten()
            .flat_map(|value| value.to_le_bytes());
        self.push(View::Vectors, bytes, FLOAT, "VEC3", values.len(), more)
    }

    /// Linear colours with an opacity, of which 65535 is 1.
    pub(super) fn push_colors(&mut self, values: &[[u16; 4]]) -> usize {
        let bytes = values
            .iter()
            .flatten()
            .flat_map(|value| value.to_le_bytes());
        let more = json!({ "normalized": true });
        self.push(
            View::Colors,
            bytes,
            UNSIGNED_SHORT,
            "VEC4",
            values.len(),
            more,
        )
    }

    /// Corners of triangles.
    pub(super) fn push_indices(&mut self, values: &[u32]) -> usize {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes());
        let count = values.len();
        self.push(
            View::Indices,
            bytes,
            UNSIGNED_INT,
            "SCALAR",
            count,
            json!({}),
        )
    }

    /// Increasing times.
    pub(super) fn push_times(&mut self, values: &[f32]) -> usize {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes());
        let more = json!({ "min": [values.first()], "max": [values.last()] });
        self.push(View::Scalars, bytes, FLOAT, "SCALAR", values.len(), more)
    }

    /// Weights of shapes.
    pub(super) fn push_weights(&mut self, values: &[f32]) -> usize {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes());
        self.push(
            View::Scalars,
            bytes,
            FLOAT,
            "SCALAR",
            values.len(),
            json!({}),
        )
    }

    fn push(
        &mut self,
        view: View,
        bytes: impl Iterator<Item = u8>,
        component: u32,
        kind: &str,
        count: usize,
        more: Value,
    ) -> usize {
        let array = &mut self.views[view as usize];
        let mut accessor = json!({
            "bufferView": view as usize,
            "byteOffset": array.len(),
            "componentType": component,
            "count": count,
            "type": kind,
        });
        array.extend(bytes);
        if let (Value::Object(accessor), Value::Object(more)) = (&mut accessor, more) {
            accessor.extend(more);
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// The file, whose JSON is `document` and the description of the arrays; `None` if it is longer than the format
    /// allows (4 GiB).
    pub(super) fn into_file(self, mut document: Value) -> Option<Vec<u8>> {
        let layouts = [
            json!({ "target": ARRAY_BUFFER, "byteStride": 12 }),
            json!({ "target": ARRAY_BUFFER, "byteStride": 8 }),
            json!({ "target": ELEMENT_ARRAY_BUFFER }),
            json!({}),
        ];
        // Views must not be empty, so those that are not used are left out and the others numbered anew.
        let mut number = [0; 4];
        let (mut views, mut binary) = (Vec::new(), Vec::new());
        for (index, (bytes, mut layout)) in self.views.into_iter().zip(layouts).enumerate() {
            if bytes.is_empty() {
                continue;
            }
            number[index] = views.len();
            layout["buffer"] = json!(0);
            layout["byteOffset"] = json!(binary.len());
            layout["byteLength"] = json!(bytes.len());
            views.push(layout);
            binary.extend(bytes);
        }
        let mut accessors = self.accessors;
        for accessor in &mut accessors {
            let view = accessor["bufferView"].as_u64().unwrap_or_default() as usize;
            accessor["bufferView"] = json!(number[view]);
        }
        document["accessors"] = Value::Array(accessors);
        document["bufferViews"] = Value::Array(views);
        document["buffers"] = json!([{ "byteLength": binary.len() }]);
        let mut text = document.to_string().into_bytes();
        // All arrays are of numbers of four or eight bytes, so the binary chunk needs no padding.
        text.resize(text.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + text.len() + 8 + binary.len();
        let mut file = Vec::with_capacity(length);
        file.extend(b"glTF");
        file.extend(2u32.to_le_bytes());
        file.extend(u32::try_from(length).ok()?.to_le_bytes());
        for (kind, chunk) in [(b"JSON", text), (b"BIN\0", binary)] {
            file.extend((chunk.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(chunk);
        }
        Some(file)
    }
}
