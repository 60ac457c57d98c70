//! Machine tools with up to five axes: their kinematics, and the programs that their controllers read.
//!
//! What goes in: a [`crate::milling::toolpath::Toolpath`]. What comes out: [`post`], words of a named
//! dialect, and from these, by [`read`], the same poses again.

pub mod profile;

pub mod kinematics;

mod error;

mod rotary;

mod plan;

mod program;

mod dialect;

mod reader;

#[cfg(test)]
mod examples;

pub use error::MachineError;
pub use kinematics::Angles;
pub use profile::{Machine, load, names, source};
pub use program::{Header, Program, Restart, Stats, post};
pub use reader::{Motion, ReadError, pose_at, read};
pub use rotary::AXIS_TOLERANCE;
