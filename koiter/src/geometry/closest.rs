//! Closest points of point–edge, point–triangle and edge–edge pairs, with derivatives of the squared distance.
//!
//! Every case is the same formula. The separation is r = Σ w_i x_i over the four points of the pair, where the weights
//! depend linearly on the parameters u of the closest points that are free to slide (none, one or two of them):
//!
//! ```text
//! D(x) = min_u |r|²      ∂D/∂x_i = 2 w_i r
//! D''  = 2 w wᵀ ⊗ I − 2 Σ_k g_k g_kᵀ,     g_k = w ⊗ t_k + v_k ⊗ r
//! ```
//!
//! with t_k = ∂r/∂u_k made orthonormal (which is a linear change of the parameters) and v_k = ∂w/∂u_k. The second term
//! is the Schur complement that eliminates u. At an end of an edge or a rim of a face a parameter is fixed and its term
//! is absent; D is continuously differentiable across these changes, its Hessian is not.

use crate::Vec3;

/// The closest points of a pair of simplices over four points.
#[derive(Clone, Copy, Debug)]
pub struct ClosestPoints {
    /// Weights of the four points: the separation is Σ w_i x_i. They sum to zero.
    pub weights: [f64; 4],
    /// Vector between the closest points [m].
    pub separation: Vec3,
    /// Squared distance [m²].
    pub distance_squared: f64,
    /// Orthonormal directions in which the closest points slide, with the change of the weights along each [1/m].
    slides: [(Vec3, [f64; 4]); 2],
    num_slides: usize,
}

impl ClosestPoints {
    fn fixed(weights: [f64; 4], separation: Vec3) -> Self {
        let distance_squared = separation.norm_squared();
        Self {
            weights,
            separation,
            distance_squared,
            slides: [(Vec3::zeros(), [0.0; 4]); 2],
            num_slides: 0,
        }
    }

    /// Adds a free parameter with `tangent` = ∂r/∂u and `weights` = ∂w/∂u. Directions that are parallel to an earlier
    /// one are dropped: there the minimiser is not unique and D has no second derivative.
    fn slide(mut self, mut tangent: Vec3, mut weights: [f64; 4]) -> Self {
        let full = tangent.norm();
        for (earlier, change) in &self.slides[..self.num_slides] {
            let component = tangent.dot(earlier);
            tangent -= earlier * component;
            for (w, c) in weights.iter_mut().zip(change) {
                *w -= component * c;
            }
        }
        let norm = tangent.norm();
        // Below 1e-8 the remainder is round-off of the subtraction above.
        if norm > 1e-8 * full {
            self.slides[self.num_slides] = (tangent / norm, weights.map(|w| w / norm));
            self.num_slides += 1;
        }
        self
    }

    /// Orthonormal slide directions t_k and the change v_k of the weights along each.
    pub fn slides(&self) -> &[(Vec3, [f64; 4])] {
        &self.slides[..self.num_slides]
    }
}

/// Parameter of the point of the line `a b` nearest to `p`: 0 at `a`, 1 at `b`; not a number for an edge without length.
#[inline]
fn along_edge(p: &Vec3, a: &Vec3, along: &Vec3) -> f64 {
    (p - a).dot(along) / along.norm_squared()
}

/// Barycentric coordinates (u, v) of `p` in the plane of the triangle `a, a + ab, a + ac`, with its normal and the squared
/// length of that, if they are inside.
#[inline]
fn inside_prism(ap: &Vec3, ab: &Vec3, ac: &Vec3) -> Option<(f64, f64, Vec3, f64)> {
    let normal = ab.cross(ac);
    let norm_squared = normal.norm_squared();
    let u = ap.cross(ac).dot(&normal) / norm_squared;
    let v = ab.cross(ap).dot(&normal) / norm_squared;
    (u > 0.0 && v > 0.0 && u + v < 1.0).then_some((u, v, normal, norm_squared))
}

/// Parameters (s, t) of the closest points of the lines of two edges, if they are inside both.
#[inline]
fn inside_edges(ea: &Vec3, eb: &Vec3, r0: &Vec3) -> Option<(f64, f64)> {
    let (aa, bb, ab) = (ea.norm_squared(), eb.norm_squared(), ea.dot(eb));
    let (ar, br) = (ea.dot(r0), eb.dot(r0));
    let determinant = aa * bb - ab * ab;
    // Edges within about 1e-5 rad of parallel are served by their end points: the interior solution is ill-conditioned
    // there, and one of the ends is at the same distance to second order.
    if !(determinant > 1e-10 * aa * bb) {
        return None;
    }
    let s = (ab * br - bb * ar) / determinant;
    let t = (aa * br - ab * ar) / determinant;
    (s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0).then_some((s, t))
}

/// Squared distance of point `p` and edge `a b` [m²].
#[inline]
pub fn point_edge_distance_squared(p: &Vec3, a: &Vec3, b: &Vec3) -> f64 {
    let along = b - a;
    let u = along_edge(p, a, &along);
    // Written so that an edge without length is its first point.
    let u = if u > 0.0 { u.min(1.0) } else { 0.0 };
    (p - a - along * u).norm_squared()
}

/// Squared distance of point `p` and triangle `a b c` [m²].
#[inline]
pub fn point_triangle_distance_squared(p: &Vec3, a: &Vec3, b: &Vec3, c: &Vec3) -> f64 {
    let ap = p - a;
    match inside_prism(&ap, &(b - a), &(c - a)) {
        Some((_, _, normal, norm_squared)) => ap.dot(&normal).powi(2) / norm_squared,
        None => point_edge_distance_squared(p, a, b)
            .min(point_edge_distance_squared(p, b, c))
            .min(point_edge_distance_squared(p, c, a)),
    }
}

/// Squared distance of edges `a0 a1` and `b0 b1` [m²].
#[inline]
pub fn edge_edge_distance_squared(a0: &Vec3, a1: &Vec3, b0: &Vec3, b1: &Vec3) -> f64 {
    let (ea, eb, r0) = (a1 - a0, b1 - b0, a0 - b0);
    match inside_edges(&ea, &eb, &r0) {
        Some((s, t)) => (r0 + ea * s - eb * t).norm_squared(),
        None => point_edge_distance_squared(a0, b0, b1)
            .min(point_edge_distance_squared(a1, b0, b1))
            .min(point_edge_distance_squared(b0, a0, a1))
            .min(point_edge_distance_squared(b1, a0, a1)),
    }
}

/// Closest points of point `p` and edge `a b`; the weights are those of `(p, a, b, unused)`.
pub fn point_edge(p: &Vec3, a: &Vec3, b: &Vec3) -> ClosestPoints {
    let along = b - a;
    let u = along_edge(p, a, &along);
    if !(u > 0.0) {
        ClosestPoints::fixed([1.0, -1.0, 0.0, 0.0], p - a)
    } else if u >= 1.0 {
        ClosestPoints::fixed([1.0, 0.0, -1.0, 0.0], p - b)
    } else {
        ClosestPoints::fixed([1.0, u - 1.0, -u, 0.0], p - a - along * u)
            .slide(-along, [0.0, 1.0, -1.0, 0.0])
    }
}

/// `pair` with its four entries moved to `slots` (the identity of a pair embedded in a larger one).
fn embed(pair: ClosestPoints, slots: [usize; 3], sign: f64) -> ClosestPoints {
    let place = |w: &[f64; 4]| {
        let mut out = [0.0; 4];
        for (value, slot) in w.iter().zip(slots) {
            out[slot] += sign * value;
        }
        out
    };
    ClosestPoints {
        weights: place(&pair.weights),
        separation: pair.separation * sign,
        slides: pair
            .slides
            .map(|(tangent, weights)| (tangent * sign, place(&weights))),
        ..pair
    }
}

/// Closest points of point `p` and triangle `a b c`; the weights are those of `(p, a, b, c)`.
pub fn point_triangle(p: &Vec3, a: &Vec3, b: &Vec3, c: &Vec3) -> ClosestPoints {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    if let Some((u, v, normal, norm_squared)) = inside_prism(&ap, &ab, &ac) {
        let separation = normal * (ap.dot(&normal) / norm_squared);
        return ClosestPoints::fixed([1.0, u + v - 1.0, -u, -v], separation)
            .slide(-ab, [0.0, 1.0, -1.0, 0.0])
            .slide(-ac, [0.0, 1.0, 0.0, -1.0]);
    }
    // Outside the prism over the face (or a face without area): the closest point is on the rim.
    let mut best = embed(point_edge(p, a, b), [0, 1, 2], 1.0);
    for (pair, slots) in [
        (point_edge(p, b, c), [0, 2, 3]),
        (point_edge(p, c, a), [0, 3, 1]),
    ] {
        if pair.distance_squared < best.distance_squared {
            best = embed(pair, slots, 1.0);
        }
    }
    best
}

/// Closest points of edges `a0 a1` and `b0 b1`; the weights are those of `(a0, a1, b0, b1)`.
pub fn edge_edge(a0: &Vec3, a1: &Vec3, b0: &Vec3, b1: &Vec3) -> ClosestPoints {
    let (ea, eb, r0) = (a1 - a0, b1 - b0, a0 - b0);
    if let Some((s, t)) = inside_edges(&ea, &eb, &r0) {
        return ClosestPoints::fixed([1.0 - s, s, t - 1.0, -t], r0 + ea * s - eb * t)
            .slide(ea, [-1.0, 1.0, 0.0, 0.0])
            .slide(-eb, [0.0, 0.0, 1.0, -1.0]);
    }
    let mut best = embed(point_edge(a0, b0, b1), [0, 2, 3], 1.0);
    for (pair, slots, sign) in [
        (point_edge(a1, b0, b1), [1, 2, 3], 1.0),
        (point_edge(b0, a0, a1), [2, 0, 1], -1.0),
        (point_edge(b1, a0, a1), [3, 0, 1], -1.0),
    ] {
        if pair.distance_squared < best.distance_squared {
            best = embed(pair, slots, sign);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_alone_are_those_of_the_closest_points() {
        let mut state = 7u64;
        let mut random = || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        for trial in 0..3000 {
            // Every tenth is flat, so that edges without length and faces without area occur.
            let flat = if trial % 10 == 0 { 0.0 } else { 1.0 };
            let [a, b, c, d]: [Vec3; 4] =
                std::array::from_fn(|_| Vec3::new(random(), flat * random(), flat * random()));
            for (full, alone) in [
                (
                    point_triangle(&a, &b, &c, &d),
                    point_triangle_distance_squared(&a, &b, &c, &d),
                ),
                (
                    edge_edge(&a, &b, &c, &d),
                    edge_edge_distance_squared(&a, &b, &c, &d),
                ),
            ] {
                assert!(
                    (full.distance_squared - alone).abs() < 1e-12,
                    "trial {trial}"
                );
            }
        }
    }

    fn second(pair: &ClosestPoints) -> [[f64; 12]; 12] {
        let mut h = [[0.0; 12]; 12];
        for (i, row) in h.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let identity = if i % 3 == j % 3 { 1.0 } else { 0.0 };
                *entry = 2.0 * pair.weights[i / 3] * pair.weights[j / 3] * identity;
                for (t, v) in pair.slides() {
                    let g = |k: usize| {
                        pair.weights[k / 3] * t[k % 3] + v[k / 3] * pair.separation[k % 3]
                    };
                    *entry -= 2.0 * g(i) * g(j);
                }
            }
        }
        h
    }

    fn check(points: [[f64; 3]; 4], closest: impl Fn(&[Vec3; 4]) -> ClosestPoints, slides: usize) {
        let x = points.map(|p| Vec3::new(p[0], p[1], p[2]));
        let pair = closest(&x);
        assert_eq!(pair.slides().len(), slides);
        let h = 1e-6;
        let hessian = second(&pair);
        for i in 0..12 {
            let moved = |step: f64| {
                let mut y = x;
                y[i / 3][i % 3] += step;
                closest(&y)
            };
            let (plus, minus) = (moved(h), moved(-h));
            let gradient =
                |pair: &ClosestPoints, k: usize| 2.0 * pair.weights[k / 3] * pair.separation[k % 3];
            let difference = (plus.distance_squared - minus.distance_squared) / (2.0 * h);
            assert!((gradient(&pair, i) - difference).abs() < 1e-8);
            for j in 0..12 {
                let difference = (gradient(&plus, j) - gradient(&minus, j)) / (2.0 * h);
                assert!(
                    (hessian[i][j] - difference).abs() < 1e-7,
                    "{i} {j}: {} {difference}",
                    hessian[i][j]
                );
            }
        }
    }

    #[test]
    fn every_region_of_a_triangle_has_the_right_derivatives() {
        let face = [[0.0, 0.0, 0.1], [1.1, 0.2, 0.0], [0.3, 0.9, -0.2]];
        let pair = |x: &[Vec3; 4]| point_triangle(&x[0], &x[1], &x[2], &x[3]);
        for (p, slides) in [
            ([0.4, 0.35, 0.7], 2),
            ([0.5, -0.6, 0.3], 1),
            ([1.0, 0.9, 0.2], 1),
            ([-0.5, 0.6, 0.2], 1),
            ([-0.6, -0.5, 0.3], 0),
            ([2.0, 0.1, 0.3], 0),
        ] {
            check([p, face[0], face[1], face[2]], pair, slides);
        }
    }

    #[test]
    fn every_region_of_two_edges_has_the_right_derivatives() {
        let pair = |x: &[Vec3; 4]| edge_edge(&x[0], &x[1], &x[2], &x[3]);
        let edge = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0]];
        for (other, slides) in [
            ([[0.4, -0.5, 0.3], [0.6, 0.8, 0.4]], 2),
            ([[0.4, 0.5, 0.3], [0.6, 1.8, 0.4]], 1),
            ([[1.4, -0.5, 0.3], [1.6, 0.8, 0.4]], 1),
            ([[1.4, 0.5, 0.3], [2.6, 0.8, 0.4]], 0),
        ] {
            check([edge[0], edge[1], other[0], other[1]], pair, slides);
        }
    }

    #[test]
    fn parallel_edges_have_the_distance_of_their_lines() {
        let v = Vec3::new;
        let pair = edge_edge(
            &v(0.0, 0.0, 0.0),
            &v(1.0, 0.0, 0.0),
            &v(0.25, 0.0, 0.5),
            &v(0.75, 0.0, 0.5),
        );
        assert!((pair.distance_squared - 0.25).abs() < 1e-15);
    }
}
