//! Slits and relief bars: open paths, built from the corners' frames.
//!
//! The slit of an edge ends on the relief bar, in front of the ligament of its own hinge, and passes the corner at
//! its other end in a straight stretch along the other hinges' ligaments. A notch has no bar: the slit's own round end
//! stands there, and the tool's centre is the slit's last point. So every inner corner of four pieces gives one
//! slit of two edges, every exit one of one edge, every junction one per edge, and every hinge one relief bar. In a
//! bistable sheet a slit begins at one rectangle, passes its next corner, turns where it meets the mirrored cell's, and
//! ends at the mirrored rectangle. A narrow cut that ends inside the sheet is a slit from its end to where the border's cut turns back.

use std::collections::BTreeMap;

use kurbo::{Point, Vec2};

use super::border::{exit_point, notch};
use super::frame::{CornerFrame, CornerKind};
use super::junction::Junction;
use crate::fabrication::topology::Topology;
use crate::profile::Profile;

/// A sheet's combinatorics, frames and ligaments: what the cut builders work on.
#[derive(Debug, Clone, Copy)]
pub struct Plan<'a> {
    /// Who meets whom.
    pub topology: &'a Topology,
    /// One frame per corner.
    pub frames: &'a [CornerFrame],
    /// The corners where more slits meet.
    pub junctions: &'a BTreeMap<usize, Junction>,
    /// Free ligament length per hinge, millimetres.
    pub lengths: &'a [f64],
    /// Ligament width plus kerf, millimetres.
    pub gap: f64,
    /// Width of the burned groove, millimetres.
    pub kerf: f64,
    /// What the cuts are made for.
    pub profile: &'a Profile,
}

impl<'a> Plan<'a> {
    /// Gathers the parts; `gap` and `kerf` come from the profile.
    pub fn new(
        topology: &'a Topology,
        frames: &'a [CornerFrame],
        junctions: &'a BTreeMap<usize, Junction>,
        lengths: &'a [f64],
        profile: &'a Profile,
    ) -> Self {
        let (gap, kerf) = (profile.hinge_gap(), profile.cut.kerf);
        Plan { topology, frames, junctions, lengths, gap, kerf, profile }
    }

    /// Half-length of the straight stretch of the cut that passes `hinge`s at a corner, on the side of `edge`:
    /// a kerf longer than the longest ligament's half, but at most 0.35 of the edge.
    pub fn stretch(&self, corner: usize, edge: usize, hinges: &[usize]) -> f64 {
        let longest = hinges.iter().map(|&hinge| self.lengths[hinge]).fold(0.0, f64::max);
        let far = self.topology.edges[edge].far(corner);
        let limit = 0.35 * self.frames[corner].middle.distance(self.frames[far].middle);
        (0.5 * longest + self.kerf).min(limit)
    }

    /// Ids of the hinges on the given edges.
    pub fn hinges_of(&self, edges: &[usize]) -> Vec<usize> {
        edges.iter().filter_map(|&edge| self.topology.edges[edge].hinge.map(|hinge| hinge.id)).collect()
    }

    /// Where the slit of a hinged edge ends, and the unit direction from the hinge along the edge. `None` for a
    /// border edge.
    pub fn slit_end(&self, edge: usize) -> Option<(Point, Vec2)> {
        let corner = self.topology.edges[edge].hinge?.corner;
        let frame = &self.frames[corner];
        match frame.kind {
            CornerKind::Inner { hinged, .. } => {
                let side = usize::from(hinged[0] != edge);
                let normal = if side == 0 { frame.normal } else { -frame.normal };
                Some((frame.middle + (self.gap + frame.spread[side]) * normal, normal))
            }
            CornerKind::Concave { .. } | CornerKind::Tee { .. } => {
                Some((frame.middle + self.gap * frame.normal, frame.normal))
            }
            CornerKind::BorderHinge { .. } => {
                Some((frame.middle + (0.5 * self.gap + frame.shift) * frame.normal, frame.normal))
            }
            CornerKind::Junction => {
                let &(foot, normal) = self.junctions.get(&corner)?.feet.get(&edge)?;
                Some((foot + self.gap * normal, normal))
            }
            CornerKind::Exit { .. } | CornerKind::Bend { .. } | CornerKind::Free => None,
        }
    }
}

/// A slit's centre line and the hinges at its two ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Slit {
    /// The corners that it passes, where it turns, where it exits or where it meets others.
    pub corners: Vec<usize>,
    /// Centre line from the first hinge's relief bar (or from another cut) to the second's, or to the border.
    pub points: Vec<Point>,
    /// The hinges at its ends, where it ends at one.
    pub hinges: [Option<usize>; 2],
    /// Whether the last point lies on the border's cut.
    pub exits: bool,
}

/// All slits, in the corners' order. One whose two walls are cut each for itself is two, one after the other.
pub fn slits(plan: &Plan<'_>) -> Vec<Slit> {
    let mut cut = vec![false; plan.topology.edges.len()];
    (0..plan.frames.len()).flat_map(|corner| slits_at(plan, corner, &mut cut)).collect()
}

/// The slits of a corner whose edges are not `cut` yet; marks those.
fn slits_at(plan: &Plan<'_>, corner: usize, cut: &mut [bool]) -> Vec<Slit> {
    let frame = &plan.frames[corner];
    let mut ending = |edge: usize, rest: Vec<Point>, exits: bool| {
        if cut[edge] {
            return Slit { corners: vec![], points: vec![], hinges: [None; 2], exits };
        }
        let run = run(plan, corner, edge, cut);
        let points: Vec<Point> = run.points.into_iter().rev().chain(rest).collect();
        let corners = run.corners.into_iter().chain([corner]).collect();
        Slit { corners, points, hinges: [run.hinge, None], exits }
    };
    let slits = match frame.kind {
        CornerKind::Inner { hinged, passing } => passing_slits(plan, corner, hinged, passing, cut),
        CornerKind::Tee { passing, .. } | CornerKind::Bend { edges: passing } => {
            through_slit(plan, corner, passing, cut)
        }
        CornerKind::Exit { exit } => {
            vec![ending(exit, [frame.middle].into_iter().chain(exit_point(plan, corner)).collect(), true)]
        }
        CornerKind::Concave { hinged, exit, .. } => {
            let reach = plan.stretch(corner, exit, &plan.hinges_of(&[hinged]));
            let stretch = frame.middle + reach * frame.tangent;
            vec![ending(exit, [stretch].into_iter().chain(exit_point(plan, corner)).collect(), true)]
        }
        CornerKind::Junction => {
            let Some(junction) = plan.junctions.get(&corner) else { return Vec::new() };
            let starts = junction.starts.iter();
            let mut slits: Vec<Slit> =
                starts.map(|&(edge, start)| ending(edge, vec![start], !junction.closed)).collect();
            let ends = junction.tip.zip(notch(plan, corner));
            slits.extend(ends.map(|ends| notch_slit(corner, ends.into())));
            slits
        }
        CornerKind::BorderHinge { .. } | CornerKind::Free => Vec::new(),
    };
    slits.into_iter().filter(|slit| slit.points.len() > 1).collect()
}

/// What a slit does from one of its corners on, along one of its edges.
#[derive(Debug, Default)]
struct Run {
    /// Its points, the end last.
    points: Vec<Point>,
    /// The corners after the first at which it does not end in front of a hinge.
    corners: Vec<usize>,
    /// The hinge in front of which it ends.
    hinge: Option<usize>,
    /// Whether it ends on the border's cut.
    exits: bool,
}

/// Follows a slit from `corner` along `edge` to its end, and marks its edges as cut. It passes T-junctions and turns at
/// bends until it comes to a hinge, to the border or to a junction.
fn run(plan: &Plan<'_>, corner: usize, edge: usize, cut: &mut [bool]) -> Run {
    let mut run = Run::default();
    let (mut corner, mut edge) = (corner, edge);
    while !cut[edge] {
        cut[edge] = true;
        corner = plan.topology.edges[edge].far(corner);
        if let Some(hinge) = plan.topology.edges[edge].hinge_at(corner) {
            run.points.extend(plan.slit_end(edge).map(|(end, _)| end));
            run.hinge = Some(hinge);
            break;
        }
        let frame = &plan.frames[corner];
        run.corners.push(corner);
        let passing = match frame.kind {
            CornerKind::Inner { passing, .. } | CornerKind::Tee { passing, .. } => passing,
            CornerKind::Bend { edges } => edges,
            CornerKind::Exit { .. } => {
                run.points.push(frame.middle);
                run.points.extend(exit_point(plan, corner));
                run.exits = true;
                break;
            }
            CornerKind::Concave { hinged, exit, .. } => {
                let reach = plan.stretch(corner, exit, &plan.hinges_of(&[hinged]));
                run.points.push(frame.middle + reach * frame.tangent);
                run.points.extend(exit_point(plan, corner));
                run.exits = true;
                break;
            }
            CornerKind::Junction => {
                let junction = plan.junctions.get(&corner);
                let start =
                    junction.and_then(|junction| junction.starts.iter().find(|start| start.0 == edge));
                run.points.extend(start.map(|&(_, start)| start));
                run.exits = junction.is_some_and(|junction| !junction.closed);
                break;
            }
            CornerKind::BorderHinge { .. } | CornerKind::Free => break,
        };
        let onwards = if passing[0] == edge { [edge, passing[1]] } else { [edge, passing[0]] };
        run.points.extend(through(plan, corner, onwards, Vec2::ZERO));
        edge = onwards[1];
    }
    run
}

/// The points of a slit that comes to a corner along the first of two edges and goes on along the second: a straight
/// stretch along the ligaments, or one point where there is none.
/// `aside`: how far off the centre line the cut runs there.
fn through(plan: &Plan<'_>, corner: usize, edges: [usize; 2], aside: Vec2) -> Vec<Point> {
    let frame = &plan.frames[corner];
    let (hinges, first) = match frame.kind {
        CornerKind::Inner { hinged, passing } => (plan.hinges_of(&hinged), passing[0]),
        CornerKind::Tee { hinged, passing } => (plan.hinges_of(&[hinged]), passing[0]),
        _ => return vec![frame.middle],
    };
    let forwards = if edges[0] == first { frame.tangent } else { -frame.tangent };
    let reach = edges.map(|edge| plan.stretch(corner, edge, &hinges));
    let middle = frame.middle + aside;
    vec![middle + reach[0] * forwards, middle - reach[1] * forwards]
}

/// The slit through a corner to its two ends, or its two walls; none where it is cut already.
fn through_slit(plan: &Plan<'_>, corner: usize, edges: [usize; 2], cut: &mut [bool]) -> Vec<Slit> {
    if cut[edges[0]] {
        return Vec::new();
    }
    let CornerFrame { normal, spread, .. } = plan.frames[corner];
    let [from, to] = edges.map(|edge| run(plan, corner, edge, cut));
    let (edges, from, to) = if from.exits { ([edges[1], edges[0]], to, from) } else { (edges, from, to) };
    let slit = |aside: Vec2| {
        let middle = through(plan, corner, edges, aside);
        let points = from.points.iter().rev().chain(&middle).chain(&to.points).copied().collect();
        let corners = from.corners.iter().rev().chain([&corner]).chain(&to.corners).copied().collect();
        Slit { corners, points, hinges: [from.hinge, to.hinge], exits: to.exits }
    };
    if spread == [0.0; 2] {
        return vec![slit(Vec2::ZERO)];
    }
    vec![slit(spread[0] * normal), slit(-spread[1] * normal)]
}

/// The slit between two ligaments, and that of a narrow cut which ends on it.
fn passing_slits(
    plan: &Plan<'_>,
    corner: usize,
    hinged: [usize; 2],
    passing: [usize; 2],
    cut: &mut [bool],
) -> Vec<Slit> {
    let frame = &plan.frames[corner];
    // A border edge stands for a narrow cut.
    let border = |edge: usize| plan.topology.edges[edge].right.is_none();
    let mut slits = Vec::new();
    if border(passing[1]) {
        let Some(tip) = notch(plan, corner).filter(|_| !cut[passing[0]]) else { return Vec::new() };
        let from = run(plan, corner, passing[0], cut);
        let middle = through(plan, corner, passing, Vec2::ZERO);
        let points = from.points.into_iter().rev().chain(middle).chain([tip]).collect();
        let corners = from.corners.into_iter().rev().chain([corner]).collect();
        slits.push(Slit { corners, points, hinges: [from.hinge, None], exits: true });
    } else {
        slits.extend(through_slit(plan, corner, passing, cut));
    }
    let tip = notch(plan, corner).filter(|_| border(hinged[1]));
    slits.extend(tip.map(|tip| notch_slit(corner, [frame.middle, tip])));
    slits
}

/// The slit of a narrow cut, from its end to where the border's cut turns back.
fn notch_slit(corner: usize, ends: [Point; 2]) -> Slit {
    Slit { corners: vec![corner], points: ends.into(), hinges: [None, None], exits: true }
}

/// The relief bar of the hinge on `edge`: its centre line's two ends. The burned bar is as long as the ligament's
/// free length, so the centre line is a kerf shorter; that of a round notch is one point. `None` without a hinge.
pub fn relief_bar(plan: &Plan<'_>, edge: usize) -> Option<[Point; 2]> {
    let hinge = plan.topology.edges[edge].hinge?;
    let (end, normal) = plan.slit_end(edge)?;
    let half = 0.5 * (plan.lengths[hinge.id] - plan.kerf) * normal.turn_90();
    Some([end - half, end + half])
}
