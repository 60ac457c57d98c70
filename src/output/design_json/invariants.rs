//! What every design holds, whether this program made it or read it: checked before writing and after reading.

use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::{Design, Hinge, Piece, State};

/// Largest distance between two points that a design says are one, millimetres: a thousandth of what any machine
/// places, and far above the rounding of files with seven decimals.
pub const SAME_POINT: f64 = 1e-6;

/// Largest deviation of an axis' length from 1: above the rounding of ten printed digits.
pub const UNIT_LENGTH: f64 = 1e-9;

/// Largest absolute coordinate, millimetres. Ten times what a target may have; beyond it `f64` does not resolve
/// [`SAME_POINT`] any more.
pub const MAX_COORDINATE: f64 = 1e10;

/// Something that a design must not be. Indices count from 0, as in the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum InvalidDesign {
    /// There is nothing.
    #[error("the design has no pieces")]
    NoPieces,
    /// A coordinate that is NaN, infinite or beyond [`MAX_COORDINATE`].
    #[error("{place}: {value:e} is not a coordinate of at most {MAX_COORDINATE:e} mm")]
    Coordinate {
        /// Which coordinate.
        place: String,
        /// Its value.
        value: f64,
    },
    /// The gap is negative or not finite.
    #[error("gap_mm is {value}: it must be finite and at least 0")]
    Gap {
        /// The gap.
        value: f64,
    },
    /// A piece that is no polygon.
    #[error("piece {piece} has {count} vertices; it needs at least 3")]
    TooFewVertices {
        /// The piece.
        piece: usize,
        /// Its number of vertices.
        count: usize,
    },
    /// A piece whose lists do not belong together.
    #[error(
        "piece {piece} has {corners} corners, {closed} closed and {open} open vertices; the counts must agree"
    )]
    Counts {
        /// The piece.
        piece: usize,
        /// Number of corners.
        corners: usize,
        /// Number of closed vertices.
        closed: usize,
        /// Number of open vertices.
        open: usize,
    },
    /// A corner that the sheet does not have.
    #[error("piece {piece} names corner {corner}, but the corners run from 0 to {} only", *.count as i64 - 1)]
    NoSuchCorner {
        /// The piece.
        piece: usize,
        /// The corner.
        corner: usize,
        /// Number of corners.
        count: usize,
    },
    /// A piece that passes a corner twice.
    #[error("piece {piece} names corner {corner} twice")]
    RepeatedCorner {
        /// The piece.
        piece: usize,
        /// The corner.
        corner: usize,
    },
    /// A point of the flat state that is not in the sheet's plane.
    #[error("{place} lies {z:e} mm off the sheet's mid-plane z = 0; at most {SAME_POINT:e} mm are rounding")]
    OffSheet {
        /// Which point.
        place: String,
        /// Its height, millimetres.
        z: f64,
    },
    /// A hinge at a piece that does not exist.
    #[error("hinge {hinge} names piece {piece}, but the pieces run from 0 to {} only", *.count as i64 - 1)]
    NoSuchPiece {
        /// The hinge.
        hinge: usize,
        /// The piece.
        piece: usize,
        /// Number of pieces.
        count: usize,
    },
    /// A hinge that joins a piece with itself.
    #[error("hinge {hinge} joins piece {piece} with itself")]
    SamePiece {
        /// The hinge.
        hinge: usize,
        /// The piece.
        piece: usize,
    },
    /// A hinge at a vertex that its piece does not have.
    #[error("hinge {hinge} names vertex {vertex} of piece {piece}, whose vertices run from 0 to {} only", *.count as i64 - 1)]
    NoSuchVertex {
        /// The hinge.
        hinge: usize,
        /// The piece.
        piece: usize,
        /// The vertex.
        vertex: usize,
        /// The piece's number of vertices.
        count: usize,
    },
    /// The two vertices of a hinge are in different places.
    #[error(
        "hinge {hinge}: its two vertices are {distance:e} mm apart in the {state} state; at most {SAME_POINT:e} mm are rounding"
    )]
    Apart {
        /// The hinge.
        hinge: usize,
        /// "closed" or "open".
        state: &'static str,
        /// The distance, millimetres.
        distance: f64,
    },
    /// The hinge point is not where the vertices are.
    #[error(
        "hinge {hinge}: its point is {distance:e} mm from its vertices in the {state} state; at most {SAME_POINT:e} mm are rounding"
    )]
    PointElsewhere {
        /// The hinge.
        hinge: usize,
        /// "closed" or "open".
        state: &'static str,
        /// The distance, millimetres.
        distance: f64,
    },
    /// An axis that is no unit vector.
    #[error("hinge {hinge}: its axis has length {length}, not 1 to within {UNIT_LENGTH:e}")]
    Axis {
        /// The hinge.
        hinge: usize,
        /// Length of the axis.
        length: f64,
    },
    /// An angle out of range.
    #[error(
        "hinge {hinge}: its angle is {degrees} degrees; it must be between 0 and 180 (turn the axis round instead)"
    )]
    Angle {
        /// The hinge.
        hinge: usize,
        /// The angle, degrees.
        degrees: f64,
    },
}

/// Checks a design against everything that [`InvalidDesign`] names.
///
/// # Errors
/// The first fault found.
pub fn check(design: &Design) -> Result<(), InvalidDesign> {
    if design.pieces.is_empty() {
        return Err(InvalidDesign::NoPieces);
    }
    if !(design.gap.is_finite() && design.gap >= 0.0) {
        return Err(InvalidDesign::Gap { value: design.gap });
    }
    for (corner, point) in design.corners.iter().enumerate() {
        let place = || format!("corner {corner}");
        check_point(&point.coords, place)?;
        check_on_sheet(point, design.sheet_state == Some(State::Closed), place)?;
    }
    for (id, piece) in design.pieces.iter().enumerate() {
        check_piece(id, piece, design)?;
    }
    for (id, hinge) in design.hinges.iter().enumerate() {
        check_hinge(id, hinge, design)?;
    }
    Ok(())
}

fn check_piece(id: usize, piece: &Piece, design: &Design) -> Result<(), InvalidDesign> {
    let [corners, closed, open] = [piece.corners.len(), piece.closed.len(), piece.open.len()];
    if corners != closed || corners != open {
        return Err(InvalidDesign::Counts { piece: id, corners, closed, open });
    }
    if corners < 3 {
        return Err(InvalidDesign::TooFewVertices { piece: id, count: corners });
    }
    for (i, &corner) in piece.corners.iter().enumerate() {
        if corner >= design.corners.len() {
            return Err(InvalidDesign::NoSuchCorner { piece: id, corner, count: design.corners.len() });
        }
        if piece.corners[..i].contains(&corner) {
            return Err(InvalidDesign::RepeatedCorner { piece: id, corner });
        }
    }
    for (state, points) in [(State::Closed, &piece.closed), (State::Open, &piece.open)] {
        for (vertex, point) in points.iter().enumerate() {
            let place = || format!("piece {id}, {} vertex {vertex}", super::state_name(state));
            check_point(&point.coords, place)?;
            check_on_sheet(point, design.sheet_state == Some(state), place)?;
        }
    }
    Ok(())
}

fn check_hinge(id: usize, hinge: &Hinge, design: &Design) -> Result<(), InvalidDesign> {
    check_point(&hinge.point.coords, || format!("hinge {id}, point"))?;
    check_point(&hinge.axis, || format!("hinge {id}, axis"))?;
    for (&piece, &vertex) in hinge.pieces.iter().zip(&hinge.vertices) {
        let Some(found) = design.pieces.get(piece) else {
            return Err(InvalidDesign::NoSuchPiece { hinge: id, piece, count: design.pieces.len() });
        };
        if vertex >= found.closed.len() {
            return Err(InvalidDesign::NoSuchVertex { hinge: id, piece, vertex, count: found.closed.len() });
        }
    }
    let [j, k] = hinge.pieces;
    if j == k {
        return Err(InvalidDesign::SamePiece { hinge: id, piece: j });
    }
    let sheet = design.sheet_state.unwrap_or(State::Closed);
    for state in [State::Closed, State::Open] {
        let [p, q] = [0, 1].map(|end| {
            let piece = &design.pieces[hinge.pieces[end]];
            let vertices = if state == State::Closed { &piece.closed } else { &piece.open };
            vertices[hinge.vertices[end]]
        });
        let name = super::state_name(state);
        let distance = (p - q).norm();
        if distance > SAME_POINT {
            return Err(InvalidDesign::Apart { hinge: id, state: name, distance });
        }
        let distance = (p - hinge.point).norm();
        if state == sheet && distance > SAME_POINT {
            return Err(InvalidDesign::PointElsewhere { hinge: id, state: name, distance });
        }
    }
    let length = hinge.axis.norm();
    if (length - 1.0).abs() > UNIT_LENGTH {
        return Err(InvalidDesign::Axis { hinge: id, length });
    }
    if !(0.0..=std::f64::consts::PI).contains(&hinge.angle) {
        return Err(InvalidDesign::Angle { hinge: id, degrees: hinge.angle.to_degrees() });
    }
    Ok(())
}

fn check_point(point: &Vector3, place: impl Fn() -> String) -> Result<(), InvalidDesign> {
    match point
        .iter()
        .zip(["x", "y", "z"])
        .find(|(value, _)| !value.is_finite() || value.abs() > MAX_COORDINATE)
    {
        Some((&value, axis)) => {
            Err(InvalidDesign::Coordinate { place: format!("{}, {axis}", place()), value })
        }
        None => Ok(()),
    }
}

fn check_on_sheet(point: &Point3, flat: bool, place: impl Fn() -> String) -> Result<(), InvalidDesign> {
    if flat && point.z.abs() > SAME_POINT {
        return Err(InvalidDesign::OffSheet { place: place(), z: point.z });
    }
    Ok(())
}
