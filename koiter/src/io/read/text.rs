//! Lines and numbers of text formats.

use super::ParseError;

/// The lines of a text that are not blank, without what follows `#`, each with its number from 1.
pub(super) fn content_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().filter_map(|(index, line)| {
        let content = line.split('#').next().unwrap_or_default().trim();
        (!content.is_empty()).then_some((index + 1, content))
    })
}

/// Three finite coordinates from the next three words.
pub(super) fn parse_position<'a>(
    words: &mut impl Iterator<Item = &'a str>,
    line: usize,
) -> Result<[f64; 3], ParseError> {
    let mut position = [0.0; 3];
    for (value, axis) in position.iter_mut().zip(["x", "y", "z"]) {
        let word = words.next().ok_or_else(|| {
            ParseError::at_line(line, format!("the {axis} coordinate is missing"))
        })?;
        *value = word
            .parse()
            .ok()
            .filter(|value: &f64| value.is_finite())
            .ok_or_else(|| {
                let word = shortened(word);
                ParseError::at_line(
                    line,
                    format!("the {axis} coordinate '{word}' is not a finite number"),
                )
            })?;
    }
    Ok(position)
}

/// A word from a file, fit for an error message: garbage can be long.
pub(super) fn shortened(word: &str) -> String {
    const LENGTH: usize = 40;
    if word.chars().count() <= LENGTH {
        return word.escape_debug().to_string();
    }
    let start: String = word.chars().take(LENGTH).collect();
    format!("{}…", start.escape_debug())
}

/// An index that a face uses is checked against the number of vertices.
pub(super) fn check_corner(vertex: u32, num_vertices: usize) -> Result<(), String> {
    if (vertex as usize) < num_vertices {
        Ok(())
    } else {
        Err(format!(
            "the face uses vertex {vertex} (counted from 0), but there are only {num_vertices} vertices; \
             correct the index or add the vertex"
        ))
    }
}

/// A face needs three corners.
pub(super) fn check_corner_count(count: usize) -> Result<(), String> {
    if count >= 3 {
        Ok(())
    } else {
        Err(format!(
            "the face has {count} corners; at least 3 are needed: complete or remove it"
        ))
    }
}
