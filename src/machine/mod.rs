//! Machine tools with up to five axes: their kinematics, and the programs that their controllers read.
//!
//! What goes in: a [`crate::milling::toolpath::Toolpath`]. What comes out: words of a named dialect, and from these, read back
//! by a reader of our own, the same poses again.

pub mod profile;

pub mod kinematics;

pub use kinematics::Angles;
pub use profile::{Machine, load, names};
