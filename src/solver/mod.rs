//! Numbers only: least squares and sparse factorisations. No geometry word appears here.
//!
//! A problem is a list of [`Term`]s. Each term is a family of small residual blocks over few unknowns; the
//! sum of weighted squares is minimised by the Levenberg-Marquardt method on the normal equations, whose
//! sparsity pattern is analysed once.

pub mod cholesky;

pub mod derivative_check;

pub mod levenberg_marquardt;

pub mod normal_equations;

pub mod journal;

pub use journal::{Journal, Run};
pub use levenberg_marquardt::{Iteration, Options, Report, Step, Termination, Watch, go_on, minimize};

/// A family of residual blocks of the same meaning.
///
/// Block `b` has [`Term::rows`] residuals that depend on [`Term::unknowns`] only.
pub trait Term {
    /// Name for reports.
    fn name(&self) -> &'static str;
    /// Number of blocks.
    fn blocks(&self) -> usize;
    /// Number of residuals of block `b`.
    fn rows(&self, b: usize) -> usize;
    /// Indices of the unknowns of block `b`, all different.
    fn unknowns(&self, b: usize) -> &[usize];
    /// Writes the residuals of block `b` (#rows) and their Jacobian (#rows by #unknowns, row after row) at
    /// the point `x`. `jacobian` arrives zeroed.
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]);
    /// Updates what the term holds constant while a step is computed (closest points, directions). Called at
    /// the start and after every accepted step.
    fn refresh(&mut self, _x: &[f64]) {}
}

/// A term with its weight: it contributes `weight * (sum of squared residuals)`.
pub struct Weighted<'a> {
    /// The term.
    pub term: Box<dyn Term + 'a>,
    /// Factor of the squares, >= 0.
    pub weight: f64,
}
