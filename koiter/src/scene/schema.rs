//! The JSON Schema (draft 2020-12) of scene files, for editors that complete and check them.
//!
//! It is derived from the types that read a scene, so it has their keys, defaults and, as descriptions, their
//! documentation with units. It is weaker than [`super::SceneFile::parse`] in what it refuses: ranges, names that must
//! exist and keys that exclude each other are left to that.

use schemars::generate::SchemaSettings;
use schemars::transform::{Transform, transform_subschemas};
use schemars::{Schema, SchemaGenerator, json_schema as schema};
use serde_json::{Value, json};

use super::spec::{ENERGY_NAMES, FIELD_NAMES, MaterialSpec, SceneSpec};
use crate::material::presets;

/// The schema as a JSON object.
pub fn json_schema() -> Value {
    let mut root = SchemaSettings::draft2020_12()
        .with_transform(WithoutNull)
        .into_generator()
        .into_root_schema_for::<SceneSpec>();
    root.insert("title".into(), json!("Koiter scene"));
    if let Some(properties) = root.get_mut("properties").and_then(Value::as_object_mut) {
        properties.insert("variants".into(), variants());
    }
    root.to_value()
}

/// `material`: a name, or a table.
pub(super) fn material(generator: &mut SchemaGenerator) -> Schema {
    let table = generator.subschema_for::<MaterialSpec>();
    schema!({ "anyOf": [preset_name(generator), table] })
}

/// Names of the presets.
pub(in crate::scene) fn preset_name(_: &mut SchemaGenerator) -> Schema {
    schema!({ "type": "string", "enum": presets::ALL.map(|preset| preset.name) })
}

/// An energy.
pub(super) fn energy_name(_: &mut SchemaGenerator) -> Schema {
    schema!({ "anyOf": [{ "type": "string", "enum": ENERGY_NAMES }, { "type": "string" }] })
}

/// A field of a run.
pub(super) fn field_name(_: &mut SchemaGenerator) -> Schema {
    schema!({ "type": "string", "enum": FIELD_NAMES })
}

/// Fields of a run.
pub(super) fn field_names(generator: &mut SchemaGenerator) -> Schema {
    schema!({ "type": "array", "items": field_name(generator) })
}

/// Sets of overrides, taken out of a scene before its keys are read.
fn variants() -> Value {
    json!({
        "description": "Sets of overrides by dotted path; --set GROUP=NAME picks one of a group.",
        "type": "object",
        "additionalProperties": {
            "type": "object",
            "properties": {
                "default": {
                    "description": "Name of the set that holds without --set.",
                    "type": ["string", "integer"]
                }
            },
            "additionalProperties": { "description": "Overrides.", "type": "object" }
        }
    })
}

/// TOML has no null: an optional key is left out, and the infinite default of a box has no number.
#[derive(Clone, Debug)]
struct WithoutNull;

impl Transform for WithoutNull {
    fn transform(&mut self, schema: &mut Schema) {
        transform_subschemas(self, schema);
        if schema.get("default").is_some_and(has_null) {
            schema.remove("default");
        }
        if let Some(Value::Array(types)) = schema.get_mut("type") {
            types.retain(|name| name != "null");
            if let [only] = &types[..] {
                let only = only.clone();
                schema.insert("type".into(), only);
            }
        }
        if let Some(Value::Array(choices)) = schema.get_mut("anyOf") {
            choices.retain(|choice| choice["type"] != "null");
            if let [Value::Object(only)] = &choices[..] {
                let only = only.clone();
                schema.remove("anyOf");
                // A description at the key says more than that of the type.
                for (key, value) in only {
                    schema.ensure_object().entry(key).or_insert(value);
                }
            }
        }
    }
}

fn has_null(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::Array(items) => items.iter().any(has_null),
        _ => false,
    }
}

#[cfg(test)]
mod tests;
