//! Arrays of floating-point numbers in NumPy's format NPY. Reference: NEP 1.

use crate::io::bytes::{ByteReader, Endian};

const MAGIC: &[u8] = b"\x93NUMPY";

/// An array, the last index fastest.
#[derive(Debug, PartialEq)]
pub(super) struct Array {
    pub(super) shape: Vec<usize>,
    pub(super) values: Vec<f64>,
}

/// Reads an array of `float32` or `float64`.
///
/// # Errors
/// What is wrong, as the end of a sentence.
pub(super) fn parse_npy(bytes: &[u8]) -> Result<Array, String> {
    let mut reader = ByteReader::new(bytes, Endian::Little);
    let header = read_header(&mut reader).ok_or("it does not begin as NPY files do")?;
    let endian = match value_of(header, "descr") {
        Some("'<f8'" | "'<f4'") => Endian::Little,
        Some("'>f8'" | "'>f4'") => Endian::Big,
        other => {
            let kind = other.unwrap_or("without a type");
            return Err(format!(
                "its numbers are {kind}; give it float32 or float64"
            ));
        }
    };
    if value_of(header, "fortran_order") != Some("False") {
        return Err("it is in Fortran's order; give it numpy.ascontiguousarray".to_string());
    }
    let shape = shape(header).ok_or("its shape cannot be read")?;
    let is_double = header.contains("f8'");
    let size = if is_double { 8 } else { 4 };
    let count = shape
        .iter()
        .try_fold(1_usize, |count, &length| count.checked_mul(length));
    let length = count.and_then(|count| count.checked_mul(size));
    if length != Some(reader.remaining()) {
        let found = reader.remaining();
        return Err(format!(
            "its shape {shape:?} does not fit its {found} bytes"
        ));
    }
    let body = reader.take(reader.remaining()).unwrap_or_default();
    let mut reader = ByteReader::new(body, endian);
    let mut next = || match is_double {
        true => reader.f64(),
        false => reader.f32().map(f64::from),
    };
    let values = std::iter::from_fn(&mut next).collect();
    Ok(Array { shape, values })
}

/// The dictionary at the beginning, as text.
fn read_header<'a>(reader: &mut ByteReader<'a>) -> Option<&'a str> {
    if reader.take(MAGIC.len())? != MAGIC {
        return None;
    }
    let version = reader.u8()?;
    reader.u8()?;
    let length = match version {
        1 => usize::from(reader.u16()?),
        _ => reader.u32()? as usize,
    };
    str::from_utf8(reader.take(length)?).ok()
}

/// The value of a key, up to the comma behind it; not for tuples.
fn value_of<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = header.split_once(&format!("'{key}':"))?;
    rest.split([',', '}']).next().map(str::trim)
}

fn shape(header: &str) -> Option<Vec<usize>> {
    let (_, rest) = header.split_once("'shape':")?;
    let (_, rest) = rest.split_once('(')?;
    let (lengths, _) = rest.split_once(')')?;
    let lengths = lengths
        .split(',')
        .map(str::trim)
        .filter(|text| !text.is_empty());
    lengths.map(|text| text.parse().ok()).collect()
}
