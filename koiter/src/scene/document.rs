//! The scene as a tree of values that know where they were typed.
//!
//! Everything that can be wrong with a scene is said of a dotted path (`shell.cloth.material.young`), and
//! [`Document::locate`] is the one place where a path becomes a place in a text. Elements of a list are addressed by
//! their `name`, or by their number from 0.

pub use difference::Difference;
pub(super) use overlay::suggest;

mod difference;
mod overlay;
mod parse;
mod short_form;
mod write;

use std::sync::Arc;

use super::error::{Location, SceneError, Source};

/// A scene file with its overrides applied.
#[derive(Clone, Debug)]
pub struct Document {
    pub(super) root: Node,
}

/// A value and where it was typed.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) value: Value,
    pub(super) location: Location,
}

#[derive(Clone, Debug)]
pub(super) enum Value {
    Bool(bool),
    Integer(i64),
    Float(f64),
    Text(String),
    List(Vec<Node>),
    Table(Table),
}

#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    pub(super) entries: Vec<Entry>,
    /// Made by dotted keys (`a.b = 1`): an overlay then merges it, key by key, instead of replacing.
    pub(super) dotted: bool,
}

#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) key: String,
    pub(super) key_location: Location,
    pub(super) node: Node,
}

impl Document {
    /// Reads a scene file; picks variants and applies overrides, each a `KEY=VALUE` text.
    ///
    /// # Errors
    /// Text that is no TOML, in the file or in an override; an override of an element that does not exist; a variant
    /// that does not exist.
    pub fn parse(name: &str, text: &str, overrides: &[String]) -> Result<Self, SceneError> {
        let root = parse::parse_toml(Arc::new(Source {
            name: name.to_owned(),
            text: text.to_owned(),
        }))?;
        let mut document = Self { root };
        let overrides = overrides
            .iter()
            .map(|text| parse::parse_override(text))
            .collect::<Result<Vec<_>, _>>()?;
        // Before the overrides, so that they can set the inner keys of a short form, and after, since they may have some.
        short_form::expand_short_forms(&mut document.root);
        overlay::apply(&mut document, overrides)?;
        short_form::expand_short_forms(&mut document.root);
        Ok(document)
    }

    /// A document without text, for scenes made by a program.
    pub fn empty() -> Self {
        let source = Arc::new(Source {
            name: String::new(),
            text: String::new(),
        });
        let root = Node {
            value: Value::Table(Table::default()),
            location: Location { source, span: 0..0 },
        };
        Self { root }
    }

    /// Where a dotted path was typed, or else the nearest table around it; `None` in an empty document.
    pub fn locate(&self, path: &str) -> Option<Location> {
        if self.root.location.source.text.is_empty() {
            return None;
        }
        let mut node = &self.root;
        for segment in path.split('.').filter(|segment| !segment.is_empty()) {
            match node.child(segment) {
                Some(child) => node = child,
                None => break,
            }
        }
        Some(node.location.clone())
    }

    /// Gives an error that has a path its place.
    pub(super) fn place(&self, mut error: SceneError) -> SceneError {
        if error.location.is_none() {
            error.location = self.locate(&error.path);
        }
        error
    }
}

impl Node {
    /// The entry of a table, or the element of a list by name or number.
    pub(super) fn child(&self, segment: &str) -> Option<&Self> {
        match &self.value {
            Value::Table(table) => table.get(segment),
            Value::List(items) => items.get(find_element(items, segment)?),
            _ => None,
        }
    }

    /// What the value is, in a message.
    pub(super) fn describe(&self) -> String {
        match &self.value {
            Value::Bool(value) => format!("{value}"),
            Value::Integer(value) => format!("the number {value}"),
            Value::Float(value) => format!("the number {value}"),
            Value::Text(value) => format!("the text \"{value}\""),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Table(_) => "a table".to_owned(),
        }
    }

    /// The `name` entry of a table.
    pub(super) fn name(&self) -> Option<&str> {
        let Value::Table(table) = &self.value else {
            return None;
        };
        match &table.get("name")?.value {
            Value::Text(name) => Some(name),
            _ => None,
        }
    }
}

impl Table {
    pub(super) fn get(&self, key: &str) -> Option<&Node> {
        let entry = self.entries.iter().find(|entry| entry.key == key)?;
        Some(&entry.node)
    }

    /// Takes an entry out.
    fn remove(&mut self, key: &str) -> Option<Node> {
        let index = self.entries.iter().position(|entry| entry.key == key)?;
        Some(self.entries.remove(index).node)
    }
}

/// The path segment by which an element of a list is addressed.
pub(super) fn element_segment(index: usize, node: &Node) -> String {
    node.name()
        .map_or_else(|| index.to_string(), ToOwned::to_owned)
}

fn find_element(items: &[Node], segment: &str) -> Option<usize> {
    items
        .iter()
        .position(|item| item.name() == Some(segment))
        .or_else(|| segment.parse().ok().filter(|&index| index < items.len()))
}

#[cfg(test)]
mod tests;
