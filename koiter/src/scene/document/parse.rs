//! From TOML text to a tree with places.

use std::ops::Range;
use std::sync::Arc;

use toml_edit::{Item, TableLike};

use super::{Entry, Node, Table, Value};
use crate::scene::error::{Location, SceneError, SceneErrorKind, Source};

/// Reads a whole TOML text.
pub(super) fn parse_toml(source: Arc<Source>) -> Result<Node, SceneError> {
    let parsed = toml_edit::Document::parse(source.text.as_str());
    let document = parsed.map_err(|error| {
        let end = source.text.len();
        let span = error.span().unwrap_or(0..0);
        let span = span.start.min(end)..span.end.min(end);
        let location = Location {
            source: source.clone(),
            span,
        };
        let message = error.message().trim().replace('\n', "; ");
        SceneError::new(SceneErrorKind::Syntax, format!("not valid TOML: {message}"))
            .or_at(Some(&location))
    })?;
    let whole = 0..0;
    Ok(Node {
        value: Value::Table(convert_table(document.as_table(), &source, &whole, false)?),
        location: locate(&source, whole),
    })
}

/// Reads one `KEY=VALUE`. The value is TOML; a single bare word is taken as text, so that no shell quotes are needed.
pub(super) fn parse_override(text: &str) -> Result<Node, SceneError> {
    let source = Arc::new(Source {
        name: format!("--set {text}"),
        text: text.to_owned(),
    });
    let Some((key, value)) = text.split_once('=') else {
        let location = locate(&source, 0..text.len());
        return Err(SceneError::new(
            SceneErrorKind::Syntax,
            format!("an override is written KEY=VALUE, but \"{text}\" has no '='"),
        )
        .or_at(Some(&location)));
    };
    parse_toml(source.clone()).or_else(|error| {
        let word = value.trim();
        let bare = word.starts_with(|c: char| c.is_ascii_alphabetic() || "./_".contains(c))
            && word
                .chars()
                .all(|c| c.is_ascii_alphanumeric() || "./_-".contains(c));
        if !bare {
            return Err(error);
        }
        // Parsed again with quotes to have the keys; the places of keys are those of the text as typed.
        let quoted = parse_toml(Arc::new(Source {
            name: source.name.clone(),
            text: format!("{key}=\"{word}\""),
        }))
        .map_err(|_| error)?;
        let start = key.len() + 1 + value.find(word).unwrap_or(0);
        Ok(relocate(quoted, &source, start..start + word.len()))
    })
}

/// Moves keys to another copy of the same text and the one value at the end to `value_span`.
fn relocate(mut node: Node, source: &Arc<Source>, value_span: Range<usize>) -> Node {
    node.location = match &mut node.value {
        Value::Table(table) => {
            for entry in &mut table.entries {
                entry.key_location = locate(source, entry.key_location.span.clone());
                entry.node = relocate(entry.node.clone(), source, value_span.clone());
            }
            locate(source, node.location.span.clone())
        }
        _ => locate(source, value_span),
    };
    node
}

fn locate(source: &Arc<Source>, span: Range<usize>) -> Location {
    Location {
        source: source.clone(),
        span,
    }
}

fn convert_table(
    table: &dyn TableLike,
    source: &Arc<Source>,
    around: &Range<usize>,
    dotted: bool,
) -> Result<Table, SceneError> {
    let mut entries = Vec::with_capacity(table.len());
    for (name, item) in table.iter() {
        let key_span = table
            .get_key_value(name)
            .and_then(|(key, _)| key.span())
            .unwrap_or_else(|| around.clone());
        entries.push(Entry {
            key: name.to_owned(),
            node: convert_item(item, source, &key_span)?,
            key_location: locate(source, key_span),
        });
    }
    Ok(Table { entries, dotted })
}

fn convert_item(item: &Item, source: &Arc<Source>, key: &Range<usize>) -> Result<Node, SceneError> {
    match item {
        Item::Value(value) => convert_value(value, source, key),
        Item::Table(table) => {
            let span = table.span().unwrap_or_else(|| key.clone());
            let value = convert_table(table, source, &span, table.is_dotted())?;
            Ok(Node {
                value: Value::Table(value),
                location: locate(source, span),
            })
        }
        Item::ArrayOfTables(tables) => {
            let items = tables
                .iter()
                .map(|table| {
                    let span = table.span().unwrap_or_else(|| key.clone());
                    Ok(Node {
                        value: Value::Table(convert_table(table, source, &span, false)?),
                        location: locate(source, span),
                    })
                })
                .collect::<Result<Vec<_>, SceneError>>()?;
            Ok(Node {
                value: Value::List(items),
                location: locate(source, key.clone()),
            })
        }
        // The parser produces no such item; an empty table is what it would mean.
        Item::None => Ok(Node {
            value: Value::Table(Table::default()),
            location: locate(source, key.clone()),
        }),
    }
}

fn convert_value(
    value: &toml_edit::Value,
    source: &Arc<Source>,
    key: &Range<usize>,
) -> Result<Node, SceneError> {
    let span = value.span().unwrap_or_else(|| key.clone());
    let location = locate(source, span.clone());
    let value = match value {
        toml_edit::Value::String(text) => Value::Text(text.value().clone()),
        toml_edit::Value::Integer(number) => Value::Integer(*number.value()),
        toml_edit::Value::Float(number) if !number.value().is_finite() => {
            return Err(SceneError::new(
                SceneErrorKind::OutOfRange,
                format!("{} is not a finite number", number.value()),
            )
            .or_at(Some(&location))
            .with_help("leave a limit out instead of setting it to infinity"));
        }
        toml_edit::Value::Float(number) => Value::Float(*number.value()),
        toml_edit::Value::Boolean(value) => Value::Bool(*value.value()),
        toml_edit::Value::Datetime(_) => {
            return Err(SceneError::new(
                SceneErrorKind::WrongType,
                "a scene has no dates; write times as seconds",
            )
            .or_at(Some(&location)));
        }
        toml_edit::Value::Array(items) => Value::List(
            items
                .iter()
                .map(|item| convert_value(item, source, &span))
                .collect::<Result<_, _>>()?,
        ),
        toml_edit::Value::InlineTable(table) => {
            Value::Table(convert_table(table, source, &span, table.is_dotted())?)
        }
    };
    Ok(Node { value, location })
}
