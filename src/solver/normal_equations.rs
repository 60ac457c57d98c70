//! Assembly of the normal equations `J^T W J` and `J^T W r` into a fixed pattern.

use super::Weighted;
use super::cholesky::CholeskyPattern;

/// The fixed pattern of a problem's normal equations with the current values.
pub struct NormalEquations {
    /// Pattern and symbolic factorisation.
    pub pattern: CholeskyPattern,
    /// Values of the lower triangle of `J^T W J`.
    pub values: Vec<f64>,
    /// The gradient `J^T W r` (half the derivative of the energy).
    pub gradient: Vec<f64>,
    /// Where each block's products go, term after term, block after block.
    slots: Vec<u32>,
    residuals: Vec<f64>,
    jacobian: Vec<f64>,
}

impl NormalEquations {
    /// Analyses the pattern of `terms` over `n` unknowns.
    pub fn new(n: usize, terms: &[Weighted]) -> Self {
        let mut entries = Vec::new();
        let (mut most_rows, mut most_unknowns) = (0, 0);
        for term in terms.iter().map(|weighted| &weighted.term) {
            for b in 0..term.blocks() {
                most_rows = most_rows.max(term.rows(b));
                let unknowns = term.unknowns(b);
                most_unknowns = most_unknowns.max(unknowns.len());
                for (i, &u) in unknowns.iter().enumerate() {
                    entries.extend(unknowns[..=i].iter().map(|&v| (u.max(v), u.min(v))));
                }
            }
        }
        let pattern = CholeskyPattern::new(n, entries.iter().copied());
        let slots = entries.iter().map(|&(row, column)| pattern.slot(row, column) as u32).collect();
        let values = vec![0.0; pattern.entries()];
        Self {
            pattern,
            values,
            gradient: vec![0.0; n],
            slots,
            residuals: vec![0.0; most_rows],
            jacobian: vec![0.0; most_rows * most_unknowns],
        }
    }

    /// Evaluates all terms at `x`: fills the matrix and the gradient, and returns each term's sum of squares
    /// (without its weight).
    pub fn assemble(&mut self, terms: &[Weighted], x: &[f64]) -> Vec<f64> {
        self.values.fill(0.0);
        self.gradient.fill(0.0);
        let mut next_slot = 0;
        let mut sums = Vec::with_capacity(terms.len());
        for Weighted { term, weight } in terms {
            let mut sum = 0.0;
            for b in 0..term.blocks() {
                let unknowns = term.unknowns(b);
                let (rows, columns) = (term.rows(b), unknowns.len());
                let residuals = &mut self.residuals[..rows];
                let jacobian = &mut self.jacobian[..rows * columns];
                jacobian.fill(0.0);
                term.evaluate(b, x, residuals, jacobian);
                sum += residuals.iter().map(|r| r * r).sum::<f64>();
                for (i, &u) in unknowns.iter().enumerate() {
                    let mut slope = 0.0;
                    for row in 0..rows {
                        slope += jacobian[row * columns + i] * residuals[row];
                    }
                    self.gradient[u] += weight * slope;
                    for j in 0..=i {
                        let mut product = 0.0;
                        for row in 0..rows {
                            product += jacobian[row * columns + i] * jacobian[row * columns + j];
                        }
                        self.values[self.slots[next_slot] as usize] += weight * product;
                        next_slot += 1;
                    }
                }
            }
            sums.push(sum);
        }
        sums
    }

    /// Each term's sum of squares at `x`, without its weight.
    pub fn sums_of_squares(&mut self, terms: &[Weighted], x: &[f64]) -> Vec<f64> {
        let mut sums = Vec::with_capacity(terms.len());
        for Weighted { term, .. } in terms {
            let mut sum = 0.0;
            for b in 0..term.blocks() {
                let (rows, columns) = (term.rows(b), term.unknowns(b).len());
                let residuals = &mut self.residuals[..rows];
                let jacobian = &mut self.jacobian[..rows * columns];
                jacobian.fill(0.0);
                term.evaluate(b, x, residuals, jacobian);
                sum += residuals.iter().map(|r| r * r).sum::<f64>();
            }
            sums.push(sum);
        }
        sums
    }
}
