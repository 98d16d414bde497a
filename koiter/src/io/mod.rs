//! Files: meshes in, pictures' raw material out, and the result folder of a run.
//!
//! Nothing else in the library reads or writes files. Every parser takes bytes, so that it can be tested and fuzzed
//! without a file system, and no parser panics, hangs or reserves memory on the word of a header.

mod atomic_file;
mod bounded_read;
mod bytes;
mod checksum;
pub mod read;
pub mod record;
pub mod result;
pub mod write;

pub use atomic_file::write_atomically;
pub use bounded_read::{MAX_DATA_BYTES, MAX_SCENE_BYTES, read_bounded};
pub use checksum::crc32;
pub use read::{RawMesh, ReadError, read_mesh, read_points, read_quads, read_texture};
pub use result::Checkpoint;
