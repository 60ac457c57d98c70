//! Corners on the border of the sheet or of a hole in it.

use kurbo::{Point, Vec2};

use super::{Corner, Sheet, between, crossing, towards};
use crate::fabrication::layout::{CutKind, CutPath, PathVertex};
use crate::verify::grooves::FLAT;

/// A border that turns by less has one vertex at its corner, radians.
const ROUND: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// A line: a point and a unit direction.
type Straight = (Point, Vec2);

impl Sheet<'_> {
    /// What comes to a corner on the border; `None` where that is not known.
    pub(super) fn border_corner(&self, corner: usize) -> Option<Corner> {
        let edges = self.topology.fans[corner].edges.as_slice();
        let [leaves, .., arrives] = *edges else { return None };
        let hinged = |edge: usize| self.hinge(corner, edge).is_some();
        match edges[1..edges.len() - 1] {
            [] => Some(self.free(corner, arrives, leaves)),
            [edge] if hinged(edge) => Some(self.border_hinge(corner, edge, arrives, leaves)),
            [edge] => Some(self.exit(corner, edge, arrives, leaves)),
            [a, b] if hinged(a) && !hinged(b) => Some(self.concave(corner, [a, b], leaves, arrives)),
            [a, b] if hinged(b) && !hinged(a) => Some(self.concave(corner, [b, a], arrives, leaves)),
            _ => None,
        }
    }

    /// The border beside an edge, g/2 outside of the line through two points on its piece.
    fn beside(&self, from: Point, to: Point) -> Straight {
        let direction = (to - from).normalize();
        (from - 0.5 * self.gap * direction.turn_90(), direction)
    }

    /// The border's line beside a border edge.
    fn outline(&self, edge: usize) -> Straight {
        let [from, to] = self.topology.edges[edge].ends.map(|corner| self.border_vertex(corner, edge));
        self.beside(from, to)
    }

    /// The vertex of a border edge's piece, where hinges stand g apart even if the design's do not.
    fn border_vertex(&self, corner: usize, edge: usize) -> Point {
        let edges = self.topology.fans[corner].edges.as_slice();
        let at = self.place(corner);
        match edges[1..edges.len() - 1] {
            [slit] if self.hinge(corner, slit).is_none() && self.topology.edges[slit].hinge.is_some() => {
                let above = if edges[0] == edge { 0.5 } else { -0.5 };
                at + above * self.gap * self.exit_normal(corner, slit)
            }
            [a, b] if self.hinge(corner, a).is_some() != self.hinge(corner, b).is_some() => {
                let first = self.hinge(corner, a).is_some();
                let [hinged, slit] = if first { [a, b] } else { [b, a] };
                let (in_line, other) = if first { (edges[0], edges[3]) } else { (edges[3], edges[0]) };
                let (middle, normal) = self.stepped(corner, [hinged, slit], in_line, other);
                middle + if edge == in_line { 0.5 } else { -0.5 } * self.gap * normal
            }
            _ => at,
        }
    }

    /// One piece alone: its corner, rounded where it is sharp.
    fn free(&self, corner: usize, arrives: usize, leaves: usize) -> Corner {
        let at = self.place(corner);
        let (before, after) = (self.outline(arrives), self.outline(leaves));
        let out = [before, after].map(|(_, direction)| -direction.turn_90());
        let angle = turn(before, after);
        let radius = 0.5 * self.gap;
        if angle > ROUND {
            let [from, to] = out.map(|out| at + radius * out);
            let vertices = [(from, (0.25 * angle).tan()), (to, 0.0)];
            let vertices = vertices.map(|(point, bulge)| PathVertex { point, bulge }).into();
            let arc = CutPath { kind: CutKind::Border, vertices, closed: false };
            let more = arc.segments(FLAT).into_iter().map(|ends| (leaves, ends)).collect();
            return Corner { ends: vec![(arrives, vec![from]), (leaves, vec![to])], more };
        }
        let outward = out[0] + out[1];
        let outward = if outward.length() > 0.1 { outward.normalize() } else { out[0] };
        let concave = (angle < -ROUND).then(|| crossing(before, after)).flatten();
        let point = vec![concave.unwrap_or(at + radius * outward)];
        Corner { ends: vec![(arrives, point.clone()), (leaves, point)], more: Vec::new() }
    }

    /// Two pieces that are hinged at the border: it runs straight past their ligament.
    fn border_hinge(&self, corner: usize, edge: usize, arrives: usize, leaves: usize) -> Corner {
        let at = self.place(corner);
        let normal = self.across(corner, [arrives, leaves], edge);
        let along = -normal.turn_90();
        let pole = self.hinge(corner, edge).map_or(0.0, |hinge| self.pole(hinge));
        let foot = at - (0.5 * self.gap - pole) * normal;
        let end = foot + self.gap * normal;
        let [before, after] = [(arrives, -along), (leaves, along)].map(|(border, along)| {
            let reach = self.border_reach(corner, border, edge, foot, (normal, along));
            (border, vec![foot + reach * along, foot])
        });
        let more = self.bar(edge, end, normal).into_iter().collect();
        Corner { ends: vec![before, after, (edge, vec![end])], more }
    }

    /// How far the border runs straight past a ligament: where it then turns into the sheet, so far that it keeps away from
    /// the end of the bar.
    fn border_reach(
        &self,
        corner: usize,
        border: usize,
        hinged: usize,
        foot: Point,
        (normal, along): (Vec2, Vec2),
    ) -> f64 {
        let edge = &self.topology.edges[hinged];
        let length = edge.hinge.map_or(0.0, |hinge| self.lengths[hinge.id]);
        let far = self.far(corner, border) - 0.5 * self.gap * self.outline(border).1.turn_90();
        let least = self.reach(corner, border, &[hinged]);
        // Solved by repetition: a longer reach turns a little more.
        let needed = (0..8).fold(least, |reach, _| {
            let onwards = far - (foot + reach * along);
            let turn = onwards.dot(normal).atan2(onwards.dot(along)).max(0.0);
            reach.max(0.5 * (length - self.kerf) + self.gap * (0.5 * turn).tan() + 0.2 * self.kerf)
        });
        needed.min(0.35 * self.place(corner).distance(self.far(corner, border)))
    }

    /// Square to a slit that runs out, towards the piece whose border leaves.
    fn exit_normal(&self, corner: usize, slit: usize) -> Vec2 {
        let edges = &self.topology.fans[corner].edges;
        let along = self.place(corner) - self.far(corner, slit);
        let [leaves, arrives] = [edges[0], edges[edges.len() - 1]].map(|edge| self.vertex(corner, edge));
        between(arrives, leaves).unwrap_or_else(|| along.normalize().turn_90())
    }

    /// Two pieces whose slit runs out of the sheet.
    fn exit(&self, corner: usize, slit: usize, arrives: usize, leaves: usize) -> Corner {
        let at = self.place(corner);
        let along = towards(self.exit_normal(corner, slit).turn_90(), at - self.far(corner, slit));
        let (before, after) = (self.outline(arrives), self.outline(leaves));
        let sharp = (turn(before, after).abs() > ROUND).then(|| crossing(before, after)).flatten();
        let end = sharp.unwrap_or_else(|| {
            let outward = -(before.1 + after.1).turn_90();
            at + 0.5 * self.gap / (0.5 * along.dot(outward)).max(0.5) * along
        });
        let ends = vec![(slit, vec![at, end]), (arrives, vec![end]), (leaves, vec![end])];
        Corner { ends, more: Vec::new() }
    }

    /// Where the slit passes a corner of three pieces, and the unit vector from there to the hinge.
    fn stepped(
        &self,
        corner: usize,
        [hinged, slit]: [usize; 2],
        in_line: usize,
        other: usize,
    ) -> (Point, Vec2) {
        let hinge = self.vertex(corner, hinged);
        let normal = between(self.vertex(corner, other), hinge)
            .unwrap_or_else(|| self.across(corner, [in_line, slit], hinged));
        (hinge - hinge.distance(self.place(corner)) * normal, normal)
    }

    /// Three pieces at a step of the border: the slit passes the hinge in line with one of the border edges.
    fn concave(&self, corner: usize, [hinged, slit]: [usize; 2], in_line: usize, other: usize) -> Corner {
        let (middle, normal) = self.stepped(corner, [hinged, slit], in_line, other);
        let along = towards(normal.turn_90(), self.far(corner, slit) - self.place(corner));
        let out = crossing((middle, along), self.outline(other)).unwrap_or(middle - 0.5 * self.gap * along);
        let inwards = middle + self.reach(corner, slit, &[hinged]) * along;
        let reach = self.border_reach(corner, in_line, hinged, middle, (normal, -along));
        let end = middle + self.gap * normal;
        let mut ends = vec![(hinged, vec![end]), (slit, vec![inwards, out]), (other, vec![out])];
        // Very short ligaments end before the border's corner.
        let beyond = reach > middle.distance(out) + self.kerf;
        let past = beyond.then(|| middle - reach * along);
        ends.push((in_line, past.into_iter().chain([out]).collect()));
        Corner { ends, more: self.bar(hinged, end, normal).into_iter().collect() }
    }
}

/// By how much the border turns, radians, positive to the left.
fn turn((_, before): Straight, (_, after): Straight) -> f64 {
    before.cross(after).atan2(before.dot(after))
}
