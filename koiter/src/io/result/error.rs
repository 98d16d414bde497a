//! What can go wrong with a result folder.

use std::io;
use std::path::{Path, PathBuf};

use crate::io::{MAX_DATA_BYTES, read_bounded};

/// Why a result folder could not be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultError {
    /// The system refused: full disk, no permission, no such folder.
    #[error("could not {action} {}: {source}", path.display())]
    Io {
        /// What was tried.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The folder holds something else.
    #[error(
        "{} is not empty and not a Koiter result; choose another folder, or empty it first",
        path.display()
    )]
    NotEmpty {
        /// The folder.
        path: PathBuf,
    },
    /// Another run writes to the folder.
    #[error("another run is writing to {}; wait for its end", path.display())]
    InUse {
        /// The folder.
        path: PathBuf,
    },
    /// The folder to be read is not a result.
    #[error("{} is not a Koiter result: {reason}", path.display())]
    NotAResult {
        /// The folder.
        path: PathBuf,
        /// What is missing or wrong.
        reason: String,
    },
    /// The format is newer than this program.
    #[error(
        "{} has format version {found}, this program reads version {supported}; use a newer Koiter",
        path.display()
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// Version found.
        found: u32,
        /// Version this program reads.
        supported: u32,
    },
    /// A file of the result is damaged.
    #[error("{} is broken: {reason}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// What was to be written contradicts itself.
    #[error("the {what} cannot be written: {reason}")]
    Invalid {
        /// "manifest", "topology", "rest shape" or "frame".
        what: &'static str,
        /// What is wrong with it.
        reason: String,
    },
    /// There is no such frame.
    #[error("there is no frame {index}: {} has {len} frames, numbered from 0", path.display())]
    NoFrame {
        /// The frame asked for.
        index: usize,
        /// Number of frames.
        len: usize,
        /// The folder.
        path: PathBuf,
    },
    /// A value could not be turned into JSON.
    #[error("could not turn a value for {} into JSON: {source}", path.display())]
    Json {
        /// The file it was meant for.
        path: PathBuf,
        /// What the serialiser said.
        source: serde_json::Error,
    },
}

/// Wraps a system error: `map_err(while_trying("read", path))`.
pub(super) fn while_trying<'a>(
    action: &'static str,
    path: &'a Path,
) -> impl FnOnce(io::Error) -> ResultError + 'a {
    move |source| ResultError::Io {
        action,
        path: path.to_path_buf(),
        source,
    }
}

/// The bytes of a file of a result.
///
/// # Errors
/// Broken, if it is none that a run can have written; a refusal of the system.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, ResultError> {
    read_bounded(path, MAX_DATA_BYTES).map_err(unreadable(path))
}

/// The same, or nothing where there is no such file.
pub(super) fn read_if_there(path: &Path) -> Result<Option<Vec<u8>>, ResultError> {
    match read_file(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(ResultError::Io { source, .. }) if source.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// A pipe, a device or a folder in the place of a file is damage, not a refusal of the system.
pub(super) fn unreadable<'a>(path: &'a Path) -> impl FnOnce(io::Error) -> ResultError + 'a {
    move |error| match error.kind() {
        io::ErrorKind::InvalidInput | io::ErrorKind::FileTooLarge => ResultError::Broken {
            path: path.to_path_buf(),
            reason: error.to_string(),
        },
        _ => while_trying("read", path)(error),
    }
}
