//! From the tool's axes to angles of the rotary axes.
//!
//! Every axis is reached by two pairs of angles, and by whole turns of the upper one beyond these. [`solve`]
//! picks, for all runs at once, the pairs with the least rotary time. Between two poses of a cut the
//! controller turns the *angles* evenly, the path its axis: blocks are halved until the two differ by at most
//! [`AXIS_TOLERANCE`] over the stock's thickness.
//!
//! At the pole (tool upright on a table with C) the upper angle means nothing. What happens there:
//! - a tool that tilts by less than `upright_below_deg` (and by less than the tolerance over the thickness)
//!   is set upright, and C held;
//! - a path straight through the pole goes on with the other sign of the tilt, C held: one of the two pairs;
//! - what C must turn by before the path leaves the upright is turned there, where it moves nothing, evenly
//!   along the upright stretch, up to `max_swing_deg`;
//! - beyond that, and where limits would be run over, the tool retreats along its axis, turns above the
//!   stock and comes back to the same pose: as far from bends of its path as the run allows, since slits bend
//!   at their ends, at the ligaments, and never closer to one than the tool's diameter;
//! - where an upright stretch lies in a bend altogether C turns along it all the same, in blocks of at most
//!   `max_swing_deg`, the feed as slow as that takes: better than a mark at a ligament. Where limits leave no
//!   such way either, the job is refused.
//! - Near the pole, but not at it, C turns fast; blocks are halved until none turns an axis by more than
//!   `max_swing_deg`, and feed drops to what the axis does.

mod bends;
mod chain;
mod knots;
mod refine;
mod spread;

use nalgebra::{Unit, Vector3};

use super::error::MachineError;
use super::kinematics::Angles;
use super::profile::{Machine, Rotary};
use crate::milling::toolpath::{Kind, Pose, Rate, Toolpath};

/// How far the tool's axis may leave the path's between two poses, millimetres over the stock's thickness.
pub const AXIS_TOLERANCE: f64 = 0.005;

/// How far the tip may leave its straight line between two poses of a cut in joint coordinates, millimetres.
const TIP_TOLERANCE: f64 = 0.002;

/// A pose that the program names, and how the tool comes to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Station {
    /// Where; upright where it is set upright.
    pub pose: Pose,
    /// How fast.
    pub rate: Rate,
    /// What for.
    pub kind: Kind,
    /// Angles on arrival.
    pub arrive: Angles,
    /// Angles on departure: the same but for a retreat.
    pub leave: Angles,
    /// Whether the tool retreats here, turns above the stock and comes back.
    pub retreat: bool,
}

/// What the solution is measured by.
struct Measure<'a> {
    machine: &'a Machine,
    rotary: &'a Rotary,
    /// Length over which the axis counts.
    length: f64,
    /// Tilt below which the tool is set upright.
    upright: f64,
    /// Diameter of the tool.
    diameter: f64,
}

/// The stations of every run, the start first, with angles.
///
/// # Errors
/// An axis that points sideways or down, a feed that is none, a tilt that three axes do not have, no way
/// within the limits.
pub(super) fn solve(toolpath: &Toolpath, machine: &Machine) -> Result<Vec<Vec<Station>>, MachineError> {
    check(toolpath)?;
    let length = toolpath.thickness + 2.0 * toolpath.radius;
    let Some(rotary) = &machine.rotary else { return straight(toolpath, length) };
    let measure = Measure {
        machine,
        rotary,
        length,
        upright: rotary.upright.min(AXIS_TOLERANCE / length),
        diameter: 2.0 * toolpath.radius,
    };
    let mut runs = refine::refine(toolpath, &measure);
    chain::choose(&mut runs, &measure)?;
    Ok(runs.iter().map(|stations| spread::spread(stations, &measure)).collect())
}

fn check(toolpath: &Toolpath) -> Result<(), MachineError> {
    for (index, run) in toolpath.runs.iter().enumerate() {
        let poses = std::iter::once(run.start).chain(run.blocks.iter().map(|block| block.to));
        for (block, pose) in poses.enumerate() {
            let fault = |what| MachineError::Path { run: index + 1, block, what };
            if !pose.tip.coords.iter().chain(pose.axis.iter()).all(|value| value.is_finite()) {
                return Err(fault("a coordinate is not a finite number"));
            }
            // Beyond 60 degrees the tool lies in the sheet rather than cutting it.
            if pose.axis.z < 0.5 {
                return Err(fault("the tool's axis does not point up from the stock"));
            }
        }
        for (block, rate) in run.blocks.iter().enumerate().map(|(block, at)| (block + 1, at.rate)) {
            if matches!(rate, Rate::Feed(feed) if !(feed.is_finite() && feed > 0.0)) {
                return Err(MachineError::Path { run: index + 1, block, what: "the feed is not above zero" });
            }
        }
    }
    Ok(())
}

/// Stations for three axes: the path's own poses, all of them upright.
fn straight(toolpath: &Toolpath, length: f64) -> Result<Vec<Vec<Station>>, MachineError> {
    let mut runs = Vec::with_capacity(toolpath.runs.len());
    for (index, run) in toolpath.runs.iter().enumerate() {
        let poses = std::iter::once((run.start, Rate::Rapid, Kind::Approach));
        let poses = poses.chain(run.blocks.iter().map(|block| (block.to, block.rate, block.kind)));
        let mut stations = Vec::with_capacity(run.blocks.len() + 1);
        for (block, (pose, rate, kind)) in poses.enumerate() {
            let tilt = pose.axis.x.hypot(pose.axis.y).atan2(pose.axis.z);
            if tilt * length > AXIS_TOLERANCE {
                let degrees = tilt.to_degrees();
                return Err(MachineError::Tilted { run: index + 1, block, tip: pose.tip, degrees });
            }
            let pose = Pose { axis: Vector3::z_axis(), ..pose };
            let angles = Angles::default();
            stations.push(Station { pose, rate, kind, arrive: angles, leave: angles, retreat: false });
        }
        runs.push(stations);
    }
    Ok(runs)
}

impl Measure<'_> {
    /// The axis in the table's frame.
    fn on_table(&self, pose: &Pose) -> Vector3<f64> {
        self.machine.setup.fixture * pose.axis.as_ref()
    }

    fn is_upright(&self, pose: &Pose) -> bool {
        self.rotary.is_upright(&self.on_table(pose), self.upright)
    }

    /// Largest error between two poses whose angles are turned evenly: of the axis over the length and, in
    /// joint coordinates, of the tip, both as parts of what is allowed.
    fn error(&self, poses: [&Pose; 2], angles: [Angles; 2]) -> f64 {
        let [from, to] = poses;
        let joints = [0, 1].map(|end| self.machine.joints(&poses[end].tip, angles[end]));
        let mut worst: f64 = 0.0;
        for t in [0.25, 0.5, 0.75] {
            let at = angles[0].between(angles[1], t);
            let axis = self.machine.tool_axis(at);
            let wanted = between(&from.axis, &to.axis, t);
            worst = worst.max((axis.as_ref() - wanted.as_ref()).norm() * self.length / AXIS_TOLERANCE);
            if !self.machine.tcp {
                let tip = self.machine.pose(&(joints[0] + (joints[1] - joints[0]) * t), at).tip;
                let wanted = from.tip + (to.tip - from.tip) * t;
                worst = worst.max((tip - wanted).norm() / TIP_TOLERANCE);
            }
        }
        worst
    }

    /// For each pair of branches at both ends the change of the turn (the nearest) if a block may be cut so.
    fn ways(&self, poses: [&Pose; 2], branches: [[Angles; 2]; 2]) -> [[Option<f64>; 2]; 2] {
        [0, 1].map(|before| {
            [0, 1].map(|after| {
                let (from, to) = (branches[0][before], branches[1][after]);
                let change = nearest(to.turn - from.turn);
                let end = Angles { turn: from.turn + change, ..to };
                let swing = change.abs().max((to.tilt - from.tilt).abs());
                let fits = swing <= self.rotary.max_swing && self.error(poses, [from, end]) <= 1.0;
                fits.then_some(change)
            })
        })
    }
}

/// The axis at part `t` of an even turn between two.
pub(super) fn between(from: &Unit<Vector3<f64>>, to: &Unit<Vector3<f64>>, t: f64) -> Unit<Vector3<f64>> {
    let angle = from.cross(to).norm().atan2(from.dot(to));
    // Below this sines and angles are the same number.
    if angle < 1e-7 {
        return Unit::new_normalize(from.lerp(to, t));
    }
    let [a, b] = [((1.0 - t) * angle).sin(), (t * angle).sin()];
    Unit::new_normalize(from.as_ref() * a + to.as_ref() * b)
}

/// The same angle within half a turn of zero.
fn nearest(angle: f64) -> f64 {
    angle - (angle / std::f64::consts::TAU).round() * std::f64::consts::TAU
}

#[cfg(test)]
mod tests;
