//! The pattern: control meshes, pieces and hinges. Knows sheets and pieces, not machines.

pub mod design;
