//! Terms that hold points to the target and its boundary.

use super::{PointAt, indices};
use crate::geometry::{Point3, Vector3};
use crate::kirigami::control_mesh::Target;
use crate::solver::Term;

/// Closeness to the target, c_prox: the distance to the tangent plane at the nearest point.
pub struct Proximity<'a> {
    points: Vec<PointAt>,
    unknowns: Vec<usize>,
    target: &'a Target,
    /// Millimetres per unit of length of the unknowns.
    scale: f64,
    feet: Vec<(Vector3, f64)>,
}

impl<'a> Proximity<'a> {
    /// Over points in space.
    pub fn new(points: Vec<PointAt>, target: &'a Target, scale: f64) -> Self {
        let feet = vec![(Vector3::zeros(), 0.0); points.len()];
        Self { unknowns: indices(&points), points, target, scale, feet }
    }
}

impl Term for Proximity<'_> {
    fn name(&self) -> &'static str {
        "prox"
    }
    fn blocks(&self) -> usize {
        self.points.len()
    }
    fn rows(&self, _: usize) -> usize {
        1
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.unknowns[3 * b..3 * b + 3]
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let (normal, offset) = &self.feet[b];
        residuals[0] = self.points[b].read(x).dot(normal) - offset;
        jacobian.copy_from_slice(normal.as_slice());
    }
    fn refresh(&mut self, x: &[f64]) {
        for (point, foot) in self.points.iter().zip(&mut self.feet) {
            let found = self.target.surface.closest(&Point3::from(point.read(x) * self.scale));
            *foot = (found.normal, found.point.coords.dot(&found.normal) / self.scale);
        }
    }
}

/// What a border point of the pattern is held to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hold {
    /// The target's boundary; the point may glide along it.
    Boundary,
    /// A plane given by a point (millimetres) and a unit normal.
    Plane(Point3, Vector3),
}

/// Keeps the pattern's border on the target's boundary, or where it was in Stage 1, measured outwards along
/// the surface.
pub struct Boundary<'a> {
    points: Vec<(PointAt, Hold)>,
    unknowns: Vec<usize>,
    target: &'a Target,
    /// Millimetres per unit of length of the unknowns.
    scale: f64,
    feet: Vec<(Vector3, f64)>,
}

impl<'a> Boundary<'a> {
    /// Over points in space with what they are held to.
    pub fn new(points: Vec<(PointAt, Hold)>, target: &'a Target, scale: f64) -> Self {
        let unknowns = points.iter().flat_map(|(p, _)| p.indices()).collect();
        let feet = vec![(Vector3::zeros(), 0.0); points.len()];
        Self { points, unknowns, target, scale, feet }
    }
}

impl Term for Boundary<'_> {
    fn name(&self) -> &'static str {
        "boundary"
    }
    fn blocks(&self) -> usize {
        self.points.len()
    }
    fn rows(&self, _: usize) -> usize {
        1
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.unknowns[3 * b..3 * b + 3]
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let (normal, offset) = &self.feet[b];
        residuals[0] = self.points[b].0.read(x).dot(normal) - offset;
        jacobian.copy_from_slice(normal.as_slice());
    }
    fn refresh(&mut self, x: &[f64]) {
        for ((point, hold), foot) in self.points.iter().zip(&mut self.feet) {
            let (at, normal) = match hold {
                Hold::Plane(at, normal) => (*at, *normal),
                Hold::Boundary => {
                    let found = self.target.boundary.closest(&Point3::from(point.read(x) * self.scale));
                    (found.point, found.conormal)
                }
            };
            *foot = (normal, at.coords.dot(&normal) / self.scale);
        }
    }
}
