//! A document as TOML text again: the scene as it was run, overrides included.

use std::fmt::Write;

use super::{Document, Node, Table, Value};

impl Document {
    /// TOML text with the same values: variants picked, overrides applied, comments gone.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        if let Value::Table(root) = &self.root.value {
            let is_list = |node: &Node| as_tables(node).is_some();
            for entry in root.entries.iter().filter(|entry| !is_list(&entry.node)) {
                push_entry(&mut text, &entry.key, &entry.node);
            }
            for entry in &root.entries {
                for table in as_tables(&entry.node).into_iter().flatten() {
                    let _ = writeln!(text, "\n[[{}]]", quote_key(&entry.key));
                    for inner in &table.entries {
                        push_entry(&mut text, &inner.key, &inner.node);
                    }
                }
            }
        }
        text
    }
}

/// The tables of a list of tables.
fn as_tables(node: &Node) -> Option<Vec<&Table>> {
    let Value::List(items) = &node.value else {
        return None;
    };
    let tables = items.iter().map(|item| match &item.value {
        Value::Table(table) => Some(table),
        _ => None,
    });
    tables
        .collect::<Option<Vec<_>>>()
        .filter(|tables| !tables.is_empty())
}

fn push_entry(text: &mut String, key: &str, node: &Node) {
    let _ = writeln!(text, "{} = {}", quote_key(key), inline(node));
}

pub(super) fn inline(node: &Node) -> String {
    match &node.value {
        Value::Bool(value) => value.to_string(),
        Value::Integer(value) => value.to_string(),
        // `{:?}` keeps every digit and a point or exponent, as TOML wants of a float.
        Value::Float(value) => format!("{value:?}"),
        Value::Text(value) => toml_edit::Value::from(value.as_str()).to_string(),
        Value::List(items) => {
            let items: Vec<String> = items.iter().map(inline).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Table(table) => {
            let entries = table.entries.iter();
            let entries: Vec<String> = entries
                .map(|e| format!("{} = {}", quote_key(&e.key), inline(&e.node)))
                .collect();
            match entries.is_empty() {
                true => "{}".to_owned(),
                false => format!("{{ {} }}", entries.join(", ")),
            }
        }
    }
}

fn quote_key(key: &str) -> String {
    let bare = !key.is_empty()
        && key
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || "_-".contains(c));
    match bare {
        true => key.to_owned(),
        false => toml_edit::Value::from(key).to_string(),
    }
}
