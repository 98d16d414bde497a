//! The checksum of HDF5's metadata: Bob Jenkins' `lookup3`, `hashlittle` with the initial value 0.

/// The checksum of some bytes.
pub(super) fn lookup3(bytes: &[u8]) -> u32 {
    let start = 0xdead_beef_u32.wrapping_add(bytes.len() as u32);
    let mut state = [start; 3];
    let mut rest = bytes;
    while rest.len() > 12 {
        let (block, after) = rest.split_at(12);
        add(&mut state, block);
        mix(&mut state);
        rest = after;
    }
    // Nothing to add is nothing to mix.
    if !rest.is_empty() {
        add(&mut state, rest);
        finish(&mut state);
    }
    state[2]
}

/// Adds up to twelve bytes as three numbers, least significant byte first.
fn add(state: &mut [u32; 3], block: &[u8]) {
    for (word, bytes) in state.iter_mut().zip(block.chunks(4)) {
        let number = bytes
            .iter()
            .rev()
            .fold(0, |sum, &byte| sum << 8 | u32::from(byte));
        *word = word.wrapping_add(number);
    }
}

fn mix([a, b, c]: &mut [u32; 3]) {
    let round = |turn: u32, x: &mut u32, y: &mut u32, z: &mut u32| {
        *x = x.wrapping_sub(*z);
        *x ^= z.rotate_left(turn);
        *z = z.wrapping_add(*y);
    };
    round(4, a, b, c);
    round(6, b, c, a);
    round(8, c, a, b);
    round(16, a, b, c);
    round(19, b, c, a);
    round(4, c, a, b);
}

fn finish([a, b, c]: &mut [u32; 3]) {
    let round = |turn: u32, x: &mut u32, y: u32| {
        *x = (*x ^ y).wrapping_sub(y.rotate_left(turn));
    };
    round(14, c, *b);
    round(11, a, *c);
    round(25, b, *a);
    round(16, c, *b);
    round(4, a, *c);
    round(14, b, *a);
    round(24, c, *b);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_the_published_self_test_are_met() {
        // lookup3.c, driver5: the empty key, and this one of 30 bytes with the initial value 0.
        assert_eq!(lookup3(b""), 0xdead_beef);
        assert_eq!(lookup3(b"Four score and seven years ago"), 0x1777_0551);
    }
}
