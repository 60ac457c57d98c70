//! What the readers make of a file: cuts in order, the design's hash, and what cannot stand in a cut file.

use kurbo::Point;

use super::cut_name;
use super::fault::{Check, Fault};
use crate::fabrication::layout::{CutKind, CutPath};

/// A machine file as it was read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MachineFile {
    /// Its name in the folder.
    pub name: &'static str,
    /// The cuts in cutting order, millimetres, y up.
    pub paths: Vec<CutPath>,
    /// What is engraved: open paths of straight segments.
    pub engraved: Vec<Vec<Point>>,
    /// The hash of the design that it names.
    pub hash: Option<String>,
    /// What does not belong into a cut file.
    pub faults: Vec<Fault>,
}

/// A file that cannot be read as what its name says.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{file}{}: {reason}; make the files again", line.map(|line| format!(", line {line}")).unwrap_or_default())]
pub struct ReadError {
    /// Its name.
    pub file: &'static str,
    /// Where, from 1.
    pub line: Option<usize>,
    /// Why not.
    pub reason: String,
}

/// How a comment with a design's hash begins.
const HASH_COMMENT: &str = "design.json ";

/// The comment by which a machine file names its design.
pub fn hash_comment(hash: &str) -> String {
    format!("{HASH_COMMENT}{hash}")
}

impl MachineFile {
    pub(super) fn new(name: &'static str) -> Self {
        Self { name, paths: Vec::new(), engraved: Vec::new(), hash: None, faults: Vec::new() }
    }

    /// What is wrong with a cut, by its number in cutting order.
    pub(super) fn cut_fault(
        &self,
        check: Check,
        index: usize,
        at: impl Into<Option<Point>>,
        says: impl Into<String>,
    ) -> Fault {
        Fault::new(check, self.name, cut_name(&self.paths, index), at, says)
    }

    /// Takes note of a comment.
    pub(super) fn comment(&mut self, text: &str) {
        if let Some(hash) = text.trim().strip_prefix(HASH_COMMENT) {
            self.hash.get_or_insert_with(|| hash.to_owned());
        }
    }

    pub(super) fn fault(
        &mut self,
        check: Check,
        what: impl Into<String>,
        at: impl Into<Option<Point>>,
        says: impl Into<String>,
    ) {
        self.faults.push(Fault::new(check, self.name, what, at, says));
    }

    /// The fault of a file that was made from another design.
    pub(super) fn hash_fault(&self, hash: &str) -> Option<Fault> {
        let says = match &self.hash {
            Some(found) if found == hash => return None,
            Some(found) => format!("was made from a design with the hash {found}; design.json has {hash}"),
            None => format!("names no design; it should have the comment \"{}\"", hash_comment(hash)),
        };
        Some(Fault::new(Check::Design, self.name, "the head", None, says))
    }
}

/// The layers that are cut, as the contract with the workshop names them: DXF layer, colour in the SVG.
const LAYERS: [(CutKind, &str, &str); 5] = [
    (CutKind::Slit, "SLIT", "#ff0000"),
    (CutKind::Relief, "RELIEF", "#0000ff"),
    (CutKind::Window, "WINDOW", "#00ff00"),
    (CutKind::Border, "BORDER", "#ff00ff"),
    (CutKind::Lead, "LEAD", "#00ffff"),
];

/// The layer of texts.
pub(super) const NOTE: &str = "NOTE";

/// The layer of what is engraved.
pub(super) const ENGRAVE: &str = "ENGRAVE";

/// The kind of cut on a layer of this name.
pub(super) fn kind_of(layer: &str) -> Option<CutKind> {
    LAYERS.iter().find(|(_, name, _)| *name == layer).map(|(kind, ..)| *kind)
}

/// The layer's name.
pub(super) fn layer_name(kind: CutKind) -> &'static str {
    LAYERS.iter().find(|(other, ..)| *other == kind).map_or("?", |(_, name, _)| name)
}

/// The layer's colour in the SVG, by which laser programs sort cuts.
pub(super) fn colour_of(kind: CutKind) -> &'static str {
    LAYERS.iter().find(|(other, ..)| *other == kind).map_or("?", |(.., colour)| colour)
}
