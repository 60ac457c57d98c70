//! A controller's memory while it runs a program, and the moves that come of it.

use nalgebra::{Unit, Vector3};

use super::Motion;
use crate::geometry::Point3;
use crate::machine::kinematics::Angles;
use crate::machine::profile::Machine;
use crate::milling::toolpath::Pose;

/// A tip that moves by less stays, and the feed is that of the rotary axes, millimetres: LinuxCNC's own
/// limit.
const STILL: f64 = 1e-7;

/// What one line asks for.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Target {
    /// Program coordinates.
    pub xyz: [Option<f64>; 3],
    /// Degrees of the axis that tilts and of the one it carries.
    pub turns: [Option<f64>; 2],
    /// The tool's axis on the table.
    pub vector: Option<Vector3<f64>>,
    /// Machine coordinates, without the tool's length.
    pub machine: bool,
}

/// What a feed means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FeedMode {
    PerMinute,
    InverseTime,
}

pub(super) struct Controller<'a> {
    pub machine: &'a Machine,
    /// The program's coordinates of the tip: on the table where the tip is held, else of the joints, from the
    /// work offset; millimetres.
    place: [Option<f64>; 3],
    angles: [Option<f64>; 2],
    vector: Option<Vector3<f64>>,
    /// Millimetres to a unit of the program.
    pub unit: f64,
    pub tcp: bool,
    /// Whether the tool's length counts.
    pub length: bool,
    pub rapid: Option<bool>,
    pub feed: Option<f64>,
    pub feed_mode: FeedMode,
    pub speed: f64,
    /// 1 forwards, -1 backwards, 0 stands.
    pub spinning: f64,
    pub ended: bool,
    pub motions: Vec<Motion>,
}

impl<'a> Controller<'a> {
    pub fn new(machine: &'a Machine) -> Self {
        let turns = if machine.rotary.is_some() { [None; 2] } else { [Some(0.0); 2] };
        Self {
            machine,
            place: [None; 3],
            angles: turns,
            vector: None,
            unit: 1.0,
            tcp: false,
            length: false,
            rapid: None,
            feed: None,
            feed_mode: FeedMode::PerMinute,
            speed: 0.0,
            spinning: 0.0,
            ended: false,
            motions: Vec::new(),
        }
    }

    /// The two axes' letters; none for three axes.
    pub fn letters(&self) -> [Option<char>; 2] {
        self.machine.rotary.as_ref().map_or([None; 2], |rotary| rotary.table.letters().map(Some))
    }

    /// Takes the tip over, or lets it go: the same place in other coordinates.
    pub fn hold_tip(&mut self, on: bool) -> Result<(), String> {
        if on == self.tcp {
            return Ok(());
        }
        if !self.machine.tcp {
            return Err("the machine has no tool centre point control".into());
        }
        if on && !self.length {
            return Err("tool centre point control before the tool's length".into());
        }
        // What the program does not know it does not need: the next line says all coordinates, or refuses.
        let known = self.stand();
        self.tcp = on;
        let zero = self.machine.setup.zero;
        self.place = match known {
            Some((pose, _)) if on => (self.machine.setup.fixture * pose.tip.coords).data.0[0].map(Some),
            Some((pose, Some(angles))) => (self.machine.joints(&pose.tip, angles) - zero).data.0[0].map(Some),
            _ => [None; 3],
        };
        if on && self.machine.dialect.writes_vectors() {
            self.vector = self.known_angles().map(|angles| self.table_axis(angles));
            self.angles = [None; 2];
        }
        if !on {
            self.vector = None;
        }
        Ok(())
    }

    fn known_angles(&self) -> Option<Angles> {
        let [tilt, turn] = self.angles;
        Some(Angles { tilt: tilt?.to_radians(), turn: turn?.to_radians() })
    }

    fn table_axis(&self, angles: Angles) -> Vector3<f64> {
        self.machine.setup.fixture * self.machine.tool_axis(angles).into_inner()
    }

    /// Where the tool stands, as far as the program has said.
    fn stand(&self) -> Option<(Pose, Option<Angles>)> {
        let [x, y, z] = self.place;
        let place = Vector3::new(x?, y?, z?);
        let setup = &self.machine.setup;
        if self.tcp {
            let tip = Point3::from(setup.fixture.inverse() * place);
            if let Some(vector) = self.vector {
                let axis = Unit::new_normalize(setup.fixture.inverse() * vector);
                return Some((Pose { tip, axis }, None));
            }
            let angles = self.known_angles()?;
            return Some((Pose { tip, axis: self.machine.tool_axis(angles) }, Some(angles)));
        }
        let angles = self.known_angles()?;
        Some((self.machine.pose(&(setup.zero + place), angles), Some(angles)))
    }

    /// Goes where a line says.
    pub fn go(&mut self, line: usize, target: Target) -> Result<(), String> {
        let rapid = self.rapid.ok_or("a move before G0 or G1")?;
        let before = self.stand();
        let joints = self.joints();
        self.set(target)?;
        if target.machine && !rapid {
            return Err("machine coordinates at feed".into());
        }
        let (Some((from, angles_from)), Some((pose, angles_to))) = (before, self.stand()) else {
            return Ok(());
        };
        let has_axes = self.machine.rotary.is_some();
        let angles = angles_from.zip(angles_to).filter(|_| has_axes).map(|(from, to)| [from, to]);
        let joints = joints.zip(self.joints()).filter(|_| has_axes && !self.tcp).map(|(from, to)| [from, to]);
        let mut motion = Motion {
            line,
            from,
            pose,
            angles,
            joints,
            rapid,
            feed: 0.0,
            seconds: 0.0,
            spindle: self.spinning * self.speed,
            tcp: self.tcp,
        };
        self.time(&mut motion)?;
        self.motions.push(motion);
        Ok(())
    }

    fn joints(&self) -> Option<Point3> {
        let [x, y, z] = self.place;
        Some(self.machine.setup.zero + Vector3::new(x?, y?, z?))
    }

    fn set(&mut self, target: Target) -> Result<(), String> {
        let setup = &self.machine.setup;
        for (axis, value) in target.xyz.iter().enumerate() {
            let Some(value) = value else { continue };
            if target.machine {
                if self.tcp {
                    return Err("machine coordinates while the tip is held".into());
                }
                let length = if axis == 2 { setup.tool_length } else { 0.0 };
                self.place[axis] = Some(value * self.unit - length - setup.zero[axis]);
            } else if axis == 2 && !self.length {
                return Err("Z without the tool's length".into());
            } else {
                self.place[axis] = Some(value * self.unit);
            }
        }
        for (angle, value) in self.angles.iter_mut().zip(target.turns) {
            *angle = value.or(*angle);
        }
        if let Some(vector) = target.vector {
            if vector.norm() < 1e-6 {
                return Err("the tool's vector has no direction".into());
            }
            self.vector = Some(vector);
        }
        Ok(())
    }

    /// Feed and time of a motion.
    fn time(&self, motion: &mut Motion) -> Result<(), String> {
        let length = (motion.pose.tip - motion.from.tip).norm();
        let [tilt, turn] =
            motion.angles.map_or([0.0; 2], |[from, to]| [to.tilt - from.tilt, to.turn - from.turn]);
        if motion.rapid {
            let turning = self.machine.rotary.as_ref().map_or(1.0, |rotary| rotary.rapid);
            let moved = motion.joints.map_or(length, |[from, to]| (to - from).amax());
            motion.seconds = 60.0 * (moved / self.machine.rapid).max(tilt.abs().max(turn.abs()) / turning);
            return Ok(());
        }
        let feed = self.feed.filter(|&feed| feed > 0.0).ok_or("a cut without feed")?;
        let turned = tilt.hypot(turn);
        let minutes = match self.feed_mode {
            FeedMode::InverseTime => 1.0 / feed,
            FeedMode::PerMinute if length > STILL => length / (feed * self.unit),
            FeedMode::PerMinute => turned.to_degrees() / feed,
        };
        motion.seconds = 60.0 * minutes;
        if minutes > 0.0 {
            motion.feed = if length > STILL { length / minutes } else { turned / minutes };
        }
        Ok(())
    }

    /// What an M word does that all dialects share; false where it is not one of these.
    pub fn auxiliary(&mut self, code: u32) -> bool {
        match code {
            3 => self.spinning = 1.0,
            4 => self.spinning = -1.0,
            5 => self.spinning = 0.0,
            6..=9 => {}
            2 | 30 => self.ended = true,
            _ => return false,
        }
        true
    }
}
