//! Slits and relief bars: open paths, built from the corners' frames.
//!
//! The slit of an edge ends on the relief bar, in front of the ligament of its own hinge, and passes the corner at
//! its other end in a straight stretch along the other hinges' ligaments. So every inner corner of four pieces gives one
//! slit of two edges, every exit one of one edge, every junction one per edge, and every hinge one relief bar. A narrow
//! cut that ends inside the sheet is a slit from its end to where the border's cut turns back.

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
}

impl<'a> Plan<'a> {
    /// Gathers the parts; `gap` and `kerf` come from the profile.
    pub fn new(
        topology: &'a Topology,
        frames: &'a [CornerFrame],
        junctions: &'a BTreeMap<usize, Junction>,
        lengths: &'a [f64],
        profile: &Profile,
    ) -> Self {
        Plan { topology, frames, junctions, lengths, gap: profile.hinge_gap(), kerf: profile.cut.kerf }
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
                let normal = if hinged[0] == edge { frame.normal } else { -frame.normal };
                Some((frame.middle + self.gap * normal, normal))
            }
            CornerKind::Concave { .. } => Some((frame.middle + self.gap * frame.normal, frame.normal)),
            CornerKind::BorderHinge { .. } => {
                Some((frame.middle + 0.5 * self.gap * frame.normal, frame.normal))
            }
            CornerKind::Junction => {
                let &(foot, normal) = self.junctions.get(&corner)?.feet.get(&edge)?;
                Some((foot + self.gap * normal, normal))
            }
            CornerKind::Exit { .. } | CornerKind::Free => None,
        }
    }
}

/// A slit's centre line and the hinges at its two ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Slit {
    /// The corner that it passes, where it exits or where it meets others.
    pub corner: usize,
    /// Centre line from the first hinge's relief bar (or from another cut) to the second's, or to the border.
    pub points: Vec<Point>,
    /// The hinges at its ends, where it ends at one.
    pub hinges: [Option<usize>; 2],
    /// Whether the last point lies on the border's cut.
    pub exits: bool,
}

/// All slits, in the corners' order.
pub fn slits(plan: &Plan<'_>) -> Vec<Slit> {
    (0..plan.frames.len()).flat_map(|corner| slits_at(plan, corner)).collect()
}

fn slits_at(plan: &Plan<'_>, corner: usize) -> Vec<Slit> {
    let frame = &plan.frames[corner];
    let hinge_of = |edge: usize| plan.topology.edges[edge].hinge.map(|hinge| hinge.id);
    let ending = |edge: usize, rest: Vec<Point>, exits: bool| {
        let points: Vec<Point> = plan.slit_end(edge).map(|(end, _)| end).into_iter().chain(rest).collect();
        Slit { corner, points, hinges: [hinge_of(edge), None], exits }
    };
    let slits = match frame.kind {
        CornerKind::Inner { hinged, passing } => passing_slits(plan, corner, hinged, passing),
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

/// The slit between two ligaments, and that of a narrow cut which ends on it.
fn passing_slits(plan: &Plan<'_>, corner: usize, hinged: [usize; 2], passing: [usize; 2]) -> Vec<Slit> {
    let frame = &plan.frames[corner];
    let hinges = plan.hinges_of(&hinged);
    let reach = passing.map(|edge| plan.stretch(corner, edge, &hinges));
    // A border edge stands for a narrow cut.
    let border = |edge: usize| plan.topology.edges[edge].right.is_none();
    let end = |edge: usize| if border(edge) { notch(plan, corner) } else { Some(plan.slit_end(edge)?.0) };
    let [Some(from), Some(to)] = passing.map(end) else { return Vec::new() };
    let points =
        vec![from, frame.middle + reach[0] * frame.tangent, frame.middle - reach[1] * frame.tangent, to];
    let hinge_of = |edge: usize| plan.topology.edges[edge].hinge.map(|hinge| hinge.id);
    let mut slits = vec![Slit { corner, points, hinges: passing.map(hinge_of), exits: border(passing[1]) }];
    let tip = notch(plan, corner).filter(|_| border(hinged[1]));
    slits.extend(tip.map(|tip| notch_slit(corner, [frame.middle, tip])));
    slits
}

/// The slit of a narrow cut, from its end to where the border's cut turns back.
fn notch_slit(corner: usize, ends: [Point; 2]) -> Slit {
    Slit { corner, points: ends.into(), hinges: [None, None], exits: true }
}

/// The relief bar of the hinge on `edge`: its centre line's two ends. The burned bar is as long as the ligament's
/// free length, so the centre line is a kerf shorter. `None` for a border edge.
pub fn relief_bar(plan: &Plan<'_>, edge: usize) -> Option<[Point; 2]> {
    let hinge = plan.topology.edges[edge].hinge?;
    let (end, normal) = plan.slit_end(edge)?;
    let half = 0.5 * (plan.lengths[hinge.id] - plan.kerf) * normal.turn_90();
    Some([end - half, end + half])
}
