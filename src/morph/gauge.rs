//! Where the sheet as a whole stands on its way.
//!
//! Hinges say nothing of that. Each position is laid on the closed state, as well as all its points allow, and then taken
//! along evenly: its middle on a straight line, its turn about one axis.

use crate::geometry::rotation::{RigidMotion, axis_angle};
use crate::geometry::{Point3, centroid};
use nalgebra::{Rotation3, Unit};

/// The way of the sheet as a whole from the closed to the open state.
pub struct Gauge {
    closed: Vec<Point3>,
    middles: [Point3; 2],
    /// From the closed state, laid on it, to the open one.
    whole: RigidMotion,
}

impl Gauge {
    /// Of all points of the pieces in both states.
    pub fn new(closed: Vec<Point3>, open: &[Point3]) -> Self {
        let whole = RigidMotion::fit(open, &closed).inverse();
        Self { middles: [centroid(&closed), centroid(open)], closed, whole }
    }

    /// The motion of the whole that brings these points, those of the pieces at `at` of the way, to their place.
    pub fn place(&self, points: &[Point3], at: f64) -> RigidMotion {
        let lay = RigidMotion::fit(points, &self.closed);
        let (axis, angle) = axis_angle(&self.whole.rotation);
        let turn = axis.map_or_else(Rotation3::identity, |axis| {
            Rotation3::from_axis_angle(&Unit::new_unchecked(axis), at * angle)
        });
        let [from, to] = self.middles;
        let middle = from + at * (to - from);
        let along = RigidMotion { rotation: *turn.matrix(), translation: middle.coords - turn * from.coords };
        along.after(&lay)
    }
}
