//! `hand.txt`: where a hand pulls at a run that can be played with.
//!
//! ```text
//! 1234 0.1 0.25 -0.05    the number of a vertex, and where it is to go [m]
//! released               nothing is pulled
//! ```
//!
//! The run makes the file when it begins and deletes it at its end; whoever may write to the folder may pull, as with
//! `request.txt`.

use std::fs;
use std::path::Path;

use super::error::while_trying;
use super::{HAND, ResultError};
use crate::Vec3;
use crate::io::{read_bounded, write_atomically};

/// Longer files are not read.
const MAX_BYTES: u64 = 128;
const RELEASED: &str = "released";

/// What a hand does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hand {
    /// Nothing.
    Released,
    /// It pulls at a vertex.
    Pulls {
        /// Number of the vertex, counted through all parts.
        vertex: usize,
        /// Where to [m].
        target: Vec3,
    },
}

impl Hand {
    /// Reads a line; `None` if it is none of the two kinds.
    pub fn parse(line: &str) -> Option<Self> {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words[..] {
            [RELEASED] => Some(Self::Released),
            [vertex, x, y, z] => {
                let number = |word: &str| word.parse().ok().filter(|x: &f64| x.is_finite());
                Some(Self::Pulls {
                    vertex: vertex.parse().ok()?,
                    target: Vec3::new(number(x)?, number(y)?, number(z)?),
                })
            }
            _ => None,
        }
    }

    /// What the file says; `None` where no run waits for a hand, or the file cannot be understood.
    pub fn read(folder: &Path) -> Option<Self> {
        let bytes = read_bounded(&folder.join(HAND), MAX_BYTES).ok()?;
        Self::parse(std::str::from_utf8(&bytes).ok()?)
    }

    /// Writes the file.
    ///
    /// # Errors
    /// A refusal of the system.
    pub fn write(self, folder: &Path) -> Result<(), ResultError> {
        let path = folder.join(HAND);
        let line = match self {
            Self::Released => format!("{RELEASED}\n"),
            Self::Pulls { vertex, target } => {
                format!("{vertex} {} {} {}\n", target.x, target.y, target.z)
            }
        };
        write_atomically(&path, line.as_bytes()).map_err(while_trying("write", &path))
    }

    /// Deletes the file, as far as it can be deleted: a run that has ended waits for no hand.
    pub fn withdraw(folder: &Path) {
        // Where it stays, the lock of the folder tells that no run is there.
        let _ = fs::remove_file(folder.join(HAND));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_is_read_as_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        assert_eq!(Hand::read(folder), None);
        let target = Vec3::new(0.1, -2.5e-7, 1.0 / 3.0);
        for hand in [Hand::Pulls { vertex: 7, target }, Hand::Released] {
            hand.write(folder).unwrap();
            assert_eq!(Hand::read(folder), Some(hand));
        }
        Hand::withdraw(folder);
        Hand::withdraw(folder);
        assert_eq!(Hand::read(folder), None);
    }

    #[test]
    fn other_lines_are_no_hand() {
        for line in [
            "",
            "7",
            "7 0 0",
            "7 0 0 nan",
            "7 0 0 inf",
            "-1 0 0 0",
            "7 0 0 0 0",
            "hold",
        ] {
            assert_eq!(Hand::parse(line), None, "{line}");
        }
    }
}
