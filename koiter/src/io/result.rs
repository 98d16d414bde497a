//! The result folder of a run: what was simulated, its topology, a file a frame, a line of figures a step.
//!
//! ```text
//! manifest.json     format, version, title, scene text, parts
//! topology.bin      the faces of all parts
//! rest.bin          what every face is at rest
//! frames/00000.bin  step, time, positions, fields; 00001.bin, …
//! stats.jsonl       one JSON object a step
//! checkpoint.bin    where an interrupted run goes on
//! summary.json      one JSON object, at the end of the run
//! request.txt       what someone asks of the run: pause or stop
//! hand.txt          where a hand pulls, while the run can be played with
//! ```
//!
//! Vertices and faces of all parts are numbered through; a [`Part`] says which ranges are its own. Numbers in the
//! binary files are little-endian, each such file ends in a CRC-32 of what stands before. Files are written under
//! another name and renamed when they are complete, so a run that is killed leaves whole frames only.

mod checkpoint;
mod error;
mod folder_lock;
mod frame;
mod frame_probe;
mod hand;
mod manifest;
mod reader;
mod request;
mod rest_file;
mod topology_file;
mod writer;

pub use checkpoint::{Checkpoint, CheckpointError, Totals};
pub use error::ResultError;
pub use folder_lock::FolderLock;
pub use frame::{Field, Frame, FrameInfo, FrameTopology};
pub use frame_probe::{Element, FrameProbe};
pub use hand::Hand;
pub use manifest::{Manifest, Part, PartKind, UpAxis};
pub use reader::{ResultReader, decode_stats};
pub use request::RunRequest;
pub use topology_file::decode_topology;
pub use writer::{ResultWriter, keep_lines};

use std::path::{Path, PathBuf};

const MANIFEST: &str = "manifest.json";
const TOPOLOGY: &str = "topology.bin";
const REST: &str = "rest.bin";
const FRAMES: &str = "frames";
const STATS: &str = "stats.jsonl";
const CHECKPOINT: &str = "checkpoint.bin";
const SUMMARY: &str = "summary.json";
const REQUEST: &str = "request.txt";
const HAND: &str = "hand.txt";

fn frame_path(folder: &Path, index: usize) -> PathBuf {
    folder.join(FRAMES).join(format!("{index:05}.bin"))
}

#[cfg(test)]
mod tests;
