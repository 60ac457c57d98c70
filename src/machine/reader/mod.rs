//! Programs read back: from words to poses, by a way of its own.
//!
//! The reader knows the words that our programs use, and what they mean to their controller; whatever else it
//! meets it refuses, with the line. It takes numbers as they stand: a program in inches, with another sign or
//! with a turn too many is read as the machine would run it, for others to judge.

mod controller;
mod heidenhain;
mod iso;
mod siemens;

use thiserror::Error;

use super::kinematics::Angles;
use super::profile::{Dialect, Machine};
use super::rotary::between;
use crate::geometry::Point3;
use crate::milling::toolpath::Pose;

/// A line that moves the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// The line, from 1.
    pub line: usize,
    /// Where the tool stood, part's frame.
    pub from: Pose,
    /// Where it comes to.
    pub pose: Pose,
    /// Angles of the rotary axes before and after, as commanded, whole turns counted; `None` for three axes
    /// and for programs of vectors.
    pub angles: Option<[Angles; 2]>,
    /// Joint positions of the tip before and after, machine coordinates: what is moved evenly where the tip
    /// is not held.
    pub joints: Option<[Point3; 2]>,
    /// Whether the machine goes as fast as it can.
    pub rapid: bool,
    /// Speed of the tip, mm/min, as asked for; where the tip stays that of the axes, rad/min. Zero at rapid.
    pub feed: f64,
    /// How long it takes as asked for, seconds; at rapid as long as the slowest joint.
    pub seconds: f64,
    /// Turns of the spindle a minute: zero when it stands, negative when it turns backwards.
    pub spindle: f64,
    /// Whether the controller holds the tip while the axes turn.
    pub tcp: bool,
}

/// A program that the reader does not take.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("line {line}, \"{text}\": {what}")]
pub struct ReadError {
    /// The line, from 1.
    pub line: usize,
    /// The line as it stands, shortened.
    pub text: String,
    /// What is wrong with it.
    pub what: String,
}

/// Every move of a program, in order, from where all coordinates are known.
///
/// # Errors
/// A word that the machine's dialect does not have or our programs do not use, a line that comes too early (a
/// move without feed or tool length, say), a program that does not end.
pub fn read(text: &str, machine: &Machine) -> Result<Vec<Motion>, ReadError> {
    match machine.dialect {
        Dialect::LinuxCnc | Dialect::FanucAngles | Dialect::FanucVectors | Dialect::Haas => {
            iso::read(text, machine)
        }
        Dialect::SiemensAngles | Dialect::SiemensVectors => siemens::read(text, machine),
        Dialect::HeidenhainTcpm | Dialect::HeidenhainM128 => heidenhain::read(text, machine),
    }
}

/// Where the tool stands at part `t` of a move, as the controller goes.
pub fn pose_at(motion: &Motion, machine: &Machine, t: f64) -> Pose {
    let tip = motion.from.tip + (motion.pose.tip - motion.from.tip) * t;
    match (motion.angles, motion.joints) {
        (Some([from, to]), Some(joints)) => {
            machine.pose(&(joints[0] + (joints[1] - joints[0]) * t), from.between(to, t))
        }
        (Some([from, to]), None) => Pose { tip, axis: machine.tool_axis(from.between(to, t)) },
        (None, _) => Pose { tip, axis: between(&motion.from.axis, &motion.pose.axis, t) },
    }
}

/// Runs `line` on every line of the text with its number, and refuses with the number and the text.
fn each_line(text: &str, mut line: impl FnMut(usize, &str) -> Result<(), String>) -> Result<(), ReadError> {
    for (index, content) in text.lines().enumerate() {
        line(index + 1, content).map_err(|what| error(index + 1, content, what))?;
    }
    Ok(())
}

fn error(line: usize, text: &str, what: String) -> ReadError {
    let text = text.chars().take(60).map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
    ReadError { line, text, what }
}

/// A number as controllers read it: digits with at most one point and a sign in front.
fn number(text: &str) -> Result<f64, String> {
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    let plain = digits.chars().all(|digit| digit.is_ascii_digit() || digit == '.')
        && digits.chars().any(|digit| digit.is_ascii_digit())
        && digits.matches('.').count() <= 1;
    let value = if plain { text.parse().ok().filter(|value: &f64| value.is_finite()) } else { None };
    value.ok_or_else(|| format!("\"{text}\" is not a number"))
}

#[cfg(test)]
mod tests;
