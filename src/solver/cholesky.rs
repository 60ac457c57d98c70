//! Sparse Cholesky factorisation with a fixed pattern: analysed once, factorised many times.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{MatMut, Side};

/// The pattern of a symmetric matrix, lower triangle by columns, and its symbolic factorisation under
/// an approximate-minimum-degree ordering.
pub struct CholeskyPattern {
    n: usize,
    column_starts: Vec<usize>,
    rows: Vec<usize>,
    symbolic: SymbolicLlt<usize>,
}

/// A numeric factorisation.
pub struct CholeskyFactor {
    n: usize,
    llt: Llt<usize, f64>,
}

impl CholeskyPattern {
    /// Builds the pattern of an `n` by `n` matrix from its lower-triangle entries `(row, column)`; duplicates
    /// are fine, and the diagonal is always part of it.
    ///
    /// # Panics
    /// If an entry lies outside the lower triangle: a broken invariant of the caller.
    pub fn new(n: usize, entries: impl IntoIterator<Item = (usize, usize)>) -> Self {
        let mut keyed: Vec<(u32, u32)> = (0..n as u32).map(|i| (i, i)).collect();
        keyed.extend(entries.into_iter().map(|(row, column)| {
            assert!(column <= row && row < n, "entry ({row}, {column}) outside the lower triangle");
            (column as u32, row as u32)
        }));
        keyed.sort_unstable();
        keyed.dedup();
        let mut column_starts = vec![0; n + 1];
        for &(column, _) in &keyed {
            column_starts[column as usize + 1] += 1;
        }
        for column in 0..n {
            column_starts[column + 1] += column_starts[column];
        }
        let rows: Vec<usize> = keyed.iter().map(|&(_, row)| row as usize).collect();
        let symbolic = SymbolicLlt::try_new(
            SymbolicSparseColMatRef::new_checked(n, n, &column_starts, None, &rows),
            Side::Lower,
        )
        .expect("memory for the symbolic factorisation");
        Self { n, column_starts, rows, symbolic }
    }

    /// Number of stored entries of the lower triangle.
    pub fn entries(&self) -> usize {
        self.rows.len()
    }

    /// Where entry `(row, column)` of the lower triangle is stored.
    ///
    /// # Panics
    /// If the entry is not in the pattern.
    pub fn slot(&self, row: usize, column: usize) -> usize {
        let (start, end) = (self.column_starts[column], self.column_starts[column + 1]);
        start + self.rows[start..end].binary_search(&row).expect("entry is in the pattern")
    }

    /// Where the diagonal entry of a column is stored.
    pub fn diagonal(&self, column: usize) -> usize {
        self.column_starts[column]
    }

    /// Factorises the matrix with these values; `None` where it is not positive definite (or not finite).
    pub fn factor(&self, values: &[f64]) -> Option<CholeskyFactor> {
        let symbolic =
            SymbolicSparseColMatRef::new_checked(self.n, self.n, &self.column_starts, None, &self.rows);
        let matrix = SparseColMatRef::new(symbolic, values);
        let llt = Llt::try_new_with_symbolic(self.symbolic.clone(), matrix, Side::Lower).ok()?;
        Some(CholeskyFactor { n: self.n, llt })
    }
}

impl CholeskyFactor {
    /// Solves for one right-hand side, in place.
    pub fn solve_in_place(&self, rhs: &mut [f64]) {
        let n = self.n;
        self.llt.solve_in_place(MatMut::from_column_major_slice_mut(rhs, n, 1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_a_chain_of_springs() {
        // Second differences with both ends held: K x = f with constant f has the parabola as its solution.
        let n = 50;
        let entries = (1..n).map(|i| (i, i - 1));
        let pattern = CholeskyPattern::new(n, entries);
        let mut values = vec![0.0; pattern.entries()];
        for i in 0..n {
            values[pattern.diagonal(i)] = 2.0;
            if i > 0 {
                values[pattern.slot(i, i - 1)] = -1.0;
            }
        }
        let mut x = vec![1.0; n];
        pattern.factor(&values).expect("positive definite").solve_in_place(&mut x);
        for (i, value) in x.iter().enumerate() {
            let t = (i + 1) as f64;
            let exact = 0.5 * t * ((n + 1) as f64 - t);
            // Condition number about n^2, so 1e-12 relative leaves three digits of room.
            assert!((value - exact).abs() < 1e-12 * 400.0, "{i}: {value} {exact}");
        }
    }

    #[test]
    fn refuses_indefinite_and_not_finite() {
        let pattern = CholeskyPattern::new(2, [(1, 0)]);
        assert!(pattern.factor(&[1.0, 2.0, 1.0]).is_none());
        assert!(pattern.factor(&[f64::NAN, 0.0, 1.0]).is_none());
    }
}
