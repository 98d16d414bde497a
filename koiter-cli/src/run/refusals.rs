//! Result folders that cannot be written to or gone on with.

use std::io::ErrorKind;

use koiter::io::result::ResultError;

use super::beginning::BEGIN_AGAIN;
use crate::failure::{Code, Failure};

/// A folder that may not be written to is an input that is wrong, unless the system refused.
pub(super) fn writing(error: ResultError) -> Failure {
    match error {
        ResultError::NotEmpty { .. } | ResultError::InUse { .. } => {
            Failure::result(error).with_help("choose another folder with --out")
        }
        error => Failure::run(&error).with_code(Code::of_result(&error)),
    }
}

/// A result that cannot be taken up again is an input that is wrong, unless the system refused.
pub(super) fn damaged(error: ResultError) -> Failure {
    match error {
        // A file that is missing, or a folder in its place.
        ResultError::Io { ref source, .. }
            if matches!(source.kind(), ErrorKind::NotFound | ErrorKind::IsADirectory) =>
        {
            Failure::result(error).with_help(BEGIN_AGAIN)
        }
        ResultError::Io { .. } | ResultError::InUse { .. } => writing(error),
        error => Failure::result(error).with_help(BEGIN_AGAIN),
    }
}
