//! Numbers only: least squares and sparse factorisations. No geometry word appears here.
//!
//! A problem is a list of [`Term`]s. Each term is a family of small residual blocks over few unknowns; the
//! sum of weighted squares is minimised by the Levenberg-Marquardt method on the normal equations, whose
//! sparsity pattern is analysed once.

pub mod cholesky;

pub mod dense;

pub mod derivative_check;

pub mod dissection;

pub mod fronts;

pub mod levenberg_marquardt;

pub mod multifrontal;

pub mod normal_equations;

pub mod journal;

#[cfg(test)]
mod examples;

pub use journal::{Journal, Run};
pub use levenberg_marquardt::{Iteration, Options, Precision, Report, Step, System, Termination, Watch};

/// A family of residual blocks of the same meaning.
///
/// Block `b` has [`Term::rows`] residuals that depend on [`Term::unknowns`] only.
pub trait Term: Sync {
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
    /// Factor of the squares, >= 0. A term of weight 0 is not evaluated.
    pub weight: f64,
    /// How much of the term's curvature the steps see.
    pub coupling: Coupling,
}

/// How much of a term's curvature the steps see. The gradient is always complete.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coupling {
    /// All of it: `J^T J`.
    Full,
    /// An upper bound that couples only unknowns of the same place: the blocks of `J^T J` on the diagonal, times
    /// the number of places (a + b + .. is squared at most as many times a^2 + b^2 + ..). It adds nothing to the
    /// sparsity pattern; errors that vary from place to place vanish in a few steps, even ones in many.
    ByPlace,
}
