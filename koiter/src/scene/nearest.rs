//! The nearest valid name to a mistyped one.

/// The candidate that differs least from `word`, if it differs little enough to be a slip of the keyboard.
///
/// A slip is at most one edit in three letters (of the longer word); a candidate that begins with the whole word, or
/// the reverse, also counts.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    let (distance, candidate) = candidates
        .into_iter()
        .map(|candidate| (edit_distance(&word, &candidate.to_lowercase()), candidate))
        .min_by_key(|(distance, _)| *distance)?;
    let longer = word.chars().count().max(candidate.chars().count());
    let prefix = word.len() > 2 && (candidate.starts_with(&word) || word.starts_with(candidate));
    (distance * 3 <= longer || prefix).then_some(candidate)
}

/// Insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b`.
fn edit_distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().collect();
    let b: Vec<char> = b.chars().collect();
    let mut rows = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            if i == 0 || j == 0 {
                rows[i][j] = i + j;
                continue;
            }
            let replace = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replace.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            rows[i][j] = best;
        }
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_finds_its_word_and_nonsense_finds_none() {
        let keys = ["young", "poisson", "density", "thickness"];
        assert_eq!(nearest("yuong", keys), Some("young"));
        assert_eq!(nearest("thicknes", keys), Some("thickness"));
        assert_eq!(nearest("Density", keys), Some("density"));
        assert_eq!(nearest("thick", keys), Some("thickness"));
        assert_eq!(nearest("wind", keys), None);
        assert_eq!(nearest("young", []), None);
    }

    #[test]
    fn distances_of_single_edits_are_one() {
        for (a, b) in [
            ("abc", "ab"),
            ("abc", "abcd"),
            ("abc", "axc"),
            ("abc", "acb"),
        ] {
            assert_eq!(edit_distance(a, b), 1, "{a} {b}");
        }
        assert_eq!(edit_distance("", "abc"), 3);
    }
}
