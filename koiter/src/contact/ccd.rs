//! Additive continuous collision detection.
//!
//! Advances along straight motions by conservative steps until the gap has shrunk to a tenth of what it was at the
//! start, or the motion is over. A step can never overshoot: two primitives cannot approach by more than the largest
//! motions of their points. Reference: Li, Kaufman, Jiang, "Codimensional IPC" (2021), Algorithm 1.

use super::pair::{Pair, PairKind};
use crate::Vec3;

/// Fraction of the initial gap that is always kept.
const SLACK: f64 = 0.1;

/// Advances before a shorter, still safe, step is returned. Grazing motions converge slowly; so many are never needed where
/// it matters, and the fallback only costs a Newton iteration.
const MAX_ADVANCES: usize = 128;

/// How far two primitives may move towards each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Fraction of the motion that keeps a tenth of the gap; 0 if they touch at the start.
    pub fraction: f64,
    /// Lower bound of their distance over the whole motion [m].
    pub nearest: f64,
}

/// The largest fraction in `[0, 1]` of the motion `x + t dx` that keeps a tenth of the gap beyond `touching_distance`.
pub fn additive_ccd(
    pair: &Pair,
    x: &[Vec3; 4],
    dx: &[Vec3; 4],
    touching_distance: f64,
) -> Approach {
    let mean = (dx[0] + dx[1] + dx[2] + dx[3]) * 0.25;
    let relative = dx.map(|d| d - mean);
    let norms = relative.map(|d| d.norm());
    let reach = match pair.kind {
        PairKind::VertexFace => norms[0] + norms[1].max(norms[2]).max(norms[3]),
        PairKind::EdgeEdge => norms[0].max(norms[1]) + norms[2].max(norms[3]),
    };
    let gap = |x: &[Vec3; 4]| pair.distance_squared(x).sqrt() - touching_distance;
    let mut current = gap(x);
    let nearest = touching_distance + current - reach;
    // Written so that what is not a number counts as touching.
    if !(current > 0.0 && reach < f64::INFINITY) {
        return Approach {
            fraction: 0.0,
            nearest: f64::NEG_INFINITY,
        };
    }
    let kept = SLACK * current;
    let mut fraction = 0.0;
    for _ in 0..MAX_ADVANCES {
        let advance = (1.0 - SLACK) * current / reach;
        let next = fraction + advance;
        if next >= 1.0 {
            return Approach {
                fraction: 1.0,
                nearest,
            };
        }
        let moved = std::array::from_fn(|i| x[i] + relative[i] * next);
        current = gap(&moved);
        // The first advance leaves a tenth of the gap, up to round-off, whatever the motion.
        if current < kept && fraction > 0.0 {
            break;
        }
        fraction = next;
    }
    Approach { fraction, nearest }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn v(x: f64, y: f64, z: f64) -> Vec3 {
        Vec3::new(x, y, z)
    }

    #[test]
    fn a_vertex_stops_before_the_face_it_flies_through() {
        let pair = Pair {
            kind: PairKind::VertexFace,
            vertices: [0, 1, 2, 3],
        };
        let x = [
            v(0.2, 0.2, 1.0),
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(0.0, 1.0, 0.0),
        ];
        let dx = [
            v(0.0, 0.0, -4.0),
            Vec3::zeros(),
            Vec3::zeros(),
            Vec3::zeros(),
        ];
        let t = additive_ccd(&pair, &x, &dx, 0.0).fraction;
        assert!(t < 0.25 && t > 0.8 * 0.25, "{t}");
        let thick = additive_ccd(&pair, &x, &dx, 0.5).fraction;
        assert!(thick < 0.125 && thick > 0.8 * 0.125, "{thick}");
    }

    #[test]
    fn edges_that_miss_each_other_may_move_all_the_way() {
        let pair = Pair {
            kind: PairKind::EdgeEdge,
            vertices: [0, 1, 2, 3],
        };
        let x = [
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(0.5, 1.0, 0.0),
            v(0.5, 2.0, 0.0),
        ];
        let dx = [
            v(0.0, 0.0, 0.0),
            v(0.0, 0.0, 0.0),
            v(5.0, 0.0, 0.0),
            v(5.0, 0.0, 0.0),
        ];
        assert_eq!(additive_ccd(&pair, &x, &dx, 0.0).fraction, 1.0);
    }

    #[test]
    fn random_motions_never_pass_through_the_touching_distance() {
        let mut state = 1u64;
        let mut random = || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        };
        for trial in 0..2000 {
            let kind = if trial % 2 == 0 {
                PairKind::VertexFace
            } else {
                PairKind::EdgeEdge
            };
            let pair = Pair {
                kind,
                vertices: [0, 1, 2, 3],
            };
            let x: [Vec3; 4] = std::array::from_fn(|_| v(random(), random(), random()));
            let dx: [Vec3; 4] = std::array::from_fn(|_| v(random(), random(), random()) * 3.0);
            let distance = |t: f64| {
                let moved = std::array::from_fn(|i| x[i] + dx[i] * t);
                pair.closest(&moved).distance_squared.sqrt()
            };
            if distance(0.0) <= 0.05 {
                continue;
            }
            let Approach {
                fraction: t,
                nearest,
            } = additive_ccd(&pair, &x, &dx, 0.05);
            for k in 0..=200 {
                assert!(distance(t * f64::from(k) / 200.0) > 0.05, "trial {trial}");
                assert!(distance(f64::from(k) / 200.0) >= nearest, "trial {trial}");
            }
        }
    }

    #[test]
    fn motions_that_are_not_numbers_stop_at_once() {
        let pair = Pair {
            kind: PairKind::EdgeEdge,
            vertices: [0, 1, 2, 3],
        };
        let x = [
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(0.5, 1.0, 0.0),
            v(0.5, 2.0, 0.0),
        ];
        let dx = [
            v(f64::NAN, 0.0, 0.0),
            Vec3::zeros(),
            Vec3::zeros(),
            Vec3::zeros(),
        ];
        assert_eq!(additive_ccd(&pair, &x, &dx, 0.0).fraction, 0.0);
    }
}
