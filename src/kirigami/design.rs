//! The result of the optimisation: rigid pieces in two states and the hinges between them.

use crate::geometry::{Point3, Vector3};

/// One of the two states of the sheet (the paper's words).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// The slits are closed.
    Closed,
    /// The slits have opened to holes.
    Open,
}

impl State {
    /// The one that this is not.
    pub fn other(self) -> Self {
        match self {
            Self::Closed => Self::Open,
            Self::Open => Self::Closed,
        }
    }
}

/// The families of cut patterns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PatternKind {
    /// Section 2.1 of the paper: rectangles that turn by about 45 degrees, "constant mean stretch".
    RotatingRectangles,
    /// Section 2.2: rectangles that snap between two states, and 8-gons that they hold apart.
    Bistable,
    /// Made by another program: any pieces, only as rigid as they came.
    Imported,
}

/// A rigid piece: its hinge polygon in both states.
///
/// Vertex `i` is a hinge point (or, at the sheet's border, a free corner), not a point of the cut outline.
/// Vertices are counter-clockwise seen from +z of the sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// The sheet corner near each vertex: indices into [`Design::corners`].
    pub corners: Vec<usize>,
    /// Vertices in the closed state, millimetres.
    pub closed: Vec<Point3>,
    /// Vertices in the open state, millimetres.
    pub open: Vec<Point3>,
}

impl Piece {
    /// Its vertices in a state.
    pub fn vertices(&self, state: State) -> &[Point3] {
        match state {
            State::Closed => &self.closed,
            State::Open => &self.open,
        }
    }
}

/// A hinge between two pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct Hinge {
    /// The two pieces j and k.
    pub pieces: [usize; 2],
    /// The vertex of piece j and of piece k that coincide at the hinge, in both states.
    pub vertices: [usize; 2],
    /// The hinge point in the frame of the sheet state, millimetres.
    pub point: Point3,
    /// Unit axis in the frame of the sheet state.
    pub axis: Vector3,
    /// Turning angle in radians, >= 0: about `axis` it takes piece j's view of piece k from the sheet state
    /// to the other.
    pub angle: f64,
}

/// A designed sheet.
///
/// Pieces tile the sheet: two pieces that share two consecutive corners (in opposite order) are neighbours
/// across the edge between those corners. Of rotating pieces that edge carries one hinge at most, at one of its two ends, and
/// none where the sheet is cut apart; of bistable sheets one or none, and none between two of the pieces that only move.
/// At an inner corner of valence 4 two opposite edges have their hinge there; the slit along the other two
/// passes straight through the corner, between the two hinges.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// Which pattern it is.
    pub pattern: PatternKind,
    /// The flat state that is cut; `None` where neither state is flat.
    pub sheet_state: Option<State>,
    /// Distance between the two hinge points of an inner corner, across the slit that passes between them.
    pub gap: f64,
    /// Corner midpoints m of the closed state: inner closed hinge points stand at m ± (gap/2) n.
    pub corners: Vec<Point3>,
    /// The rigid pieces.
    pub pieces: Vec<Piece>,
    /// The hinges.
    pub hinges: Vec<Hinge>,
}

impl Design {
    /// Mean distance between neighbouring corners in the sheet, millimetres; an edge of two pieces counts twice.
    pub fn mean_edge(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for piece in &self.pieces {
            for (i, &corner) in piece.corners.iter().enumerate() {
                let next = piece.corners[(i + 1) % piece.corners.len()];
                sum += (self.corners[next] - self.corners[corner]).norm();
                count += 1.0;
            }
        }
        sum / count
    }
}
