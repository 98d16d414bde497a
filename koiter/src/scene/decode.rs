//! From the tree of values to typed structs, by serde, with errors that know their place.
//!
//! Only what scene files need: structs, lists, tuples, options, numbers, text, and enums without data.

use std::fmt::Display;

use serde::de::{self, DeserializeOwned, DeserializeSeed, Expected, IntoDeserializer, Unexpected};

use super::document::{Node, Table, Value, element_segment, suggest};
use super::error::{SceneError, SceneErrorKind};

/// Reads a typed value; unknown keys, wrong types and missing keys are errors at their place.
pub(super) fn decode<T: DeserializeOwned>(root: &Node) -> Result<T, SceneError> {
    T::deserialize(root)
}

impl de::Error for SceneError {
    fn custom<T: Display>(message: T) -> Self {
        Self::new(SceneErrorKind::WrongType, message.to_string())
    }

    fn invalid_type(_: Unexpected<'_>, expected: &dyn Expected) -> Self {
        // What was found is told where the node is known.
        Self::new(
            SceneErrorKind::WrongType,
            plain_words(&expected.to_string()),
        )
    }

    fn invalid_value(_: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::new(
            SceneErrorKind::WrongType,
            plain_words(&expected.to_string()),
        )
    }

    fn invalid_length(_: usize, expected: &dyn Expected) -> Self {
        Self::new(
            SceneErrorKind::WrongType,
            plain_words(&expected.to_string()),
        )
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        Self::new(SceneErrorKind::UnknownKey, format!("unknown key '{field}'"))
            .with_help(suggest(field, expected))
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        Self::new(
            SceneErrorKind::UnknownName,
            format!("unknown name '{variant}'"),
        )
        .with_help(suggest(variant, expected))
    }

    fn missing_field(field: &'static str) -> Self {
        Self::new(
            SceneErrorKind::MissingKey,
            format!("the key '{field}' is missing"),
        )
    }
}

/// Serde's names of types, in the words of a scene file.
fn plain_words(expected: &str) -> String {
    let words = match expected {
        "f64" => "a number",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number, 0 or larger",
        "i64" => "a whole number",
        "a string" => "text in quotes",
        "a boolean" => "true or false",
        "a sequence" => "a list",
        "a tuple of size 2" => "a pair [time, value]",
        "an array of length 2" => "a list of 2 values",
        "an array of length 3" => "a list of 3 numbers [x, y, z]",
        other if other.starts_with("struct ") => "a table",
        other => other,
    };
    format!("expected {words}")
}

/// Tells what was found, and where.
fn finish(error: SceneError, node: &Node) -> SceneError {
    let mut error = error;
    if error.location.is_none() && error.kind == SceneErrorKind::WrongType {
        error.message = format!("{}, found {}", error.message, node.describe());
    }
    error.or_at(Some(&node.location))
}

impl<'de> de::Deserializer<'de> for &'de Node {
    type Error = SceneError;

    fn deserialize_any<V: de::Visitor<'de>>(self, visitor: V) -> Result<V::Value, SceneError> {
        match &self.value {
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::Integer(value) => visitor.visit_i64(*value),
            Value::Float(value) => visitor.visit_f64(*value),
            Value::Text(value) => visitor.visit_borrowed_str(value),
            Value::List(items) => visit_list(items, visitor),
            Value::Table(table) => visitor.visit_map(MapAccess::new(table)),
        }
        .map_err(|error| finish(error, self))
    }

    fn deserialize_option<V: de::Visitor<'de>>(self, visitor: V) -> Result<V::Value, SceneError> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: de::Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, SceneError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: de::Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, SceneError> {
        match &self.value {
            Value::Text(name) => {
                let name: de::value::StrDeserializer<'_, SceneError> =
                    name.as_str().into_deserializer();
                visitor.visit_enum(name)
            }
            _ => Err(SceneError::new(
                SceneErrorKind::WrongType,
                format!("expected one of the names {}", variants.join(", ")),
            )),
        }
        .map_err(|error| finish(error, self))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq
        tuple tuple_struct map struct identifier ignored_any
    }
}

/// Serde asks a list only for as many elements as it wants: what is left over is an error too.
fn visit_list<'de, V: de::Visitor<'de>>(
    items: &'de [Node],
    visitor: V,
) -> Result<V::Value, SceneError> {
    let expected = plain_words(&(&visitor as &dyn Expected).to_string());
    let mut access = ListAccess { items, next: 0 };
    let value = visitor.visit_seq(&mut access)?;
    if access.next < items.len() {
        return Err(SceneError::new(SceneErrorKind::WrongType, expected));
    }
    Ok(value)
}

struct ListAccess<'de> {
    items: &'de [Node],
    next: usize,
}

impl<'de> de::SeqAccess<'de> for &mut ListAccess<'de> {
    type Error = SceneError;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, SceneError> {
        let Some(node) = self.items.get(self.next) else {
            return Ok(None);
        };
        let index = self.next;
        self.next += 1;
        seed.deserialize(node)
            .map(Some)
            .map_err(|error| error.inside(&element_segment(index, node)))
    }
}

struct MapAccess<'de> {
    table: &'de Table,
    next: usize,
}

impl<'de> MapAccess<'de> {
    fn new(table: &'de Table) -> Self {
        Self { table, next: 0 }
    }
}

impl<'de> de::MapAccess<'de> for MapAccess<'de> {
    type Error = SceneError;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, SceneError> {
        let Some(entry) = self.table.entries.get(self.next) else {
            return Ok(None);
        };
        let key: de::value::BorrowedStrDeserializer<'de, SceneError> =
            de::value::BorrowedStrDeserializer::new(&entry.key);
        seed.deserialize(key)
            .map(Some)
            .map_err(|error| error.inside(&entry.key).or_at(Some(&entry.key_location)))
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(
        &mut self,
        seed: V,
    ) -> Result<V::Value, SceneError> {
        let entry = &self.table.entries[self.next];
        self.next += 1;
        seed.deserialize(&entry.node)
            .map_err(|error| error.inside(&entry.key))
    }
}
