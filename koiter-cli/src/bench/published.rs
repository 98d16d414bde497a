//! Published figures that ship with the program: rows of comma-separated values.

/// Rows of fields, without the heading.
pub(super) fn rows(text: &'static str) -> impl Iterator<Item = Vec<&'static str>> {
    text.lines().skip(1).map(|line| line.split(',').collect())
}

/// A number of such a file.
///
/// # Panics
/// If it is none: the file ships with the program.
pub(super) fn number(field: &str) -> f64 {
    field.parse().expect("shipped tables hold numbers")
}
