//! Frames as whole numbers of 16 bits, so that they compress well: for files that are sent.
//!
//! ```text
//! number = round((value − low) / step),  0 … 65534; 65535: no value
//! chunk  = zlib of, for each of its frames: low bytes, then high bytes, of numbers − numbers of the frame before (mod 2¹⁶)
//! ```
//!
//! The first frame of a chunk stands for itself. Every part has its own `low` and `step` along each axis, the least there is
//! over its frames: a small shell on a wide floor is not drawn in steps. `viewer/src/data/embedded.ts` reads it.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;

/// The largest number that stands for a value.
const MOST: f64 = 65534.0;
const NO_VALUE: u16 = u16::MAX;

/// What numbers mean.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Scale {
    low: f64,
    step: f64,
}

impl Scale {
    /// Of the number of a value; NaN and what is infinite has none.
    pub(super) fn number(&self, value: f64) -> u16 {
        match value.is_finite() {
            true => ((value - self.low) / self.step).round().clamp(0.0, MOST) as u16,
            false => NO_VALUE,
        }
    }
}

/// The values that a scale must cover.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    low: f64,
    high: f64,
}

impl Extent {
    pub(super) const EMPTY: Self = Self {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };

    pub(super) fn include(&mut self, value: f64) {
        if value.is_finite() {
            self.low = self.low.min(value);
            self.high = self.high.max(value);
        }
    }

    /// The scale that covers the extent; of a single value any step will do.
    pub(super) fn scale(&self) -> Scale {
        let span = self.high - self.low;
        Scale {
            low: if self.low.is_finite() { self.low } else { 0.0 },
            step: if span > 0.0 { span / MOST } else { 1.0 },
        }
    }
}

/// The chunk of some frames.
pub(super) fn chunk(frames: &[Vec<u16>]) -> Vec<u8> {
    compressed(&differences(frames))
}

fn differences(frames: &[Vec<u16>]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(2 * frames.iter().map(Vec::len).sum::<usize>());
    for (index, frame) in frames.iter().enumerate() {
        let before = |k: usize| match index {
            0 => 0,
            _ => frames[index - 1][k],
        };
        let change = |k: usize| frame[k].wrapping_sub(before(k));
        for byte in 0..2 {
            bytes.extend((0..frame.len()).map(|k| change(k).to_le_bytes()[byte]));
        }
    }
    bytes
}

/// Zlib.
pub(super) fn compressed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    written.expect("memory can be written to")
}

/// Base64 with padding (RFC 4648).
pub(super) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |k: usize| u32::from(three.get(k).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for letter in 0..4 {
            let index = (bits >> (18 - 6 * letter) & 63) as usize;
            let is_there = letter <= three.len();
            text.push(if is_there {
                LETTERS[index] as char
            } else {
                '='
            });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_wrap_round_and_low_bytes_come_first() {
        // The same bytes stand in the test of the page.
        let bytes = differences(&[vec![65535, 258], vec![1, 256]]);
        assert_eq!(bytes, [0xff, 2, 0xff, 1, 2, 0xfe, 0, 0xff]);
    }

    #[test]
    fn values_come_back_to_half_a_step() {
        let mut extent = Extent::EMPTY;
        [-1.0, 3.0, f64::NAN]
            .into_iter()
            .for_each(|value| extent.include(value));
        let scale = extent.scale();
        for value in [-1.0, -0.3, 0.0, 2.999, 3.0] {
            let back = scale.low + scale.step * f64::from(scale.number(value));
            // Half a step, and the round-off of a few operations.
            assert!(
                (back - value).abs() <= 0.5 * scale.step * (1.0 + 1e-9),
                "{value}"
            );
        }
        assert_eq!(scale.number(f64::NAN), NO_VALUE);
        let mut single = Extent::EMPTY;
        single.include(2.0);
        assert_eq!((single.scale().low, single.scale().number(2.0)), (2.0, 0));
        assert_eq!(Extent::EMPTY.scale().number(f64::NAN), NO_VALUE);
    }

    #[test]
    fn base64_is_that_of_the_standard() {
        let cases = ["", "f", "fo", "foo", "foob", "fooba", "foobar"];
        let coded = [
            "", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy",
        ];
        for (text, expected) in cases.into_iter().zip(coded) {
            assert_eq!(base64(text.as_bytes()), expected);
        }
    }
}
