//! Writing a result folder.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;

use super::error::{read_if_there, while_trying};
use super::{
    CHECKPOINT, Checkpoint, FRAMES, FolderLock, Frame, MANIFEST, Manifest, REQUEST, REST,
    ResultError, ResultReader, STATS, SUMMARY, TOPOLOGY, frame_path, rest_file, topology_file,
};
use crate::audit::RestFace;
use crate::io::write_atomically;

/// Another file of a run, which belongs to the old result when a folder is written anew.
const PROBES: &str = "probes.csv";

/// Writes a result folder, frame by frame.
#[derive(Debug)]
pub struct ResultWriter {
    lock: FolderLock,
    num_vertices: usize,
    num_faces: usize,
    num_frames: usize,
    stats: File,
}

impl ResultWriter {
    /// Starts a result in `folder`, which is created if needed.
    ///
    /// `faces` are those of all parts, by the vertex numbers of the whole. A folder that holds an old Koiter result is
    /// written anew: its frames, `rest.bin`, `stats.jsonl`, `summary.json`, `checkpoint.bin` and `probes.csv` are deleted first,
    /// everything else in it stays.
    ///
    /// # Errors
    /// A folder with other content, a manifest that contradicts itself or the faces, a refusal of the system.
    pub fn create(
        folder: &Path,
        manifest: &Manifest,
        faces: &[[u32; 3]],
    ) -> Result<Self, ResultError> {
        // Before the folder is made: a manifest that is refused leaves nothing behind.
        check_manifest(manifest, faces)?;
        Self::create_locked(FolderLock::create(folder)?, manifest, faces)
    }

    /// [`ResultWriter::create`] in a folder that is locked already.
    ///
    /// # Errors
    /// As there.
    pub fn create_locked(
        lock: FolderLock,
        manifest: &Manifest,
        faces: &[[u32; 3]],
    ) -> Result<Self, ResultError> {
        check_manifest(manifest, faces)?;
        let folder = lock.folder();
        let is_empty = fs::read_dir(folder)
            .map_err(while_trying("list", folder))?
            .next()
            .is_none();
        if !is_empty {
            check_is_ours(folder)?;
            clear_old_result(folder)?;
        }
        let frames = folder.join(FRAMES);
        fs::create_dir_all(&frames).map_err(while_trying("create the folder", &frames))?;
        // The manifest first: a kill from here on leaves a folder that is known as ours and can be written anew.
        write_manifest(folder, manifest)?;
        let path = folder.join(TOPOLOGY);
        let bytes = topology_file::encode(manifest.num_vertices(), faces);
        write_atomically(&path, &bytes).map_err(while_trying("write", &path))?;
        Self::open_at(lock, manifest, 0)
    }

    /// Goes on with an interrupted run of the same parts: keeps the first `frames` frames and `stats` lines of figures,
    /// drops the rest.
    ///
    /// # Errors
    /// Not a result, or one of other parts; fewer frames or lines than are to be kept, or a damaged frame among them; a
    /// refusal of the system.
    pub fn resume(
        folder: &Path,
        manifest: &Manifest,
        frames: usize,
        stats: usize,
    ) -> Result<Self, ResultError> {
        Self::resume_locked(FolderLock::take(folder)?, manifest, frames, stats)
    }

    /// [`ResultWriter::resume`] in a folder that is locked already.
    ///
    /// # Errors
    /// As there.
    pub fn resume_locked(
        lock: FolderLock,
        manifest: &Manifest,
        frames: usize,
        stats: usize,
    ) -> Result<Self, ResultError> {
        let folder = lock.folder();
        let reader = ResultReader::open(folder)?;
        if reader.manifest().parts != manifest.parts {
            return Err(ResultError::Broken {
                path: folder.join(MANIFEST),
                reason: "its parts are not those of the run that is to go on".to_string(),
            });
        }
        if frames > reader.len() {
            let (index, len) = (frames - 1, reader.len());
            return Err(ResultError::NoFrame {
                index,
                len,
                path: folder.to_path_buf(),
            });
        }
        // What may be refused comes before what is deleted. Every kept frame is read: one that a later `render` stumbles
        // over would be found when the hours are spent.
        (0..frames).try_for_each(|index| reader.frame(index).map(drop))?;
        keep_lines(&folder.join(STATS), stats)?;
        for index in (frames..reader.len()).rev() {
            let path = frame_path(folder, index);
            fs::remove_file(&path).map_err(while_trying("delete", &path))?;
        }
        for name in [SUMMARY, REQUEST] {
            remove_if_there(&folder.join(name))?;
        }
        // The scene may have got a later end.
        write_manifest(folder, manifest)?;
        Self::open_at(lock, manifest, frames)
    }

    fn open_at(
        lock: FolderLock,
        manifest: &Manifest,
        num_frames: usize,
    ) -> Result<Self, ResultError> {
        let path = lock.folder().join(STATS);
        let stats = OpenOptions::new().create(true).append(true).open(&path);
        Ok(Self {
            num_vertices: manifest.num_vertices(),
            num_faces: manifest.num_faces(),
            num_frames,
            stats: stats.map_err(while_trying("open", &path))?,
            lock,
        })
    }

    /// Number of frames written.
    pub fn num_frames(&self) -> usize {
        self.num_frames
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        self.lock.folder()
    }

    /// Writes the next frame; it is on the disk when this returns.
    ///
    /// # Errors
    /// Wrong lengths, a time or position that is not finite, a refusal of the system.
    pub fn write_frame(&mut self, frame: &Frame) -> Result<(), ResultError> {
        frame
            .check(self.num_vertices, self.num_faces)
            .map_err(|reason| ResultError::Invalid {
                what: "frame",
                reason,
            })?;
        let path = frame_path(self.folder(), self.num_frames);
        let bytes = frame.encode(self.num_faces);
        write_atomically(&path, &bytes).map_err(while_trying("write", &path))?;
        self.num_frames += 1;
        Ok(())
    }

    /// Writes the rest shape, `rest.bin`: of every face, in the order of the topology.
    ///
    /// # Errors
    /// Another number of faces, a refusal of the system.
    pub fn write_rest(&self, rest: &[RestFace]) -> Result<(), ResultError> {
        if rest.len() != self.num_faces {
            let (found, expected) = (rest.len(), self.num_faces);
            return Err(ResultError::Invalid {
                what: "rest shape",
                reason: format!("it has {found} faces, the topology {expected}"),
            });
        }
        let path = self.folder().join(REST);
        write_atomically(&path, &rest_file::encode(rest)).map_err(while_trying("write", &path))
    }

    /// Appends `record` to `stats.jsonl` as one line. Numbers that are not finite become `null`.
    ///
    /// # Errors
    /// A refusal of the system.
    pub fn append_stats(&mut self, record: &impl Serialize) -> Result<(), ResultError> {
        let path = self.folder().join(STATS);
        let mut line = serde_json::to_string(record).map_err(|source| ResultError::Json {
            path: path.clone(),
            source,
        })?;
        line.push('\n');
        // One call, so that readers of a running simulation see whole lines.
        self.stats
            .write_all(line.as_bytes())
            .map_err(while_trying("write", &path))
    }

    /// Writes `checkpoint.bin`, after all lines of figures are on the disk: what it says was done is there.
    ///
    /// # Errors
    /// A refusal of the system; the checkpoint before is then still there.
    pub fn write_checkpoint(&self, checkpoint: &Checkpoint) -> Result<(), ResultError> {
        let path = self.folder().join(STATS);
        self.stats
            .sync_data()
            .map_err(while_trying("write", &path))?;
        let path = self.folder().join(CHECKPOINT);
        write_atomically(&path, &checkpoint.to_bytes()).map_err(while_trying("write", &path))
    }

    /// Writes `summary.json`.
    ///
    /// # Errors
    /// A refusal of the system.
    pub fn write_summary(&self, summary: &impl Serialize) -> Result<(), ResultError> {
        let path = self.folder().join(SUMMARY);
        let json = serde_json::to_string_pretty(summary).map_err(|source| ResultError::Json {
            path: path.clone(),
            source,
        })?;
        write_atomically(&path, json.as_bytes()).map_err(while_trying("write", &path))
    }
}

fn check_manifest(manifest: &Manifest, faces: &[[u32; 3]]) -> Result<(), ResultError> {
    (manifest.check(faces)).map_err(|reason| ResultError::Invalid {
        what: "manifest",
        reason,
    })
}

fn write_manifest(folder: &Path, manifest: &Manifest) -> Result<(), ResultError> {
    let path = folder.join(MANIFEST);
    let json = manifest.to_json().map_err(|source| ResultError::Json {
        path: path.clone(),
        source,
    })?;
    write_atomically(&path, json.as_bytes()).map_err(while_trying("write", &path))
}

/// Refuses a folder with other content than a result.
fn check_is_ours(folder: &Path) -> Result<(), ResultError> {
    match Manifest::read(folder) {
        // A damaged or newer manifest is still ours.
        Ok(_) | Err(ResultError::Broken { .. } | ResultError::Version { .. }) => Ok(()),
        Err(ResultError::NotAResult { .. }) => Err(ResultError::NotEmpty {
            path: folder.to_path_buf(),
        }),
        Err(error) => Err(error),
    }
}

/// Deletes what an old result consists of. The manifest stays until it is replaced.
fn clear_old_result(folder: &Path) -> Result<(), ResultError> {
    // The summary first: without it nothing says that the run had ended. Then the checkpoint, since what follows it is
    // gone, and the topology: without it a half-cleared result is not taken for a whole one.
    for name in [SUMMARY, CHECKPOINT, TOPOLOGY, REST, STATS, PROBES, REQUEST] {
        remove_if_there(&folder.join(name))?;
    }
    let frames = folder.join(FRAMES);
    if frames.is_dir() {
        for entry in fs::read_dir(&frames).map_err(while_trying("list", &frames))? {
            let path = entry.map_err(while_trying("list", &frames))?.path();
            if path
                .extension()
                .is_some_and(|extension| extension == "bin" || extension == "tmp")
            {
                remove_if_there(&path)?;
            }
        }
    }
    Ok(())
}

fn remove_if_there(path: &Path) -> Result<(), ResultError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(while_trying("delete", path)(error))
        }
        _ => Ok(()),
    }
}

/// Cuts a text file after its first `count` lines; a last line that a kill cut short is no line.
///
/// # Errors
/// Fewer lines, a refusal of the system.
pub fn keep_lines(path: &Path, count: usize) -> Result<(), ResultError> {
    let bytes = read_if_there(path)?.unwrap_or_default();
    let mut lines = bytes
        .split_inclusive(|&byte| byte == b'\n')
        .filter(|line| line.ends_with(b"\n"));
    let mut length = 0;
    for kept in 0..count {
        match lines.next() {
            Some(line) => length += line.len(),
            None => {
                let reason = format!("it has {kept} complete lines, {count} are needed to go on");
                return Err(ResultError::Broken {
                    path: path.to_path_buf(),
                    reason,
                });
            }
        }
    }
    write_atomically(path, &bytes[..length]).map_err(while_trying("write", path))
}
