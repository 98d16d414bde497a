//! Quadratic basis functions on a triangle, over s towards the second corner and t towards the third.
//!
//! Nodes: the corners i, j, k, then the middles of the edges jk, ki, ij ("Better Bending" (2026), Table 3).

/// The points at which faces are sampled, each with a third of the area: exact for quadratic functions.
pub(super) const SAMPLES: [[f64; 2]; 3] = [
    [1.0 / 6.0, 1.0 / 6.0],
    [2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0],
];

/// ∂_s and ∂_t of the functions of all nodes at a point.
pub(super) fn slopes([s, t]: [f64; 2]) -> [[f64; 2]; 6] {
    [
        [4.0 * (s + t) - 3.0, 4.0 * (s + t) - 3.0],
        [4.0 * s - 1.0, 0.0],
        [0.0, 4.0 * t - 1.0],
        [4.0 * t, 4.0 * s],
        [-4.0 * t, 4.0 * (1.0 - s - 2.0 * t)],
        [4.0 * (1.0 - 2.0 * s - t), -4.0 * s],
    ]
}

/// ∂_ss, ∂_st and ∂_tt of the functions of all nodes; they are constant.
pub(super) const CURVATURES: [[f64; 3]; 6] = [
    [4.0, 4.0, 4.0],
    [4.0, 0.0, 0.0],
    [0.0, 0.0, 4.0],
    [0.0, 4.0, 0.0],
    [0.0, -4.0, -8.0],
    [-8.0, -4.0, 0.0],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_functions() {
        // x = s, t and their products as functions of the nodes, whose derivatives are known.
        let nodes = [
            [0.0, 0.0],
            [1.0, 0.0],
            [0.0, 1.0],
            [0.5, 0.5],
            [0.0, 0.5],
            [0.5, 0.0],
        ];
        let [s, t] = [0.3, 0.45];
        type Case = (fn([f64; 2]) -> f64, [f64; 2], [f64; 3]);
        let cases: [Case; 5] = [
            (|x| x[0], [1.0, 0.0], [0.0; 3]),
            (|x| x[1], [0.0, 1.0], [0.0; 3]),
            (|x| x[0] * x[0], [2.0 * s, 0.0], [2.0, 0.0, 0.0]),
            (|x| x[0] * x[1], [t, s], [0.0, 1.0, 0.0]),
            (|x| x[1] * x[1], [0.0, 2.0 * t], [0.0, 0.0, 2.0]),
        ];
        for (f, first, second) in cases {
            for (axis, expected) in first.iter().enumerate() {
                let found: f64 = (0..6).map(|n| f(nodes[n]) * slopes([s, t])[n][axis]).sum();
                assert!((found - expected).abs() < 1e-15);
            }
            for (axis, expected) in second.iter().enumerate() {
                let found: f64 = (0..6).map(|n| f(nodes[n]) * CURVATURES[n][axis]).sum();
                assert!((found - expected).abs() < 1e-15);
            }
        }
    }
}
