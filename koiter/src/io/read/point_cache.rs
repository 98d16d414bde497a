//! Positions over time of vertices whose mesh is known otherwise: PC2 point caches, and NPZ files of NumPy.
//!
//! The layout of PC2 is told in [`crate::io::write`]. Of an NPZ file the arrays `positions` (f, n, 3) and, if it is there,
//! `times` (f) [s] are read; they are what `koiter export --to npz` writes.

mod npy;
mod zip;

use super::ParseError;
use crate::Vec3;
use crate::io::bytes::{ByteReader, Endian};
use crate::io::write::PC2_MAGIC;
use crate::scene::PointCache;
use npy::parse_npy;
use zip::stored_file;

/// Frames an array of coordinates may have, and vertices: more have more points than memory takes.
const LARGEST_COUNT: usize = 1 << 31;

/// Reads a point cache from the bytes of its file, whatever they are.
///
/// # Errors
/// The place and nature of the first fault.
pub fn parse_point_cache(bytes: &[u8]) -> Result<PointCache, ParseError> {
    let cache = if bytes.starts_with(PC2_MAGIC) {
        parse_pc2(&bytes[PC2_MAGIC.len()..])?
    } else if bytes.starts_with(zip::MAGIC) {
        parse_npz(bytes)?
    } else {
        let problem = "it is neither a PC2 point cache nor an NPZ file of NumPy";
        return Err(ParseError::in_file(problem));
    };
    if cache.frames.iter().all(Vec::is_empty) {
        return Err(ParseError::in_file("it has no positions"));
    }
    for (number, frame) in cache.frames.iter().enumerate() {
        if let Some(vertex) = frame.iter().position(|x| !x.iter().all(|v| v.is_finite())) {
            let problem = format!("vertex {vertex} of frame {number} is not at finite numbers");
            return Err(ParseError::in_file(problem));
        }
    }
    Ok(cache)
}

fn parse_pc2(bytes: &[u8]) -> Result<PointCache, ParseError> {
    let mut reader = ByteReader::new(bytes, Endian::Little);
    let header = (|| Some([reader.u32()?, reader.u32()?, reader.u32()?, reader.u32()?]))();
    let Some([num_points, _first_frame, _rate, num_frames]) = header else {
        return Err(ParseError::in_file("it ends within its header"));
    };
    let (num_points, num_frames) = (num_points as usize, num_frames as usize);
    let expected = num_points
        .checked_mul(12)
        .and_then(|size| size.checked_mul(num_frames));
    if expected != Some(reader.remaining()) {
        let problem = format!(
            "its header says {num_frames} frames of {num_points} points, which are not the {} bytes that follow",
            reader.remaining()
        );
        return Err(ParseError::in_file(problem));
    }
    let mut point = || {
        let [x, y, z] = [reader.f32()?, reader.f32()?, reader.f32()?].map(f64::from);
        Some(Vec3::new(x, y, z))
    };
    let mut frames = Vec::new();
    // Without points the number of frames has no bytes to answer for it.
    for _ in 0..if num_points == 0 { 0 } else { num_frames } {
        frames.push((0..num_points).map_while(|_| point()).collect());
    }
    Ok(PointCache {
        times: None,
        frames,
    })
}

fn parse_npz(bytes: &[u8]) -> Result<PointCache, ParseError> {
    let array = |name: &str| -> Result<_, ParseError> {
        let file = stored_file(bytes, &format!("{name}.npy"))?;
        let in_array = |problem| ParseError::in_file(format!("array '{name}': {problem}"));
        file.map(|bytes| parse_npy(bytes).map_err(in_array))
            .transpose()
    };
    let Some(positions) = array("positions")? else {
        let problem = "it has no array 'positions' of frames, vertices and coordinates";
        return Err(ParseError::in_file(problem));
    };
    let [num_frames, num_points, 3] = positions.shape[..] else {
        let problem = format!(
            "array 'positions' has the shape {:?}; give it frames, vertices and 3 coordinates",
            positions.shape
        );
        return Err(ParseError::in_file(problem));
    };
    let times = array("times")?;
    if let Some(times) = times.as_ref().filter(|times| times.shape != [num_frames]) {
        let problem = format!(
            "array 'times' has the shape {:?} for {num_frames} frames; give it one number a frame",
            times.shape
        );
        return Err(ParseError::in_file(problem));
    }
    let (points, _) = positions.values.as_chunks::<3>();
    let frames = points.chunks(num_points.clamp(1, LARGEST_COUNT));
    Ok(PointCache {
        times: times.map(|times| times.values),
        frames: frames
            .map(|frame| frame.iter().map(|x| Vec3::from(*x)).collect())
            .collect(),
    })
}

#[cfg(test)]
mod tests;
