//! Lines for people and scripts, written so that a full disk or a reader that went away is no panic.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write, stderr, stdout};

/// Writes a line to standard output. A closed pipe ends the program quietly, anything else with status 1.
pub(crate) fn line(text: Arguments<'_>) {
    check(writeln!(stdout(), "{text}"));
}

/// Writes a whole text to standard output, as [`line`] does.
pub(crate) fn write_out(text: &[u8]) {
    check(stdout().write_all(text).and_then(|()| stdout().flush()));
}

fn check(written: io::Result<()>) {
    let Err(error) = written else {
        return;
    };
    if error.kind() == ErrorKind::BrokenPipe {
        std::process::exit(0);
    }
    error_line(format_args!("cannot write to standard output: {error}"));
    std::process::exit(1);
}

/// Writes a line to standard error, if it can be written to.
pub(crate) fn error_line(text: Arguments<'_>) {
    let _ = writeln!(stderr(), "{text}");
}

/// A word as a shell takes it.
pub(crate) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+@%".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

/// `println!` that cannot panic.
macro_rules! say {
    ($($argument:tt)*) => { $crate::output::line(format_args!($($argument)*)) };
}

/// `eprintln!` that cannot panic.
macro_rules! say_error {
    ($($argument:tt)*) => { $crate::output::error_line(format_args!($($argument)*)) };
}

pub(crate) use {say, say_error};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_split_them() {
        assert_eq!(quoted("--set"), "--set");
        assert_eq!(quoted("gravity=[0, 1]"), "'gravity=[0, 1]'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
    }
}
