//! Why a mesh is no pattern, in words.

use std::fmt::Display;

use crate::geometry::Point3;
use crate::geometry::topology::{Defect, NotADisk};

use super::alternation::{Alternation, Odd, OddPlace};

/// What is wrong with the mesh of a pattern. Indices count from 0, the messages from 1, as OBJ files do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PatternMeshError {
    /// The mesh is no disk.
    #[error(transparent)]
    Mesh(#[from] NotADisk),
    /// A face that passes the same vertex twice.
    #[error("face {} names vertex {} twice: remove degenerate faces in the modeller", .face + 1, .vertex + 1)]
    RepeatedVertex {
        /// The face.
        face: usize,
        /// The vertex.
        vertex: usize,
    },
    /// Two vertices in one place.
    #[error(
        "face {}: vertices {} and {} lie in one place, {}: weld them in the modeller",
        .face + 1, .ends[0] + 1, .ends[1] + 1, mm(.at)
    )]
    NoLength {
        /// The face.
        face: usize,
        /// The vertices.
        ends: [usize; 2],
        /// Where.
        at: Point3,
    },
    /// A control mesh has faces other than quads.
    #[error(
        "face {} at {} has {corners} corners: in a control mesh every face is a quad. Make it one, or let the faces be \
         the pieces",
        .face + 1, mm(.at)
    )]
    NotAQuad {
        /// The face.
        face: usize,
        /// Its number of corners.
        corners: usize,
        /// Its first corner.
        at: Point3,
    },
    /// The vertices cannot be piece centres and corners by turns.
    #[error(
        "around the hole of the control mesh centres and corners of pieces do not take turns: vertices {} and {} of face \
         {} at {} would be alike. Let an even number of edges lead around the hole",
        .ends[0] + 1, .ends[1] + 1, .face + 1, mm(.at)
    )]
    NoTwoColours {
        /// A face where it shows.
        face: usize,
        /// Two vertices of an edge.
        ends: [usize; 2],
        /// Where.
        at: Point3,
    },
    /// A vertex that is to be a piece centre does not exist.
    #[error("no face has vertex {}, which is to be the centre of a piece", .vertex + 1)]
    NoSuchVertex {
        /// The vertex.
        vertex: usize,
    },
    /// An inner vertex with two faces would be a piece with two corners.
    #[error(
        "vertex {} at {} is the centre of a piece, but has only two faces around it: merge them into one quad",
        .vertex + 1, mm(.at)
    )]
    Doublet {
        /// The vertex.
        vertex: usize,
        /// Where.
        at: Point3,
    },
    /// The pieces of a control mesh are no disk.
    #[error("the pieces of the control mesh (counted by the vertices at their centres): {0}")]
    Pieces(NotADisk),
    /// Too few pieces.
    #[error("the mesh makes {pieces} pieces; at least {} are needed: use a finer mesh", super::LEAST_PIECES)]
    TooFew {
        /// Number of pieces.
        pieces: usize,
    },
    /// Two pieces with two hinges.
    #[error(
        "{what} {} and {} share two sides, from vertex {} to {} and from {} to {}: two hinges would hold them fast. Merge \
         them, or cut one of the sides",
        .pieces[0] + 1, .pieces[1] + 1,
        .sides[0][0] + 1, .sides[0][1] + 1, .sides[1][0] + 1, .sides[1][1] + 1
    )]
    SharedTwice {
        /// What `pieces` counts.
        what: &'static str,
        /// The two pieces' faces, or the vertices at their centres.
        pieces: [usize; 2],
        /// The two sides.
        sides: [[usize; 2]; 2],
    },
    /// The cuts cannot be made.
    #[error(transparent)]
    Cut(#[from] CutError),
    /// Neighbours cannot turn in opposite senses.
    #[error(
        "neighbouring pieces cannot all turn in opposite senses: {}. {}",
        list(&.0.odd, place), remedy(.0)
    )]
    Alternation(Box<Alternation>),
}

impl PatternMeshError {
    /// Whether the input is faulty (exit status 1), rather than sound but not makeable as it is (2).
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Mesh(fault) => !matches!(
                fault.defect,
                Defect::Closed { .. }
                    | Defect::Holes { .. }
                    | Defect::Handles { .. }
                    | Defect::OneSided { .. }
            ),
            Self::Alternation(_) => false,
            _ => true,
        }
    }
}

/// What is wrong with the user's cuts. `line` is that of the file they stand in, counted from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CutError {
    /// The file has no polyline.
    #[error("the file has no cuts: draw them as polylines (`l` elements)")]
    NoPath,
    /// A vertex away from all of the mesh's.
    #[error(
        "line {line}: vertex {} of the cut at {} is not a vertex of the mesh: the nearest one, {}, is {distance:.4} mm \
         away, and up to {tolerance:.4} mm are allowed",
        .vertex + 1, mm(.at), .nearest + 1
    )]
    NotAVertex {
        /// The line.
        line: usize,
        /// The vertex in the cuts' file.
        vertex: usize,
        /// Where.
        at: Point3,
        /// The nearest vertex of the mesh.
        nearest: usize,
        /// Its distance, millimetres.
        distance: f64,
        /// What is allowed, millimetres.
        tolerance: f64,
    },
    /// A vertex that is no corner of a piece.
    #[error(
        "line {line}: the cut runs through vertex {}, {}",
        .vertex + 1,
        if *.centre {
            "the centre of a piece. Cuts run between pieces: in a control mesh across the faces, from one piece corner \
             to the next"
        } else {
            "which is the corner of no piece"
        }
    )]
    NotACorner {
        /// The line.
        line: usize,
        /// The vertex.
        vertex: usize,
        /// Whether it is the centre of a piece.
        centre: bool,
    },
    /// No side of a piece.
    #[error(
        "line {line}: the cut goes from vertex {} to {}, but no two pieces share a side there",
        .ends[0] + 1, .ends[1] + 1
    )]
    NotAnEdge {
        /// The line.
        line: usize,
        /// Two vertices that follow each other in the cut.
        ends: [usize; 2],
    },
    /// A side at the border.
    #[error(
        "line {line}: from vertex {} to {} the cut runs along the border, where nothing is to cut: let it end at the \
         border",
        .ends[0] + 1, .ends[1] + 1
    )]
    Border {
        /// The line.
        line: usize,
        /// Two vertices that follow each other in the cut.
        ends: [usize; 2],
    },
    /// A path of one vertex.
    #[error("line {line}: the cut has only one vertex, it needs at least 2")]
    TooShort {
        /// The line.
        line: usize,
    },
    /// The same vertex twice in a row.
    #[error("line {line}: the cut names vertex {} twice in a row", .vertex + 1)]
    StandsStill {
        /// The line.
        line: usize,
        /// The vertex.
        vertex: usize,
    },
    /// The same edge twice.
    #[error("line {line}: the cut runs twice between vertex {} and {}", .ends[0] + 1, .ends[1] + 1)]
    Twice {
        /// The line.
        line: usize,
        /// The edge.
        ends: [usize; 2],
    },
    /// The sheet falls apart.
    #[error("the cuts leave the sheet in {} parts, of {} pieces: shorten one", .pieces.len(), list(.pieces, usize::to_string))]
    InParts {
        /// Number of pieces of each part, largest first.
        pieces: Vec<usize>,
    },
}

/// At most this many things are listed in a message.
const MOST_LISTED: usize = 6;

/// "a; b; c and 7 more".
fn list<T>(things: &[T], text: impl Fn(&T) -> String) -> String {
    let shown: Vec<String> = things.iter().take(MOST_LISTED).map(text).collect();
    let shown = shown.join("; ");
    if things.len() > MOST_LISTED {
        format!("{shown} and {} more", things.len() - MOST_LISTED)
    } else {
        shown
    }
}

fn mm(p: &Point3) -> impl Display {
    format!("({:.2}, {:.2}, {:.2}) mm", p.x, p.y, p.z)
}

fn place(odd: &OddPlace) -> String {
    let (pieces, first) = (odd.pieces, odd.vertices.iter().min().map_or(0, |v| v + 1));
    match odd.kind {
        Odd::Corner => format!("{pieces} pieces meet at vertex {first}, {}", mm(&odd.at)),
        Odd::Hole => format!("{pieces} pieces lie around the hole at vertex {first}, {}", mm(&odd.at)),
    }
}

fn remedy(found: &Alternation) -> String {
    let path = |path: &Vec<usize>| path.iter().map(|v| (v + 1).to_string()).collect::<Vec<_>>().join("-");
    format!(
        "An even number is needed. Cut the sheet along vertices {} ({:.1} mm), or have that done: cuts = \"automatic\"",
        list(&found.paths, path),
        found.length
    )
}
