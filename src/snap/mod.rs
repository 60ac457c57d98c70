//! Snap mechanics: the energy of a sheet on its way between its two states. A stage after fabrication.
//!
//! Between the two states of a bistable sheet rigid pieces on ideal pins have no way that is free of strain. What gives is
//! the ligament at each hinge ([`ligament`]: it bends, stretches and shears) and, lumped into it, the pieces. [`cell`] is
//! one cell of the regular pattern, [`yielding`] the same with ligaments that yield, [`sheet`] any design, in the plane or
//! in space. The model, its figures and its limits are told in `docs/snap.md`.
//!
//! ```text
//! Profile, hinge rows ──ligament──> Ligament ──sheet (joint, drive)──> SheetSnap ─┐
//!                     rectangles ──cell, yielding──────────────────> CellSnap ──assess──> Snap
//! ```
//!
//! Energies are millijoules: newtons times millimetres.

pub mod ligament;

pub mod cell;

pub mod yielding;

pub mod pose;

pub mod joint;

pub mod sheet;

pub mod assess;
