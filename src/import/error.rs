//! Why a design of another program is not taken over.

use std::path::PathBuf;

use crate::geometry::read::ReadMeshError;

/// A fault of the input. Pieces and their corners count from 0, as in `design.json`; faces of meshes and lines of
/// files from 1.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // The messages name what the fields hold.
pub enum ImportError {
    #[error(transparent)]
    Mesh(#[from] ReadMeshError),
    #[error("{} has {closed} faces and {open_path} has {open}: both files must hold the same faces in the same order", closed_path.display(), open_path = open_path.display())]
    FaceCount { closed_path: PathBuf, open_path: PathBuf, closed: usize, open: usize },
    #[error("face {face} has {closed} corners in {} and {open} in {open_path}: both files must hold the same faces in the same order", closed_path.display(), open_path = open_path.display())]
    CornerCount { closed_path: PathBuf, open_path: PathBuf, face: usize, closed: usize, open: usize },
    #[error("{}: {what}", path.display())]
    File { path: PathBuf, what: String },
    #[error("{}, line {line}: {what}", path.display())]
    Line { path: PathBuf, line: usize, what: String },
    #[error(
        "{source_name}: corner {} of piece {} and corner {} of piece {} are {distance:.3e} mm apart in the {state} \
         state, more than the tolerance of {tolerance:.3e} mm: a hinge's two corners must coincide in both states; \
         check the constraint (pieces and corners count from 0), or raise --tolerance-mm",
        corners[0], pieces[0], corners[1], pieces[1]
    )]
    ConstraintApart {
        source_name: String,
        pieces: [usize; 2],
        corners: [usize; 2],
        state: &'static str,
        distance: f64,
        tolerance: f64,
    },
    #[error("{what} is {value}: {rule}")]
    Option { what: &'static str, value: f64, rule: &'static str },
    #[error("the design has no extent: all its points are one")]
    NoExtent,
    #[error(
        "a coordinate is {value:e} mm after scaling, beyond the limit of {limit:e} mm: check --units, --size-mm and \
         --scale"
    )]
    TooLarge { value: f64, limit: f64 },
    #[error(
        "no corner of one piece coincides with a corner of another in both states, to within {tolerance:.3e} mm: there \
         are no hinges; check that both files hold the same pieces, or raise --tolerance-mm"
    )]
    NoHinges { tolerance: f64 },
    #[error(
        "the pieces are not connected: they form {parts} parts, the smallest of which is {smallest}; import each part \
         by itself, or raise --tolerance-mm (now {tolerance:.3e}) if hinges were missed"
    )]
    NotConnected { parts: usize, smallest: String, tolerance: f64 },
    #[error(
        "{}: turned over in one of the two states, as a mirror image would be; no motion of a rigid sheet does that: \
         correct the order of the corners or the coordinates of that state",
        named(.pieces)
    )]
    Mirrored { pieces: Vec<usize> },
    #[error("piece {piece} has no area in the {state} state: remove it in both states")]
    NoArea { piece: usize, state: &'static str },
    #[error(
        "the design is not rigid: piece {piece} differs between the two states by {strain:.2e} mean edges (the largest \
         distance that the best rigid motion leaves), more than --max-strain {limit:.1e}; in all {beyond} pieces do; \
         allow more and let --improve make it rigid"
    )]
    NotRigid { piece: usize, strain: f64, limit: f64, beyond: usize },
}

impl ImportError {
    /// Whether the input is faulty (exit status 1), rather than sound but not makeable (2).
    pub fn is_bad_input(&self) -> bool {
        !matches!(self, Self::NotRigid { .. } | Self::Mirrored { .. })
    }
}

/// Pieces in words: all of a few, the first of many.
pub(super) fn named(indices: &[usize]) -> String {
    const NAMED: usize = 8;
    let named: Vec<String> = indices.iter().take(NAMED).map(usize::to_string).collect();
    match indices.len() {
        1 => format!("piece {}", named[0]),
        n if n <= NAMED => format!("pieces {}", named.join(", ")),
        n => format!("pieces {} and {} more", named.join(", "), n - NAMED),
    }
}
