//! Where files are to be written.

use std::path::Path;

use crate::failure::Failure;

/// Refuses a place where no file can be: before work is done for it.
pub(crate) fn check(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        let message = format!("{} is a folder: name a file to write", path.display());
        return Err(Failure::input(message));
    }
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            let (path, folder) = (path.display(), folder.display());
            let message = format!("cannot write {path}: there is no folder {folder}");
            Err(Failure::input(message))
        }
        _ => Ok(()),
    }
}

/// Makes a folder for pictures, and those above it.
pub(crate) fn make_folder(path: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(path).map_err(|error| {
        Failure::input(format!(
            "cannot make the folder {}: {error}",
            path.display()
        ))
    })
}
