//! The term that keeps pieces from becoming slivers.

use super::{PointAt, indices};
use crate::geometry::Vector3;
use crate::solver::Term;

/// Least widths: at every corner of a closed piece, the height of the corner's triangle over its longer side is at
/// least a given one. One residual per corner, zero where that holds: pieces that are wide enough do not feel it.
///
/// Over all corners of a quad these heights are its width: the least distance of a vertex from a side that does not
/// touch it. In the plane a corner that is turned over has a negative height; in space heights have no sign.
pub struct LeastWidths {
    corners: Vec<([PointAt; 3], Vec<usize>)>,
    least: f64,
}

impl LeastWidths {
    /// Each corner with its next and its previous neighbour, counter-clockwise in the plane; `least` in mean edges. All points have
    /// the same dimension.
    pub fn new(corners: impl IntoIterator<Item = [PointAt; 3]>, least: f64) -> Self {
        Self { corners: corners.into_iter().map(|points| (points, indices(&points))).collect(), least }
    }
}

impl Term for LeastWidths {
    fn name(&self) -> &'static str {
        "widths"
    }
    fn blocks(&self) -> usize {
        self.corners.len()
    }
    fn rows(&self, _: usize) -> usize {
        1
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.corners[b].1
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let [apex, next, previous] = self.corners[b].0.map(|point| point.read(x));
        let (u, v) = (next - apex, previous - apex);
        let cross = u.cross(&v);
        // The direction in which areas count as positive.
        let up = if self.corners[b].0[0].dimension == 2 {
            Vector3::z()
        } else {
            cross.try_normalize(0.0).unwrap_or_default()
        };
        let area = cross.dot(&up);
        let along_u = u.norm_squared() > v.norm_squared();
        let length = if along_u { u.norm() } else { v.norm() }.max(f64::MIN_POSITIVE);
        let height = area / length;
        // Also where the height is not a number: that must not look like success.
        if height >= self.least {
            residuals[0] = 0.0;
            return;
        }
        residuals[0] = self.least - height;
        // d area = (v x up) . du + (up x u) . dv, and the length changes along the longer side.
        let mut du = v.cross(&up) / length;
        let mut dv = up.cross(&u) / length;
        if along_u {
            du -= u * (height / (length * length));
        } else {
            dv -= v * (height / (length * length));
        }
        let dimension = self.corners[b].0[0].dimension;
        for axis in 0..dimension {
            jacobian[axis] = du[axis] + dv[axis];
            jacobian[dimension + axis] = -du[axis];
            jacobian[2 * dimension + axis] = -dv[axis];
        }
    }
}
