//! From good files to damaged ones.

use crate::random::Random;

/// Numbers at the edges of what formats and types hold.
const NUMBERS: &[&str] = &[
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "7",
    "0.5",
    "255",
    "256",
    "1e3",
    "65536",
    "1e7",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551615",
    "1e-300",
    "1e-5",
    "1e15",
    "1e155",
    "1e200",
    "-1e308",
    "1e308",
    "1e400",
    "nan",
    "inf",
    "-inf",
    "0x10",
    "1_000",
    "1,5",
    "٣",
];

/// Bytes of integers and floats at the edges.
const WORDS: &[u64] = &[
    0,
    1,
    2,
    3,
    0x7f,
    0x80,
    0xff,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7fff_ffff_ffff_ffff,
    0x8000_0000_0000_0000,
    u64::MAX,
    0x7ff8_0000_0000_0000,
    0x7ff0_0000_0000_0000,
    0x7fef_ffff_ffff_ffff,
    0x7f80_0000,
    0x7fc0_0000,
];

/// One in so many inputs is blown up to the full length, to show what takes more than linear time or memory.
const BLOW_UP: usize = 2000;

/// A damaged copy of one of the `corpus`, at most `max_length` bytes long.
///
/// Every third time it is one of the first `num_good`: what was found later reaches new branches mostly by being refused,
/// and its copies are refused at the same place.
pub(crate) fn mutate(
    corpus: &[Vec<u8>],
    num_good: usize,
    dictionary: &[&str],
    max_length: usize,
    random: &mut Random,
) -> Vec<u8> {
    let candidates = match random.below(3) {
        0 => &corpus[..num_good],
        _ => corpus,
    };
    let mut bytes = random.pick(candidates).clone();
    for _ in 0..1 + random.below(4) {
        damage(&mut bytes, corpus, dictionary, random);
    }
    if random.below(BLOW_UP) == 0 {
        let range = some_range(&bytes, random);
        let piece = bytes[range.clone()].to_vec();
        if !piece.is_empty() {
            let times = max_length.saturating_sub(bytes.len()) / piece.len();
            bytes.splice(range.end..range.end, piece.repeat(times));
        }
    }
    bytes.truncate(max_length);
    bytes
}

fn damage(bytes: &mut Vec<u8>, corpus: &[Vec<u8>], dictionary: &[&str], random: &mut Random) {
    let at = random.below(bytes.len() + 1);
    let range = some_range(bytes, random);
    match random.below(13) {
        0 => bytes.insert(at, random.next() as u8),
        1 if at < bytes.len() => bytes[at] = random.next() as u8,
        2 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
        // A byte from elsewhere in the file: digits for digits, letters for letters.
        3 if at < bytes.len() => bytes[at] = *random.pick(bytes),
        4 => drop(bytes.drain(range)),
        5 => {
            let piece = bytes[range].to_vec();
            bytes.splice(at..at, piece);
        }
        6 => {
            let other = random.pick(corpus);
            let piece = other[some_range(other, random)].to_vec();
            bytes.splice(range, piece);
        }
        7 => overwrite_word(bytes, at, random),
        8 => replace_number(bytes, at, random),
        9 if !dictionary.is_empty() => {
            bytes.splice(at..at, random.pick(dictionary).bytes());
        }
        10 if !dictionary.is_empty() => {
            bytes.splice(range, random.pick(dictionary).bytes());
        }
        11 => {
            let other = random.pick(corpus);
            copy_line(bytes, other, at, random);
        }
        _ if random.below(8) == 0 => bytes.truncate(at),
        _ => replace_number(bytes, at, random),
    }
}

/// A range of up to 16 bytes, or, now and then, of any length.
fn some_range(bytes: &[u8], random: &mut Random) -> std::ops::Range<usize> {
    let start = random.below(bytes.len() + 1);
    let left = bytes.len() - start;
    let most = if random.below(8) == 0 {
        left
    } else {
        left.min(16)
    };
    start..start + random.below(most + 1)
}

fn overwrite_word(bytes: &mut [u8], at: usize, random: &mut Random) {
    let word = *random.pick(WORDS);
    let length = *random.pick(&[1, 2, 4, 8]);
    let mut word = word.to_le_bytes()[..length].to_vec();
    if random.below(2) == 0 {
        word.reverse();
    }
    for (byte, value) in bytes[at..].iter_mut().zip(word) {
        *byte = value;
    }
}

/// Replaces the first number at or after `at`.
fn replace_number(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    let is_numeric = |byte: &u8| byte.is_ascii_digit() || b"+-.e_".contains(byte);
    let Some(digit) = bytes[at..].iter().position(u8::is_ascii_digit) else {
        return;
    };
    let start = at + digit;
    let length = bytes[start..]
        .iter()
        .take_while(|byte| is_numeric(byte))
        .count();
    bytes.splice(start..start + length, random.pick(NUMBERS).bytes());
}

/// Puts a line of another file in front of the line after `at`.
fn copy_line(bytes: &mut Vec<u8>, other: &[u8], at: usize, random: &mut Random) {
    let lines: Vec<&[u8]> = other.split_inclusive(|&byte| byte == b'\n').collect();
    if lines.is_empty() {
        return;
    }
    let line = random.pick(&lines).to_vec();
    let to = bytes[at..]
        .iter()
        .position(|&byte| byte == b'\n')
        .map_or(bytes.len(), |end| at + end + 1);
    bytes.splice(to..to, line);
}
