//! What can be wrong with a machine file.

use std::fmt;

use kurbo::Point;

/// What was checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Check {
    /// The file names the design that it was made from.
    Design,
    /// Millimetres.
    Units,
    /// Every entity is a cut on a layer of ours, or a note.
    Layer,
    /// All numbers are finite.
    Numbers,
    /// Both files hold the same cuts.
    Agreement,
    /// No segment is so short that a machine dwells on it.
    Segment,
    /// The border is one closed cut, and the last; windows are closed.
    Border,
    /// All cuts are on the stock.
    Stock,
    /// No cut is made twice.
    Duplicate,
    /// No two cuts run along each other.
    Overlap,
    /// Enough material between two cuts.
    Web,
    /// No slit ends in the middle of the sheet or beyond its border.
    End,
    /// One connected body, which holds all pieces.
    Body,
    /// Width and place of the ligaments.
    Ligament,
    /// Every side of every piece is cut where it should be, and nothing else is.
    Piece,
    /// The copies lie where the report says.
    Copies,
    /// The features of a test coupon have their sizes.
    Size,
    /// Leads lie in scrap and lead into a closed cut.
    Lead,
    /// The border is cut but for the tabs that the report tells of.
    Tab,
    /// What is engraved lies on pieces, clear of all cuts.
    Engraving,
}

impl Check {
    /// What to do about it.
    pub fn remedy(self) -> &'static str {
        match self {
            Self::Design => "make the files again, all of them from one design, or name the right folder",
            Self::Units => "write or export the file in millimetres",
            Self::Layer => {
                "put every cut on SLIT, RELIEF, WINDOW, BORDER or LEAD, every text on NOTE and what is engraved on ENGRAVE"
            }
            Self::Numbers => "make the files again; do not cut this one",
            Self::Agreement => "make both files again, and change neither by hand",
            Self::Segment => "merge the segment's ends",
            Self::Border => "keep one closed border for each part, and cut it last",
            Self::Stock => "move the part onto the stock, or set the profile's sheet to the true stock",
            Self::Duplicate => "delete one of the two cuts",
            Self::Overlap => "shorten one of the two cuts to where they meet",
            Self::Web => "use larger pieces, or make the files again if they were changed",
            Self::End => "make the files again: a cut was moved, lengthened or lost",
            Self::Body => "make the files again: a cut was moved, added or closed",
            Self::Ligament => "make the files again, or correct the profile's kerf if that is what differs",
            Self::Size => "make the files again: a cut was moved or lost",
            Self::Lead => "make the files again, with shorter leads if they were not changed",
            Self::Tab => "make the files again, and change none by hand",
            Self::Engraving => "make the files again; do not engrave this one",
            Self::Copies => "make the files again, and change none by hand",
            Self::Piece => "make the files again: a cut was moved, scaled, added or lost",
        }
    }
}

/// One thing that is wrong, with its place and value.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Which check found it.
    pub check: Check,
    /// The file.
    pub file: &'static str,
    /// The cut, hinge, piece or key.
    pub what: String,
    /// Where on the sheet.
    pub at: Option<Point>,
    /// Value and limit.
    pub says: String,
    /// The hinge whose ligament it is.
    pub hinge: Option<usize>,
}

impl Fault {
    /// A fault that belongs to no hinge.
    pub(super) fn new(
        check: Check,
        file: &'static str,
        what: impl Into<String>,
        at: impl Into<Option<Point>>,
        says: impl Into<String>,
    ) -> Self {
        Self { check, file, what: what.into(), at: at.into(), says: says.into(), hinge: None }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.file, self.what)?;
        if let Some(at) = self.at {
            write!(f, " at ({:.3}, {:.3}) mm", at.x, at.y)?;
        }
        write!(f, ": {}", self.says)
    }
}
