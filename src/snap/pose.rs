//! Rigid motions of pieces as unknowns of the solver: a shift and a rotation vector, against the closed state.
//!
//! Derivatives are wrenches: a scalar's derivative by a shift is a force, by a small turn in the fixed frame a moment.

use nalgebra::Matrix3;

use crate::geometry::{Point3, Vector3};

/// Where each piece has its unknowns. In the plane a piece has three of them (two shifts, one turn), in space six.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// The middle of each piece's vertices in the closed state, millimetres: it turns about this point.
    pub centres: Vec<Point3>,
    /// Whether all stays in the plane.
    pub planar: bool,
    /// Millimetres per unit of a shift: shifts and turns are then of the same size.
    pub unit: f64,
}

/// Which of the six motions are unknowns in the plane: shifts along x and y, the turn about z.
const PLANAR: [usize; 3] = [0, 1, 5];
const SPATIAL: [usize; 6] = [0, 1, 2, 3, 4, 5];

impl Layout {
    /// The motions that are unknowns.
    fn motions(&self) -> &'static [usize] {
        if self.planar { &PLANAR } else { &SPATIAL }
    }

    /// Number of unknowns per piece.
    pub fn per_piece(&self) -> usize {
        self.motions().len()
    }

    /// The unknowns of a piece.
    pub fn unknowns(&self, piece: usize) -> std::ops::Range<usize> {
        let n = self.per_piece();
        piece * n..(piece + 1) * n
    }

    /// One place in the plane for each unknown.
    pub fn places(&self) -> Vec<[f64; 2]> {
        let n = self.per_piece();
        self.centres.iter().flat_map(|centre| std::iter::repeat_n([centre.x, centre.y], n)).collect()
    }

    /// The pose of a piece.
    pub fn pose(&self, x: &[f64], piece: usize) -> Pose {
        let mut motion = [0.0; 6];
        for (&to, &value) in self.motions().iter().zip(&x[self.unknowns(piece)]) {
            motion[to] = value;
        }
        let [sx, sy, sz, wx, wy, wz] = motion;
        let w = Vector3::new(wx, wy, wz);
        let (rotation, jacobian) = exponential(&w);
        let centre = self.centres[piece] + Vector3::new(sx, sy, sz) * self.unit;
        Pose { centre, rotation, jacobian }
    }

    /// Writes the unknowns of a piece that has moved by this rotation vector, its centre to `centre`.
    pub fn set(&self, x: &mut [f64], piece: usize, centre: &Point3, w: &Vector3) {
        let shift = (centre - self.centres[piece]) / self.unit;
        let motion = [shift.x, shift.y, shift.z, w.x, w.y, w.z];
        for (&from, value) in self.motions().iter().zip(&mut x[self.unknowns(piece)]) {
            *value = motion[from];
        }
    }

    /// Writes a wrench on a piece as derivatives by its unknowns.
    pub fn slopes(&self, pose: &Pose, wrench: &Wrench, row: &mut [f64]) {
        let force = wrench.force * self.unit;
        let moment = pose.jacobian.transpose() * wrench.moment;
        let all = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
        for (&from, to) in self.motions().iter().zip(row) {
            *to = all[from];
        }
    }
}

/// Where a piece stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Its middle.
    pub centre: Point3,
    /// Its rotation since the closed state.
    pub rotation: Matrix3<f64>,
    /// Small turn in the fixed frame per change of the rotation vector.
    jacobian: Matrix3<f64>,
}

/// Derivative of a scalar by the motion of a piece.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// By its shift.
    pub force: Vector3,
    /// By a small turn about its middle.
    pub moment: Vector3,
}

impl Wrench {
    /// Adds the derivative by a vector of the piece that turns with it: `turned` is the vector, `slope` the derivative.
    pub fn turn(&mut self, turned: &Vector3, slope: &Vector3) {
        self.moment += turned.cross(slope);
    }

    /// Adds the derivative by a point of the piece at `arm` from its middle.
    pub fn push(&mut self, arm: &Vector3, slope: &Vector3) {
        self.force += slope;
        self.turn(arm, slope);
    }
}

/// Below this angle the series to second order is exact to rounding.
const SMALL: f64 = 1e-4;

/// The rotation of a rotation vector, and its left Jacobian: the turn in the fixed frame per change of the vector.
fn exponential(w: &Vector3) -> (Matrix3<f64>, Matrix3<f64>) {
    let angle = w.norm();
    let cross = w.cross_matrix();
    let (a, b, c) = if angle < SMALL {
        let square = angle * angle;
        (1.0 - square / 6.0, 0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0)
    } else {
        let (sin, cos) = angle.sin_cos();
        (sin / angle, (1.0 - cos) / angle.powi(2), (angle - sin) / angle.powi(3))
    };
    let square = cross * cross;
    (Matrix3::identity() + cross * a + square * b, Matrix3::identity() + cross * b + square * c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_jacobian_is_the_turn_of_the_rotation() {
        for w in [Vector3::new(0.3, -0.7, 1.1), Vector3::new(2e-5, 3e-5, -1e-5), Vector3::zeros()] {
            let (rotation, jacobian) = exponential(&w);
            let exact = nalgebra::Rotation3::new(w);
            assert!((rotation - exact.matrix()).norm() < 1e-14);
            for axis in 0..3 {
                let mut step = Vector3::zeros();
                step[axis] = 1e-6;
                let (ahead, behind) = (exponential(&(w + step)).0, exponential(&(w - step)).0);
                let turn = (ahead - behind) * rotation.transpose() / 2e-6;
                let expected: Vector3 = jacobian.column(axis).into();
                assert!((turn - expected.cross_matrix()).norm() < 1e-9, "{w}");
            }
        }
    }
}
