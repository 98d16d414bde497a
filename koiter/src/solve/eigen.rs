//! A few eigenvalues of a pair of sparse symmetric matrices.
//!
//! ```text
//! B φ = θ C φ,    C positive definite and factorised,    the largest θ
//! ```
//!
//! Block Lanczos iteration of `C⁻¹ B`, which is symmetric in the inner product of C, with full reorthogonalisation in that
//! product and the Rayleigh–Ritz values of the whole space. A block is wider than the number of eigenvalues asked for, so
//! that repeated ones are all found. B may be singular or indefinite. Reference: Y. Saad, "Numerical Methods for Large
//! Eigenvalue Problems" (2011), section 6.3. Why this and not another method: `docs/decisions/0009`.

use nalgebra::{DMatrix, DVector};

use super::cholesky::SparseCholesky;
use crate::assembly::SymmetricMatrix;

/// An eigenvalue with its eigenvector, φᵀ C φ = 1.
#[derive(Clone, Debug)]
pub struct EigenPair {
    /// θ.
    pub value: f64,
    /// φ.
    pub vector: Vec<f64>,
}

/// The iteration did not end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "{converged} of {wanted} eigenvalues converged in a space of {dimension} vectors; the largest relative residual is \
     {residual:.1e}"
)]
pub struct EigenNotConverged {
    /// Eigenvalues asked for.
    pub wanted: usize,
    /// Those whose residual is small.
    pub converged: usize,
    /// Vectors of the space.
    pub dimension: usize,
    /// Largest residual over the largest eigenvalue.
    pub residual: f64,
}

/// Largest residual `|C⁻¹ B φ − θ φ|` in the norm of C, over the eigenvalue. The error of an eigenvalue is about its square
/// over the distance to the next one.
const TOLERANCE: f64 = 1e-8;

/// Blocks before giving up; plates and strips take 5 to 15.
const MAX_BLOCKS: usize = 60;

/// Vectors of a block beyond the number of eigenvalues asked for: with them the last converge about as fast as the first.
const SPARE: usize = 2;

/// What of a vector must be left after orthogonalisation, so that it is more than round-off.
const INDEPENDENT: f64 = 1e-10;

/// The `count` largest eigenvalues in decreasing order; fewer if `C⁻¹ B` has a smaller range.
///
/// `multiply` is `x ↦ B x`. Where rows and columns of C are those of the identity because unknowns are prescribed, those
/// of B are zero.
///
/// # Errors
/// [`EigenNotConverged`].
pub fn largest_eigenpairs(
    c: &SymmetricMatrix,
    factor: &mut dyn SparseCholesky,
    multiply: &dyn Fn(&[f64]) -> Vec<f64>,
    count: usize,
) -> Result<Vec<EigenPair>, EigenNotConverged> {
    let n = c.pattern.num_rows();
    let mut image = |vectors: &[Vec<f64>]| -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
        let products: Vec<Vec<f64>> = vectors.iter().map(|v| multiply(v)).collect();
        let mut solved = products.concat();
        factor.solve(&mut solved);
        let solved = solved.chunks(n.max(1)).map(<[f64]>::to_vec).collect();
        (products, solved)
    };
    let mut space = Space::new(c);
    // An image has no part that B does not see: motions without mass, prescribed unknowns.
    let (_, mut block) = image(&start_vectors(n, count + SPARE));
    space.make_orthogonal(&mut block);
    if block.is_empty() {
        // B is zero.
        return Ok(Vec::new());
    }
    let mut projected = DMatrix::zeros(0, 0);
    let mut ritz = Ritz::default();
    for _ in 0..MAX_BLOCKS {
        let first = space.vectors.len();
        space.vectors.append(&mut block);
        let (products, mut next) = image(&space.vectors[first..]);
        projected = with_block(projected, &space.vectors, &products);
        let outside = space.make_orthogonal(&mut next);
        ritz = Ritz::new(&projected, &outside, count);
        if next.is_empty() || ritz.is_converged(count) {
            return Ok(ritz.pairs(&space.vectors));
        }
        block = next;
    }
    Err(EigenNotConverged {
        wanted: count,
        converged: ritz.residuals.iter().filter(|r| **r <= TOLERANCE).count(),
        dimension: space.vectors.len(),
        residual: ritz.residuals.iter().copied().fold(0.0, f64::max),
    })
}

/// Vectors without symmetry or smoothness, the same in every run.
fn start_vectors(n: usize, count: usize) -> Vec<Vec<f64>> {
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut next = || {
        // Linear congruential, constants of Knuth's MMIX; its upper bits are good enough to be in general position.
        state =
            (state.wrapping_mul(6_364_136_223_846_793_005)).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    (0..count)
        .map(|_| (0..n).map(|_| next()).collect())
        .collect()
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(a, b)| a * b).sum()
}

/// `x` += `factor` `y`.
fn add(x: &mut [f64], factor: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(a, b)| *a += factor * b);
}

/// `vectorsᵀ B vectors` from that without the last block, and the products B v of that block.
fn with_block(
    projected: DMatrix<f64>,
    vectors: &[Vec<f64>],
    products: &[Vec<f64>],
) -> DMatrix<f64> {
    let (size, first) = (vectors.len(), vectors.len() - products.len());
    let mut larger = projected.resize(size, size, 0.0);
    for (column, product) in (first..).zip(products) {
        for (row, vector) in vectors[..=column].iter().enumerate() {
            let entry = dot(vector, product);
            larger[(row, column)] = entry;
            larger[(column, row)] = entry;
        }
    }
    larger
}

/// Vectors that are orthonormal in the inner product of C.
struct Space<'a> {
    c: &'a SymmetricMatrix,
    vectors: Vec<Vec<f64>>,
}

impl<'a> Space<'a> {
    fn new(c: &'a SymmetricMatrix) -> Self {
        let vectors = Vec::new();
        Self { c, vectors }
    }

    /// Makes `block` orthonormal and orthogonal to the space, without vectors that depend on others. Returns the part of
    /// the old block outside the space in terms of the new one: `old = space · something + new · returned`.
    fn make_orthogonal(&self, block: &mut Vec<Vec<f64>>) -> DMatrix<f64> {
        let old = std::mem::take(block);
        let mut outside = DMatrix::zeros(old.len(), old.len());
        for (column, mut vector) in old.into_iter().enumerate() {
            let before = dot(&vector, &self.c.multiply(&vector)).sqrt();
            // Twice is enough: what is left of a second projection is round-off.
            for _ in 0..2 {
                let product = self.c.multiply(&vector);
                for basis in &self.vectors {
                    add(&mut vector, -dot(basis, &product), basis);
                }
                for (row, basis) in block.iter().enumerate() {
                    let share = dot(basis, &product);
                    add(&mut vector, -share, basis);
                    outside[(row, column)] += share;
                }
            }
            let after = dot(&vector, &self.c.multiply(&vector)).sqrt();
            if after > INDEPENDENT * before {
                outside[(block.len(), column)] = after;
                vector.iter_mut().for_each(|x| *x /= after);
                block.push(vector);
            }
        }
        let rows = block.len();
        outside.resize_vertically(rows, 0.0)
    }
}

/// Rayleigh–Ritz values of a space.
#[derive(Default)]
struct Ritz {
    /// Decreasing.
    values: Vec<f64>,
    /// Over the vectors of the space.
    coordinates: Vec<DVector<f64>>,
    /// Over the largest |θ|, in the norm of C.
    residuals: Vec<f64>,
}

impl Ritz {
    /// The `count` largest; `outside` is what `C⁻¹ B` of the last block has outside the space, in an orthonormal basis.
    fn new(projected: &DMatrix<f64>, outside: &DMatrix<f64>, count: usize) -> Self {
        let eigen = projected.clone().symmetric_eigen();
        let mut order: Vec<usize> = (0..projected.nrows()).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        order.truncate(count);
        let mut ritz = Self::default();
        for index in order {
            let coordinates: DVector<f64> = eigen.eigenvectors.column(index).into();
            let value = eigen.eigenvalues[index];
            let last = coordinates.rows(projected.nrows() - outside.ncols(), outside.ncols());
            ritz.residuals.push((outside * last).norm() / value.abs());
            ritz.values.push(value);
            ritz.coordinates.push(coordinates);
        }
        ritz
    }

    fn is_converged(&self, count: usize) -> bool {
        self.values.len() == count && self.residuals.iter().all(|r| *r <= TOLERANCE)
    }

    fn pairs(&self, vectors: &[Vec<f64>]) -> Vec<EigenPair> {
        let pair = |(value, coordinates): (&f64, &DVector<f64>)| {
            let mut vector = vec![0.0; vectors.first().map_or(0, Vec::len)];
            for (basis, share) in vectors.iter().zip(coordinates.iter()) {
                add(&mut vector, *share, basis);
            }
            EigenPair {
                value: *value,
                vector,
            }
        };
        self.values
            .iter()
            .zip(&self.coordinates)
            .map(pair)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::assembly::{DofLayout, NodeId, Pattern, PatternBuilder};
    use crate::solve::{LinearSolver, nested_dissection};

    /// The Laplacian of an n × n grid of a membrane that is held outside, with `shift` on its diagonal.
    fn membrane(n: usize, shift: f64) -> SymmetricMatrix {
        let mut layout = DofLayout::new();
        layout.push_nodes(n * n, 1, true);
        let neighbors = |at: usize| {
            let right = (at % n + 1 < n).then_some(at + 1);
            let above = (at + n < n * n).then_some(at + n);
            right.into_iter().chain(above)
        };
        let mut builder = PatternBuilder::default();
        for (a, b) in (0..n * n).flat_map(|a| neighbors(a).map(move |b| (a, b))) {
            builder.couple([a, b].map(|node| NodeId(node as u32)));
        }
        let mut matrix = SymmetricMatrix::zeros(Arc::new(Pattern::new(&layout, &builder.finish())));
        matrix.values.fill(-1.0);
        let pattern = Arc::clone(&matrix.pattern);
        for &position in pattern.diagonal_positions() {
            matrix.values[position as usize] = 4.0 + shift;
        }
        matrix
    }

    fn factorized(matrix: &SymmetricMatrix) -> Box<dyn SparseCholesky> {
        let mut factor = LinearSolver::default().create();
        factor.analyze(&matrix.pattern, &nested_dissection(&matrix.pattern));
        factor.factorize(matrix).unwrap();
        factor
    }

    /// Eigenvalues of [`membrane`] without shift, increasing.
    fn exact(n: usize) -> Vec<f64> {
        let one = |k: usize| {
            4.0 * (k as f64 * std::f64::consts::PI / (2.0 * (n + 1) as f64))
                .sin()
                .powi(2)
        };
        let mut all: Vec<f64> = (1..=n)
            .flat_map(|i| (1..=n).map(move |j| one(i) + one(j)))
            .collect();
        all.sort_by(f64::total_cmp);
        all
    }

    #[test]
    fn repeated_eigenvalues_of_a_square_are_all_found() {
        let (n, shift) = (30, 0.01);
        let matrix = membrane(n, shift);
        let pairs =
            largest_eigenpairs(&matrix, factorized(&matrix).as_mut(), &<[f64]>::to_vec, 9).unwrap();
        // Nine of the lowest, of which three pairs are equal up to round-off.
        for (pair, expected) in pairs.iter().zip(exact(n)) {
            let found = 1.0 / pair.value - shift;
            // The square of the residual's tolerance, over gaps of some percent, is below round-off of the shift.
            assert!((found / expected - 1.0).abs() < 1e-11, "{found} {expected}");
            let residual = matrix
                .multiply(&pair.vector)
                .iter()
                .zip(&pair.vector)
                .map(|(cx, x)| (x - pair.value * cx).abs())
                .fold(0.0, f64::max);
            assert!(residual < 1e-7, "{residual:.1e}");
        }
        assert_eq!(pairs.len(), 9);
    }

    #[test]
    fn a_singular_and_indefinite_matrix_gives_its_largest_values() {
        // B has rank 3: signs and sizes of a few single unknowns; C is the membrane.
        let matrix = membrane(12, 0.0);
        let entries = [(5, 2.0), (70, -7.0), (100, 1.0)];
        let multiply = |x: &[f64]| {
            let mut y = vec![0.0; x.len()];
            entries.iter().for_each(|&(at, b)| y[at] = b * x[at]);
            y
        };
        let mut factor = factorized(&matrix);
        let pairs = largest_eigenpairs(&matrix, factor.as_mut(), &multiply, 5).unwrap();
        // The same problem on the three unknowns: eigenvalues of |B|^½ sign C⁻¹ |B|^½.
        let mut columns = Vec::new();
        for (at, _) in entries {
            let mut unit = vec![0.0; 144];
            unit[at] = 1.0;
            factor.solve(&mut unit);
            columns.push(unit);
        }
        let small = DMatrix::from_fn(3, 3, |i, j| columns[j][entries[i].0] * entries[j].1);
        let mut expected: Vec<f64> = small.complex_eigenvalues().iter().map(|v| v.re).collect();
        expected.sort_by(|a, b| b.total_cmp(a));
        assert_eq!(pairs.len(), 3);
        for (pair, expected) in pairs.iter().zip(expected) {
            assert!(
                (pair.value - expected).abs() < 1e-12,
                "{} {expected}",
                pair.value
            );
        }
    }

    #[test]
    fn what_does_not_converge_is_an_error() {
        // All eigenvalues of a diagonal matrix lie within 1e-7 of each other: no space short of the whole separates them.
        let mut matrix = membrane(40, 0.0);
        matrix.values.fill(0.0);
        let pattern = Arc::clone(&matrix.pattern);
        for (i, &position) in pattern.diagonal_positions().iter().enumerate() {
            matrix.values[position as usize] = 1.0 + 1e-5 * (i as f64 * 0.37).sin();
        }
        let result = largest_eigenpairs(&matrix, factorized(&matrix).as_mut(), &<[f64]>::to_vec, 1);
        let error = result.unwrap_err();
        assert!(error.to_string().contains("0 of 1 eigenvalues"), "{error}");
    }
}
