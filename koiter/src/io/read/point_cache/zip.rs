//! A file of a ZIP archive, found by the archive's directory.

use super::ParseError;
use crate::io::bytes::{ByteReader, Endian};

/// How an archive begins that has files.
pub(super) const MAGIC: &[u8] = b"PK\x03\x04";
const CENTRAL_HEADER: &[u8] = b"PK\x01\x02";
const END: &[u8] = b"PK\x05\x06";
const END_LENGTH: usize = 22;
/// Longest comment behind the end.
const LONGEST_COMMENT: usize = u16::MAX as usize;

/// The bytes of the file `name`; `None` if the archive has none of this name.
pub(super) fn stored_file<'a>(
    archive: &'a [u8],
    name: &str,
) -> Result<Option<&'a [u8]>, ParseError> {
    let broken = || ParseError::in_file("its directory, at its end, is damaged or cut off");
    let mut directory = directory(archive).ok_or_else(broken)?;
    while directory.starts_with(CENTRAL_HEADER) {
        let mut reader = ByteReader::new(directory, Endian::Little);
        let entry = Entry::read(&mut reader).ok_or_else(broken)?;
        directory = &directory[reader.offset()..];
        if entry.name != name.as_bytes() {
            continue;
        }
        if entry.method != 0 {
            let problem = format!("'{name}' is compressed; write it with numpy.savez");
            return Err(ParseError::in_file(problem));
        }
        return content(archive, &entry).map(Some).ok_or_else(broken);
    }
    Ok(None)
}

/// What the directory says of a file.
struct Entry<'a> {
    method: u16,
    length: usize,
    offset: usize,
    name: &'a [u8],
}

impl<'a> Entry<'a> {
    fn read(reader: &mut ByteReader<'a>) -> Option<Self> {
        // Signature, versions, flags.
        reader.take(4 + 2 + 2 + 2)?;
        let method = reader.u16()?;
        // Time, date, checksum, compressed length.
        reader.take(2 + 2 + 4 + 4)?;
        let length = reader.u32()? as usize;
        let [name, extra, comment] = [reader.u16()?, reader.u16()?, reader.u16()?];
        // Disk, attributes.
        reader.take(2 + 2 + 4)?;
        let offset = reader.u32()? as usize;
        let name = reader.take(name.into())?;
        reader.take(usize::from(extra) + usize::from(comment))?;
        Some(Self {
            method,
            length,
            offset,
            name,
        })
    }
}

/// From the first entry of the directory on.
fn directory(archive: &[u8]) -> Option<&[u8]> {
    let earliest = archive.len().saturating_sub(END_LENGTH + LONGEST_COMMENT);
    let last = archive.len().checked_sub(END_LENGTH)?;
    let end = (earliest..=last)
        .rev()
        .find(|&at| archive[at..].starts_with(END))?;
    let mut reader = ByteReader::new(&archive[end..], Endian::Little);
    reader.take(16)?;
    archive.get(reader.u32()? as usize..)
}

/// Behind the file's own header, whose names may be longer than the directory's.
fn content<'a>(archive: &'a [u8], entry: &Entry) -> Option<&'a [u8]> {
    let mut reader = ByteReader::new(archive.get(entry.offset..)?, Endian::Little);
    reader.take(26)?;
    let [name, extra] = [reader.u16()?, reader.u16()?];
    reader.take(usize::from(name) + usize::from(extra))?;
    reader.take(entry.length)
}
