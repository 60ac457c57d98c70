//! From ruled walls to the path of a cylindrical tool, and back: what that path leaves of the sheet.
//!
//! What goes in: the centre lines of [`crate::solid::strokes`] with the tool's axis at every point. [`walk`] goes once around
//! every opening, [`track`] measures these walks, [`path`] makes passes of them. What comes out: [`toolpath::Toolpath`], poses
//! of the tool in the program's frame, which know nothing of the machine that takes them on.

pub mod error;

pub mod toolpath;

pub mod walk;

pub mod track;

pub mod order;

pub mod path;

pub mod sweep;

#[cfg(test)]
mod tests;
