//! Two rotary axes under the part: from angles to the tool's axis and place, and back.
//!
//! Frames: the *table's* turns with the part; with both angles zero it is the machine's, shifted to the
//! program's zero. The *part's* is the path's own, z = 0 on top of the stock; a wedge turns it against the
//! table's. Joint positions are those of the tip in machine coordinates: the spindle's face stands the tool's
//! length above.
//!
//! With the tool's angles seen from the part (sign +1, ISO), R = R_turn(turn) R_tilt(tilt) takes directions
//! of the machine to those of the table: the tool's axis is R z. For sign -1 the table turns by the angles:
//! both change sign. Places: p - turn centre = R_turn (R_tilt (m - tilt centre) + tilt centre - turn centre),
//! which is LinuxCNC's `trtfuncs.c` for xyzac-trt and xyzbc-trt (sign -1) and `xyzab_tdr_kins.comp` (sign
//! +1).

use std::f64::consts::PI;

use nalgebra::{Rotation3, Unit, Vector3};

use super::profile::{Machine, Rotary, Table};
use crate::geometry::Point3;
use crate::milling::toolpath::Pose;

/// Angles of the axis that tilts and of the one on top of it, radians, as commanded.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Angles {
    /// Of the axis that is fixed to the machine's bed: A or B.
    pub tilt: f64,
    /// Of the axis that it carries: C, or A on a table of B and A. Counts whole turns.
    pub turn: f64,
}

impl Angles {
    /// The angles at part `t` of an even turn from `self` to `to`.
    pub fn between(self, to: Self, t: f64) -> Self {
        Self { tilt: self.tilt + (to.tilt - self.tilt) * t, turn: self.turn + (to.turn - self.turn) * t }
    }
}

impl Rotary {
    /// From the machine's directions to the table's.
    pub fn rotation(&self, angles: Angles) -> Rotation3<f64> {
        self.turning(angles.turn) * self.tilting(angles.tilt)
    }

    fn tilting(&self, angle: f64) -> Rotation3<f64> {
        let axis = if self.table == Table::TiltAC { Vector3::x_axis() } else { Vector3::y_axis() };
        Rotation3::from_axis_angle(&axis, self.sign * angle)
    }

    fn turning(&self, angle: f64) -> Rotation3<f64> {
        let axis = if self.table == Table::TiltBA { Vector3::x_axis() } else { Vector3::z_axis() };
        Rotation3::from_axis_angle(&axis, self.sign * angle)
    }

    /// The tool's axis in the table's frame.
    pub fn axis(&self, angles: Angles) -> Vector3<f64> {
        self.rotation(angles) * Vector3::z()
    }

    /// The two pairs of angles that point the tool along `axis` (table's frame), the turn in (-π, π] each.
    ///
    /// Where the axis lies on the pole (upright on tables with C) the turn is free and comes out as one value
    /// of many.
    pub fn branches(&self, axis: &Vector3<f64>) -> [Angles; 2] {
        let [i, j, k] = [axis.x, axis.y, axis.z];
        let (tilt, turn) = match self.table {
            Table::TiltAC => (i.hypot(j).atan2(k), i.atan2(-j)),
            Table::TiltBC => (i.hypot(j).atan2(k), j.atan2(i)),
            Table::TiltBA => (i.atan2(j.hypot(k)), (-j).atan2(k)),
        };
        let other = match self.table {
            Table::TiltAC | Table::TiltBC => -tilt,
            // From 90 to 270 degrees, without a seam where tools stand upright.
            Table::TiltBA => PI - tilt,
        };
        let opposite = if turn > 0.0 { turn - PI } else { turn + PI };
        [
            Angles { tilt: self.sign * tilt, turn: self.sign * turn },
            Angles { tilt: self.sign * other, turn: self.sign * opposite },
        ]
    }

    /// Whether a tool along `axis` (table's frame) stands within `tilt` of the pole: never on a table of B
    /// and A.
    pub fn is_upright(&self, axis: &Vector3<f64>, tilt: f64) -> bool {
        self.table != Table::TiltBA && axis.x.hypot(axis.y) <= tilt.sin() && axis.z > 0.0
    }

    fn to_table(&self, joints: &Point3, angles: Angles) -> Point3 {
        let carried = self.tilting(angles.tilt) * (joints - self.tilt_centre);
        self.turn_centre + self.turning(angles.turn) * (carried + (self.tilt_centre - self.turn_centre))
    }

    fn to_joints(&self, place: &Point3, angles: Angles) -> Point3 {
        let carried = self.turning(angles.turn).inverse() * (place - self.turn_centre);
        self.tilt_centre
            + self.tilting(angles.tilt).inverse() * (carried - (self.tilt_centre - self.turn_centre))
    }
}

impl Machine {
    /// The tip's joint position for a tip at `tip` (part's frame) and the angles.
    pub fn joints(&self, tip: &Point3, angles: Angles) -> Point3 {
        let place = self.setup.zero + self.setup.fixture * tip.coords;
        self.rotary.as_ref().map_or(place, |rotary| rotary.to_joints(&place, angles))
    }

    /// Where the tool stands on the part for the tip's joint position and the angles.
    pub fn pose(&self, joints: &Point3, angles: Angles) -> Pose {
        let place = self.rotary.as_ref().map_or(*joints, |rotary| rotary.to_table(joints, angles));
        let tip = Point3::from(self.setup.fixture.inverse() * (place - self.setup.zero));
        Pose { tip, axis: self.tool_axis(angles) }
    }

    /// The tool's axis in the part's frame.
    pub fn tool_axis(&self, angles: Angles) -> Unit<Vector3<f64>> {
        let axis = self.rotary.as_ref().map_or(Vector3::z(), |rotary| rotary.axis(angles));
        Unit::new_normalize(self.setup.fixture.inverse() * axis)
    }
}

#[cfg(test)]
mod tests;
