//! HDF5 files with what VTKHDF needs of the format: groups, attributes, and arrays in one piece each, not compressed.
//!
//! Superblock of version 2, object headers of version 2 with compact links and attributes. Reference: "HDF5 File Format
//! Specification Version 3.0", The HDF Group. All numbers are little-endian.

mod checksum;

use checksum::lookup3;

const SIGNATURE: &[u8; 8] = b"\x89HDF\r\n\x1a\n";
const SUPERBLOCK_LENGTH: usize = 48;
/// "No address".
const UNDEFINED: u64 = u64::MAX;

/// Message types of object headers.
mod message {
    pub(super) const DATASPACE: u8 = 0x01;
    pub(super) const LINK_INFO: u8 = 0x02;
    pub(super) const DATATYPE: u8 = 0x03;
    pub(super) const FILL_VALUE: u8 = 0x05;
    pub(super) const LINK: u8 = 0x06;
    pub(super) const LAYOUT: u8 = 0x08;
    pub(super) const GROUP_INFO: u8 = 0x0a;
    pub(super) const ATTRIBUTE: u8 = 0x0c;
}

/// A group: named children and attributes. Names have no `/`.
#[derive(Debug, Default)]
pub(super) struct Group {
    attributes: Vec<(String, Attribute)>,
    children: Vec<(String, Node)>,
}

#[derive(Debug)]
enum Node {
    Group(Group),
    Dataset(Dataset),
}

/// A value of an attribute.
#[derive(Debug)]
pub(super) enum Attribute {
    /// A text of fixed length.
    Text(String),
    /// One number.
    Integer(i64),
    /// A list of numbers.
    Integers(Vec<i64>),
    /// One number.
    Real(f64),
}

/// An array, the last index fastest.
#[derive(Debug)]
pub(super) struct Dataset {
    /// Of its numbers.
    pub(super) kind: NumberKind,
    /// Lengths.
    pub(super) shape: Vec<usize>,
    /// Numbers, little-endian.
    pub(super) bytes: Vec<u8>,
}

/// Kinds of numbers.
#[derive(Clone, Copy, Debug)]
pub(super) enum NumberKind {
    Int32,
    Int64,
    Float32,
    Float64,
}

impl Group {
    pub(super) fn attribute(&mut self, name: &str, value: Attribute) {
        self.attributes.push((name.to_string(), value));
    }

    pub(super) fn group(&mut self, name: &str, group: Group) {
        self.children.push((name.to_string(), Node::Group(group)));
    }

    pub(super) fn dataset(&mut self, name: &str, dataset: Dataset) {
        self.children
            .push((name.to_string(), Node::Dataset(dataset)));
    }

    /// A list of whole numbers, or a table of as many columns as `N`.
    pub(super) fn integers<const N: usize>(&mut self, name: &str, rows: &[[i64; N]]) {
        let shape = if N == 1 {
            vec![rows.len()]
        } else {
            vec![rows.len(), N]
        };
        let bytes = rows.as_flattened().iter().flat_map(|x| x.to_le_bytes());
        self.dataset(
            name,
            Dataset {
                kind: NumberKind::Int64,
                shape,
                bytes: bytes.collect(),
            },
        );
    }
}

/// A whole file whose root is `root`.
pub(super) fn file_bytes(root: Group) -> Vec<u8> {
    let mut bytes = vec![0; SUPERBLOCK_LENGTH];
    let root = write_group(&mut bytes, root);
    let mut superblock = SIGNATURE.to_vec();
    // Version; sizes of addresses and lengths; no flags.
    superblock.extend([2, 8, 8, 0]);
    for address in [0, UNDEFINED, bytes.len() as u64, root] {
        superblock.extend(address.to_le_bytes());
    }
    superblock.extend(lookup3(&superblock).to_le_bytes());
    bytes[..SUPERBLOCK_LENGTH].copy_from_slice(&superblock);
    bytes
}

/// Appends a group behind its children; returns the address of its header.
fn write_group(bytes: &mut Vec<u8>, group: Group) -> u64 {
    let mut header = Header::default();
    // Version, no flags, no heap and no index: links stand in the header.
    let mut link_info = vec![0, 0];
    link_info.extend(UNDEFINED.to_le_bytes());
    link_info.extend(UNDEFINED.to_le_bytes());
    header.message(message::LINK_INFO, &link_info);
    header.message(message::GROUP_INFO, &[0, 0]);
    for (name, value) in &group.attributes {
        header.message(message::ATTRIBUTE, &attribute(name, value));
    }
    for (name, node) in group.children {
        let address = match node {
            Node::Group(child) => write_group(bytes, child),
            Node::Dataset(dataset) => write_dataset(bytes, &dataset),
        };
        // Version, and a name whose length takes two bytes.
        let mut link = vec![1, 1];
        link.extend((name.len() as u16).to_le_bytes());
        link.extend(name.as_bytes());
        link.extend(address.to_le_bytes());
        header.message(message::LINK, &link);
    }
    header.write(bytes)
}

fn write_dataset(bytes: &mut Vec<u8>, dataset: &Dataset) -> u64 {
    let length = dataset.bytes.len() as u64;
    let address = match length {
        0 => UNDEFINED,
        _ => aligned_end(bytes),
    };
    bytes.extend(&dataset.bytes);
    let mut header = Header::default();
    header.message(message::DATASPACE, &dataspace(&dataset.shape));
    header.message(message::DATATYPE, &dataset.kind.datatype());
    // Version; space is there from the beginning; a fill value would be written if set; none is.
    header.message(message::FILL_VALUE, &[2, 1, 2, 0]);
    // Version; contiguous.
    let mut layout = vec![3, 1];
    layout.extend(address.to_le_bytes());
    layout.extend(length.to_le_bytes());
    header.message(message::LAYOUT, &layout);
    header.write(bytes)
}

fn attribute(name: &str, value: &Attribute) -> Vec<u8> {
    let (datatype, shape, data) = match value {
        Attribute::Text(text) => {
            // Strings of length 0 there are none; texts are padded with zeros.
            let mut data = text.as_bytes().to_vec();
            data.resize(data.len().max(1), 0);
            (text_datatype(data.len()), vec![], data)
        }
        Attribute::Integer(number) => {
            let data = number.to_le_bytes().to_vec();
            (NumberKind::Int64.datatype(), vec![], data)
        }
        Attribute::Integers(numbers) => {
            let data = numbers.iter().flat_map(|number| number.to_le_bytes());
            let shape = vec![numbers.len()];
            (NumberKind::Int64.datatype(), shape, data.collect())
        }
        Attribute::Real(number) => {
            let data = number.to_le_bytes().to_vec();
            (NumberKind::Float64.datatype(), vec![], data)
        }
    };
    let dataspace = dataspace(&shape);
    // Version, no flags.
    let mut bytes = vec![3, 0];
    for length in [name.len() + 1, datatype.len(), dataspace.len()] {
        bytes.extend((length as u16).to_le_bytes());
    }
    // The name is ASCII and ends in a 0.
    bytes.push(0);
    bytes.extend(name.as_bytes());
    bytes.push(0);
    bytes.extend(datatype);
    bytes.extend(dataspace);
    bytes.extend(data);
    bytes
}

/// Version 2: scalar without lengths, else simple; it cannot grow.
fn dataspace(shape: &[usize]) -> Vec<u8> {
    let mut bytes = vec![2, shape.len() as u8, 0, u8::from(!shape.is_empty())];
    bytes.extend(
        shape
            .iter()
            .flat_map(|&length| (length as u64).to_le_bytes()),
    );
    bytes
}

/// A text of fixed length, padded with zeros, ASCII.
fn text_datatype(length: usize) -> Vec<u8> {
    let mut bytes = vec![0x13, 1, 0, 0];
    bytes.extend((length as u32).to_le_bytes());
    bytes
}

impl NumberKind {
    fn datatype(self) -> Vec<u8> {
        match self {
            Self::Int32 => fixed_point(4),
            Self::Int64 => fixed_point(8),
            // Sign; exponent's place and length; mantissa's length; bias.
            Self::Float32 => floating_point(4, 31, [23, 8, 0, 23], 127),
            Self::Float64 => floating_point(8, 63, [52, 11, 0, 52], 1023),
        }
    }
}

/// Class 0, signed.
fn fixed_point(size: u32) -> Vec<u8> {
    let mut bytes = vec![0x10, 8, 0, 0];
    bytes.extend(size.to_le_bytes());
    bytes.extend([0, 0]);
    bytes.extend((8 * size as u16).to_le_bytes());
    bytes
}

/// Class 1, IEEE 754: the leading 1 of the mantissa is not stored.
fn floating_point(size: u32, sign: u8, places: [u8; 4], bias: u32) -> Vec<u8> {
    let mut bytes = vec![0x11, 0x20, sign, 0];
    bytes.extend(size.to_le_bytes());
    bytes.extend([0, 0]);
    bytes.extend((8 * size as u16).to_le_bytes());
    bytes.extend(places);
    bytes.extend(bias.to_le_bytes());
    bytes
}

/// Messages of an object header.
#[derive(Default)]
struct Header {
    messages: Vec<u8>,
}

impl Header {
    fn message(&mut self, kind: u8, data: &[u8]) {
        self.messages.push(kind);
        self.messages.extend((data.len() as u16).to_le_bytes());
        self.messages.push(0);
        self.messages.extend(data);
    }

    /// Appends the header and returns its address.
    fn write(self, bytes: &mut Vec<u8>) -> u64 {
        let address = aligned_end(bytes);
        let start = bytes.len();
        // Version; the length of the messages takes four bytes.
        bytes.extend(b"OHDR\x02\x02");
        bytes.extend((self.messages.len() as u32).to_le_bytes());
        bytes.extend(self.messages);
        let checksum = lookup3(&bytes[start..]);
        bytes.extend(checksum.to_le_bytes());
        address
    }
}

/// The end of the file, moved to a multiple of 8.
fn aligned_end(bytes: &mut Vec<u8>) -> u64 {
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes.len() as u64
}
