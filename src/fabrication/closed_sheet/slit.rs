//! Slits and relief bars: open paths, built from the corners' frames.
//!
//! The slit of an edge ends on the relief bar, in front of the ligament of its own hinge, and passes the corner at
//! its other end in a straight stretch along the other hinges' ligaments. So every inner corner gives one slit of
//! two edges, every exit one of one edge, and every hinge one relief bar.

use kurbo::{Point, Vec2};

use super::border::exit_point;
use super::frame::{CornerFrame, CornerKind};
use crate::fabrication::topology::Topology;
use crate::profile::Profile;

/// A sheet's combinatorics, frames and ligaments: what the cut builders work on.
#[derive(Debug, Clone, Copy)]
pub struct Plan<'a> {
    /// Who meets whom.
    pub topology: &'a Topology,
    /// One frame per corner.
    pub frames: &'a [CornerFrame],
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
        lengths: &'a [f64],
        profile: &Profile,
    ) -> Self {
        Plan { topology, frames, lengths, gap: profile.hinge_gap(), kerf: profile.laser.kerf }
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
            CornerKind::Exit { .. } | CornerKind::Free => None,
        }
    }
}

/// A slit's centre line and the hinges at its two ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Slit {
    /// The corner that it passes or where it exits.
    pub corner: usize,
    /// Centre line from the first hinge's relief bar to the second's, or to the border.
    pub points: Vec<Point>,
    /// The hinge at the first end, and the one at the second unless the slit exits there.
    pub hinges: [Option<usize>; 2],
    /// Whether the last point lies on the border's cut.
    pub exits: bool,
}

/// All slits, one per inner corner and per exit, in the corners' order.
pub fn slits(plan: &Plan<'_>) -> Vec<Slit> {
    (0..plan.frames.len()).filter_map(|corner| slit_at(plan, corner)).collect()
}

fn slit_at(plan: &Plan<'_>, corner: usize) -> Option<Slit> {
    let frame = &plan.frames[corner];
    let hinge_of = |edge: usize| plan.topology.edges[edge].hinge.map(|hinge| hinge.id);
    match frame.kind {
        CornerKind::Inner { hinged, passing } => {
            let hinges = plan.hinges_of(&hinged);
            let reach = passing.map(|edge| plan.stretch(corner, edge, &hinges));
            let points = vec![
                plan.slit_end(passing[0])?.0,
                frame.middle + reach[0] * frame.tangent,
                frame.middle - reach[1] * frame.tangent,
                plan.slit_end(passing[1])?.0,
            ];
            Some(Slit { corner, points, hinges: passing.map(hinge_of), exits: false })
        }
        CornerKind::Exit { exit } => {
            let points = vec![plan.slit_end(exit)?.0, frame.middle, exit_point(plan, corner)?];
            Some(Slit { corner, points, hinges: [hinge_of(exit), None], exits: true })
        }
        CornerKind::Concave { hinged, exit, .. } => {
            let reach = plan.stretch(corner, exit, &plan.hinges_of(&[hinged]));
            let points =
                vec![plan.slit_end(exit)?.0, frame.middle + reach * frame.tangent, exit_point(plan, corner)?];
            Some(Slit { corner, points, hinges: [hinge_of(exit), None], exits: true })
        }
        CornerKind::BorderHinge { .. } | CornerKind::Free => None,
    }
}

/// The relief bar of the hinge on `edge`: its centre line's two ends. The burned bar is as long as the ligament's
/// free length, so the centre line is a kerf shorter. `None` for a border edge.
pub fn relief_bar(plan: &Plan<'_>, edge: usize) -> Option<[Point; 2]> {
    let hinge = plan.topology.edges[edge].hinge?;
    let (end, normal) = plan.slit_end(edge)?;
    let half = 0.5 * (plan.lengths[hinge.id] - plan.kerf) * normal.turn_90();
    Some([end - half, end + half])
}
