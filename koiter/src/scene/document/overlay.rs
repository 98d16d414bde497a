//! Overrides by dotted path: variants of a scene and `--set KEY=VALUE`.
//!
//! A scene may name sets of overrides:
//!
//! ```toml
//! [variants.resolution]
//! default = "small"
//! [variants.resolution.tiny]
//! shell.cloth.mesh.irregular.max_area = 2e-3
//! [variants.resolution.small]
//! shell.cloth.mesh.irregular.max_area = 3e-4
//! ```
//!
//! `--set resolution=tiny` picks one; all other overrides are applied after the variants.

use super::{Document, Entry, Node, Table, Value, find_element};
use crate::scene::error::{Location, SceneError, SceneErrorKind};
use crate::scene::nearest::nearest;

/// Takes the variants out of the document, applies those picked, then the other overrides in their order.
pub(super) fn apply(document: &mut Document, overrides: Vec<Node>) -> Result<(), SceneError> {
    let Value::Table(root) = &mut document.root.value else {
        return Ok(());
    };
    let variants = root.remove("variants");
    let mut overrides = overrides;
    if let Some(variants) = variants {
        let groups = expect_table(variants, "variants")?;
        for group in groups.entries {
            let picked = take_choice(&mut overrides, &group.key);
            let overlay = pick(group, picked)?;
            merge(&mut document.root, overlay)?;
        }
    }
    for overlay in overrides {
        let Value::Table(table) = overlay.value else {
            continue;
        };
        merge(&mut document.root, table)?;
    }
    Ok(())
}

/// The last override of the top-level key `name`; all such are removed.
fn take_choice(overrides: &mut [Node], name: &str) -> Option<Node> {
    let mut choice = None;
    for node in overrides {
        if let Value::Table(table) = &mut node.value
            && let Some(value) = table.remove(name)
        {
            choice = Some(value);
        }
    }
    choice
}

/// The overrides of the chosen variant of a group.
fn pick(group: Entry, picked: Option<Node>) -> Result<Table, SceneError> {
    let path = format!("variants.{}", group.key);
    let mut options = expect_table(group.node, &path)?;
    let default = options.remove("default");
    let Some(choice) = picked.or(default) else {
        let message = format!("the variants of '{}' have no default", group.key);
        return Err(SceneError::new(SceneErrorKind::MissingKey, message)
            .inside(&path)
            .or_at(Some(&group.key_location))
            .with_help("add a line such as: default = \"small\""));
    };
    let name = match &choice.value {
        Value::Text(name) => name.clone(),
        Value::Integer(number) => number.to_string(),
        _ => choice.location.text().to_owned(),
    };
    match options.remove(&name) {
        Some(overlay) => expect_table(overlay, &format!("{path}.{name}")),
        None => {
            let names: Vec<&str> = options.entries.iter().map(|e| e.key.as_str()).collect();
            let message = format!("'{}' has no variant '{name}'", group.key);
            Err(SceneError::new(SceneErrorKind::UnknownName, message)
                .inside(&path)
                .or_at(Some(&choice.location))
                .with_help(suggest(&name, &names)))
        }
    }
}

fn expect_table(node: Node, path: &str) -> Result<Table, SceneError> {
    let description = node.describe();
    match node.value {
        Value::Table(table) => Ok(table),
        _ => Err(SceneError::new(
            SceneErrorKind::WrongType,
            format!("'{path}' must be a table, but it is {description}"),
        )
        .inside(path)
        .or_at(Some(&node.location))),
    }
}

/// A part of a dotted path, and where it was typed.
struct Segment {
    name: String,
    location: Location,
}

/// Longer paths than any scene has; without a bound the tables they make could be nested deeper than the stack.
const LONGEST_PATH: usize = 32;

/// Applies every entry of an overlay.
fn merge(root: &mut Node, overlay: Table) -> Result<(), SceneError> {
    for entry in overlay.entries {
        merge_entry(root, entry, &mut Vec::new())?;
    }
    Ok(())
}

fn merge_entry(root: &mut Node, entry: Entry, prefix: &mut Vec<Segment>) -> Result<(), SceneError> {
    let depth = prefix.len();
    prefix.extend(entry.key.split('.').map(|name| Segment {
        name: name.to_owned(),
        location: entry.key_location.clone(),
    }));
    if prefix.len() > LONGEST_PATH {
        let message = format!("this path has more than {LONGEST_PATH} keys");
        return Err(SceneError::new(SceneErrorKind::UnknownKey, message)
            .or_at(Some(&entry.key_location))
            .with_help("a path is that of a value in the scene, such as shell.cloth.thickness"));
    }
    let dotted = matches!(&entry.node.value, Value::Table(table) if table.dotted);
    if dotted && let Value::Table(table) = entry.node.value {
        for inner in table.entries {
            merge_entry(root, inner, prefix)?;
        }
    } else {
        set(root, prefix, entry.node)?;
    }
    prefix.truncate(depth);
    Ok(())
}

/// Sets the value at a path, making tables on the way.
fn set(root: &mut Node, path: &[Segment], value: Node) -> Result<(), SceneError> {
    let dotted = |path: &[Segment]| {
        let names: Vec<&str> = path.iter().map(|segment| segment.name.as_str()).collect();
        names.join(".")
    };
    let mut node = root;
    for (depth, Segment { name, location }) in path.iter().enumerate() {
        let refuse = |kind, message| {
            SceneError::new(kind, message)
                .inside(&dotted(path))
                .or_at(Some(location))
        };
        let here = &path[..depth];
        let description = match node.value {
            Value::Table(_) | Value::List(_) => String::new(),
            _ => node.describe(),
        };
        node = match &mut node.value {
            Value::Table(table) => entry_or_table(table, name, location),
            Value::List(items) => match find_element(items, name) {
                Some(index) => &mut items[index],
                None => {
                    let names: Vec<&str> = items.iter().filter_map(Node::name).collect();
                    let message = format!("there is no {} '{name}'", dotted(here));
                    return Err(refuse(SceneErrorKind::UnknownName, message)
                        .with_help(suggest(name, &names)));
                }
            },
            _ => {
                let message = format!(
                    "'{}' is {description}: it has no key '{name}'",
                    dotted(here)
                );
                return Err(refuse(SceneErrorKind::WrongType, message));
            }
        };
    }
    *node = value;
    Ok(())
}

fn entry_or_table<'a>(table: &'a mut Table, key: &str, location: &Location) -> &'a mut Node {
    let index = table.entries.iter().position(|entry| entry.key == key);
    let index = index.unwrap_or_else(|| {
        table.entries.push(Entry {
            key: key.to_owned(),
            key_location: location.clone(),
            node: Node {
                value: Value::Table(Table::default()),
                location: location.clone(),
            },
        });
        table.entries.len() - 1
    });
    &mut table.entries[index].node
}

/// "did you mean …" and the list of what there is.
pub(in crate::scene) fn suggest(word: &str, names: &[&str]) -> String {
    let list = match names {
        [] => "there are none".to_owned(),
        names => format!("there are: {}", names.join(", ")),
    };
    match nearest(word, names.iter().copied()) {
        Some(name) => format!("did you mean '{name}'? {list}"),
        None => list,
    }
}
