//! Terms of single points, lengths and angles: fairness and the shapes of cells.

use super::{PointAt, indices};
use crate::solver::Term;

/// Soft linear conditions `sum of coefficients times points = 0`: fairness, Eqs. (6) and (9).
pub struct LinearTerm {
    name: &'static str,
    dimension: usize,
    blocks: Vec<(Vec<usize>, Vec<f64>)>,
}

impl LinearTerm {
    /// Each block holds points with their coefficients.
    pub fn new(name: &'static str, dimension: usize, blocks: &[Vec<(PointAt, f64)>]) -> Self {
        let blocks = blocks
            .iter()
            .map(|block| {
                let (points, coefficients): (Vec<PointAt>, Vec<f64>) = block.iter().copied().unzip();
                (indices(&points), coefficients)
            })
            .collect();
        Self { name, dimension, blocks }
    }
}

impl Term for LinearTerm {
    fn name(&self) -> &'static str {
        self.name
    }
    fn blocks(&self) -> usize {
        self.blocks.len()
    }
    fn rows(&self, _: usize) -> usize {
        self.dimension
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.blocks[b].0
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let (unknowns, coefficients) = &self.blocks[b];
        for row in 0..self.dimension {
            residuals[row] = 0.0;
            for (k, coefficient) in coefficients.iter().enumerate() {
                let column = k * self.dimension + row;
                residuals[row] += coefficient * x[unknowns[column]];
                jacobian[row * unknowns.len() + column] = *coefficient;
            }
        }
    }
}

/// Right angles: the product of two sides that meet in a point vanishes. One residual per angle.
///
/// Over the open hinges it keeps the pattern fully open, as the model cell is; over the corners of closed
/// pieces it keeps these near rectangles.
pub struct RightAngles {
    name: &'static str,
    angles: Vec<([PointAt; 3], Vec<usize>)>,
}

impl RightAngles {
    /// Each angle's apex with the far ends of its two sides; all points have the same dimension.
    pub fn new(name: &'static str, angles: impl IntoIterator<Item = [PointAt; 3]>) -> Self {
        Self { name, angles: angles.into_iter().map(|points| (points, indices(&points))).collect() }
    }
}

impl Term for RightAngles {
    fn name(&self) -> &'static str {
        self.name
    }
    fn blocks(&self) -> usize {
        self.angles.len()
    }
    fn rows(&self, _: usize) -> usize {
        1
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.angles[b].1
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let points = &self.angles[b].0;
        let [apex, p, q] = points.map(|point| point.read(x));
        let (u, v) = (p - apex, q - apex);
        residuals[0] = u.dot(&v);
        let dimension = points[0].dimension;
        for axis in 0..dimension {
            jacobian[axis] = -u[axis] - v[axis];
            jacobian[dimension + axis] = v[axis];
            jacobian[2 * dimension + axis] = u[axis];
        }
    }
}

/// Lengths: the squared distance of two points minus the squared model length. One residual per pair.
pub struct Lengths {
    name: &'static str,
    pairs: Vec<([PointAt; 2], Vec<usize>, f64)>,
}

impl Lengths {
    /// Pairs of points of the same dimension with their model lengths.
    pub fn new(name: &'static str, pairs: impl IntoIterator<Item = ([PointAt; 2], f64)>) -> Self {
        let pairs = pairs.into_iter().map(|(points, length)| (points, indices(&points), length)).collect();
        Self { name, pairs }
    }
}

impl Term for Lengths {
    fn name(&self) -> &'static str {
        self.name
    }
    fn blocks(&self) -> usize {
        self.pairs.len()
    }
    fn rows(&self, _: usize) -> usize {
        1
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.pairs[b].1
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let ([p, q], _, length) = &self.pairs[b];
        let along = q.read(x) - p.read(x);
        residuals[0] = along.norm_squared() - length * length;
        for axis in 0..p.dimension {
            jacobian[axis] = -2.0 * along[axis];
            jacobian[p.dimension + axis] = 2.0 * along[axis];
        }
    }
}
