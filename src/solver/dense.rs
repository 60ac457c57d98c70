//! Dense kernels of the factorisation: partial elimination of a front, and triangular solves with a panel.
//!
//! Large fronts are worked in tiles of fixed size, at the same time where threads are free; each tile is one
//! sequential product, so that the numbers do not depend on the number of threads.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{BlockStructure, matmul as triangular_matmul};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par, Spec};
use std::ops::{AddAssign, Div, Mul, Sub, SubAssign};

/// The precisions in which a matrix can be factorised.
pub trait Real:
    faer::traits::RealField
    + Copy
    + Default
    + Send
    + Sync
    + AddAssign
    + Div<Output = Self>
    + Mul<Output = Self>
    + Sub<Output = Self>
    + SubAssign
{
    /// Rounds a number.
    fn of(value: f64) -> Self;
    /// The number itself.
    fn f64(self) -> f64;
}

impl Real for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn f64(self) -> f64 {
        self
    }
}

impl Real for f32 {
    fn of(value: f64) -> Self {
        value as f32
    }
    fn f64(self) -> f64 {
        f64::from(self)
    }
}

/// Rows and columns of a tile.
const TILE: usize = 256;

/// Columns that are factorised before the rest is updated.
const BLOCK: usize = 128;

/// Eliminates the columns of a panel (rows by own columns) and writes what they contribute to the rows below into the lower
/// triangle of `update`, a square matrix. False where the matrix is not positive definite.
pub fn eliminate<T: Real>(panel: MatMut<T>, mut update: MatMut<T>, in_tiles: bool) -> bool {
    if panel.ncols() == 0 {
        update.fill(T::default());
        return true;
    }
    if in_tiles { eliminate_in_tiles(panel, update) } else { eliminate_at_once(panel, update) }
}

fn eliminate_at_once<T: Real>(panel: MatMut<T>, update: MatMut<T>) -> bool {
    let columns = panel.ncols();
    let (mut own, mut below) = panel.split_at_row_mut(columns);
    if !cholesky(own.as_mut()) {
        return false;
    }
    divide(own.as_ref(), below.as_mut());
    minus_square(update, below.as_ref());
    true
}

fn eliminate_in_tiles<T: Real>(mut panel: MatMut<T>, update: MatMut<T>) -> bool {
    let columns = panel.ncols();
    let mut done = 0;
    while done < columns {
        let width = BLOCK.min(columns - done);
        let (left, rest) = panel.as_mut().split_at_col_mut(done);
        let left = left.as_ref();
        let current = rest.split_at_col_mut(width).0.split_at_row_mut(done).1;
        let left = left.split_at_row(done).1;
        let beside = left.split_at_row(width).0;
        let (mut own, below) = current.split_at_row_mut(width);
        subtract_product(own.as_mut(), beside, beside);
        if !cholesky(own.as_mut()) {
            return false;
        }
        let own = own.as_ref();
        let left_below = left.split_at_row(width).1;
        by_rows(below, 0, &|first, mut tile| {
            let rows = left_below.subrows(first, tile.nrows());
            subtract_product(tile.as_mut(), rows, beside);
            divide(own, tile);
        });
        done += width;
    }
    let below = panel.as_ref().split_at_row(columns).1;
    minus_square_in_tiles(update, below);
    true
}

/// The Cholesky factor of a symmetric matrix, in its lower triangle.
fn cholesky<T: Real>(matrix: MatMut<T>) -> bool {
    let mut memory =
        MemBuffer::new(cholesky_in_place_scratch::<T>(matrix.nrows(), Par::Seq, Spec::default()));
    cholesky_in_place(matrix, Default::default(), Par::Seq, MemStack::new(&mut memory), Spec::default())
        .is_ok()
}

/// `rows <- rows L^-T`.
fn divide<T: Real>(lower: MatRef<T>, rows: MatMut<T>) {
    solve_lower_triangular_in_place(lower, rows.transpose_mut(), Par::Seq);
}

/// `c <- c - a b^T`.
fn subtract_product<T: Real>(c: MatMut<T>, a: MatRef<T>, b: MatRef<T>) {
    matmul(c, Accum::Add, a, b.transpose(), T::of(-1.0), Par::Seq);
}

/// `c <- -a b^T`.
fn minus_product<T: Real>(c: MatMut<T>, a: MatRef<T>, b: MatRef<T>) {
    matmul(c, Accum::Replace, a, b.transpose(), T::of(-1.0), Par::Seq);
}

/// `c <- -a a^T` in the lower triangle.
fn minus_square<T: Real>(c: MatMut<T>, a: MatRef<T>) {
    use BlockStructure::{Rectangular, TriangularLower};
    let transposed = a.transpose();
    triangular_matmul(
        c,
        TriangularLower,
        Accum::Replace,
        a,
        Rectangular,
        transposed,
        Rectangular,
        T::of(-1.0),
        Par::Seq,
    );
}

/// Where a range is cut in two: at a multiple of the tile, near the middle.
fn middle(length: usize) -> usize {
    length.div_ceil(2 * TILE) * TILE
}

fn by_rows<T: Real>(matrix: MatMut<T>, first: usize, work: &(impl Fn(usize, MatMut<T>) + Sync)) {
    if matrix.nrows() <= TILE {
        work(first, matrix);
        return;
    }
    let half = middle(matrix.nrows());
    let (upper, lower) = matrix.split_at_row_mut(half);
    rayon::join(|| by_rows(upper, first, work), || by_rows(lower, first + half, work));
}

fn minus_product_in_tiles<T: Real>(c: MatMut<T>, a: MatRef<T>, b: MatRef<T>) {
    if c.nrows().max(c.ncols()) <= TILE {
        minus_product(c, a, b);
    } else if c.nrows() >= c.ncols() {
        let half = middle(c.nrows());
        let (upper, lower) = c.split_at_row_mut(half);
        let (a_upper, a_lower) = a.split_at_row(half);
        rayon::join(
            || minus_product_in_tiles(upper, a_upper, b),
            || minus_product_in_tiles(lower, a_lower, b),
        );
    } else {
        let half = middle(c.ncols());
        let (left, right) = c.split_at_col_mut(half);
        let (b_left, b_right) = b.split_at_row(half);
        rayon::join(|| minus_product_in_tiles(left, a, b_left), || minus_product_in_tiles(right, a, b_right));
    }
}

fn minus_square_in_tiles<T: Real>(c: MatMut<T>, a: MatRef<T>) {
    if c.nrows() <= TILE {
        minus_square(c, a);
        return;
    }
    let half = middle(c.nrows());
    let (upper, _, lower, rest) = c.split_at_mut(half, half);
    let (a_upper, a_lower) = a.split_at_row(half);
    rayon::join(
        || minus_square_in_tiles(upper, a_upper),
        || {
            rayon::join(
                || minus_product_in_tiles(lower, a_lower, a_upper),
                || minus_square_in_tiles(rest, a_lower),
            )
        },
    );
}

/// Solves with a panel's triangle and carries the result to the rows below: `front` holds the own entries,
/// then those of the rows below.
pub fn solve_lower<T: Real>(panel: &[T], columns: usize, front: &mut [T]) {
    let rows = front.len();
    for (j, column) in panel.chunks_exact(rows).enumerate().take(columns) {
        let value = front[j] / column[j];
        front[j] = value;
        for (entry, factor) in front[j + 1..].iter_mut().zip(&column[j + 1..]) {
            *entry -= *factor * value;
        }
    }
}

/// Solves with the transpose of a panel: the entries of the rows below are known, the own ones are found.
pub fn solve_upper<T: Real>(panel: &[T], columns: usize, front: &mut [T]) {
    let rows = front.len();
    for j in (0..columns).rev() {
        let column = &panel[j * rows..(j + 1) * rows];
        front[j] = (front[j] - dot(&column[j + 1..], &front[j + 1..])) / column[j];
    }
}

/// The scalar product, in eight partial sums.
fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    let mut sums = [T::default(); 8];
    let (a_chunks, b_chunks) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest = a_chunks.remainder().iter().zip(b_chunks.remainder());
    let mut tail = T::default();
    rest.for_each(|(x, y)| tail += *x * *y);
    for (x, y) in a_chunks.zip(b_chunks) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    sums.iter().for_each(|sum| tail += *sum);
    tail
}
