//! Reading a result folder, also of a run that is still going on.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::error::{read_file, read_if_there, unreadable, while_trying};
use super::frame::HEADER_LENGTH;
use super::{
    FRAMES, Frame, FrameInfo, Manifest, Part, REST, ResultError, STATS, SUMMARY, TOPOLOGY,
    decode_topology, frame_path,
    frame_probe::{Element, FrameProbe, ProbeError, probe_frame},
    rest_file,
};
use crate::audit::RestFace;
use crate::io::bounded_read::open_regular;

/// A result folder opened for reading; frames are read when asked for.
#[derive(Clone, Debug)]
pub struct ResultReader {
    folder: PathBuf,
    manifest: Manifest,
    faces: Vec<[u32; 3]>,
    len: usize,
    count: fn(&Path) -> Result<usize, ResultError>,
}

impl ResultReader {
    /// Reads manifest and topology and counts the frames.
    ///
    /// # Errors
    /// Not a result folder, a newer format, a broken file, a missing frame, a refusal of the system.
    pub fn open(folder: &Path) -> Result<Self, ResultError> {
        Self::open_with(folder, count_frames)
    }

    /// As [`ResultReader::open`], but frames may be missing: for who looks at each anyway. The length is then that up to
    /// the last.
    ///
    /// # Errors
    /// As there, but for missing frames.
    pub fn open_with_gaps(folder: &Path) -> Result<Self, ResultError> {
        Self::open_with(folder, |folder| {
            Ok(frame_indices(folder)?.last().map_or(0, |last| last + 1))
        })
    }

    fn open_with(
        folder: &Path,
        count: fn(&Path) -> Result<usize, ResultError>,
    ) -> Result<Self, ResultError> {
        let manifest = Manifest::read(folder)?;
        let path = folder.join(TOPOLOGY);
        let bytes = read_file(&path)?;
        let broken = |reason| ResultError::Broken {
            path: path.clone(),
            reason,
        };
        let (num_vertices, faces) = decode_topology(&bytes).map_err(broken)?;
        if num_vertices != manifest.num_vertices() {
            let expected = manifest.num_vertices();
            return Err(broken(format!(
                "it has {num_vertices} vertices, the manifest {expected}"
            )));
        }
        manifest.check(&faces).map_err(broken)?;
        let len = count(folder)?;
        Ok(Self {
            folder: folder.to_path_buf(),
            manifest,
            faces,
            len,
            count,
        })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What the run was made of.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The faces of all parts, by the vertex numbers of the whole.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The parts in a frame.
    pub fn parts_in<'a>(&'a self, frame: &'a Frame) -> &'a [Part] {
        let own = frame.topology.as_ref();
        own.map_or(&self.manifest.parts, |own| &own.parts)
    }

    /// The faces in a frame, by the vertex numbers of the whole.
    pub fn faces_in<'a>(&'a self, frame: &'a Frame) -> &'a [[u32; 3]] {
        frame
            .topology
            .as_ref()
            .map_or(&self.faces, |own| &own.faces)
    }

    /// Number of frames when the folder was opened or last refreshed.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no frame.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Counts the frames again: a run that goes on adds to them.
    ///
    /// # Errors
    /// A missing frame, unless the folder was opened with gaps; a refusal of the system.
    pub fn refresh(&mut self) -> Result<(), ResultError> {
        self.len = (self.count)(&self.folder)?;
        Ok(())
    }

    /// Reads and checks frame `index`.
    ///
    /// # Errors
    /// No such frame, a broken file, a refusal of the system.
    pub fn frame(&self, index: usize) -> Result<Frame, ResultError> {
        let path = self.existing_frame(index)?;
        let bytes = read_file(&path)?;
        let broken = |reason| ResultError::Broken {
            path: path.clone(),
            reason,
        };
        let mut frame = Frame::decode(&bytes).map_err(broken)?;
        if let Some(own) = &mut frame.topology {
            let parts = &self.manifest.parts;
            if own.parts.len() != parts.len() {
                let (found, expected) = (own.parts.len(), parts.len());
                return Err(broken(format!(
                    "it has {found} parts, the manifest {expected}"
                )));
            }
            for (own, part) in own.parts.iter_mut().zip(parts) {
                *own = Part {
                    vertices: own.vertices.clone(),
                    faces: own.faces.clone(),
                    ..part.clone()
                };
            }
        }
        frame
            .check(self.manifest.num_vertices(), self.manifest.num_faces())
            .map_err(broken)?;
        Ok(frame)
    }

    /// Step and time of frame `index`, from its first bytes only.
    ///
    /// # Errors
    /// No such frame, a file that does not start as a frame, a refusal of the system.
    pub fn frame_info(&self, index: usize) -> Result<FrameInfo, ResultError> {
        let path = self.existing_frame(index)?;
        let mut bytes = Vec::with_capacity(HEADER_LENGTH);
        open_regular(&path)
            .and_then(|file| file.take(HEADER_LENGTH as u64).read_to_end(&mut bytes))
            .map_err(unreadable(&path))?;
        Frame::decode_info(&bytes).map_err(|reason| ResultError::Broken { path, reason })
    }

    /// One vertex or face of frame `index`, of which only these bytes are read: for its history over thousands of frames. The
    /// checksum of the frame is not looked at.
    ///
    /// # Errors
    /// No such frame, vertex or face, a file that is none, a refusal of the system.
    pub fn probe(&self, index: usize, element: Element) -> Result<FrameProbe, ResultError> {
        let path = self.existing_frame(index)?;
        let counts = (self.manifest.num_vertices(), self.manifest.num_faces());
        let mut file = open_regular(&path).map_err(unreadable(&path))?;
        probe_frame(&mut file, counts, element).map_err(|error| match error {
            ProbeError::Io(source) => unreadable(&path)(source),
            ProbeError::Broken(reason) => ResultError::Broken {
                path: path.clone(),
                reason,
            },
        })
    }

    /// What every face is at rest, in the order of [`ResultReader::faces`]; `None` in results of versions that did not
    /// write it.
    ///
    /// # Errors
    /// A broken file, a refusal of the system.
    pub fn rest(&self) -> Result<Option<Vec<RestFace>>, ResultError> {
        let path = self.folder.join(REST);
        let Some(bytes) = read_if_there(&path)? else {
            return Ok(None);
        };
        match rest_file::decode(&bytes, self.faces.len()) {
            Ok(rest) => Ok(Some(rest)),
            Err(reason) => Err(ResultError::Broken { path, reason }),
        }
    }

    /// The lines of `stats.jsonl`; see [`decode_stats`].
    ///
    /// # Errors
    /// A complete line that is not JSON, a refusal of the system.
    pub fn stats(&self) -> Result<Vec<serde_json::Value>, ResultError> {
        let path = self.folder.join(STATS);
        let Some(bytes) = read_if_there(&path)? else {
            return Ok(Vec::new());
        };
        decode_stats(&bytes).map_err(|reason| ResultError::Broken { path, reason })
    }

    /// `summary.json`, if the run has ended.
    ///
    /// # Errors
    /// A file that is not JSON, a refusal of the system.
    pub fn summary(&self) -> Result<Option<serde_json::Value>, ResultError> {
        let path = self.folder.join(SUMMARY);
        let Some(bytes) = read_if_there(&path)? else {
            return Ok(None);
        };
        serde_json::from_slice(&bytes)
            .map(Some)
            .map_err(|error| ResultError::Broken {
                path,
                reason: error.to_string(),
            })
    }

    fn existing_frame(&self, index: usize) -> Result<PathBuf, ResultError> {
        if index < self.len {
            Ok(frame_path(&self.folder, index))
        } else {
            let (len, path) = (self.len, self.folder.clone());
            Err(ResultError::NoFrame { index, len, path })
        }
    }
}

/// The lines of `stats.jsonl`; a last line that is not complete (the run goes on, or was killed) is left out.
///
/// # Errors
/// What is wrong, as the end of a sentence that begins with the file's name.
pub fn decode_stats(bytes: &[u8]) -> Result<Vec<serde_json::Value>, String> {
    bytes
        .split_inclusive(|&byte| byte == b'\n')
        .filter(|line| line.ends_with(b"\n"))
        .enumerate()
        .map(|(index, line)| {
            serde_json::from_slice(line)
                .map_err(|error| format!("line {} is not JSON ({error})", index + 1))
        })
        .collect()
}

/// Numbers of the frame files, growing.
fn frame_indices(folder: &Path) -> Result<Vec<usize>, ResultError> {
    let frames = folder.join(FRAMES);
    let mut indices = Vec::new();
    for entry in fs::read_dir(&frames).map_err(while_trying("list", &frames))? {
        let name = entry.map_err(while_trying("list", &frames))?.file_name();
        let index = name
            .to_str()
            .and_then(|name| name.strip_suffix(".bin")?.parse::<usize>().ok());
        indices.extend(index);
    }
    indices.sort_unstable();
    Ok(indices)
}

/// Number of frame files; they must be numbered from 0 without gap.
fn count_frames(folder: &Path) -> Result<usize, ResultError> {
    let indices = frame_indices(folder)?;
    match indices
        .iter()
        .enumerate()
        .find(|&(expected, &index)| expected != index)
    {
        Some((missing, _)) => Err(ResultError::Broken {
            path: frame_path(folder, missing),
            reason: "the file is missing, though later frames are there".to_string(),
        }),
        None => Ok(indices.len()),
    }
}
