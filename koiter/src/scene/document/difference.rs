//! Where two scenes differ.

use super::write::inline;
use super::{Document, Node, Value, element_segment};

/// A key whose values differ between two documents, as TOML; `None`: not set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Dotted path of the key.
    pub path: String,
    /// Its value in the first document.
    pub here: Option<String>,
    /// Its value in the second.
    pub there: Option<String>,
}

impl Document {
    /// The first key with another value in `other`, apart from the paths in `ignored`; the order of keys is no difference.
    pub fn first_difference(&self, other: &Self, ignored: &[&str]) -> Option<Difference> {
        compare(&self.root, &other.root, "", ignored)
    }
}

fn compare(here: &Node, there: &Node, path: &str, ignored: &[&str]) -> Option<Difference> {
    if ignored.contains(&path) {
        return None;
    }
    let join = |segment: &str| match path {
        "" => segment.to_owned(),
        path => format!("{path}.{segment}"),
    };
    match (&here.value, &there.value) {
        (Value::Table(a), Value::Table(b)) => {
            let in_both_or_here = a.entries.iter().find_map(|entry| {
                let path = join(&entry.key);
                compare_optional(Some(&entry.node), b.get(&entry.key), &path, ignored)
            });
            in_both_or_here.or_else(|| {
                let only_there = b.entries.iter().filter(|entry| a.get(&entry.key).is_none());
                only_there.into_iter().find_map(|entry| {
                    compare_optional(None, Some(&entry.node), &join(&entry.key), ignored)
                })
            })
        }
        (Value::List(a), Value::List(b)) => (0..a.len().max(b.len())).find_map(|index| {
            let node = a.get(index).or(b.get(index))?;
            let path = join(&element_segment(index, node));
            compare_optional(a.get(index), b.get(index), &path, ignored)
        }),
        _ => (!is_equal(&here.value, &there.value)).then(|| Difference {
            path: path.to_owned(),
            here: Some(inline(here)),
            there: Some(inline(there)),
        }),
    }
}

/// A table that only one side has differs in its inner keys, so that ignored ones among them are ignored.
fn compare_optional(
    here: Option<&Node>,
    there: Option<&Node>,
    path: &str,
    ignored: &[&str],
) -> Option<Difference> {
    if ignored.contains(&path) {
        return None;
    }
    let only = |node: &Node| match &node.value {
        Value::Table(table) => table.entries.iter().find_map(|entry| {
            let inner = Some(&entry.node);
            let (here, there) = (here.and(inner), there.and(inner));
            compare_optional(here, there, &format!("{path}.{}", entry.key), ignored)
        }),
        _ => Some(Difference {
            path: path.to_owned(),
            here: here.map(inline),
            there: there.map(inline),
        }),
    };
    match (here, there) {
        (Some(a), Some(b)) => compare(a, b, path, ignored),
        (Some(node), None) | (None, Some(node)) => only(node),
        (None, None) => None,
    }
}

fn is_equal(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Bool(a), Value::Bool(b)) => a == b,
        (Value::Text(a), Value::Text(b)) => a == b,
        (Value::Integer(a), Value::Integer(b)) => a == b,
        (Value::Float(a), Value::Float(b)) => a == b,
        // `1` and `1.0` are the same number to a scene.
        (Value::Integer(i), Value::Float(x)) | (Value::Float(x), Value::Integer(i)) => {
            *i as f64 == *x
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn difference(here: &str, there: &str) -> Option<(String, Option<String>, Option<String>)> {
        let parse = |text| Document::parse("a", text, &[]).unwrap();
        parse(here)
            .first_difference(&parse(there), &["time.end", "output.camera"])
            .map(|d| (d.path, d.here, d.there))
    }

    #[test]
    fn order_spelling_and_ignored_keys_are_no_difference() {
        let a = "time = { end = 1, dt = 0.1 }\ngravity = [0, 0, -9.81]";
        let b = "gravity = [0.0, 0.0, -9.81]\n[time]\ndt = 1e-1\nend = 5\n[output]\ncamera = 'top'";
        assert_eq!(difference(a, b), None);
        assert_eq!(difference(b, a), None);
    }

    #[test]
    fn the_key_and_both_values_are_named() {
        let some = |text: &str| Some(text.to_owned());
        let a = "time.dt = 0.1\n[[shell]]\nname = 'cloth'\nthickness = 1e-3";
        let thicker = a.replace("1e-3", "2e-3");
        let at = "shell.cloth.thickness".to_owned();
        assert_eq!(
            difference(a, &thicker),
            Some((at.clone(), some("0.001"), some("0.002")))
        );
        let unset = a.replace("thickness = 1e-3", "");
        assert_eq!(
            difference(a, &unset),
            Some((at.clone(), some("0.001"), None))
        );
        assert_eq!(difference(&unset, a), Some((at, None, some("0.001"))));
        let two = format!("{a}\n[[shell]]\nname = 'lining'");
        let (path, here, _) = difference(a, &two).unwrap();
        assert_eq!((path.as_str(), here), ("shell.lining.name", None));
    }
}
