//! The closed cuts around the sheet and around its holes.
//!
//! The border's cut runs g/2 = (h + k)/2 outside the hinge polygons, so that at a hinge h/2 of material is left
//! outside the hinge point. Corner by corner: a straight stretch along a ligament, an arc around a convex corner,
//! one vertex elsewhere; an exiting slit ends exactly on a vertex of the border.

use kurbo::{Point, Vec2};

use super::frame::CornerKind;
use super::slit::Plan;
use crate::fabrication::layout::PathVertex;

/// Turns below this are joined by the averaged offset point, above it by an arc or by the lines' intersection.
const SHARP_TURN: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// A straight line: a point and a unit direction.
#[derive(Debug, Clone, Copy)]
struct Line {
    point: Point,
    direction: Vec2,
}

impl Line {
    /// Unit normal on the side away from the sheet: to the right when travelling.
    fn outward(self) -> Vec2 {
        -self.direction.turn_90()
    }

    /// `None` if the lines are parallel within a degree.
    fn intersect(self, other: Line) -> Option<Point> {
        let sine = self.direction.cross(other.direction);
        let along = (other.point - self.point).cross(other.direction) / sine;
        (sine.abs() > 0.02).then(|| self.point + along * self.direction)
    }
}

/// The cut of one border loop: vertices in travelling order, the sheet to the left.
pub fn border_vertices(plan: &Plan<'_>, border: &[usize]) -> Vec<PathVertex> {
    let count = border.len();
    (0..count).flat_map(|i| corner_vertices(plan, border[(i + count - 1) % count], border[i])).collect()
}

/// Where the slit that exits at `corner` meets the border's cut. `None` if no slit exits there.
pub fn exit_point(plan: &Plan<'_>, corner: usize) -> Option<Point> {
    let frame = &plan.frames[corner];
    let fan = &plan.topology.fans[corner];
    let (leaves, arrives) = (*fan.edges.first()?, *fan.edges.last()?);
    let slit = Line { point: frame.middle, direction: frame.tangent };
    match frame.kind {
        CornerKind::Exit { .. } => {
            let (line_in, line_out) = (offset_line(plan, arrives), offset_line(plan, leaves));
            if turn(line_in, line_out).abs() > SHARP_TURN
                && let Some(point) = line_in.intersect(line_out)
            {
                return Some(point);
            }
            let outward = line_in.outward() + line_out.outward();
            // A slit may run out askew; beyond 60 degrees the design is broken, and the web check finds it.
            let slope = (0.5 * frame.tangent.dot(outward)).max(0.5);
            Some(frame.middle + 0.5 * plan.gap / slope * frame.tangent)
        }
        CornerKind::Concave { in_line_leaves, .. } => {
            let other = offset_line(plan, if in_line_leaves { arrives } else { leaves });
            let square = frame.middle - 0.5 * plan.gap * frame.tangent;
            Some(slit.intersect(other).unwrap_or(square))
        }
        CornerKind::Inner { .. }
        | CornerKind::Tee { .. }
        | CornerKind::Bend { .. }
        | CornerKind::BorderHinge { .. }
        | CornerKind::Junction
        | CornerKind::Free => None,
    }
}

/// Where the border's cut turns back at a corner on which a narrow cut ends: beside the sides of that cut it runs as
/// beside all others. `None` where the sides are nearly parallel.
pub fn notch(plan: &Plan<'_>, corner: usize) -> Option<Point> {
    let fan = &plan.topology.fans[corner];
    let (leaves, arrives) = (*fan.edges.first()?, *fan.edges.last()?);
    offset_line(plan, arrives).intersect(offset_line(plan, leaves))
}

/// The border's vertices at the corner between two consecutive border edges.
fn corner_vertices(plan: &Plan<'_>, arrives: usize, leaves: usize) -> Vec<PathVertex> {
    let corner = plan.topology.edges[leaves].ends[0];
    let frame = &plan.frames[corner];
    let straight = |point| PathVertex { point, bulge: 0.0 };
    match frame.kind {
        CornerKind::BorderHinge { hinged } => {
            let hinges = plan.hinges_of(&[hinged]);
            let foot = frame.middle - (0.5 * plan.gap - frame.shift) * frame.normal;
            let before = border_stretch(plan, corner, arrives, foot, &hinges) * frame.tangent;
            let after = border_stretch(plan, corner, leaves, foot, &hinges) * frame.tangent;
            vec![straight(foot - before), straight(foot + after)]
        }
        CornerKind::Exit { .. } => exit_point(plan, corner).map(straight).into_iter().collect(),
        CornerKind::Concave { hinged, in_line_leaves, .. } => {
            let in_line = if in_line_leaves { leaves } else { arrives };
            let reach = border_stretch(plan, corner, in_line, frame.middle, &plan.hinges_of(&[hinged]));
            let mut points: Vec<Point> = exit_point(plan, corner).into_iter().collect();
            // The stretch along the ligament; very short ligaments end before the border's corner.
            if points.iter().all(|point| reach > frame.middle.distance(*point) + plan.kerf) {
                points.push(frame.middle - reach * frame.tangent);
            }
            if !in_line_leaves {
                points.reverse();
            }
            points.into_iter().map(straight).collect()
        }
        CornerKind::Junction if plan.junctions.get(&corner).is_some_and(|junction| !junction.closed) => {
            along_junction(plan, corner, arrives, leaves).into_iter().map(straight).collect()
        }
        CornerKind::Free
        | CornerKind::Inner { .. }
        | CornerKind::Tee { .. }
        | CornerKind::Bend { .. }
        | CornerKind::Junction => {
            free_corner(plan, frame.middle, offset_line(plan, arrives), offset_line(plan, leaves))
        }
    }
}

/// Half-length of the border's straight stretch along the ligaments of `hinges`, from its `foot` towards the far end of
/// the border edge. Where the border turns into the sheet beyond it the stretch is longer than [`Plan::stretch`]: so
/// long that the turned border keeps the ligament's width from the relief bar's end.
fn border_stretch(plan: &Plan<'_>, corner: usize, edge: usize, foot: Point, hinges: &[usize]) -> f64 {
    let frame = &plan.frames[corner];
    let leaves = plan.topology.edges[edge].ends[0] == corner;
    let longest = hinges.iter().map(|&hinge| plan.lengths[hinge]).fold(0.0, f64::max);
    let bar = 0.5 * (longest - plan.kerf);
    let far = plan.frames[plan.topology.edges[edge].far(corner)].middle;
    let limit = 0.35 * frame.middle.distance(far);
    let far = far + 0.5 * plan.gap * offset_line(plan, edge).outward();
    // The tangent leaves the corner along the border, but at concave corners it runs into the sheet.
    let forwards = match frame.kind {
        CornerKind::Concave { .. } => -frame.tangent,
        _ if leaves => frame.tangent,
        _ => -frame.tangent,
    };
    let mut reach = plan.stretch(corner, edge, hinges);
    // The turn grows a little as the stretch gets longer; where exactly the border meets the far corner shifts it by less
    // than the fraction of a kerf that is added.
    for _ in 0..8 {
        let onwards = far - (foot + reach * forwards);
        let turn = onwards.dot(frame.normal).atan2(onwards.dot(forwards)).max(0.0);
        reach = reach.max(bar + plan.gap * (0.5 * turn).tan() + 0.2 * plan.kerf);
    }
    reach.min(limit)
}

/// The border's vertices along an open junction, against its counter-clockwise sense.
fn along_junction(plan: &Plan<'_>, corner: usize, arrives: usize, leaves: usize) -> Vec<Point> {
    let Some(junction) = plan.junctions.get(&corner) else { return Vec::new() };
    let mut points: Vec<Point> = junction.outline.iter().rev().copied().collect();
    // Beside a slit that runs out here the border's line comes up to the slit's end.
    let beside = |edge: usize, end: Point| {
        let line = offset_line(plan, edge);
        let runs_out = junction.starts.iter().any(|&(_, start)| start == end);
        runs_out.then(|| line.point + (end - line.point).dot(line.direction) * line.direction)
    };
    let [first, last] = [points[0], points[points.len() - 1]];
    points.extend(beside(leaves, last));
    points.splice(0..0, beside(arrives, first));
    points
}

fn free_corner(plan: &Plan<'_>, middle: Point, line_in: Line, line_out: Line) -> Vec<PathVertex> {
    let angle = turn(line_in, line_out);
    let radius = 0.5 * plan.gap;
    if angle > SHARP_TURN {
        return vec![
            PathVertex { point: middle + radius * line_in.outward(), bulge: (0.25 * angle).tan() },
            PathVertex { point: middle + radius * line_out.outward(), bulge: 0.0 },
        ];
    }
    let concave = (angle < -SHARP_TURN).then(|| line_in.intersect(line_out)).flatten();
    let outward = line_in.outward() + line_out.outward();
    // Antiparallel sides have no mean direction; the arriving one's will do.
    let outward = if outward.hypot() > 0.1 { outward.normalize() } else { line_in.outward() };
    let averaged = middle + radius * outward;
    vec![PathVertex { point: concave.unwrap_or(averaged), bulge: 0.0 }]
}

fn turn(line_in: Line, line_out: Line) -> f64 {
    line_in.direction.cross(line_out.direction).atan2(line_in.direction.dot(line_out.direction))
}

/// The line between a border edge's two closed vertices, shifted outwards by g/2.
fn offset_line(plan: &Plan<'_>, edge: usize) -> Line {
    let [from, to] = plan.topology.edges[edge].ends.map(|corner| vertex(plan, corner, edge));
    let line = Line { point: from, direction: (to - from).normalize() };
    Line { point: from + 0.5 * plan.gap * line.outward(), ..line }
}

/// The closed vertex of a border edge's piece at one of its corners, for the profile's own gap.
fn vertex(plan: &Plan<'_>, corner: usize, edge: usize) -> Point {
    let frame = &plan.frames[corner];
    let leaves = plan.topology.edges[edge].ends[0] == corner;
    let above = match frame.kind {
        // A slit that comes from a T-junction leaves the sheet between two vertices in one place.
        CornerKind::Exit { exit } if plan.topology.edges[exit].hinge.is_none() => return frame.middle,
        CornerKind::Exit { .. } => leaves,
        CornerKind::Concave { in_line_leaves, .. } => leaves == in_line_leaves,
        CornerKind::Inner { .. }
        | CornerKind::Tee { .. }
        | CornerKind::Bend { .. }
        | CornerKind::BorderHinge { .. }
        | CornerKind::Junction
        | CornerKind::Free => return frame.middle,
    };
    frame.middle + if above { 0.5 } else { -0.5 } * plan.gap * frame.normal
}
