//! Which runs a sweep makes: all combinations of the values of its keys.

use crate::failure::Failure;

/// Most runs of a sweep: a slip of the keyboard should not ask for a million.
const MOST_RUNS: usize = 10_000;
/// Longest piece of a value in the name of a folder.
const LONGEST_WORD: usize = 24;

/// What is varied, and the runs.
pub(super) struct Plan {
    /// Keys with their values as typed.
    pub(super) keys: Vec<(String, Vec<String>)>,
    /// All combinations, the last key changing fastest.
    pub(super) runs: Vec<Run>,
}

/// A run of a sweep.
pub(super) struct Run {
    /// The values of the keys, in their order.
    pub(super) values: Vec<String>,
    /// The same as `--set` takes them.
    pub(super) overrides: Vec<String>,
    /// Name of its result folder.
    pub(super) folder: String,
}

impl Plan {
    /// From texts such as `shell.cloth.bending=bac,dcs`.
    pub(super) fn new(vary: &[String]) -> Result<Self, Failure> {
        let keys = vary
            .iter()
            .map(|text| parse(text))
            .collect::<Result<Vec<_>, _>>()?;
        let count = (keys.iter()).try_fold(1usize, |count, (_, values)| {
            count
                .checked_mul(values.len())
                .filter(|&count| count <= MOST_RUNS)
        });
        let Some(count) = count else {
            return Err(Failure::input(format!(
                "a sweep of more than {MOST_RUNS} runs; vary less"
            )));
        };
        let runs = (0..count).map(|index| run(&keys, index, count)).collect();
        Ok(Self { keys, runs })
    }

    /// Pictures in a row of the grid: the values of the key that changes fastest.
    pub(super) fn columns(&self) -> usize {
        self.keys.last().map_or(1, |(_, values)| values.len())
    }
}

fn parse(text: &str) -> Result<(String, Vec<String>), Failure> {
    let wrong = |reason: &str| {
        Failure::input(format!("--vary {text}: {reason}"))
            .with_help("give a key and its values, such as --vary shell.cloth.bending=bac,dcs")
    };
    let (key, values) = text
        .split_once('=')
        .ok_or_else(|| wrong("there is no '='"))?;
    if key.trim().is_empty() {
        return Err(wrong("the key is missing"));
    }
    let values = split(values);
    if values.iter().any(|value| value.is_empty()) {
        return Err(wrong("a value is empty"));
    }
    Ok((key.trim().to_owned(), values))
}

/// Pieces between commas that stand neither in brackets nor in quotes.
fn split(text: &str) -> Vec<String> {
    let (mut pieces, mut depth, mut quote) = (vec![String::new()], 0usize, None);
    for c in text.chars() {
        match (quote, c) {
            (None, ',') if depth == 0 => {
                pieces.push(String::new());
                continue;
            }
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => depth = depth.saturating_sub(1),
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), c) if c == open => quote = None,
            _ => {}
        }
        pieces.last_mut().expect("it begins with one").push(c);
    }
    pieces.iter().map(|piece| piece.trim().to_owned()).collect()
}

fn run(keys: &[(String, Vec<String>)], index: usize, count: usize) -> Run {
    let mut rest = index;
    let mut values: Vec<String> = (keys.iter().rev())
        .map(|(_, values)| {
            let value = values[rest % values.len()].clone();
            rest /= values.len();
            value
        })
        .collect();
    values.reverse();
    let overrides = keys.iter().zip(&values);
    let overrides = overrides.map(|((key, _), value)| format!("{key}={value}"));
    let words: Vec<String> = values.iter().map(|value| word(value)).collect();
    let digits = (count - 1).to_string().len();
    Run {
        overrides: overrides.collect(),
        folder: format!("{index:0digits$}-{}", words.join("-")),
        values,
    }
}

/// A value as a part of a file's name.
fn word(value: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._+".contains(c);
    let kept = value.chars().map(|c| if plain(c) { c } else { '_' });
    kept.take(LONGEST_WORD).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(vary: &[&str]) -> Plan {
        let vary: Vec<String> = vary.iter().map(|&text| text.to_owned()).collect();
        Plan::new(&vary)
            .map_err(|failure| failure.message().to_owned())
            .unwrap()
    }

    #[test]
    fn all_combinations_are_run_and_the_last_key_changes_fastest() {
        let plan = plan(&["a=1,2", "b.c=x,y,z"]);
        let values: Vec<_> = plan.runs.iter().map(|run| run.values.join(" ")).collect();
        assert_eq!(values, ["1 x", "1 y", "1 z", "2 x", "2 y", "2 z"]);
        assert_eq!(plan.runs[4].overrides, ["a=2", "b.c=y"]);
        assert_eq!(plan.runs[4].folder, "4-2-y");
        assert_eq!(plan.columns(), 3);
    }

    #[test]
    fn commas_in_brackets_and_quotes_do_not_separate() {
        let plan = plan(&["g=[0.0, 1.0],[2.0, 3.0]", "t=\"a, b\",{ x = 1, y = 2 }"]);
        assert_eq!(plan.keys[0].1, ["[0.0, 1.0]", "[2.0, 3.0]"]);
        assert_eq!(plan.keys[1].1, ["\"a, b\"", "{ x = 1, y = 2 }"]);
        assert_eq!(plan.runs[0].folder, "0-_0.0__1.0_-_a__b_");
    }

    #[test]
    fn what_varies_nothing_is_refused() {
        for (text, reason) in [
            ("bending", "there is no '='"),
            ("=1", "the key is missing"),
            ("a=1,,2", "a value is empty"),
            ("a=", "a value is empty"),
        ] {
            let failure = Plan::new(&[text.to_owned()]).err().unwrap();
            assert!(failure.message().contains(reason), "{}", failure.message());
        }
        let many = format!("a={}", vec!["1"; 101].join(","));
        assert!(Plan::new(&[many.clone(), many]).is_err());
    }
}
