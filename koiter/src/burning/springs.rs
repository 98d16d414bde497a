//! The springs of one colour, numbered along lines.
//!
//! Where springs of one colour meet at a particle, those that lie opposite each other are coupled most strongly: in a flat
//! sheet the others are at right angles and not coupled at all. Springs that follow each other straight on form a line, and
//! are numbered one after the other along it. So the strong couplings of a colour stand next to the diagonal of its matrix.

use crate::Vec3;

/// Springs that continue each other enclose an angle with a smaller cosine than this, 180° when straight.
const STRAIGHT: f64 = -0.5;
const NONE: u32 = u32::MAX;

/// Springs of one colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Springs {
    /// The particles at their ends.
    pub ends: Vec<[u32; 2]>,
    /// Initial lengths [m].
    pub initial_lengths: Vec<f64>,
    /// Whether each is followed by the next on the same line.
    pub is_continued: Vec<bool>,
}

impl Springs {
    /// Numbers springs along lines; returns them with the old number of each.
    ///
    /// # Panics
    /// If an end is not a particle.
    pub fn along_lines(ends: &[[u32; 2]], positions: &[Vec3]) -> (Self, Vec<u32>) {
        let (order, is_continued) = order_along_lines(ends, positions);
        let ends: Vec<[u32; 2]> = order.iter().map(|&spring| ends[spring as usize]).collect();
        let initial_lengths = ends.iter().map(|&ends| vector(ends, positions).norm());
        let springs = Self {
            initial_lengths: initial_lengths.collect(),
            is_continued,
            ends,
        };
        (springs, order)
    }

    /// Number of springs.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is no spring.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }
}

/// From the second end to the first.
pub(super) fn vector([a, b]: [u32; 2], positions: &[Vec3]) -> Vec3 {
    positions[a as usize] - positions[b as usize]
}

/// Springs in the order of their lines, and whether each is followed by the next on its line.
fn order_along_lines(ends: &[[u32; 2]], positions: &[Vec3]) -> (Vec<u32>, Vec<bool>) {
    let next = continuations(ends, positions);
    let mut order = Vec::with_capacity(ends.len());
    let mut is_continued = Vec::with_capacity(ends.len());
    let mut is_done = vec![false; ends.len()];
    let is_end = |spring: usize| next[spring].contains(&NONE);
    // Open lines from their ends first; what is left are closed lines, which begin anywhere.
    let starts = (0..ends.len()).filter(|&spring| is_end(spring));
    for start in starts.chain(0..ends.len()) {
        if is_done[start] {
            continue;
        }
        let (mut spring, mut came_from) = (start, NONE);
        loop {
            is_done[spring] = true;
            order.push(spring as u32);
            let ahead = next[spring]
                .iter()
                .find(|&&other| other != NONE && other != came_from && !is_done[other as usize]);
            is_continued.push(ahead.is_some());
            let Some(&ahead) = ahead else { break };
            (came_from, spring) = (spring as u32, ahead as usize);
        }
    }
    (order, is_continued)
}

/// The spring that continues each spring beyond its first and its second end.
fn continuations(ends: &[[u32; 2]], positions: &[Vec3]) -> Vec<[u32; 2]> {
    let mut incident: Vec<(u32, u32, usize)> = Vec::with_capacity(2 * ends.len());
    for (spring, pair) in ends.iter().enumerate() {
        incident.extend((0..2).map(|end| (pair[end], spring as u32, end)));
    }
    incident.sort_unstable();
    let mut next = vec![[NONE; 2]; ends.len()];
    for at_particle in incident.chunk_by(|a, b| a.0 == b.0) {
        let direction = |&(_, spring, end): &(u32, u32, usize)| {
            let [a, b] = ends[spring as usize];
            vector(if end == 0 { [b, a] } else { [a, b] }, positions).normalize()
        };
        let mut pairs = Vec::new();
        for (i, first) in at_particle.iter().enumerate() {
            for second in &at_particle[i + 1..] {
                pairs.push((direction(first).dot(&direction(second)), first, second));
            }
        }
        // The straightest first; a stable sort keeps the order of numbers among equals.
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (cosine, &(_, first, first_end), &(_, second, second_end)) in pairs {
            let are_free = next[first as usize][first_end] == NONE
                && next[second as usize][second_end] == NONE;
            if cosine < STRAIGHT && are_free {
                next[first as usize][first_end] = second;
                next[second as usize][second_end] = first;
            }
        }
    }
    next
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn springs_of_a_cross_form_two_lines() {
        let positions =
            [[0., 0.], [1., 0.], [2., 0.], [1., 1.], [1., -1.]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let (springs, old) = Springs::along_lines(&[[0, 1], [1, 3], [1, 2], [4, 1]], &positions);
        assert_eq!(old, [0, 2, 1, 3]);
        assert_eq!(springs.is_continued, [true, false, true, false]);
    }

    #[test]
    fn a_closed_line_is_cut_once() {
        let ring = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / 8.0;
            Vec3::new(angle.cos(), angle.sin(), 0.0)
        };
        let positions: Vec<Vec3> = (0..8).map(ring).collect();
        let ends: Vec<[u32; 2]> = (0..8).map(|k| [k, (k + 1) % 8]).collect();
        let (springs, _) = Springs::along_lines(&ends, &positions);
        assert_eq!(springs.is_continued.iter().filter(|&&c| c).count(), 7);
        assert!(!springs.is_continued[7]);
    }
}
