//! Numbers from a slice of bytes, with the position for error messages.

/// Byte order of a binary file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Endian {
    Little,
    Big,
}

/// Reads forward through bytes; every method returns `None` at the end instead of panicking.
pub(crate) struct ByteReader<'a> {
    bytes: &'a [u8],
    offset: usize,
    endian: Endian,
}

impl<'a> ByteReader<'a> {
    pub(crate) fn new(bytes: &'a [u8], endian: Endian) -> Self {
        Self {
            bytes,
            offset: 0,
            endian,
        }
    }

    /// Bytes read so far.
    pub(crate) fn offset(&self) -> usize {
        self.offset
    }

    /// Bytes left.
    pub(crate) fn remaining(&self) -> usize {
        self.bytes.len() - self.offset
    }

    pub(crate) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let end = self.offset.checked_add(count)?;
        let taken = self.bytes.get(self.offset..end)?;
        self.offset = end;
        Some(taken)
    }

    /// The next `N` bytes, least significant first.
    fn ordered<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut bytes: [u8; N] = self.take(N)?.try_into().ok()?;
        if self.endian == Endian::Big {
            bytes.reverse();
        }
        Some(bytes)
    }

    pub(crate) fn u8(&mut self) -> Option<u8> {
        self.ordered().map(u8::from_le_bytes)
    }

    pub(crate) fn u16(&mut self) -> Option<u16> {
        self.ordered().map(u16::from_le_bytes)
    }

    pub(crate) fn u32(&mut self) -> Option<u32> {
        self.ordered().map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Option<u64> {
        self.ordered().map(u64::from_le_bytes)
    }

    pub(crate) fn f32(&mut self) -> Option<f32> {
        self.ordered().map(f32::from_le_bytes)
    }

    pub(crate) fn f64(&mut self) -> Option<f64> {
        self.ordered().map(f64::from_le_bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_in_both_byte_orders() {
        let bytes = [1, 0, 0, 0, 2];
        assert_eq!(ByteReader::new(&bytes, Endian::Little).u32(), Some(1));
        assert_eq!(ByteReader::new(&bytes, Endian::Big).u32(), Some(1 << 24));
    }

    #[test]
    fn the_end_is_none_and_moves_nothing() {
        let mut reader = ByteReader::new(&[7, 8], Endian::Little);
        assert_eq!(reader.u32(), None);
        assert_eq!(reader.take(usize::MAX), None);
        assert_eq!((reader.offset(), reader.remaining()), (0, 2));
        assert_eq!(reader.u16(), Some(0x0807));
        assert_eq!(reader.u8(), None);
    }
}
