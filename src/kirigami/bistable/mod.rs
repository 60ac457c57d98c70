//! Bistable sheets (section 2.2, Figs. 5, 6, 17, 18): rectangles and 8-gons that snap between two states.
//!
//! ```text
//! BistableCell, grid ──mesh──> BistableMesh ──fit──> BistablePattern ──stage 3──> Design
//! ```
//!
//! "Closed" is the unexpanded state, "open" the expanded one.

pub mod cell;

pub mod mesh;

pub mod pattern;

pub mod fit;

pub mod reach;

pub mod grid;

pub mod optimise;

pub mod family;
