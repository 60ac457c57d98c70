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
//!
//! A T-junction of a bistable sheet is the upper half of an inner corner: one piece has the passing slit's other side.

use kurbo::{Point, Vec2};

use crate::fabrication::error::FabricationError;
use crate::fabrication::mechanics::pole_offset;
use crate::fabrication::topology::{EdgeHinge, Fan, Topology};
use crate::kirigami::design::Design;
use crate::profile::Profile;

/// What a corner is for the cuts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CornerKind {
    /// Four pieces: two edges are hinged on either side of the slit that passes along the other two. At the border the
    /// end of a narrow cut: its two sides, here the edge that leaves the corner, are one slit, which passes or which
    /// stands in the place of the second hinged edge.
    Inner {
        /// Edges hinged here; the normal points along the first.
        hinged: [usize; 2],
        /// Edges of the slit that passes; the tangent points along the first.
        passing: [usize; 2],
    },
    /// Three pieces: one edge is hinged, and the slit that passes along the other two goes straight by the third piece.
    Tee {
        /// The hinged edge; the normal points along it.
        hinged: usize,
        /// Edges of the slit that passes; the tangent points along the first.
        passing: [usize; 2],
    },
    /// Two pieces: one slit between them turns here.
    Bend {
        /// Its edges.
        edges: [usize; 2],
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
    /// Three or more slits meet at angles, or more than three pieces at the border: see [`super::junction`].
    Junction,
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
    /// Unit normal of the passing slit or border; zero at a free corner, a bend and a junction.
    pub normal: Vec2,
    /// Unit tangent of it; zero likewise.
    pub tangent: Vec2,
    /// At an inner corner how far the two walls of the slit that passes are set apart, each from the centre line: along the
    /// normal, and against it. 0 where one groove cuts both.
    pub spread: [f64; 2],
    /// At a border hinge how far along the normal its ligament's centre stands off the hinge point, so that it turns about
    /// it. At other corners the design has left room for that.
    pub shift: f64,
}

/// Walls that are set apart by less than this need no two grooves, millimetres.
const LEAST_SPREAD: f64 = 2e-3;

/// The frames of all corners.
///
/// The normal is that of the design's hinge points where the design has a gap; else, and at border hinges, it is
/// perpendicular to the chord of the passing (or border) edges' far ends.
///
/// # Errors
/// A corner where hinged and passing edges do not alternate.
pub fn corner_frames(
    design: &Design,
    topology: &Topology,
    lengths: &[f64],
    profile: &Profile,
) -> Result<Vec<CornerFrame>, FabricationError> {
    let longest = |fan: &Fan| {
        let hinges = fan.edges.iter().filter_map(|&edge| topology.edges[edge].hinge);
        hinges.map(|hinge| lengths[hinge.id]).fold(0.0, f64::max)
    };
    let frame_at = |(corner, fan): (usize, &Fan)| {
        let narrow = fan.border && {
            let far = |edge: usize| middle(design, topology.edges[edge].far(corner));
            let sides = [fan.edges[0], fan.edges[fan.edges.len() - 1]].map(far);
            let room = 0.5 * longest(fan) + 3.0 * profile.cut.kerf;
            notch_depth(middle(design, corner), sides, profile.hinge_gap()) > room
        };
        let kind = corner_kind(topology, corner, fan, narrow)
            .map_err(|reason| corner_error(design, corner, reason))?;
        let (normal, tangent) = directions(design, topology, corner, fan, kind);
        if !(normal.is_finite() && tangent.is_finite()) {
            let reason = "the far ends of its edges coincide: the design has collapsed there";
            return Err(corner_error(design, corner, reason));
        }
        let place = (passed(design, topology, corner, kind, normal), normal);
        let spread = spread(design, topology, (kind, place), lengths, profile).map_err(|[width, limit]| {
            let reason = format!(
                "the slit that passes its two hinges is {width:.3} mm wider than the tool, at most {limit:.3} mm can be \
                 cleared in two passes: use a larger tool, a thinner sheet or smaller pieces, whose axes tilt less"
            );
            corner_error(design, corner, &reason)
        })?;
        let shift = match kind {
            CornerKind::BorderHinge { hinged } => pole_at(design, topology, hinged, lengths, profile),
            _ => 0.0,
        };
        Ok(CornerFrame { middle: place.0, kind, normal, tangent, spread, shift })
    };
    topology.fans.iter().enumerate().map(frame_at).collect()
}

/// Where a slit passes a corner. At a concave corner the vertex of the third piece is free and need not stand opposite the
/// hinge: there the slit keeps its distance from the hinge point.
fn passed(design: &Design, topology: &Topology, corner: usize, kind: CornerKind, normal: Vec2) -> Point {
    let at = middle(design, corner);
    match kind {
        CornerKind::Concave { hinged, .. } => {
            let hinge = vertex_at(design, topology, corner, hinged);
            hinge.map_or(at, |hinge| hinge - hinge.distance(at) * normal)
        }
        _ => at,
    }
}

/// How far the ligament on an edge stands off its hinge point.
fn pole_at(design: &Design, topology: &Topology, edge: usize, lengths: &[f64], profile: &Profile) -> f64 {
    let hinge = topology.edges[edge].hinge;
    hinge.map_or(0.0, |EdgeHinge { id, .. }| pole_offset(profile, lengths[id], design.hinges[id].angle))
}

/// How far the two walls of the slit that passes a corner are set apart: a tool that rules them, each along its own
/// hinge's axis, needs more room than its diameter, and the design has left it. A laser cuts both at once.
///
/// # Errors
/// By how much the slit is wider than the groove, and the most that two passes clear.
fn spread(
    design: &Design,
    topology: &Topology,
    (kind, (middle, normal)): (CornerKind, (Point, Vec2)),
    lengths: &[f64],
    profile: &Profile,
) -> Result<[f64; 2], [f64; 2]> {
    let CornerKind::Inner { hinged, .. } = kind else { return Ok([0.0; 2]) };
    let [Some(above), Some(below)] = hinged.map(|edge| topology.edges[edge].hinge) else {
        return Ok([0.0; 2]);
    };
    if !profile.cut.ruled {
        return Ok([0.0; 2]);
    }
    let beyond = |hinge: EdgeHinge, normal: Vec2, edge: usize| {
        let point = design.hinges[hinge.id].point;
        let out = (Point::new(point.x, point.y) - middle).dot(normal);
        out + pole_at(design, topology, edge, lengths, profile) - 0.5 * profile.hinge_gap()
    };
    let spread = [beyond(above, normal, hinged[0]), beyond(below, -normal, hinged[1])];
    if spread.iter().any(|&wall| wall < LEAST_SPREAD) {
        return Ok([0.0; 2]);
    }
    // Two passes whose centre lines are farther apart than they are wide leave a core between them at mid-plane.
    let (width, limit) = (spread[0] + spread[1], profile.cut.kerf);
    if width > limit { Err([width, limit]) } else { Ok(spread) }
}

/// How far outside a border corner the border's cut turns back, beside the corner's two border edges, whose far ends are
/// given: g/2 over the sine of half the angle between them. 0 where the angle is a right one or more.
fn notch_depth(at: Point, far: [Point; 2], gap: f64) -> f64 {
    let [a, b] = far.map(|far| (far - at).normalize());
    // sin^2 of half the angle.
    let sin2 = 0.5 * (1.0 - a.dot(b));
    if a.dot(b) > 0.0 { 0.5 * gap / sin2.max(0.0).sqrt() } else { 0.0 }
}

/// The error of a corner that cannot be cut.
pub fn corner_error(design: &Design, corner: usize, reason: &str) -> FabricationError {
    let Point { x, y } = middle(design, corner);
    FabricationError::Corner { corner, x, y, reason: reason.into() }
}

/// The corner's midpoint in the sheet plane.
pub fn middle(design: &Design, corner: usize) -> Point {
    Point::new(design.corners[corner].x, design.corners[corner].y)
}

fn corner_kind(
    topology: &Topology,
    corner: usize,
    fan: &Fan,
    narrow: bool,
) -> Result<CornerKind, &'static str> {
    const ALTERNATE: &str = "hinged edges and passing slits do not alternate around it: check the hinge list";
    let hinged = |edge: usize| topology.edges[edge].hinge_at(corner).is_some();
    let alternate = |edges: &[usize]| edges.windows(2).all(|pair| hinged(pair[0]) != hinged(pair[1]));
    let count = fan.edges.len();
    if !fan.border {
        return match *fan.edges.as_slice() {
            [] => Ok(CornerKind::Free),
            [a, b] if !hinged(a) && !hinged(b) => Ok(CornerKind::Bend { edges: [a, b] }),
            [a, b, c] if [a, b, c].into_iter().filter(|&edge| hinged(edge)).count() == 1 => {
                let first = [a, b, c].into_iter().position(hinged).unwrap_or(0);
                let [hinged, before, after] = [0, 1, 2].map(|i| [a, b, c][(first + i) % 3]);
                Ok(CornerKind::Tee { hinged, passing: [before, after] })
            }
            _ if count % 2 == 1 || count < 4 || !alternate(&fan.edges) => Err(ALTERNATE),
            [a, b, c, d] if hinged(a) => Ok(CornerKind::Inner { hinged: [a, c], passing: [b, d] }),
            [a, b, c, d] => Ok(CornerKind::Inner { hinged: [b, d], passing: [c, a] }),
            _ => Ok(CornerKind::Junction),
        };
    }
    let inside = &fan.edges[1..count - 1];
    if !alternate(inside) {
        return Err(ALTERNATE);
    }
    Ok(match *inside {
        [] => CornerKind::Free,
        [edge] if hinged(edge) => CornerKind::BorderHinge { hinged: edge },
        [edge] => CornerKind::Exit { exit: edge },
        [first, second] if hinged(first) => {
            CornerKind::Concave { hinged: first, exit: second, in_line_leaves: true }
        }
        [first, second] => CornerKind::Concave { hinged: second, exit: first, in_line_leaves: false },
        [a, b, c] if narrow && hinged(a) => CornerKind::Inner { hinged: [a, c], passing: [b, fan.edges[0]] },
        [a, b, c] if narrow => CornerKind::Inner { hinged: [b, fan.edges[0]], passing: [c, a] },
        _ => CornerKind::Junction,
    })
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
        CornerKind::Free | CornerKind::Junction | CornerKind::Bend { .. } => (Vec2::ZERO, Vec2::ZERO),
        CornerKind::Tee { hinged, passing } => {
            let normal = gap_normal(design, topology, corner, hinged, None)
                .unwrap_or_else(|| chord_normal(passing[1], passing[0], hinged));
            (normal, towards(normal.turn_90(), far(passing[0]) - at))
        }
        CornerKind::Inner { hinged, passing } => {
            // Opposite a cut that ends here stands no hinge, and no vertex that the passing slit's normal goes through.
            let opposite = topology.edges[hinged[1]].right.map(|_| hinged[1]);
            let normal = gap_normal(design, topology, corner, hinged[0], opposite)
                .unwrap_or_else(|| chord_normal(passing[1], passing[0], hinged[0]));
            (normal, towards(normal.turn_90(), far(passing[0]) - at))
        }
        CornerKind::BorderHinge { hinged } => {
            let normal = chord_normal(fan.edges[last], fan.edges[0], hinged);
            (normal, -normal.turn_90())
        }
        CornerKind::Exit { exit } => {
            let along = (at - far(exit)).normalize();
            let normal = gap_normal(design, topology, corner, fan.edges[0], Some(fan.edges[last]))
                .unwrap_or_else(|| along.turn_90());
            (normal, towards(normal.turn_90(), along))
        }
        CornerKind::Concave { hinged, exit, in_line_leaves } => {
            let (in_line, other) = if in_line_leaves { (0, last) } else { (last, 0) };
            let normal = gap_normal(design, topology, corner, hinged, Some(fan.edges[other]))
                .unwrap_or_else(|| chord_normal(fan.edges[in_line], exit, hinged));
            (normal, towards(normal.turn_90(), far(exit) - at))
        }
    }
}

fn towards(direction: Vec2, guide: Vec2) -> Vec2 {
    if direction.dot(guide) < 0.0 { -direction } else { direction }
}

/// The closed vertex at a corner of the piece to the left of an edge.
fn vertex_at(design: &Design, topology: &Topology, corner: usize, edge: usize) -> Option<Point> {
    let piece = &design.pieces[topology.edges[edge].left];
    let vertex = piece.corners.iter().position(|&c| c == corner)?;
    Some(Point::new(piece.closed[vertex].x, piece.closed[vertex].y))
}

/// Unit vector between the closed vertices of the pieces at two edges of a corner, from `below`'s (without one from the
/// corner's midpoint) to `above`'s; `None` where the design's gap vanishes there.
fn gap_normal(
    design: &Design,
    topology: &Topology,
    corner: usize,
    above: usize,
    below: Option<usize>,
) -> Option<Vec2> {
    let below = match below {
        Some(edge) => vertex_at(design, topology, corner, edge)?,
        None => middle(design, corner),
    };
    let gap = vertex_at(design, topology, corner, above)? - below;
    // A nanometre: rounding noise of coordinates below a metre is a thousand times smaller.
    (gap.length() > 1e-6).then(|| gap.normalize())
}
