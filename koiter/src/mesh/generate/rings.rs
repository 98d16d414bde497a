//! Stacks of rings around the z axis, joined by triangles: the topology of discs, tubes, cones and caps.

use crate::Vec3;

/// A circle of `count` vertices about the z axis; `count` 1 (and radius 0) is a pole.
pub(super) struct Ring {
    pub(super) radius: f64,
    pub(super) z: f64,
    pub(super) count: usize,
}

/// Joins consecutive rings.
///
/// Normals point along `e_φ × t`, where `t` runs from each ring to the next: outward for a tube whose rings rise.
/// Rings of different counts are joined by a zipper that always advances on the ring whose next vertex has the
/// smaller angle; equal counts give cells with uniform diagonals.
pub(super) fn join_rings(rings: &[Ring]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut positions = Vec::new();
    let mut starts = Vec::with_capacity(rings.len());
    for ring in rings {
        starts.push(positions.len() as u32);
        for i in 0..ring.count {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / ring.count as f64).sin_cos();
            positions.push(Vec3::new(ring.radius * cos, ring.radius * sin, ring.z));
        }
    }
    let mut faces = Vec::new();
    for (k, pair) in rings.windows(2).enumerate() {
        zip_rings(
            [starts[k], starts[k + 1]],
            [pair[0].count, pair[1].count],
            &mut faces,
        );
    }
    (positions, faces)
}

/// Triangles between two rings whose vertices are numbered from `starts`.
fn zip_rings(starts: [u32; 2], counts: [usize; 2], faces: &mut Vec<[u32; 3]>) {
    let [m, n] = counts;
    let vertex_below = |i: usize| starts[0] + (i % m) as u32;
    let vertex_above = |j: usize| starts[1] + (j % n) as u32;
    // A pole has no edges of its own to advance over.
    let (last_below, last_above) = (if m > 1 { m } else { 0 }, if n > 1 { n } else { 0 });
    let (mut i, mut j) = (0, 0);
    while i < last_below || j < last_above {
        let advance_below = j == last_above
            || (i < last_below && (i + 1) as u64 * n as u64 <= (j + 1) as u64 * m as u64);
        if advance_below {
            faces.push([vertex_below(i), vertex_below(i + 1), vertex_above(j)]);
            i += 1;
        } else {
            faces.push([vertex_below(i), vertex_above(j + 1), vertex_above(j)]);
            j += 1;
        }
    }
}
