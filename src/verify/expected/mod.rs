//! Where the cuts of a sheet should run, from the design and the profile alone.
//!
//! The rules that sheets are laid out by, told a second time and in another way: open sheets in [`mod@open`], closed ones corner by
//! corner the ends of all cuts that come there, and between two corners a straight line. With h the ligament's width, k the kerf and g = h + k:
//!
//! - the slit of a hinged edge ends g beyond the cut that passes its corner, on the middle of the relief bar;
//! - a cut that passes hinges runs straight past them, square to the line on which they stand, over half of the longest
//!   ligament there and a kerf to either side, at most 0.35 of the edge;
//! - the border runs g/2 outside of the pieces, round convex corners as an arc about them, and meets slits that run out in
//!   its own corners.
//!
//! Of lengths only those of the relief bars are read from the file: crowded ones are shorter than their angle asks.

mod border;

mod corners;

mod open;

#[cfg(test)]
mod tests;

use kurbo::{Point, Vec2};
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::fabrication::error::FabricationError;
use crate::fabrication::layout::{CutKind, CutPath};
use crate::fabrication::mechanics::{pole_offset, required_length};
use crate::fabrication::topology::{Topology, topology};
use crate::geometry::Vector2;
use crate::kirigami::design::{Design, Hinge};
use crate::profile::Profile;

pub(super) use open::open;

/// Shorter distances between hinge points are rounding, millimetres: the design has no gap.
const NO_GAP: f64 = 1e-6;

/// A straight piece of what should be cut.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    /// Its ends.
    pub ends: [Point; 2],
    /// The piece beside it.
    pub piece: usize,
    /// The piece on its other side.
    pub other: Option<usize>,
    /// Whether both of its ends are known.
    pub known: bool,
}

/// What should be cut of a sheet.
#[derive(Debug)]
pub(super) struct Expected {
    /// Everywhere but around `unknown`.
    pub lines: Vec<Line>,
    /// Corners at which cuts may run otherwise: where more than one slit passes and the border is near.
    pub unknown: Vec<Point>,
}

/// What comes to a corner.
#[derive(Debug, Default)]
struct Corner {
    /// Per edge the points of its cut, the last one at the corner.
    ends: Vec<(usize, Vec<Point>)>,
    /// Further lines, each with an edge beside it.
    more: Vec<(usize, [Point; 2])>,
}

/// The design's combinatorics with what the rule needs.
struct Sheet<'a> {
    design: &'a Design,
    topology: &'a Topology,
    profile: &'a Profile,
    /// Free length of every hinge's ligament.
    lengths: Vec<f64>,
    gap: f64,
    kerf: f64,
}

/// What should be cut of a closed sheet. `paths`: the cuts, for the bars' lengths.
///
/// # Errors
/// A design that is damaged.
pub(super) fn closed(
    design: &Design,
    profile: &Profile,
    paths: &[CutPath],
) -> Result<Expected, FabricationError> {
    let topology = topology(design)?;
    let lengths = lengths(design, profile, paths);
    let (gap, kerf) = (profile.hinge_gap(), profile.cut.kerf);
    let sheet = Sheet { design, topology: &topology, profile, lengths, gap, kerf };
    let corners: Vec<Option<Corner>> =
        (0..topology.fans.len()).into_par_iter().map(|corner| sheet.corner(corner)).collect();
    let mut expected = Expected { lines: Vec::new(), unknown: Vec::new() };
    let named = |edge: usize, ends, known| {
        let edge = &topology.edges[edge];
        Line { ends, piece: edge.left, other: edge.right, known }
    };
    for (index, edge) in topology.edges.iter().enumerate() {
        let [first, last] = edge.ends.map(|corner| {
            let points = corners[corner].as_ref()?.ends.iter().find(|(of, _)| *of == index);
            points.map(|(_, points)| points.clone())
        });
        let known = first.is_some() && last.is_some();
        let guess = |corner: usize| vec![sheet.place(corner)];
        let mut points = first.unwrap_or_else(|| guess(edge.ends[0]));
        points.reverse();
        points.extend(last.unwrap_or_else(|| guess(edge.ends[1])));
        expected.lines.extend(points.windows(2).map(|pair| named(index, [pair[0], pair[1]], known)));
    }
    for (corner, found) in corners.into_iter().enumerate() {
        match found {
            Some(Corner { more, .. }) => {
                expected.lines.extend(more.into_iter().map(|(edge, ends)| named(edge, ends, true)));
            }
            None => expected.unknown.push(sheet.place(corner)),
        }
    }
    Ok(expected)
}

/// The free length of every ligament: that of its bar, or what its angle asks for.
fn lengths(design: &Design, profile: &Profile, paths: &[CutPath]) -> Vec<f64> {
    let longest = profile.ligament_lengths()[1];
    let bars = paths.iter().filter(|path| path.kind == CutKind::Relief).map(|path| {
        let [from, to] = [0, path.vertices.len() - 1].map(|i| path.vertices[i].point);
        let middle = from.midpoint(to);
        GeomWithData::new([middle.x, middle.y], from.distance(to) + profile.cut.kerf)
    });
    let bars = RTree::bulk_load(bars.collect());
    // Bars stand half of this or all of it from their hinge point, into its two pieces.
    let gap = profile.hinge_gap();
    let of_hinge = |hinge: &Hinge| {
        let asked = required_length(profile, hinge.angle).unwrap_or(longest);
        let point = hinge.point.coords.xy();
        let vertices = hinge.pieces.iter().flat_map(|&piece| &design.pieces[piece].closed);
        let inwards: Vector2 = vertices.map(|vertex| vertex.coords.xy() - point).sum();
        let at = point + 0.75 * gap * inwards.try_normalize(NO_GAP).unwrap_or_default();
        let bar = bars.nearest_neighbor(&[at.x, at.y]);
        let near = bar.filter(|bar| (at.x - bar.geom()[0]).hypot(at.y - bar.geom()[1]) < 0.75 * gap);
        // Never longer than it should be.
        near.map_or(asked, |bar| asked.min(bar.data))
    };
    design.hinges.iter().map(of_hinge).collect()
}

impl Sheet<'_> {
    fn corner(&self, corner: usize) -> Option<Corner> {
        if self.topology.fans[corner].border { self.border_corner(corner) } else { self.inner_corner(corner) }
    }

    fn place(&self, corner: usize) -> Point {
        let at = self.design.corners[corner];
        Point::new(at.x, at.y)
    }

    /// Where the other end of an edge is.
    fn far(&self, corner: usize, edge: usize) -> Point {
        self.place(self.topology.edges[edge].far(corner))
    }

    /// The vertex at a corner of the piece to the left of an edge.
    fn vertex(&self, corner: usize, edge: usize) -> Point {
        let piece = &self.design.pieces[self.topology.edges[edge].left];
        let at = piece.corners.iter().position(|&other| other == corner).unwrap_or(0);
        Point::new(piece.closed[at].x, piece.closed[at].y)
    }

    /// The hinge on an edge if it stands at a corner.
    fn hinge(&self, corner: usize, edge: usize) -> Option<usize> {
        self.topology.edges[edge].hinge_at(corner)
    }

    /// How far the middle of a hinge's ligament stands off its point.
    fn pole(&self, hinge: usize) -> f64 {
        pole_offset(self.profile, self.lengths[hinge], self.design.hinges[hinge].angle)
    }

    /// How far a cut runs straight past the ligaments of hinged edges, on the side of one of its own.
    fn reach(&self, corner: usize, edge: usize, hinged: &[usize]) -> f64 {
        let longest = hinged.iter().filter_map(|&edge| self.topology.edges[edge].hinge);
        let longest = longest.map(|hinge| self.lengths[hinge.id]).fold(0.0, f64::max);
        let most = 0.35 * self.place(corner).distance(self.far(corner, edge));
        (0.5 * longest + self.kerf).min(most)
    }

    /// The relief bar of the hinge on an edge whose slit ends at `end`, square to `normal`.
    fn bar(&self, edge: usize, end: Point, normal: Vec2) -> Option<(usize, [Point; 2])> {
        let hinge = self.topology.edges[edge].hinge?;
        let half = 0.5 * (self.lengths[hinge.id] - self.kerf) * normal.turn_90();
        // A round notch has none.
        (half.length() > NO_GAP).then(|| (edge, [end - half, end + half]))
    }

    /// Unit normal of the chord between the far ends of two edges, on the side of a third.
    fn across(&self, corner: usize, [from, to]: [usize; 2], side: usize) -> Vec2 {
        let normal = (self.far(corner, to) - self.far(corner, from)).turn_90().normalize();
        if normal.dot(self.far(corner, side) - self.place(corner)) < 0.0 { -normal } else { normal }
    }
}

/// The unit vector between two hinge points; `None` where they coincide.
fn between(from: Point, to: Point) -> Option<Vec2> {
    let way = to - from;
    (way.length() > NO_GAP).then(|| way.normalize())
}

/// A direction, turned round if it points away from another.
fn towards(direction: Vec2, guide: Vec2) -> Vec2 {
    if direction.dot(guide) < 0.0 { -direction } else { direction }
}

/// Where two lines, each a point and a direction, meet; `None` if they are parallel within a degree.
fn crossing((a, u): (Point, Vec2), (b, v): (Point, Vec2)) -> Option<Point> {
    let sine = u.cross(v) / (u.length() * v.length());
    (sine.abs() > 0.02).then(|| a + (b - a).cross(v) / u.cross(v) * u)
}
