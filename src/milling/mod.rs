//! From ruled walls to the path of a cylindrical tool.
//!
//! What goes in: the outlines and rulings of [`crate::solid`]. What comes out: [`toolpath::Toolpath`], poses of the tool in the
//! program's frame, which know nothing of the machine that takes them on.

pub mod toolpath;
