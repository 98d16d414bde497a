//! Springs and particles that go when what they carry has burnt, and the pieces that are left.
//!
//! A spring goes when all render triangles that support it have vanished: blue and red springs are edges of two triangles
//! (of one on the boundary), green ones cross the edge between two, yellow ones span the four of a quad. A particle goes with
//! its last spring; one that is burnt stays as long as a triangle needs it.

use super::double_layer::{DoubleLayer, NO_TRIANGLE};

/// What is left of springs and particles.
#[derive(Clone, Debug, PartialEq)]
pub struct Remaining {
    /// Springs that are there, by colour.
    pub springs: [Vec<bool>; 4],
    /// Particles that are there.
    pub particles: Vec<bool>,
}

impl Remaining {
    /// Everything.
    pub fn all(shell: &DoubleLayer) -> Self {
        Self {
            springs: shell
                .springs
                .each_ref()
                .map(|springs| vec![true; springs.len()]),
            particles: vec![true; shell.particles.len()],
        }
    }

    /// What is left when these triangles of the render mesh are.
    pub fn update(&mut self, shell: &DoubleLayer, is_triangle_there: &[bool]) {
        self.particles.fill(false);
        for color in 0..4 {
            let springs = shell.springs[color].ends.iter().zip(&shell.supports[color]);
            for ((ends, supports), is_there) in springs.zip(&mut self.springs[color]) {
                let supported = |&triangle: &u32| {
                    triangle != NO_TRIANGLE && is_triangle_there[triangle as usize]
                };
                *is_there = supports.iter().any(supported);
                if *is_there {
                    ends.iter()
                        .for_each(|&end| self.particles[end as usize] = true);
                }
            }
        }
    }

    /// Number of pieces that hang together by springs.
    pub fn num_pieces(&self, shell: &DoubleLayer) -> usize {
        let mut parent: Vec<u32> = (0..self.particles.len() as u32).collect();
        let mut pieces = self.particles.iter().filter(|&&is_there| is_there).count();
        for color in 0..4 {
            let springs = shell.springs[color].ends.iter().zip(&self.springs[color]);
            for (&[a, b], _) in springs.filter(|(_, is_there)| **is_there) {
                let [a, b] = [a, b].map(|particle| root(&mut parent, particle));
                if a != b {
                    parent[a.max(b) as usize] = a.min(b);
                    pieces -= 1;
                }
            }
        }
        pieces
    }
}

fn root(parent: &mut [u32], mut particle: u32) -> u32 {
    while parent[particle as usize] != particle {
        let above = parent[parent[particle as usize] as usize];
        parent[particle as usize] = above;
        particle = above;
    }
    particle
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::burning::double_layer::Color;
    use crate::burning::quad_mesh::QuadMesh;

    fn sheet(n: usize) -> DoubleLayer {
        DoubleLayer::new(QuadMesh::grid([1.0; 2], [n, n]).unwrap(), 0.02)
    }

    #[test]
    fn springs_go_with_the_last_of_their_triangles() {
        let shell = sheet(2);
        let mut remaining = Remaining::all(&shell);
        let mut triangles = vec![true; 16];
        // Triangle 1 of quad 0 lies at the edge to quad 1, across which lies triangle 3 of quad 1, number 7.
        triangles[1] = false;
        remaining.update(&shell, &triangles);
        assert_eq!(
            remaining,
            Remaining::all(&shell),
            "each spring has another support"
        );
        triangles[7] = false;
        remaining.update(&shell, &triangles);
        let gone = |color: Color| {
            remaining.springs[color as usize]
                .iter()
                .filter(|&&is| !is)
                .count()
        };
        assert_eq!(
            [Color::Red, Color::Green, Color::Blue, Color::Yellow].map(gone),
            [0, 1, 1, 0]
        );
        // The whole quad: its yellow and red springs, and its boundary edges.
        triangles[0..4].fill(false);
        remaining.update(&shell, &triangles);
        let gone = |color: Color| {
            remaining.springs[color as usize]
                .iter()
                .filter(|&&is| !is)
                .count()
        };
        assert_eq!(
            [Color::Red, Color::Green, Color::Blue, Color::Yellow].map(gone),
            [4, 1, 3, 2]
        );
        assert!(!remaining.particles[0], "a corner of this quad alone");
        assert!(
            remaining.particles[shell.lattice(0)],
            "its green spring to quad 2 has a support there"
        );
    }

    #[test]
    fn a_cut_makes_two_pieces_and_nothing_is_none() {
        let shell = sheet(4);
        let mut remaining = Remaining::all(&shell);
        assert_eq!(remaining.num_pieces(&shell), 1);
        // Two rows of quads: green springs bridge one.
        let mut triangles = vec![true; 64];
        triangles[16..48].fill(false);
        remaining.update(&shell, &triangles);
        assert_eq!(remaining.num_pieces(&shell), 2);
        triangles.fill(false);
        remaining.update(&shell, &triangles);
        assert_eq!(remaining.num_pieces(&shell), 0);
        assert!(remaining.particles.iter().all(|is_there| !is_there));
    }
}
