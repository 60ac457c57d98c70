//! The two states of a design as fabrication sees them: the one that is cut, flat on the sheet, and the other one.

use kurbo::Point;

use crate::geometry::Point3;
use crate::geometry::rotation::RigidMotion;
use crate::kirigami::design::{Design, Piece, State};

/// The vertices of a piece in the state that is cut. Where neither is flat, the closed one.
pub fn sheet_vertices<'a>(design: &Design, piece: &'a Piece) -> &'a [Point3] {
    if design.sheet_state == Some(State::Open) { &piece.open } else { &piece.closed }
}

/// The vertices of a piece in the state that the sheet turns into.
pub fn other_vertices<'a>(design: &Design, piece: &'a Piece) -> &'a [Point3] {
    if design.sheet_state == Some(State::Open) { &piece.closed } else { &piece.open }
}

/// The name of the state that the sheet turns into.
pub fn other_name(design: &Design) -> &'static str {
    if design.sheet_state == Some(State::Open) { "closed" } else { "open" }
}

/// The rigid motion of every piece from the sheet into the other state: the best fit in the sense of least squares.
pub fn motions(design: &Design) -> Vec<RigidMotion> {
    let motion =
        |piece: &Piece| RigidMotion::fit(sheet_vertices(design, piece), other_vertices(design, piece));
    design.pieces.iter().map(motion).collect()
}

/// Where on the sheet a corner is: in the open state, where it is a window, the middle of the vertices around it.
pub fn corner_place(design: &Design, corner: usize) -> Point {
    if design.sheet_state != Some(State::Open) {
        return Point::new(design.corners[corner].x, design.corners[corner].y);
    }
    let vertices = design.pieces.iter().flat_map(|piece| {
        let at = piece.corners.iter().position(|&c| c == corner);
        at.and_then(|at| piece.open.get(at))
    });
    let (sum, count) = vertices.fold(([0.0; 2], 0.0), |([x, y], n), p| ([x + p.x, y + p.y], n + 1.0));
    if count > 0.0 { Point::new(sum[0] / count, sum[1] / count) } else { Point::ORIGIN }
}
