//! kirimorph turns a surface in space into a flat sheet with a cut pattern that morphs into that
//! surface, and makes the files that a workshop needs.
//!
//! The source is C. Jiang, F. Rist, H. Wang, J. Wallner, H. Pottmann, *Shape-morphing mechanical
//! metamaterials*, CAD 2022 ("the paper"); equation, figure and section numbers in these pages are its own.
//!
//! ```text
//! job file, mesh ──> TriMesh ──> flattening ──> ControlMesh ──> pieces and hinges ──> CutLayout ──> files
//!    job, geometry::read    geometry      kirigami (stages 1-3)      kirigami         fabrication   output
//! ```
//!
//! Frames: the *sheet* frame (millimetres, sheet mid-plane z = 0, x and y as on the machine's sheet) and the
//! *target* frame (the mesh's own coordinates times the scale to millimetres). Units: millimetres, radians and
//! `f64` everywhere inside; other units only at the rim, with a suffix in the key (`_deg`, `_mm_per_min`).
//!
//! Dependency rule: every module uses only those listed above it here, so no arrow goes back (a test checks it). `solver`
//! knows numbers only, `geometry` no kirigami, `kirigami` no machines; `output` writes what it is given and decides nothing;
//! `verify` reads machine files back and holds them against design and profile; `pipeline` is the contents page of the main
//! job, and `cli` alone opens output files and prints.

pub mod toml_source;

pub mod profile;

pub mod solver;

pub mod geometry;

pub mod remesh;

pub mod kirigami;

pub mod import;

pub mod fabrication;

pub mod solid;

pub mod snap;

pub mod morph;

pub mod milling;

pub mod machine;

pub mod output;

pub mod verify;

pub mod memory;

pub mod job;

pub mod pipeline;

pub mod cli;
