//! The term that pulls points of pieces to the guides of the open state.

use super::PointAt;
use crate::geometry::{Point3, Vector3};
use crate::kirigami::guides::GuideAim;
use crate::solver::Term;
use nalgebra::Matrix3;

/// Keeps weighted means of three points in space near an aim: three residuals each, the way to the nearest point of the
/// aim. Along a curve they may glide.
pub struct Guided<'a> {
    points: Vec<([PointAt; 3], [f64; 3])>,
    unknowns: Vec<usize>,
    aim: &'a GuideAim,
    /// Millimetres per unit of length of the unknowns.
    scale: f64,
    /// The nearest points, and what takes the part along the curve away.
    feet: Vec<(Vector3, Matrix3<f64>)>,
}

impl<'a> Guided<'a> {
    /// Points in space with their weights, of sum 1.
    pub fn new(
        points: impl IntoIterator<Item = ([PointAt; 3], [f64; 3])>,
        aim: &'a GuideAim,
        scale: f64,
    ) -> Self {
        let points: Vec<_> = points.into_iter().collect();
        let unknowns = points.iter().flat_map(|(points, _)| super::indices(points)).collect();
        let feet = vec![(Vector3::zeros(), Matrix3::zeros()); points.len()];
        Self { points, unknowns, aim, scale, feet }
    }
}

/// The mean of three points.
fn read((points, weights): &([PointAt; 3], [f64; 3]), x: &[f64]) -> Vector3 {
    points.iter().zip(weights).map(|(point, weight)| point.read(x) * *weight).sum()
}

impl Term for Guided<'_> {
    fn name(&self) -> &'static str {
        "guide"
    }
    fn blocks(&self) -> usize {
        self.points.len()
    }
    fn rows(&self, _: usize) -> usize {
        3
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.unknowns[9 * b..9 * b + 9]
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let (foot, across) = &self.feet[b];
        let away = across * (read(&self.points[b], x) - foot);
        residuals.copy_from_slice(away.as_slice());
        for (row, line) in jacobian.chunks_exact_mut(9).enumerate() {
            for (vertex, weight) in self.points[b].1.iter().enumerate() {
                for axis in 0..3 {
                    line[3 * vertex + axis] = weight * across[(row, axis)];
                }
            }
        }
    }
    fn refresh(&mut self, x: &[f64]) {
        for (point, foot) in self.points.iter().zip(&mut self.feet) {
            let found = self.aim.nearest(&Point3::from(read(point, x) * self.scale));
            let along = found.along.unwrap_or_default();
            *foot = (found.point.coords / self.scale, Matrix3::identity() - along * along.transpose());
        }
    }
}
