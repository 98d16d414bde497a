//! One writer a result folder.

#[cfg(unix)]
use std::fs::TryLockError;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

use super::ResultError;
use super::error::while_trying;

/// Keeps other runs from writing to a result folder while it lives: two would leave a mixture of both.
///
/// The system drops the lock with the process, however that ends. Where folders cannot be locked (some network file
/// systems, Windows) it keeps nobody out.
#[derive(Debug)]
pub struct FolderLock {
    folder: PathBuf,
    _file: Option<File>,
}

impl FolderLock {
    /// Locks a folder that is there.
    ///
    /// # Errors
    /// [`ResultError::InUse`] while another run writes to it; a refusal of the system.
    pub fn take(folder: &Path) -> Result<Self, ResultError> {
        Ok(Self {
            folder: folder.to_path_buf(),
            _file: lock(folder)?,
        })
    }

    /// Locks a folder that is created if needed.
    ///
    /// # Errors
    /// As [`FolderLock::take`].
    pub fn create(folder: &Path) -> Result<Self, ResultError> {
        fs::create_dir_all(folder).map_err(while_trying("create the folder", folder))?;
        Self::take(folder)
    }

    /// Whether a run writes to the folder now; `None` where that cannot be told.
    pub fn is_held(folder: &Path) -> Option<bool> {
        is_held(folder)
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }
}

/// Who asks whether a folder is in use holds it for a moment; a run that begins in this moment tries again.
#[cfg(unix)]
const ATTEMPTS: usize = 5;

#[cfg(unix)]
fn lock(folder: &Path) -> Result<Option<File>, ResultError> {
    let file = File::open(folder).map_err(while_trying("open", folder))?;
    for attempt in 1.. {
        match file.try_lock() {
            Ok(()) => break,
            Err(TryLockError::WouldBlock) if attempt < ATTEMPTS => {
                std::thread::sleep(std::time::Duration::from_millis(10));
            }
            Err(TryLockError::WouldBlock) => {
                return Err(ResultError::InUse {
                    path: folder.to_path_buf(),
                });
            }
            // Some network file systems have no locks.
            Err(TryLockError::Error(_)) => return Ok(None),
        }
    }
    Ok(Some(file))
}

#[cfg(unix)]
fn is_held(folder: &Path) -> Option<bool> {
    match File::open(folder).ok()?.try_lock_shared() {
        Ok(()) => Some(false),
        Err(TryLockError::WouldBlock) => Some(true),
        Err(TryLockError::Error(_)) => None,
    }
}

/// Elsewhere folders cannot be opened as files.
#[cfg(not(unix))]
fn is_held(_folder: &Path) -> Option<bool> {
    None
}

/// As there.
#[cfg(not(unix))]
fn lock(_folder: &Path) -> Result<Option<File>, ResultError> {
    Ok(None)
}
