//! All moves of a program, in its order, with angles, feeds and times: what is left is to write them down.
//!
//! Between runs the tool goes up along its own axis to the safe height, in a straight line above the next
//! start while the axes turn, and down along its axis. Turning moves are fed, never rapid: controllers that
//! hold the tip do not look after the speed of each joint at rapid. A program begins and ends above its first
//! and last run with both angles zero (the upper one at whole turns), where the tip's coordinates are the
//! same with tool centre point control and without.

use std::f64::consts::TAU;

use super::error::MachineError;
use super::kinematics::Angles;
use super::profile::Machine;
use super::rotary::Station;
use crate::geometry::Point3;
use crate::milling::toolpath::{Kind, Pose, Rate};

/// How far the tip may leave the straight line above the stock in joint coordinates, millimetres.
const LINK_TOLERANCE: f64 = 0.5;

/// Where a tool stands and by which angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stand {
    pub tip: Point3,
    pub angles: Angles,
}

/// One block of a program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Move {
    /// Where it ends.
    pub to: Stand,
    /// Whether the machine goes as fast as it can.
    pub rapid: bool,
    /// Speed of the tip, mm/min; zero where it stays.
    pub feed: f64,
    /// How long it takes without acceleration.
    pub seconds: f64,
    /// Whether the path asked for it: else it is the way from cut to cut.
    pub cutting: bool,
}

/// Writes moves one after the other.
pub(super) struct Planner<'a> {
    machine: &'a Machine,
    at: Stand,
    run: usize,
    moves: Vec<Move>,
}

/// The moves of one run after its start, with the number of retreats.
pub(super) fn run_moves(
    machine: &Machine,
    index: usize,
    stations: &[Station],
) -> Result<(Vec<Move>, usize), MachineError> {
    let start = Stand { tip: stations[0].pose.tip, angles: stations[0].arrive };
    let mut planner = Planner { machine, at: start, run: index + 1, moves: Vec::new() };
    let mut retreats = 0;
    for (i, station) in stations.iter().enumerate() {
        if i > 0 {
            let angles = station.arrive;
            let rapid = station.rate == Rate::Rapid && angles == planner.at.angles;
            let asked = if let Rate::Feed(given) = station.rate { given } else { machine.rapid };
            planner.cut(Stand { tip: station.pose.tip, angles }, rapid, asked)?;
        }
        if station.retreat {
            retreats += 1;
            // As the run goes down to its first cut.
            let slow = first_feed(stations).unwrap_or(machine.rapid);
            planner.retreat(&station.pose, station.leave, slow)?;
        }
    }
    Ok((planner.moves, retreats))
}

fn first_feed(stations: &[Station]) -> Option<f64> {
    stations.iter().find_map(|station| match (station.rate, station.kind) {
        (Rate::Feed(feed), kind) if kind != Kind::Retract => Some(feed),
        _ => None,
    })
}

/// The way from stand to stand above the stock.
pub(super) fn link(machine: &Machine, run: usize, from: Stand, to: Stand) -> Result<Vec<Move>, MachineError> {
    let mut planner = Planner { machine, at: from, run: run + 1, moves: Vec::new() };
    planner.above(to)?;
    Ok(planner.moves)
}

/// Where a program takes over, or lets go of, the tool: at the safe height above a stand, the angles zero.
pub(super) fn home_above(machine: &Machine, stand: &Stand) -> Stand {
    let raised = raised(machine, stand, machine.setup.safe_height);
    // Whole turns as they are: they are unwound once the tool is away.
    let turn = if machine.rotary.is_some() { (stand.angles.turn / TAU).round() * TAU } else { 0.0 };
    Stand { tip: raised.tip, angles: Angles { tilt: 0.0, turn } }
}

/// The stand lifted along its axis until the tip is `height` above the stock; unchanged where it is higher
/// already.
fn raised(machine: &Machine, stand: &Stand, height: f64) -> Stand {
    let axis = machine.tool_axis(stand.angles);
    let by = ((height - stand.tip.z) / axis.z).max(0.0);
    Stand { tip: Pose { tip: stand.tip, axis }.lifted(by).tip, ..*stand }
}

impl Planner<'_> {
    /// A block of the path.
    fn cut(&mut self, to: Stand, rapid: bool, feed: f64) -> Result<(), MachineError> {
        let length = (to.tip - self.at.tip).norm();
        let least = self.least_minutes(&to, self.machine.rotary.as_ref().map_or(1.0, |axes| axes.cutting));
        let minutes = if rapid { least } else { least.max(length / feed) };
        // The feed as it was asked for, unless an axis is too slow for it.
        let kept = length / feed >= least;
        let feed = if kept { feed } else { length / minutes };
        self.push(to, rapid, feed, minutes, true)
    }

    /// Up along the axis, turn, and back to the same pose.
    fn retreat(&mut self, pose: &Pose, leave: Angles, feed: f64) -> Result<(), MachineError> {
        let out = raised(self.machine, &self.at, self.machine.setup.clearance);
        let minutes = (out.tip - self.at.tip).norm() / feed;
        if out != self.at {
            self.push(out, false, feed, minutes, true)?;
        }
        let back = Stand { tip: pose.tip, angles: leave };
        let near = raised(self.machine, &back, self.machine.setup.clearance);
        self.above(near)?;
        let minutes = (back.tip - near.tip).norm() / feed;
        self.push(back, false, feed, minutes, true)
    }

    /// To a stand, by the safe height.
    fn above(&mut self, to: Stand) -> Result<(), MachineError> {
        let height = self.machine.setup.safe_height;
        let up = raised(self.machine, &self.at, height);
        let over = raised(self.machine, &to, height);
        self.rapid(up)?;
        if over.angles == self.at.angles {
            self.rapid(over)?;
        } else {
            let from = self.at;
            let parts = if self.machine.tcp { 1 } else { self.parts(&over) };
            for part in 1..=parts {
                let t = part as f64 / parts as f64;
                let tip = from.tip + (over.tip - from.tip) * t;
                let to = if part == parts {
                    over
                } else {
                    Stand { tip, angles: from.angles.between(over.angles, t) }
                };
                let minutes =
                    self.least_minutes(&to, self.machine.rotary.as_ref().map_or(1.0, |axes| axes.rapid));
                let feed = (to.tip - self.at.tip).norm() / minutes;
                self.push(to, false, feed, minutes, false)?;
            }
        }
        self.rapid(to)
    }

    /// Into how many blocks of joint coordinates a way above the stock is divided.
    fn parts(&self, to: &Stand) -> usize {
        let (from, machine) = (&self.at, self.machine);
        let stand = |t: f64| Stand {
            tip: from.tip + (to.tip - from.tip) * t,
            angles: from.angles.between(to.angles, t),
        };
        let strays = |parts: usize| {
            (0..parts).any(|part| {
                let [a, b] = [part, part + 1].map(|end| stand(end as f64 / parts as f64));
                let [ja, jb] = [a, b].map(|end| machine.joints(&end.tip, end.angles));
                let middle = a.angles.between(b.angles, 0.5);
                let tip = machine.pose(&nalgebra::center(&ja, &jb), middle).tip;
                (tip - nalgebra::center(&a.tip, &b.tip)).norm() > LINK_TOLERANCE
            })
        };
        let mut parts = 1;
        while parts < 4096 && strays(parts) {
            parts *= 2;
        }
        parts
    }

    fn rapid(&mut self, to: Stand) -> Result<(), MachineError> {
        if to == self.at {
            return Ok(());
        }
        let minutes = self.least_minutes(&to, 1.0);
        self.push(to, true, self.machine.rapid, minutes, false)
    }

    /// What the slowest axis needs; `turning` in rad/min.
    fn least_minutes(&self, to: &Stand, turning: f64) -> f64 {
        let (from, machine) = (&self.at, self.machine);
        let [mut before, mut slowest] = [machine.joints(&from.tip, from.angles), Point3::origin()];
        let pieces = if from.angles == to.angles { 1 } else { 8 };
        for piece in 1..=pieces {
            let t = f64::from(piece) / f64::from(pieces);
            let tip = from.tip + (to.tip - from.tip) * t;
            let joints = machine.joints(&tip, from.angles.between(to.angles, t));
            slowest += (joints - before).abs();
            before = joints;
        }
        let turn = (to.angles.tilt - from.angles.tilt).abs().max((to.angles.turn - from.angles.turn).abs());
        (slowest.coords.max() / machine.rapid).max(turn / turning)
    }

    /// Appends a move whose joints stay within their travel.
    fn push(
        &mut self,
        to: Stand,
        rapid: bool,
        feed: f64,
        minutes: f64,
        cutting: bool,
    ) -> Result<(), MachineError> {
        let pieces = if self.at.angles == to.angles { 1 } else { 8 };
        for piece in 1..=pieces {
            let t = f64::from(piece) / f64::from(pieces);
            let tip = self.at.tip + (to.tip - self.at.tip) * t;
            let at = Stand { tip, angles: self.at.angles.between(to.angles, t) };
            check_travel(self.machine, self.run, &at, f64::INFINITY)?;
        }
        self.moves.push(Move { to, rapid, feed, seconds: 60.0 * minutes, cutting });
        self.at = to;
        Ok(())
    }
}

/// Whether the joints stay within their travel, the spindle's face not above `top`.
pub(super) fn check_travel(machine: &Machine, run: usize, at: &Stand, top: f64) -> Result<(), MachineError> {
    let mut joints = machine.joints(&at.tip, at.angles);
    joints.z += machine.setup.tool_length;
    for (axis, &[least, largest]) in machine.travel.iter().enumerate() {
        let range = [least, if axis == 2 { largest.min(top) } else { largest }];
        if !(range[0]..=range[1]).contains(&joints[axis]) {
            let (value, axis) = (joints[axis], ['X', 'Y', 'Z'][axis]);
            return Err(MachineError::Travel { run, tip: at.tip, axis, value, range });
        }
    }
    Ok(())
}
