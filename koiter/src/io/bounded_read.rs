//! Reading files whose kind and size are looked at first.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Most bytes of a scene: thousands of times what people write; more is no scene.
pub const MAX_SCENE_BYTES: u64 = 64 << 20;
/// Most bytes of any other file: meshes and frames of this size have more triangles than memory takes.
pub const MAX_DATA_BYTES: u64 = 16 << 30;

/// Reads a regular file of at most `limit` bytes; links are followed.
///
/// A device may never end (`/dev/zero`), and a pipe that nobody writes to never begins.
///
/// # Errors
/// [`InvalidInput`](io::ErrorKind::InvalidInput) for what is not a regular file,
/// [`FileTooLarge`](io::ErrorKind::FileTooLarge) above the limit, [`OutOfMemory`](io::ErrorKind::OutOfMemory), and what
/// else the system says.
pub fn read_bounded(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let file = open_regular(path)?;
    let length = file.metadata()?.len();
    check_length(length, limit)?;
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length as usize)?;
    // One byte more than allowed tells that a file grew past the limit while it was read.
    file.take(limit + 1).read_to_end(&mut bytes)?;
    check_length(bytes.len() as u64, limit)?;
    Ok(bytes)
}

/// Opens a regular file for reading; links are followed.
pub(super) fn open_regular(path: &Path) -> io::Result<File> {
    // Before it is opened: opening a pipe waits for whoever writes to it.
    if std::fs::metadata(path)?.is_file() {
        File::open(path)
    } else {
        let message = "it is not a regular file";
        Err(io::Error::new(io::ErrorKind::InvalidInput, message))
    }
}

fn check_length(length: u64, limit: u64) -> io::Result<()> {
    if length <= limit {
        return Ok(());
    }
    let message = match limit >> 20 {
        0 => format!("it is larger than {limit} bytes"),
        megabytes => format!("it is larger than {megabytes} MiB"),
    };
    Err(io::Error::new(io::ErrorKind::FileTooLarge, message))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_the_limit_and_not_beyond() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, b"four").unwrap();
        assert_eq!(read_bounded(&path, 4).unwrap(), b"four");
        let error = read_bounded(&path, 3).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::FileTooLarge);
        assert_eq!(error.to_string(), "it is larger than 3 bytes");
        // A file with a hole is long without taking room: refused by its length, before it is read.
        let file = File::create(&path).unwrap();
        file.set_len(MAX_DATA_BYTES + 1).unwrap();
        let error = read_bounded(&path, MAX_DATA_BYTES).unwrap_err();
        assert_eq!(error.to_string(), "it is larger than 16384 MiB");
    }

    #[test]
    fn a_folder_is_no_regular_file_and_a_missing_file_is_missing() {
        let folder = tempfile::tempdir().unwrap();
        let error = read_bounded(folder.path(), 1).unwrap_err();
        assert_eq!(error.to_string(), "it is not a regular file");
        let error = read_bounded(&folder.path().join("none"), 1).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_pipes_are_refused_without_waiting() {
        let folder = tempfile::tempdir().unwrap();
        let (pipe, link) = (folder.path().join("pipe"), folder.path().join("link"));
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
        for path in [&pipe, &link, Path::new("/dev/zero")] {
            let error = read_bounded(path, 1).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::InvalidInput, "{path:?}");
        }
    }
}
