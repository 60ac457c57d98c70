//! From pieces and hinges to cuts: ligaments, slits, windows, border, true outlines. Knows cuts and tools, not file
//! formats. A sheet that is flat in its closed state is laid out by [`closed_sheet`], one that is flat in its open
//! state by [`open_sheet`]; the rest is common to both.

pub mod mechanics;

pub mod gaps;

pub mod notch;

pub mod topology;

pub mod states;

pub mod closed_sheet;

pub mod open_sheet;

pub mod cuts;

pub mod layout;

pub mod order;

pub mod plan;

pub mod placement;

pub mod web;

pub mod ligament;

pub mod outline;

pub mod regions;

pub mod collision;

pub mod hinge_table;

pub mod notes;

pub mod fabricate;

pub mod product;

pub mod coupon;

pub mod error;

#[cfg(test)]
pub(crate) mod test_sheet;

#[cfg(test)]
mod tests;
