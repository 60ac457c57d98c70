//! A weak pull of unknowns towards given values.

use crate::solver::Term;

/// The difference of each unknown from a given value.
pub struct Pull {
    name: &'static str,
    indices: Vec<usize>,
    values: Vec<f64>,
}

impl Pull {
    /// Towards one value per unknown.
    pub fn new(name: &'static str, values: &[f64]) -> Self {
        Self { name, indices: (0..values.len()).collect(), values: values.to_vec() }
    }
}

impl Term for Pull {
    fn name(&self) -> &'static str {
        self.name
    }
    fn blocks(&self) -> usize {
        self.values.len()
    }
    fn rows(&self, _: usize) -> usize {
        1
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.indices[b..=b]
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        residuals[0] = x[b] - self.values[b];
        jacobian[0] = 1.0;
    }
}
