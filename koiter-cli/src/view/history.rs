//! One vertex or face over time.

use koiter::io::result::{Element, FrameProbe, ResultReader};
use serde_json::{Map, Value, json};

/// Points of a history.
const MAX_POINTS: usize = 1000;

/// Position and fields in all frames, or of many frames in some, evenly chosen; those that cannot be read are left out.
///
/// # Errors
/// No such element, no frame that can be read.
pub(super) fn history(reader: &ResultReader, element: Element) -> Result<Value, String> {
    let indices = evenly(reader.len(), MAX_POINTS);
    let probes: Vec<FrameProbe> = (indices.iter())
        .filter_map(|&index| reader.probe(index, element).ok())
        .collect();
    let Some(first) = probes.first() else {
        return Err("there is no such vertex or face, or no frame that can be read".to_owned());
    };
    let mut columns = Map::new();
    let times: Vec<f64> = probes.iter().map(|probe| probe.time).collect();
    columns.insert("time".to_owned(), json!(times));
    if first.position.is_some() {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let values = probes.iter().map(|probe| probe.position.map(|x| x[axis]));
            columns.insert(name.to_owned(), values.collect());
        }
    }
    for (k, (name, _)) in first.fields.iter().enumerate() {
        let values = probes
            .iter()
            .map(|probe| probe.fields.get(k).map(|field| field.1));
        columns.insert(name.clone(), values.collect());
    }
    Ok(Value::Object(columns))
}

/// At most `most` of the numbers below `count`, evenly, with the first and the last.
pub(super) fn evenly(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|k| k * (count - 1) / (most - 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_chosen_evenly_with_both_ends() {
        assert!(evenly(0, 3).is_empty());
        assert_eq!(evenly(3, 3), [0, 1, 2]);
        assert_eq!(evenly(101, 3), [0, 50, 100]);
    }
}
