//! Conjugate gradients, preconditioned by the diagonal blocks of the nodes.

use nalgebra::DMatrix;

use crate::assembly::{NodeId, SymmetricMatrix};

/// Inverses of the diagonal blocks of a matrix.
pub struct NodeBlocks {
    starts: Vec<usize>,
    inverses: Vec<DMatrix<f64>>,
}

impl NodeBlocks {
    /// Inverts the diagonal blocks.
    ///
    /// # Errors
    /// The first unknown of a node whose block is not positive definite.
    pub fn of(matrix: &SymmetricMatrix) -> Result<Self, usize> {
        let pattern = &matrix.pattern;
        let mut blocks = Self {
            starts: pattern.node_starts().iter().map(|s| *s as usize).collect(),
            inverses: Vec::with_capacity(pattern.num_nodes()),
        };
        for node in 0..pattern.num_nodes() {
            let id = NodeId(node as u32);
            let size = pattern.size(id);
            let first = blocks.starts[node];
            let mut block = DMatrix::zeros(size, size);
            for column in 0..size {
                let at = pattern.column_starts()[first + column] as usize;
                for row in column..size {
                    block[(row, column)] = matrix.values[at + row - column];
                    block[(column, row)] = block[(row, column)];
                }
            }
            let factor = block.cholesky().ok_or(first)?;
            blocks.inverses.push(factor.inverse());
        }
        Ok(blocks)
    }

    fn apply(&self, r: &[f64], z: &mut [f64]) {
        for (inverse, range) in self.inverses.iter().zip(self.starts.windows(2)) {
            let r = nalgebra::DVectorView::from_slice(&r[range[0]..range[1]], range[1] - range[0]);
            let mut z = nalgebra::DVectorViewMut::from_slice(
                &mut z[range[0]..range[1]],
                range[1] - range[0],
            );
            z.gemv(1.0, inverse, &r, 0.0);
        }
    }
}

/// How far conjugate gradients came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConjugateGradients {
    /// Iterations.
    pub iterations: usize,
    /// Residual over that of zero, in the norm of the preconditioner.
    pub residual: f64,
    /// An unknown of a direction along which the matrix is not positive, if one was met.
    pub negative_direction: Option<usize>,
}

/// Replaces `rhs` by an approximate solution. An iterate that is not converged lowers the quadratic form all the same.
pub fn conjugate_gradients(
    matrix: &SymmetricMatrix,
    blocks: &NodeBlocks,
    rhs: &mut [f64],
    tolerance: f64,
    most_iterations: usize,
) -> ConjugateGradients {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut r = rhs.to_vec();
    rhs.fill(0.0);
    let mut z = vec![0.0; r.len()];
    blocks.apply(&r, &mut z);
    let mut p = z.clone();
    let first = dot(&r, &z);
    let mut rz = first;
    let mut outcome = ConjugateGradients {
        iterations: 0,
        residual: 0.0,
        negative_direction: None,
    };
    while outcome.iterations < most_iterations && rz > tolerance * tolerance * first {
        let ap = matrix.multiply(&p);
        let curvature = dot(&p, &ap);
        if !(curvature > 0.0) {
            let largest = (0..p.len()).max_by(|a, b| p[*a].abs().total_cmp(&p[*b].abs()));
            outcome.negative_direction = largest;
            break;
        }
        let alpha = rz / curvature;
        for i in 0..p.len() {
            rhs[i] += alpha * p[i];
            r[i] -= alpha * ap[i];
        }
        blocks.apply(&r, &mut z);
        let next = dot(&r, &z);
        let beta = next / rz;
        for i in 0..p.len() {
            p[i] = z[i] + beta * p[i];
        }
        rz = next;
        outcome.iterations += 1;
    }
    outcome.residual = if first > 0.0 {
        (rz / first).sqrt()
    } else {
        0.0
    };
    outcome
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::assembly::{DofLayout, Pattern, PatternBuilder};

    fn chain(diagonal: f64) -> SymmetricMatrix {
        let mut layout = DofLayout::new();
        layout.push_nodes(40, 6, true);
        let mut builder = PatternBuilder::default();
        for i in 0..39 {
            builder.couple([NodeId(i), NodeId(i + 1)]);
        }
        let pattern = Arc::new(Pattern::new(&layout, &builder.finish()));
        let mut matrix = SymmetricMatrix::zeros(pattern.clone());
        for (i, value) in matrix.values.iter_mut().enumerate() {
            *value = 0.1 * (i as f64).sin();
        }
        for &position in pattern.diagonal_positions() {
            matrix.values[position as usize] = diagonal;
        }
        matrix
    }

    #[test]
    fn the_solution_is_the_one_the_right_hand_side_was_made_of() {
        let matrix = chain(4.0);
        let expected: Vec<f64> = (0..240).map(|i| (i as f64 * 0.3).cos()).collect();
        let mut x = matrix.multiply(&expected);
        let blocks = NodeBlocks::of(&matrix).unwrap();
        let outcome = conjugate_gradients(&matrix, &blocks, &mut x, 1e-12, 300);
        assert!(
            outcome.iterations > 1 && outcome.residual < 1e-12,
            "{outcome:?}"
        );
        for (a, b) in x.iter().zip(&expected) {
            // The residual, times a condition number below 10.
            assert!((a - b).abs() < 1e-10, "{a} for {b}");
        }
    }

    #[test]
    fn an_indefinite_matrix_is_reported() {
        assert_eq!(NodeBlocks::of(&chain(-4.0)).err(), Some(0));
        let definite = NodeBlocks::of(&chain(4.0)).unwrap();
        let mut rhs = vec![1.0; 240];
        let outcome = conjugate_gradients(&chain(-4.0), &definite, &mut rhs, 1e-9, 10);
        assert!(outcome.negative_direction.is_some());
    }
}
