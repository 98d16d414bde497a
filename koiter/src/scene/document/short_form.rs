//! Short forms of a scene file, written out so that the rest knows one form only.

use super::{Entry, Node, Table, Value};

/// `material = "cotton"` becomes `material = { preset = "cotton" }`.
pub(super) fn expand_short_forms(root: &mut Node) {
    let Value::Table(root) = &mut root.value else {
        return;
    };
    let shells = root.entries.iter_mut().filter(|entry| entry.key == "shell");
    for shells in shells {
        let Value::List(shells) = &mut shells.node.value else {
            continue;
        };
        for shell in shells {
            let Value::Table(shell) = &mut shell.value else {
                continue;
            };
            for entry in shell.entries.iter_mut().filter(|e| e.key == "material") {
                if matches!(entry.node.value, Value::Text(_)) {
                    expand(entry, "preset");
                }
            }
        }
    }
}

/// `entry = value` becomes `entry = { key = value }`, at the same place.
fn expand(entry: &mut Entry, key: &str) {
    let inner = Entry {
        key: key.to_owned(),
        key_location: entry.key_location.clone(),
        node: entry.node.clone(),
    };
    entry.node.value = Value::Table(Table {
        entries: vec![inner],
        dotted: false,
    });
}
