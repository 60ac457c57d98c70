//! From pieces and hinges to cuts: ligaments, slits, relief cuts, border, true outlines. Knows cuts and tools,
//! not file formats.

pub mod mechanics;

pub mod topology;

pub mod frame;

pub mod slit;

pub mod border;

pub mod cuts;

pub mod layout;

pub mod placement;

pub mod order;

pub mod web;

pub mod ligament;

pub mod outline;

pub mod collision;

pub mod hinge_table;

pub mod notes;

pub mod fabricate;

pub mod error;

#[cfg(test)]
mod test_sheet;

#[cfg(test)]
mod tests;
