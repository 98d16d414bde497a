//! `request.txt`: a word that asks something of the run that writes to a result folder.
//!
//! A run looks for it between its steps. A file is a mechanism that needs no address: whoever may write to the folder may ask,
//! from a viewer, a script or an editor, and also on file systems that several machines share.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use super::error::while_trying;
use super::{REQUEST, ResultError};
use crate::io::{read_bounded, write_atomically};

/// Longer files are not read.
const MAX_BYTES: u64 = 64;

/// What is asked of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunRequest {
    /// To wait, until the file is gone.
    Pause,
    /// To end after this step, saved as after an interruption.
    Stop,
}

impl RunRequest {
    /// The word in the file.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pause => "pause",
            Self::Stop => "stop",
        }
    }

    /// What is asked at present. Words that are not known ask nothing, nor does what cannot be read.
    pub fn read(folder: &Path) -> Option<Self> {
        let bytes = read_bounded(&folder.join(REQUEST), MAX_BYTES).ok()?;
        let known = [Self::Pause, Self::Stop];
        known
            .into_iter()
            .find(|request| request.word().as_bytes() == bytes.trim_ascii())
    }

    /// Asks.
    ///
    /// # Errors
    /// A refusal of the system.
    pub fn write(self, folder: &Path) -> Result<(), ResultError> {
        let path = folder.join(REQUEST);
        let line = format!("{}\n", self.word());
        write_atomically(&path, line.as_bytes()).map_err(while_trying("write", &path))
    }

    /// Asks no longer.
    ///
    /// # Errors
    /// A refusal of the system.
    pub fn withdraw(folder: &Path) -> Result<(), ResultError> {
        let path = folder.join(REQUEST);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(while_trying("delete", &path)(error))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_stands_until_it_is_withdrawn() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        assert_eq!(RunRequest::read(folder), None);
        for request in [RunRequest::Pause, RunRequest::Stop] {
            request.write(folder).unwrap();
            assert_eq!(RunRequest::read(folder), Some(request));
        }
        RunRequest::withdraw(folder).unwrap();
        RunRequest::withdraw(folder).unwrap();
        assert_eq!(RunRequest::read(folder), None);
    }

    #[test]
    fn other_words_and_long_files_ask_nothing() {
        let folder = tempfile::tempdir().unwrap();
        for text in ["", "halt", "stop now", &"stop\n".repeat(100)] {
            fs::write(folder.path().join(REQUEST), text).unwrap();
            assert_eq!(RunRequest::read(folder.path()), None, "{text}");
        }
        fs::write(folder.path().join(REQUEST), " stop\r\n").unwrap();
        assert_eq!(RunRequest::read(folder.path()), Some(RunRequest::Stop));
    }
}
