//! Sparse linear least squares in which some sums of unknowns must become whole numbers.
//!
//! One factorisation serves all: with the solutions for the sums' own right-hand sides the least value is a small
//! dense quadratic function of the sums, whose minimum is rounded one sum after the other, the surest first (D.
//! Bommes et al., *Mixed-integer quadrangulation*, 2009, section 4.2, without further factorisations).

use super::seams::{Sum, value};
use crate::solver::cholesky::{CholeskyFactor, CholeskyPattern};

/// A row of the system: a sum of unknowns and the value it should have.
#[derive(Debug, Clone)]
pub struct Row {
    /// The sum.
    pub sum: Sum,
    /// The value.
    pub value: f64,
}

/// A sum that must become a whole number plus `offset`.
#[derive(Debug, Clone)]
pub struct Whole {
    /// The sum.
    pub sum: Sum,
    /// What is left over by whole numbers.
    pub offset: f64,
}

/// The normal equations of rows, factorised.
pub struct System {
    factor: CholeskyFactor,
    rhs: Vec<f64>,
}

impl System {
    /// Of `n` unknowns; `None` where they are not determined.
    pub fn new(n: usize, rows: &[Row]) -> Option<Self> {
        let pairs = rows.iter().flat_map(|row| {
            row.sum
                .iter()
                .enumerate()
                .flat_map(|(k, &(i, _))| row.sum[..=k].iter().map(move |&(j, _)| (i, j)))
        });
        let pattern = CholeskyPattern::new(n, pairs);
        let mut values = vec![0.0; pattern.entries()];
        let mut rhs = vec![0.0; n];
        for row in rows {
            for (k, &(i, a)) in row.sum.iter().enumerate() {
                rhs[i] += a * row.value;
                row.sum[..=k].iter().for_each(|&(j, b)| values[pattern.slot(i, j)] += a * b);
            }
        }
        // An unknown that nobody uses is zero.
        for i in 0..n {
            let slot = pattern.diagonal(i);
            values[slot] = if values[slot] == 0.0 { 1.0 } else { values[slot] };
        }
        Some(Self { factor: pattern.factor(&values)?, rhs })
    }

    /// The least-squares solution in which the given sums are whole.
    pub fn solve(&self, wholes: &[Whole]) -> Vec<f64> {
        let mut x = self.rhs.clone();
        self.factor.solve_in_place(&mut x);
        let mut free: Vec<usize> = (0..wholes.len()).collect();
        let mut columns: Vec<Vec<f64>> = wholes.iter().map(|whole| self.column(&whole.sum)).collect();
        let alone: Vec<f64> = wholes.iter().zip(&columns).map(|(w, column)| value(&w.sum, column)).collect();
        // Each round holds one sum: its column is taken out of the others, so that they do not move it.
        while !free.is_empty() {
            let miss = |k: usize| {
                let at = value(&wholes[k].sum, &x) - wholes[k].offset;
                at.round() - at
            };
            let best = (0..free.len()).fold(0, |best, next| {
                // Equal but for rounding: the first.
                if miss(free[next]).abs() < miss(free[best]).abs() - 1e-9 { next } else { best }
            });
            let held = free.remove(best);
            let column = std::mem::take(&mut columns[held]);
            let softness = value(&wholes[held].sum, &column);
            if softness <= HELD * alone[held] {
                continue;
            }
            let step = miss(held) / softness;
            x.iter_mut().zip(&column).for_each(|(x, c)| *x += step * c);
            for &other in &free {
                let share = value(&wholes[held].sum, &columns[other]) / softness;
                columns[other].iter_mut().zip(&column).for_each(|(o, c)| *o -= share * c);
            }
        }
        x
    }

    fn column(&self, sum: &Sum) -> Vec<f64> {
        let mut column = vec![0.0; self.rhs.len()];
        sum.iter().for_each(|&(i, factor)| column[i] += factor);
        self.factor.solve_in_place(&mut column);
        column
    }
}

/// A sum that moves by less than this part of what it moved at first is held by the sums before it.
const HELD: f64 = 1e-4;

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of a chain of points, neighbours 1.3 apart, the first held at 0.
    fn chain(n: usize) -> Vec<Row> {
        let held = Row { sum: vec![(0, 1e4)], value: 0.0 };
        let steps = (1..n).map(|i| Row { sum: vec![(i - 1, -1.0), (i, 1.0)], value: 1.3 });
        std::iter::once(held).chain(steps).collect()
    }

    #[test]
    fn without_whole_numbers_it_is_the_solution() {
        let x = System::new(6, &chain(6)).expect("determined").solve(&[]);
        for (i, x) in x.iter().enumerate() {
            assert!((x - 1.3 * i as f64).abs() < 1e-9, "{x}");
        }
    }

    #[test]
    fn a_held_end_spreads_the_difference_evenly() {
        // Springs in a row: the end at 6.5 goes to a half, which is there, or to 7, and the others follow.
        let system = System::new(6, &chain(6)).expect("determined");
        let end = Whole { sum: vec![(5, 1.0)], offset: 0.25 };
        let x = system.solve(&[end]);
        for (i, x) in x.iter().enumerate() {
            // The first is held by a spring that is 1e8 times as stiff.
            assert!((x - 6.25 / 5.0 * i as f64).abs() < 1e-7, "{i}: {x}");
        }
    }

    #[test]
    fn many_sums_all_become_whole() {
        let system = System::new(9, &chain(9)).expect("determined");
        let wholes: Vec<Whole> =
            [3, 8, 5].iter().map(|&i| Whole { sum: vec![(i, 1.0)], offset: 0.5 }).collect();
        let x = system.solve(&wholes);
        for whole in &wholes {
            let at = value(&whole.sum, &x) - 0.5;
            assert!((at - at.round()).abs() < 1e-9, "{at}");
        }
        // Between held ones neighbours are equally far apart.
        for i in [1, 2, 4, 6, 7] {
            assert!((x[i - 1] - 2.0 * x[i] + x[i + 1]).abs() < 1e-9);
        }
    }
}
