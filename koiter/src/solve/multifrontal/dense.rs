//! Dense kernels of one front, split into tiles that are fixed by its sizes: any number of threads gives the same bits.
//!
//! The arithmetic inside a tile is faer's, on one thread.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{
    LltError, LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};

/// Columns that are eliminated at a time.
const BLOCK: usize = 128;

/// Tiles of products are split until they have at most this many rows and columns.
const TILE: usize = 256;

/// Products of fewer multiplications are not worth a task.
const TASK: usize = 1 << 20;

/// Runs both, in parallel where the feature `parallel` is on.
pub(super) fn join<A: Send, B: Send>(
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    #[cfg(feature = "parallel")]
    {
        rayon::join(a, b)
    }
    #[cfg(not(feature = "parallel"))]
    {
        (a(), b())
    }
}

/// Memory for the dense factorisation of a diagonal block.
pub(super) struct Scratch(MemBuffer);

impl Scratch {
    pub(super) fn new() -> Self {
        Self(MemBuffer::new(cholesky_in_place_scratch::<f64>(
            BLOCK,
            Par::Seq,
            Default::default(),
        )))
    }
}

/// Factorises the panel (rows × columns, rows ≥ columns): its top becomes L₁₁, the rest L₂₁ = A₂₁ L₁₁⁻ᵀ.
///
/// # Errors
/// The first column whose pivot is not positive.
pub(super) fn factorize_panel(panel: MatMut<'_, f64>, scratch: &mut Scratch) -> Result<(), usize> {
    let columns = panel.ncols();
    if columns <= BLOCK {
        return factorize_block(panel, scratch);
    }
    let half = (columns / 2).next_multiple_of(BLOCK);
    let (mut left, right) = panel.split_at_col_mut(half);
    factorize_panel(left.rb_mut(), scratch)?;
    let (_, mut right) = right.split_at_row_mut(half);
    let below = left.rb().split_at_row(half).1;
    let (diagonal, rest) = right.rb_mut().split_at_row_mut(columns - half);
    let (top, bottom) = below.split_at_row(columns - half);
    join(
        || subtract_square(diagonal, top),
        || subtract_product(rest, bottom, top),
    );
    factorize_panel(right, scratch).map_err(|column| half + column)
}

fn factorize_block(panel: MatMut<'_, f64>, scratch: &mut Scratch) -> Result<(), usize> {
    let columns = panel.ncols();
    let (mut diagonal, below) = panel.split_at_row_mut(columns);
    cholesky_in_place(
        diagonal.rb_mut(),
        LltRegularization::default(),
        Par::Seq,
        MemStack::new(&mut scratch.0),
        Default::default(),
    )
    .map_err(|LltError::NonPositivePivot { index }| index)?;
    // Comparisons with NaN are false, so a pivot that is not a number passes the factorisation.
    if let Some(bad) =
        (0..columns).find(|&k| !(diagonal[(k, k)] > 0.0 && diagonal[(k, k)].is_finite()))
    {
        return Err(bad);
    }
    divide(diagonal.rb(), below);
    Ok(())
}

/// B ← B L⁻ᵀ, by rows.
fn divide(l: MatRef<'_, f64>, b: MatMut<'_, f64>) {
    let (rows, columns) = (b.nrows(), b.ncols());
    if rows > TILE && rows * columns * columns > TASK {
        let (upper, lower) = b.split_at_row_mut((rows / 2).next_multiple_of(64));
        join(|| divide(l, upper), || divide(l, lower));
        return;
    }
    solve_lower_triangular_in_place(l, b.transpose_mut(), Par::Seq);
}

/// C ← C − A Aᵀ, lower triangle.
pub(super) fn subtract_square(c: MatMut<'_, f64>, a: MatRef<'_, f64>) {
    let n = c.nrows();
    if n > TILE && n * n * a.ncols() > TASK {
        let half = (n / 2).next_multiple_of(64);
        let (upper, _, lower_left, lower) = c.split_at_mut(half, half);
        let (top, bottom) = a.split_at_row(half);
        join(
            || {
                join(
                    || subtract_square(upper, top),
                    || subtract_square(lower, bottom),
                )
            },
            || subtract_product(lower_left, bottom, top),
        );
        return;
    }
    triangular::matmul(
        c,
        BlockStructure::TriangularLower,
        Accum::Add,
        a,
        BlockStructure::Rectangular,
        a.transpose(),
        BlockStructure::Rectangular,
        -1.0,
        Par::Seq,
    );
}

/// C ← C − A Bᵀ.
fn subtract_product(c: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    let (rows, columns) = (c.nrows(), c.ncols());
    if rows.max(columns) > TILE && rows * columns * a.ncols() > TASK {
        if rows >= columns {
            let half = (rows / 2).next_multiple_of(64);
            let (upper, lower) = c.split_at_row_mut(half);
            let (top, bottom) = a.split_at_row(half);
            join(
                || subtract_product(upper, top, b),
                || subtract_product(lower, bottom, b),
            );
        } else {
            let half = (columns / 2).next_multiple_of(64);
            let (left, right) = c.split_at_col_mut(half);
            let (top, bottom) = b.split_at_row(half);
            join(
                || subtract_product(left, a, top),
                || subtract_product(right, a, bottom),
            );
        }
        return;
    }
    matmul(c, Accum::Add, a, b.transpose(), -1.0, Par::Seq);
}
