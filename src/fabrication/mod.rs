//! From pieces and hinges to cuts: ligaments, slits, relief cuts, border, true outlines. Knows cuts and tools,
//! not file formats.

pub mod layout;

pub mod mechanics;
