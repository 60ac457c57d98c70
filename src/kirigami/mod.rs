//! The pattern: from a flattened target to rigid pieces and hinges. Knows sheets and pieces, not machines.
//!
//! ```text
//! Flattening ──cover──> Cover (grid over the flattening) ──start──> ControlMesh (Stage 1)
//!   ──stage2──> ControlMesh of the right dimensions ──stage3──> pieces congruent in both states
//!   ──hinges──> Design ──quality, validity──> measured, or refused
//! ```

pub mod levels;

pub mod pattern;

pub mod pattern_terms;

pub mod piece_mesh;

pub mod pattern_mesh;

pub mod cover;

pub mod corners;

pub mod control_mesh;

pub mod terms;

pub mod phases;

pub mod stage2;

pub mod stage3;

pub mod rotating;

pub mod design;

pub mod hinges;

pub mod feasibility;

pub mod quality;

pub mod rigidity;

pub mod repeated;

pub mod improve;

pub mod validity;

pub mod mirror;

pub mod filled;

pub mod guides;

pub mod bistable;
