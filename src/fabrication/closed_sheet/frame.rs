//! The frame of each corner: which edges are hinged there, which slit passes, and in which direction.
//!
//! Around a corner hinged and passing edges alternate. With h the ligament's width, k the kerf and g = h + k:
//!
//! ```text
//!   inner corner                concave border corner          border hinge        exit
//!
//!        | hinged slit               | hinged slit                 | hinged slit       | slit
//!       ---  relief                 ---  relief                   ---  relief          |
//!   g (  H   ligament           g (  H                         g (  H = m              |
//!   -----m------ passing slit   -----m------ exiting slit      -----------  border  ---m---
//!   g (  H                      border                                                 |
//!       ---                     |                                                   --------  border
//!        |                      |
//! ```

use kurbo::{Point, Vec2};

use crate::fabrication::error::FabricationError;
use crate::fabrication::topology::{Fan, Topology};
use crate::kirigami::design::Design;

/// What a corner is for the cuts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CornerKind {
    /// Four pieces: two edges are hinged on either side of the slit that passes along the other two.
    Inner {
        /// Edges hinged here; the normal points along the first.
        hinged: [usize; 2],
        /// Edges of the slit that passes; the tangent points along the first.
        passing: [usize; 2],
    },
    /// Two pieces hinged at the sheet's border.
    BorderHinge {
        /// The edge; the normal points along it.
        hinged: usize,
    },
    /// Two pieces whose slit runs out of the sheet. The tangent points outwards.
    Exit {
        /// The edge.
        exit: usize,
    },
    /// Three pieces at a concave corner of the border: one edge is hinged, the other's slit exits along the
    /// line of one of the border edges.
    Concave {
        /// The hinged edge; the normal points along it.
        hinged: usize,
        /// The edge whose slit exits; the tangent points along it, into the sheet.
        exit: usize,
        /// Whether the border edge in line with the exiting slit is the one that leaves the corner.
        in_line_leaves: bool,
    },
    /// One piece alone, or none.
    Free,
}

/// A corner's place and directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerFrame {
    /// The midpoint m, sheet millimetres.
    pub middle: Point,
    /// Which edges do what.
    pub kind: CornerKind,
    /// Unit normal of the passing slit or border; zero at a free corner.
    pub normal: Vec2,
    /// Unit tangent of it; zero at a free corner.
    pub tangent: Vec2,
}

/// The frames of all corners.
///
/// The normal is that of the design's hinge points where the design has a gap; else, and at border hinges, it is
/// perpendicular to the chord of the passing (or border) edges' far ends.
///
/// # Errors
/// A corner with another number of pieces, or where hinged and passing edges do not alternate.
pub fn corner_frames(design: &Design, topology: &Topology) -> Result<Vec<CornerFrame>, FabricationError> {
    let frame_at = |(corner, fan): (usize, &Fan)| {
        let kind =
            corner_kind(topology, corner, fan).map_err(|reason| corner_error(design, corner, reason))?;
        let (normal, tangent) = directions(design, topology, corner, fan, kind);
        if !(normal.is_finite() && tangent.is_finite()) {
            let reason = "the far ends of its edges coincide: the design has collapsed there";
            return Err(corner_error(design, corner, reason));
        }
        Ok(CornerFrame { middle: middle(design, corner), kind, normal, tangent })
    };
    topology.fans.iter().enumerate().map(frame_at).collect()
}

fn corner_error(design: &Design, corner: usize, reason: &str) -> FabricationError {
    let Point { x, y } = middle(design, corner);
    FabricationError::Corner { corner, x, y, reason: reason.into() }
}

/// The corner's midpoint in the sheet plane.
pub fn middle(design: &Design, corner: usize) -> Point {
    Point::new(design.corners[corner].x, design.corners[corner].y)
}

fn corner_kind(topology: &Topology, corner: usize, fan: &Fan) -> Result<CornerKind, &'static str> {
    const ALTERNATE: &str = "hinged edges and passing slits do not alternate around it: check the hinge list";
    let hinged = |edge: usize| topology.edges[edge].hinge_at(corner).is_some();
    if !fan.border {
        return match *fan.edges.as_slice() {
            [] => Ok(CornerKind::Free),
            [a, b, c, d] if hinged(a) && !hinged(b) && hinged(c) && !hinged(d) => {
                Ok(CornerKind::Inner { hinged: [a, c], passing: [b, d] })
            }
            [a, b, c, d] if !hinged(a) && hinged(b) && !hinged(c) && hinged(d) => {
                Ok(CornerKind::Inner { hinged: [b, d], passing: [c, a] })
            }
            [_, _, _, _] => Err(ALTERNATE),
            _ => Err("the laser layout cuts inner corners of four pieces only: use a pattern without \
                      irregular corners"),
        };
    }
    match fan.edges[1..fan.edges.len() - 1] {
        [] => Ok(CornerKind::Free),
        [edge] if hinged(edge) => Ok(CornerKind::BorderHinge { hinged: edge }),
        [edge] => Ok(CornerKind::Exit { exit: edge }),
        [first, second] if hinged(first) && !hinged(second) => {
            Ok(CornerKind::Concave { hinged: first, exit: second, in_line_leaves: true })
        }
        [first, second] if !hinged(first) && hinged(second) => {
            Ok(CornerKind::Concave { hinged: second, exit: first, in_line_leaves: false })
        }
        [_, _] => Err(ALTERNATE),
        _ => Err(
            "four or more pieces meet at this border corner, but the laser layout cuts up to three: trim \
                  the pattern otherwise",
        ),
    }
}

/// Unit normal and tangent; not finite where the geometry is degenerate.
fn directions(
    design: &Design,
    topology: &Topology,
    corner: usize,
    fan: &Fan,
    kind: CornerKind,
) -> (Vec2, Vec2) {
    let far = |edge: usize| middle(design, topology.edges[edge].far(corner));
    let at = middle(design, corner);
    let last = fan.edges.len().saturating_sub(1);
    // Perpendicular to the chord `from`-`to`, on the side of `hinged`.
    let chord_normal = |from: usize, to: usize, hinged: usize| {
        let across = (far(to) - far(from)).turn_90().normalize();
        if across.dot(far(hinged) - at) < 0.0 { -across } else { across }
    };
    match kind {
        CornerKind::Free => (Vec2::ZERO, Vec2::ZERO),
        CornerKind::Inner { hinged, passing } => {
            let normal = gap_normal(design, topology, corner, hinged[0], hinged[1])
                .unwrap_or_else(|| chord_normal(passing[1], passing[0], hinged[0]));
            (normal, towards(normal.turn_90(), far(passing[0]) - at))
        }
        CornerKind::BorderHinge { hinged } => {
            let normal = chord_normal(fan.edges[last], fan.edges[0], hinged);
            (normal, -normal.turn_90())
        }
        CornerKind::Exit { exit } => {
            let along = (at - far(exit)).normalize();
            let normal = gap_normal(design, topology, corner, fan.edges[0], fan.edges[last])
                .unwrap_or_else(|| along.turn_90());
            (normal, towards(normal.turn_90(), along))
        }
        CornerKind::Concave { hinged, exit, in_line_leaves } => {
            let (in_line, other) = if in_line_leaves { (0, last) } else { (last, 0) };
            let normal = gap_normal(design, topology, corner, hinged, fan.edges[other])
                .unwrap_or_else(|| chord_normal(fan.edges[in_line], exit, hinged));
            (normal, towards(normal.turn_90(), far(exit) - at))
        }
    }
}

fn towards(direction: Vec2, guide: Vec2) -> Vec2 {
    if direction.dot(guide) < 0.0 { -direction } else { direction }
}

/// Unit vector between the closed vertices of the pieces at two edges of a corner, from `below`'s to `above`'s;
/// `None` where the design's gap vanishes there.
fn gap_normal(
    design: &Design,
    topology: &Topology,
    corner: usize,
    above: usize,
    below: usize,
) -> Option<Vec2> {
    let vertex = |edge: usize| {
        let piece = &design.pieces[topology.edges[edge].left];
        let vertex = piece.corners.iter().position(|&c| c == corner)?;
        Some(Vec2::new(piece.closed[vertex].x, piece.closed[vertex].y))
    };
    let gap = vertex(above)? - vertex(below)?;
    // A nanometre: rounding noise of coordinates below a metre is a thousand times smaller.
    (gap.length() > 1e-6).then(|| gap.normalize())
}
