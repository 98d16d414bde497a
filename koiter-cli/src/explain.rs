//! `koiter explain`: what error codes mean, from the page that the manual has of them.

use koiter::scene::{SceneErrorKind, nearest};

use crate::arguments::ExplainArguments;
use crate::failure::{Code, Failure};
use crate::output::say;

/// The page: a section a code.
const PAGE: &str = include_str!("../../docs/errors.md");

/// Prints the section of a code, or all codes with their first sentences.
pub(crate) fn explain(arguments: &ExplainArguments) -> Result<(), Failure> {
    let Some(asked) = &arguments.code else {
        for code in codes() {
            let text = section(code).unwrap_or_default().replace('\n', " ");
            // Up to the end of a clause, not to the point in a file's name.
            let ends = [". ", ": ", "; "]
                .into_iter()
                .filter_map(|end| text.find(end));
            let end = ends.min().unwrap_or(text.len());
            say!("{code:<22} {}", &text[..end]);
        }
        return Ok(());
    };
    let wanted = asked.trim().to_ascii_lowercase();
    let Some(text) = section(&wanted) else {
        let failure = Failure::input(format!("there is no error code '{asked}'"));
        return Err(failure.with_help(match nearest(&wanted, codes()) {
            Some(near) => format!("did you mean '{near}'? koiter explain lists all"),
            None => "koiter explain lists all".to_owned(),
        }));
    };
    say!("{wanted}\n\n{text}");
    Ok(())
}

/// All codes that errors can have.
fn codes() -> impl Iterator<Item = &'static str> {
    let of_scenes = SceneErrorKind::ALL.into_iter().map(SceneErrorKind::code);
    of_scenes.chain(Code::ALL.into_iter().map(Code::name))
}

/// What the page says of a code.
fn section(code: &str) -> Option<&'static str> {
    let sections = PAGE.split("\n## ").skip(1);
    let mut parts = sections.filter_map(|section| section.split_once('\n'));
    parts
        .find(|(title, _)| *title == code)
        .map(|(_, text)| text.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_has_a_section_and_every_section_a_code() {
        let sections = PAGE.split("\n## ").skip(1);
        let titles: Vec<&str> = sections.filter_map(|text| text.lines().next()).collect();
        assert_eq!(titles, codes().collect::<Vec<_>>());
        for code in codes() {
            let text = section(code).unwrap();
            assert!(
                text.contains("```sh\n") || text.contains("```text\n"),
                "{code}"
            );
        }
    }
}
