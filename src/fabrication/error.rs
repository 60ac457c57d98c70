//! What can go wrong between a design and its cut layout: each message names the place, the value, the limit
//! and the remedy. Positions are in sheet millimetres.

use thiserror::Error;

use super::mechanics::LengthError;
use crate::kirigami::cover::OTHER_UNITS;

/// Why no cut layout was made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FabricationError {
    /// A pattern between two curved surfaces cannot be cut from flat stock.
    #[error(
        "neither state of the design is flat (its sheet_state is null), so there is no flat cut file: its pieces, hinges \
         and report stand in design.json; for a laser give the job a flat `closed` or `open` target"
    )]
    NoFlatState,
    /// Broken indices or list lengths, or a number that is not finite.
    #[error("piece {piece}: {reason}; the design is damaged, make it anew")]
    BadPiece {
        /// The piece.
        piece: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A hinge whose indices do not fit the pieces.
    #[error("hinge {hinge}: {reason}; the design is damaged, make it anew")]
    BadHinge {
        /// The hinge.
        hinge: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// No ligament of the profile suits a hinge's angle.
    #[error("hinge {hinge} at ({x:.2}, {y:.2}) mm: {source}")]
    Length {
        /// The hinge.
        hinge: usize,
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
        /// What it would need.
        source: LengthError,
    },
    /// `lengths` does not fit the design or the tool.
    #[error("ligament length of hinge {hinge}: {value} mm, but it must be finite and more than {limit} mm")]
    BadLength {
        /// The hinge.
        hinge: usize,
        /// The length that was given.
        value: f64,
        /// Lower limit: the kerf.
        limit: f64,
    },
    /// One length per hinge is needed.
    #[error("{found} ligament lengths were given for {expected} hinges: give one per hinge")]
    LengthCount {
        /// Lengths given.
        found: usize,
        /// Hinges of the design.
        expected: usize,
    },
    /// An edge between two pieces that has not exactly one hinge.
    #[error(
        "the edge between pieces {pieces:?} at corners {corners:?} carries {found} hinges, but it needs exactly \
         one: check the pattern's hinge list"
    )]
    EdgeHinges {
        /// The neighbours.
        pieces: [usize; 2],
        /// The edge's end corners.
        corners: [usize; 2],
        /// Hinges found on it.
        found: usize,
    },
    /// The corner's neighbourhood is not one that this layout can cut.
    #[error("corner {corner} at ({x:.2}, {y:.2}) mm: {reason}")]
    Corner {
        /// The corner.
        corner: usize,
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
        /// What is wrong, and the remedy.
        reason: String,
    },
    /// A side too short to hold a ligament.
    #[error(
        "the side between corners {corners:?} at ({x:.2}, {y:.2}) mm is {length:.3} mm long, but ligaments need \
         more than {limit:.3} mm: take larger pieces or trim the pattern otherwise"
    )]
    ShortEdge {
        /// The side's end corners.
        corners: [usize; 2],
        /// Its midpoint.
        x: f64,
        /// Its midpoint.
        y: f64,
        /// Its length.
        length: f64,
        /// Lower limit: a ligament and kerf at either end.
        limit: f64,
    },
    /// A side of a piece of an open sheet without room for the ligaments at its ends.
    #[error(
        "a side of piece {piece} at ({x:.2}, {y:.2}) mm is {length:.3} mm long, but the ligaments at its ends need \
         {needed:.3} mm of it: take larger pieces, shorter ligaments or hinges that turn further"
    )]
    ShortSide {
        /// The piece.
        piece: usize,
        /// The side's midpoint.
        x: f64,
        /// The side's midpoint.
        y: f64,
        /// The side's length.
        length: f64,
        /// What the cuts around the ligaments and a kerf between them take.
        needed: f64,
    },
    /// A window that leaves no ligament of the asked form.
    #[error("hinge {hinge} at ({x:.2}, {y:.2}) mm: {reason}")]
    WindowCorner {
        /// The hinge.
        hinge: usize,
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
        /// What is wrong, and the remedy.
        reason: &'static str,
    },
    /// A window that is narrower than the groove that cuts it, or whose outline crosses itself.
    #[error(
        "the {kind} is only {width:.3} mm wide at ({x:.2}, {y:.2}) mm, less than the kerf of {kerf} mm: let the hinges \
         open further, or take larger pieces"
    )]
    NarrowWindow {
        /// "window" or "notch in the border".
        kind: &'static str,
        /// Midway between the two sides.
        x: f64,
        /// Midway between the two sides.
        y: f64,
        /// Width of the opening; 0 where it crosses itself.
        width: f64,
        /// The kerf.
        kerf: f64,
    },
    /// Folded ligaments of an open sheet have no room in the closed state.
    #[error(
        "corner {corner}, the window at ({x:.2}, {y:.2}) mm: closed, hinges {hinges:?} stand {found:.3} mm apart, but \
         their folded ligaments need {needed:.3} mm: optimise the design with a gap (gap_mm) of at least that"
    )]
    NarrowGap {
        /// The corner.
        corner: usize,
        /// Middle of its window.
        x: f64,
        /// Middle of its window.
        y: f64,
        /// The two hinges.
        hinges: [usize; 2],
        /// Distance of the hinge points in the closed state.
        found: f64,
        /// The gap that is needed.
        needed: f64,
    },
    /// A folded ligament of an open sheet meets a piece or another ligament in the closed state.
    #[error(
        "closed, the folded ligament of hinge {hinge} at ({x:.2}, {y:.2}) mm overlaps {other} by {area:.4} mm²: optimise \
         the design with a larger gap (gap_mm), at least {needed:.3} mm"
    )]
    FoldedLigament {
        /// The hinge.
        hinge: usize,
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
        /// What it meets.
        other: String,
        /// Overlap area.
        area: f64,
        /// The gap that a flat closed corner needs.
        needed: f64,
    },
    /// The sheet consists of several parts.
    #[error(
        "the pieces form {count} separate parts, but one sheet must be connected: trim the pattern to one part"
    )]
    SeveralParts {
        /// Number of outer border loops.
        count: usize,
    },
    /// The part does not fit on the stock.
    #[error(
        "the part measures {width:.2} x {height:.2} mm, but the sheet leaves {room_x:.2} x {room_y:.2} mm \
         between its margins: scale the target by at most {scale:.4}, turn it, or take a larger sheet{}",
        if *scale < 0.05 { OTHER_UNITS } else { "" }
    )]
    TooLarge {
        /// The part's size in x, with its kerf.
        width: f64,
        /// The part's size in y, with its kerf.
        height: f64,
        /// Stock size in x less both margins.
        room_x: f64,
        /// Stock size in y less both margins.
        room_y: f64,
        /// The largest scale at which the part fits.
        scale: f64,
    },
    /// Two cuts come too close.
    #[error(
        "only {web:.3} mm of material would stand between a {first} and a {second} cut at ({x:.2}, {y:.2}) mm, \
         but the cut needs {limit:.3} mm: take larger pieces or shorter ligaments"
    )]
    Web {
        /// What one cut is.
        first: &'static str,
        /// What the other cut is.
        second: &'static str,
        /// Midway between the two cuts.
        x: f64,
        /// Midway between the two cuts.
        y: f64,
        /// Width of the material between the burned grooves; negative where they overlap.
        web: f64,
        /// The profile's least web.
        limit: f64,
    },
    /// A relief bar that no shortening frees from its neighbours.
    #[error(
        "hinge {hinge} at ({x:.2}, {y:.2}) mm: its relief bar, shortened to {length:.2} mm as far as its angle allows, leaves \
         only {web:.3} mm of material to the next cut, but the cut needs {limit:.3} mm: take larger pieces, a target that \
         opens less, or a narrower ligament"
    )]
    CrowdedHinge {
        /// The hinge.
        hinge: usize,
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
        /// Free length of its ligament.
        length: f64,
        /// Material between the bar's groove and the next one.
        web: f64,
        /// The profile's least web.
        limit: f64,
    },
    /// The burned sheet falls apart.
    #[error(
        "the cuts would free a scrap of {area:.4} mm² at ({x:.2}, {y:.2}) mm from the sheet: take larger pieces \
         or shorter ligaments there"
    )]
    FallsApart {
        /// Area of the part that comes free.
        area: f64,
        /// A point in it.
        x: f64,
        /// A point in it.
        y: f64,
    },
    /// Cutting the ligaments does not give one region per piece.
    #[error("piece {piece} at ({x:.2}, {y:.2}) mm {reason}: check the design around it")]
    PieceRegion {
        /// The piece.
        piece: usize,
        /// Its centroid.
        x: f64,
        /// Its centroid.
        y: f64,
        /// What became of it.
        reason: String,
    },
    /// Two pieces joined by a hinge overlap in the other state.
    #[error(
        "pieces {pieces:?} overlap by {area:.4} mm² when hinge {hinge} at ({x:.2}, {y:.2}) mm has turned by \
         {angle_deg:.1} degrees: {}", hinge_remedy(*.length, *.needed)
    )]
    HingeCollision {
        /// The pieces.
        pieces: [usize; 2],
        /// Their hinge.
        hinge: usize,
        /// The hinge's x.
        x: f64,
        /// The hinge's y.
        y: f64,
        /// Overlap area.
        area: f64,
        /// The hinge's angle in degrees.
        angle_deg: f64,
        /// The free length that was laid out.
        length: f64,
        /// The free length at which the roots of the ligament just clear each other, h tan(angle/2).
        needed: f64,
    },
    /// Two pieces that only meet at a corner overlap in the other state.
    #[error(
        "pieces {pieces:?}, which meet at corner {corner} at ({x:.2}, {y:.2}) mm, overlap by {area:.4} mm² in the \
         {state} state: their hinges turn too far there; let the target stretch less at that place, or take larger pieces"
    )]
    CornerCollision {
        /// The pieces.
        pieces: [usize; 2],
        /// The corner.
        corner: usize,
        /// The corner's x.
        x: f64,
        /// The corner's y.
        y: f64,
        /// Overlap area.
        area: f64,
        /// The state in which they overlap.
        state: &'static str,
    },
}

/// What frees two pieces that collide about their hinge: a longer ligament, or, where it is long enough to turn about its
/// own centre, a hinge point in that centre.
fn hinge_remedy(length: f64, needed: f64) -> String {
    if length < needed {
        return format!("its ligament's free length is {length:.3} mm and must be at least {needed:.3} mm");
    }
    "its ligament is long enough, but the hinge point stands off its centre; bring the design's gap (gap_mm) nearer to \
     ligament width plus kerf, or take larger pieces"
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colliding_pieces_are_blamed_on_what_is_wrong() {
        let collision = |length: f64| FabricationError::HingeCollision {
            pieces: [0, 24],
            hinge: 1,
            x: 12.76,
            y: 13.63,
            area: 0.0543,
            angle_deg: 80.5,
            length,
            needed: 0.423,
        };
        let (short, long) = (collision(0.4).to_string(), collision(0.88).to_string());
        assert!(short.ends_with("free length is 0.400 mm and must be at least 0.423 mm"), "{short}");
        assert!(long.contains("gap_mm") && !long.contains("must be at least"), "{long}");
    }
}
