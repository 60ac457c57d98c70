//! The cut layout: what the machine is told to cut, in order.

use kurbo::Point;

/// What a cut is for; also its layer in the machine file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CutKind {
    /// An open path between two pieces.
    Slit,
    /// The bar of a T at a slit's end that frees the ligament.
    Relief,
    /// A closed cut around a hole of the sheet.
    Window,
    /// The closed outer cut. Cut last.
    Border,
}

/// A vertex of a cut path and the shape of the segment that leaves it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathVertex {
    /// Position on the sheet, millimetres.
    pub point: Point,
    /// tan(sweep/4) of the arc to the next vertex, positive counter-clockwise, 0 for a straight line (the DXF
    /// convention). The last vertex of an open path has 0.
    pub bulge: f64,
}

/// One cut: the centre line of the kerf.
#[derive(Debug, Clone, PartialEq)]
pub struct CutPath {
    /// Purpose and layer.
    pub kind: CutKind,
    /// Vertices in cutting direction; at least two.
    pub vertices: Vec<PathVertex>,
    /// Whether a last segment leads from the last vertex back to the first.
    pub closed: bool,
}

/// A text that is drawn but not cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// Left end of the base line, millimetres.
    pub position: Point,
    /// Letter height, millimetres.
    pub height: f64,
    /// One line of text.
    pub text: String,
}

/// All cuts of one sheet, in the order in which they are to be cut. The kerf is already applied: paths are
/// centre lines of the burned groove.
#[derive(Debug, Clone, PartialEq)]
pub struct CutLayout {
    /// Stock size in x and y, millimetres; the lower left corner is the origin.
    pub sheet: [f64; 2],
    /// Width of the burned groove, millimetres.
    pub kerf: f64,
    /// Cuts in cutting order: inner before outer, border last.
    pub paths: Vec<CutPath>,
    /// Texts on the non-cut layer.
    pub notes: Vec<Note>,
}
