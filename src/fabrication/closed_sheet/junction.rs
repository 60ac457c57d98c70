//! Corners where more slits meet than one that passes straight through.
//!
//! At an inner corner of n = 6, 8, ... pieces n/2 slits meet at angles. Cut as a star, each of them would come nearer
//! than the ligament's width to the ends of the relief bars beside it. So the slits end on the corners of a small
//! polygon, which is cut out: each ligament has one of its sides behind it, straight and square to the hinged edge as
//! the passing slit of a corner of four pieces is, and is as wide, as long and as well centred.
//!
//! ```text
//!              \ slit        H  hinge point, g/2 outside the middle of its side
//!     ---       \            g = h + k: ligament's width and kerf
//!      H   _____ v           v  where the sides of two hinges and the slit between them meet
//!     --- |     /
//!         |  m /             f  angle between the normals of the two sides
//!               \            radius: from m to the middles of the sides; v is radius tan(f/2) beside them
//! ```
//!
//! The sides reach at least (l - k)/2 + g tan(turn/2) to either end, l the ligament's free length and turn the angle by
//! which the slit there turns towards the bar: then the bar's end keeps the ligament's width. The radius is the design's,
//! or what that asks for where it is more; the ligament then stands off its hinge point by the difference. Milled ones with ruled
//! walls reach as far as the axis needs to turn ([`turning_reach`]). Where sides
//! do not meet there (nearly parallel ones would meet far off) a short cut joins their ends, and the slit starts from it.
//!
//! Where a narrow cut ends inside the sheet its two sides count as one slit, which the border's cut reaches from outside;
//! at other border corners the polygon is open, and the border's cut runs along it.

use std::collections::BTreeMap;

use kurbo::{Point, Vec2};

use super::border::notch;
use super::frame::{CornerKind, corner_error};
use super::slit::Plan;
use crate::fabrication::error::FabricationError;
use crate::fabrication::gaps::turning_reach;
use crate::fabrication::mechanics::pole_offset;
use crate::kirigami::design::Design;

/// The cuts around the middle of such a corner.
#[derive(Debug, Clone, PartialEq)]
pub struct Junction {
    /// Per hinged edge the middle of the straight cut behind its ligament, and the unit normal of that cut towards the
    /// hinge.
    pub feet: BTreeMap<usize, (Point, Vec2)>,
    /// The polygon, counter-clockwise; at a wide border corner the part of it that the border's cut follows.
    pub outline: Vec<Point>,
    /// The passing edges and where on the outline their slits start.
    pub starts: Vec<(usize, Point)>,
    /// Where on the outline the slit of the narrow cut starts that ends here.
    pub tip: Option<Point>,
    /// Whether the outline is a closed cut of its own.
    pub closed: bool,
}

/// Sides whose normals are less than this apart from being parallel or opposite do not meet in a corner.
const NEARLY_PARALLEL: f64 = 0.2;
/// Nor do those that would meet this many times as far out as they must reach.
const FAR_OUT: f64 = 3.0;

/// The straight cut behind one ligament.
#[derive(Debug, Clone, Copy)]
struct Side {
    edge: usize,
    /// From the corner towards the hinge.
    normal: Vec2,
    /// Distance from the corner.
    radius: f64,
    /// The design's radius.
    least: f64,
    /// Half the relief bar's centre line.
    half_bar: f64,
    /// How far it must reach clockwise and counter-clockwise from its middle.
    reach: [f64; 2],
    /// Where the cuts that go on from its two ends lead.
    towards: [Point; 2],
}

impl Side {
    fn end(&self, middle: Point, counter_clockwise: bool) -> Point {
        let reach = if counter_clockwise { self.reach[1] } else { -self.reach[0] };
        middle + self.radius * self.normal + reach * self.normal.turn_90()
    }
}

/// The junctions among a sheet's corners. `plan` needs none yet.
///
/// # Errors
/// The end of a cut whose two sides overlap, or leave no room for the border's cut between them.
pub fn junctions(plan: &Plan<'_>, design: &Design) -> Result<BTreeMap<usize, Junction>, FabricationError> {
    let mut found = BTreeMap::new();
    for (corner, frame) in plan.frames.iter().enumerate() {
        let border = plan.topology.fans[corner].border;
        if border && matches!(frame.kind, CornerKind::Junction | CornerKind::Inner { .. }) {
            check_room(plan, design, corner)?;
        }
        if frame.kind == CornerKind::Junction {
            found.insert(corner, junction(plan, design, corner));
        }
    }
    Ok(found)
}

/// The end of a cut: whether its sides leave room between them.
fn check_room(plan: &Plan<'_>, design: &Design, corner: usize) -> Result<(), FabricationError> {
    let middle = plan.frames[corner].middle;
    let fan = &plan.topology.fans[corner];
    let far = |edge: usize| plan.frames[plan.topology.edges[edge].far(corner)].middle;
    let turn = |pair: &[usize]| {
        let [a, b] = [pair[0], pair[1]].map(|edge| far(edge) - middle);
        a.cross(b).atan2(a.dot(b)).rem_euclid(2.0 * std::f64::consts::PI)
    };
    let angle = fan.edges.windows(2).map(turn).sum::<f64>().to_degrees();
    if angle > 360.0 {
        let reason = format!(
            "the pieces around the end of this cut take {angle:.1} degrees, more than a full turn: closed, the two \
             sides of the cut overlap, and the flat sheet cannot be cut. Let the cut start elsewhere, or take a \
             target whose sheet needs no cut there"
        );
        return Err(corner_error(design, corner, &reason));
    }
    let sides = [fan.edges[0], fan.edges[fan.edges.len() - 1]];
    let shortest = sides.map(|edge| far(edge).distance(middle)).into_iter().fold(f64::INFINITY, f64::min);
    let narrow = notch(plan, corner).is_none_or(|tip| tip.distance(middle) > 0.6 * shortest);
    if narrow && angle > 330.0 {
        let reason = format!(
            "the two sides of the cut that ends here are only {:.1} degrees apart, too close together for the border's \
             cut to pass between them: leave this cut out, or let it end where it opens",
            360.0 - angle
        );
        return Err(corner_error(design, corner, &reason));
    }
    Ok(())
}

fn junction(plan: &Plan<'_>, design: &Design, corner: usize) -> Junction {
    let middle = plan.frames[corner].middle;
    let fan = &plan.topology.fans[corner];
    let notch = if fan.border { notch(plan, corner) } else { None };
    let mut sides = sides(plan, design, corner, notch.unwrap_or(middle));
    let pairs: Vec<[usize; 2]> = (0..sides.len()).map(|i| [i, (i + 1) % sides.len()]).collect();
    let inside = if fan.border { &pairs[..sides.len() - 1] } else { &pairs[..] };
    // Turns depend on the ends and the ends on the turns, a little.
    for _ in 0..8 {
        let radius = inside.iter().map(|&[i, j]| least_radius(&sides[i], &sides[j])).fold(0.0, f64::max);
        for side in &mut sides {
            side.radius = radius.max(side.least);
            side.reach = [false, true].map(|ccw| needed_reach(plan, side, middle, ccw));
        }
        reach_for_turning(plan, design, corner, inside, &mut sides);
    }
    let feet = sides.iter().map(|s| (s.edge, (middle + s.radius * s.normal, s.normal))).collect();
    let passing = |edge: &usize| plan.topology.edges[*edge].hinge_at(corner).is_none();
    let mut starts = Vec::new();
    let mut outline = Vec::new();
    if !fan.border {
        for (&[i, j], &edge) in pairs.iter().zip(slits_after(plan, corner, &sides).iter()) {
            let (points, start) = joint(&sides[i], &sides[j], middle);
            outline.extend(points);
            starts.push((edge, start));
        }
        return Junction { feet, outline, starts, tip: None, closed: true };
    }
    let [first, last] = [sides[0], sides[sides.len() - 1]];
    let [begin, end] = [first.end(middle, false), last.end(middle, true)];
    let inner = &fan.edges[1..fan.edges.len() - 1];
    for (&[i, j], &edge) in inside.iter().zip(slits_after(plan, corner, &sides).iter()) {
        let (points, start) = joint(&sides[i], &sides[j], middle);
        outline.extend(points);
        starts.push((edge, start));
    }
    let [before, after] = [inner[0], inner[inner.len() - 1]].map(|edge| Some(edge).filter(|e| passing(e)));
    starts.extend(before.map(|edge| (edge, begin)));
    starts.extend(after.map(|edge| (edge, end)));
    let tip = match (before, after) {
        (None, None) | (Some(_), Some(_)) => begin.midpoint(end),
        (None, Some(_)) => begin,
        (Some(_), None) => end,
    };
    let room = tip.distance(middle) + 2.0 * plan.kerf;
    let narrow = notch.is_some_and(|notch| notch.distance(middle) > room);
    outline.insert(0, begin);
    outline.push(end);
    Junction { feet, outline, starts, tip: narrow.then_some(tip), closed: narrow }
}

/// The passing edge after each side, counter-clockwise, that has one.
fn slits_after(plan: &Plan<'_>, corner: usize, sides: &[Side]) -> Vec<usize> {
    let fan = &plan.topology.fans[corner];
    let count = fan.edges.len();
    let at = |side: &Side| fan.edges.iter().position(|&e| e == side.edge).unwrap_or(0);
    sides.iter().map(|side| fan.edges[(at(side) + 1) % count]).collect()
}

fn sides(plan: &Plan<'_>, design: &Design, corner: usize, notch: Point) -> Vec<Side> {
    let middle = plan.frames[corner].middle;
    let fan = &plan.topology.fans[corner];
    let count = fan.edges.len();
    let far = |edge: usize| plan.frames[plan.topology.edges[edge].far(corner)].middle;
    let [leaves, arrives] = [fan.edges[0], fan.edges[count - 1]].map(|edge| far(edge) - middle);
    let narrow = leaves.dot(arrives) > 0.0;
    let towards = |edge: usize| match plan.topology.edges[edge].right {
        None if narrow => notch,
        _ => far(edge),
    };
    let side = |(i, &edge): (usize, &usize)| {
        let hinge = plan.topology.edges[edge].hinge_at(corner)?;
        let ends = [fan.edges[(i + count - 1) % count], fan.edges[(i + 1) % count]].map(towards);
        let point = design.hinges[hinge].point;
        let offset = Point::new(point.x, point.y) - middle;
        // A nanometre: the design has no gap.
        let normal = if offset.length() > 1e-6 {
            offset.normalize()
        } else {
            let across = -(ends[1] - ends[0]).normalize().turn_90();
            if across.dot(far(edge) - middle) < 0.0 { -across } else { across }
        };
        let half_bar = 0.5 * (plan.lengths[hinge] - plan.kerf);
        let pole = pole_offset(plan.profile, plan.lengths[hinge], design.hinges[hinge].angle);
        let least = (offset.length() + pole - 0.5 * plan.gap).max(0.0);
        let reach = [half_bar + 0.3 * plan.kerf; 2];
        Some(Side { edge, normal, radius: least, least, half_bar, reach, towards: ends })
    };
    fan.edges.iter().enumerate().filter_map(side).collect()
}

/// How far the side must reach to one end, so that the cut which goes on from there keeps the ligament's width from the
/// end of the relief bar.
fn needed_reach(plan: &Plan<'_>, side: &Side, middle: Point, counter_clockwise: bool) -> f64 {
    let onwards = side.towards[usize::from(counter_clockwise)] - side.end(middle, counter_clockwise);
    let along = if counter_clockwise { side.normal.turn_90() } else { -side.normal.turn_90() };
    let turn = onwards.dot(side.normal).atan2(onwards.dot(along)).clamp(0.0, 0.5 * std::f64::consts::PI);
    // The part of a kerf is for where exactly the cut goes on to.
    side.half_bar + plan.gap * (0.5 * turn).tan() + 0.3 * plan.kerf
}

/// Where walls are ruled: sides reach as far as the tool's axis needs to turn from one hinge's to the next one's.
fn reach_for_turning(
    plan: &Plan<'_>,
    design: &Design,
    corner: usize,
    pairs: &[[usize; 2]],
    sides: &mut [Side],
) {
    if !plan.profile.cut.ruled {
        return;
    }
    for &[i, j] in pairs {
        if !meet(&sides[i], &sides[j]) {
            continue;
        }
        let hinge = |i: usize| plan.topology.edges[sides[i].edge].hinge_at(corner);
        let (Some(first), Some(second)) = (hinge(i), hinge(j)) else { continue };
        let angle = between(&sides[i], &sides[j]);
        let reach = turning_reach(design, plan.profile, plan.lengths, [first, second], angle);
        sides[i].reach[1] = sides[i].reach[1].max(reach);
        sides[j].reach[0] = sides[j].reach[0].max(reach);
    }
}

/// Angle from the first side's normal to the next one's, counter-clockwise.
fn between(a: &Side, b: &Side) -> f64 {
    a.normal.cross(b.normal).atan2(a.normal.dot(b.normal)).rem_euclid(2.0 * std::f64::consts::PI)
}

fn meet(a: &Side, b: &Side) -> bool {
    (NEARLY_PARALLEL..std::f64::consts::PI - NEARLY_PARALLEL).contains(&between(a, b))
}

/// The common radius at which two sides that meet reach far enough.
fn least_radius(a: &Side, b: &Side) -> f64 {
    if meet(a, b) { a.reach[1].max(b.reach[0]) / (0.5 * between(a, b)).tan() } else { 0.0 }
}

/// The outline's points between a side and the next one, and where the slit between them starts.
fn joint(a: &Side, b: &Side, middle: Point) -> (Vec<Point>, Point) {
    if meet(a, b) {
        let (sin, cos) = between(a, b).sin_cos();
        let beside = [(b.radius - a.radius * cos) / sin, (a.radius - b.radius * cos) / sin];
        let reach = [a.reach[1], b.reach[0]];
        let fits = |i: usize| beside[i] >= reach[i] - 1e-6 && beside[i] <= FAR_OUT * reach[i];
        if fits(0) && fits(1) {
            let point = middle + a.radius * a.normal + beside[0] * a.normal.turn_90();
            return (vec![point], point);
        }
    }
    let [from, to] = [a.end(middle, true), b.end(middle, false)];
    let start = from.midpoint(to);
    if from.distance(to) > 1e-3 { (vec![from, to], start) } else { (vec![start], start) }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::fabrication::closed_sheet::cuts_of;
    use crate::fabrication::closed_sheet::ligament::measure_ligaments;
    use crate::fabrication::layout::CutKind;
    use crate::fabrication::regions::piece_outlines;
    use crate::fabrication::test_sheet::profile;
    use crate::fabrication::web::{CutIndex, check_webs};
    use crate::geometry::{Point3, Vector3};
    use crate::kirigami::design::{Hinge, PatternKind, Piece, State};

    /// `n` kites around one corner, which take the angle `total`; every second spoke is hinged there, `offset` from it,
    /// the others at their far ends, 10 mm out. Where they do not close the first and the last one lie at the border.
    fn star(n: usize, total: f64, offset: f64, first: usize) -> Design {
        let closed_fan = total == 2.0 * PI;
        let spokes = if closed_fan { n } else { n + 1 };
        let at = |radius: f64, part: f64| {
            let angle = 0.3 + total * part / n as f64;
            Point3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        };
        let mut corners = vec![Point3::origin()];
        corners.extend((0..spokes).map(|i| at(10.0, i as f64)));
        corners.extend((0..n).map(|i| at(13.0, i as f64 + 0.5)));
        let piece = |i: usize| {
            let own = vec![0, 1 + i, 1 + spokes + i, 1 + (i + 1) % spokes];
            let mut closed: Vec<Point3> = own.iter().map(|&c| corners[c]).collect();
            let hinged = i + (i + first) % 2;
            let free = !closed_fan && (hinged == 0 || hinged == n);
            closed[0] = at(if free { 0.0 } else { offset }, hinged as f64);
            Piece { corners: own, open: closed.clone(), closed }
        };
        let pieces: Vec<Piece> = (0..n).map(piece).collect();
        let hinge = |i: usize| {
            let vertices = if (i + first).is_multiple_of(2) { [0, 0] } else { [3, 1] };
            let point = pieces[i].closed[vertices[1]];
            Hinge { pieces: [(i + n - 1) % n, i], vertices, point, axis: Vector3::z(), angle: 1.0 }
        };
        let hinges = (usize::from(!closed_fan)..n).map(hinge).collect();
        let pattern = PatternKind::RotatingRectangles;
        Design { pattern, sheet_state: Some(State::Closed), gap: 2.0 * offset, corners, pieces, hinges }
    }

    #[test]
    fn ligaments_around_a_junction_are_as_wide_as_all_others() {
        let profile = profile();
        let (gap, kerf) = (profile.hinge_gap(), profile.cut.kerf);
        for (n, length) in [(6, 0.8), (6, 1.35), (8, 1.1), (10, 0.8)] {
            // The corners of a regular polygon of n/2 sides stand radius * tan(2 pi / n) beside the sides' middles.
            let radius = 1.5 * gap / (2.0 * PI / n as f64).tan();
            for offset in [0.5 * gap + radius, 0.0] {
                let design = star(n, 2.0 * PI, offset, 0);
                let (set, _) = cuts_of(&design, &profile, &vec![length; n]).unwrap();
                let index = CutIndex::new(&set.paths);
                check_webs(&set.paths, &set.touches, &index, kerf, profile.cut.min_web).unwrap();
                let ligaments = measure_ligaments(&design.hinges, &set, &index, &profile);
                for ligament in &ligaments {
                    assert!((ligament.width - profile.ligament.width).abs() < 1e-9, "{n} {ligament:?}");
                    assert!((ligament.length - length).abs() < 1e-9);
                }
                // Where the design leaves the room the hinges stand in the ligaments' middles; else the report says
                // how far off.
                for ligament in ligaments.iter().step_by(2) {
                    assert_eq!(ligament.centre_offset < 1e-9, offset > 0.0, "{n} {ligament:?}");
                    assert!(ligament.centre_offset <= 0.5 * gap + radius);
                }
                assert_eq!(piece_outlines(&design, &set.paths, &ligaments, kerf).unwrap().len(), n);
                let windows = set.paths.iter().filter(|path| path.kind == CutKind::Window);
                assert_eq!(windows.map(|window| window.vertices.len()).collect::<Vec<_>>(), [n / 2]);
            }
        }
    }

    #[test]
    fn cuts_may_end_where_four_or_more_pieces_meet() {
        let profile = profile();
        let kerf = profile.cut.kerf;
        // Four and five pieces, hinged at the first inner spoke or at the second, around narrow wedges and at a straight border.
        for (n, first, wedge) in
            [(4, 1, 30.0), (4, 0, 30.0), (5, 1, 38.0), (5, 0, 38.0), (6, 1, 30.0), (4, 1, 180.0)]
        {
            let design = star(n, (360.0_f64 - wedge).to_radians(), 0.5 * profile.hinge_gap(), first);
            let lengths = vec![0.9; design.hinges.len()];
            let (set, _) = cuts_of(&design, &profile, &lengths).unwrap();
            let index = CutIndex::new(&set.paths);
            let webs = check_webs(&set.paths, &set.touches, &index, kerf, profile.cut.min_web);
            assert!(webs.is_ok(), "{n} {first} {wedge}: {webs:?}");
            let ligaments = measure_ligaments(&design.hinges, &set, &index, &profile);
            for ligament in &ligaments {
                assert!(
                    (ligament.width - profile.ligament.width).abs() < 1e-3,
                    "{n} {first} {wedge} {ligament:?}"
                );
            }
            let outlines = piece_outlines(&design, &set.paths, &ligaments, kerf);
            assert_eq!(outlines.map(|all| all.len()), Ok(n), "{n} {first} {wedge}");
        }
    }

    #[test]
    fn sides_of_a_cut_that_overlap_or_touch_are_refused() {
        let profile = profile();
        for (degrees, says) in [(390.0_f64, "take 390.0 degrees"), (359.0, "1.0 degrees apart")] {
            let design = star(5, degrees.to_radians(), 0.5 * profile.hinge_gap(), 1);
            let error = cuts_of(&design, &profile, &vec![0.9; design.hinges.len()]).unwrap_err().to_string();
            assert!(error.starts_with("corner 0 at (0.00, 0.00) mm") && error.contains(says), "{error}");
        }
    }
}
