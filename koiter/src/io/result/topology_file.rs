//! `topology.bin`: the faces of all parts.
//!
//! ```text
//! "KOITERTP"  u32 version  u64 vertices  u64 faces  u32 × 3 a face  u32 CRC-32
//! ```

use crate::io::bytes::{ByteReader, Endian};
use crate::io::checksum::crc32;

const MAGIC: &[u8; 8] = b"KOITERTP";
const VERSION: u32 = 1;

pub(super) fn encode(num_vertices: usize, faces: &[[u32; 3]]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(32 + 12 * faces.len());
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((num_vertices as u64).to_le_bytes());
    bytes.extend((faces.len() as u64).to_le_bytes());
    for index in faces.iter().flatten() {
        bytes.extend(index.to_le_bytes());
    }
    let checksum = crc32(&bytes);
    bytes.extend(checksum.to_le_bytes());
    bytes
}

/// Number of vertices and faces from the bytes of `topology.bin`; whether they fit each other is for
/// [`Manifest::check`](super::Manifest::check).
///
/// # Errors
/// What is wrong, as the end of a sentence that begins with the file's name.
pub fn decode_topology(bytes: &[u8]) -> Result<(usize, Vec<[u32; 3]>), String> {
    let body = checked_body(bytes, MAGIC, VERSION)?;
    let mut reader = ByteReader::new(body, Endian::Little);
    let short = || "it ends within the header".to_string();
    let num_vertices = reader.u64().ok_or_else(short)? as usize;
    let num_faces = reader.u64().ok_or_else(short)? as usize;
    if num_faces.checked_mul(12) != Some(reader.remaining()) {
        return Err(format!(
            "{num_faces} faces do not fit its {} bytes",
            bytes.len()
        ));
    }
    let mut faces = Vec::with_capacity(num_faces);
    while let (Some(a), Some(b), Some(c)) = (reader.u32(), reader.u32(), reader.u32()) {
        faces.push([a, b, c]);
    }
    Ok((num_vertices, faces))
}

/// What lies between magic and version in front and the checksum at the end, when all three are right.
pub(super) fn checked_body<'a>(
    bytes: &'a [u8],
    magic: &[u8; 8],
    version: u32,
) -> Result<&'a [u8], String> {
    let (content, checksum) = bytes
        .split_last_chunk::<4>()
        .ok_or_else(|| format!("it has only {} bytes", bytes.len()))?;
    let mut reader = ByteReader::new(content, Endian::Little);
    if reader.take(8) != Some(magic) {
        return Err("it does not start as such a file does".to_string());
    }
    // The version comes before the checksum, which another version may place elsewhere.
    match reader.u32() {
        Some(found) if found == version => {}
        Some(found) => {
            return Err(format!(
                "it has version {found}, this program reads {version}"
            ));
        }
        None => return Err("it ends within the header".to_string()),
    }
    if crc32(content) != u32::from_le_bytes(*checksum) {
        return Err(format!(
            "its {} bytes do not match their checksum (cut off or changed)",
            bytes.len()
        ));
    }
    Ok(&content[reader.offset()..])
}
