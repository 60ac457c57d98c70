//! The cut along a rim: its sides, and at every hinge the window's end beside the ligament.

use kurbo::{Point, Vec2};

use super::neck::{Neck, root_radius};
use super::rim::{Rim, Side};
use crate::fabrication::error::FabricationError;
use crate::fabrication::layout::{CutKind, CutPath, PathVertex};
use crate::kirigami::design::Design;
use crate::profile::Profile;

/// A side that climbs less steeply than this from the ligament's axis never leaves it.
const LEAST_CLIMB: f64 = 0.05;
/// Shorter arcs and walls are left out, millimetres: verification allows none below 0.01 mm.
const SHORTEST: f64 = 0.011;

/// Sizes that are the same at all hinges, millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Tool {
    /// Distance of the flats' centre lines from the hinge point.
    reach: f64,
    /// Radius of the centre line at the ligaments' roots.
    root: f64,
    kerf: f64,
}

/// A vertex of the cut before rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Corner {
    point: Point,
    radius: f64,
}

/// The cut of one rim.
#[derive(Debug, Clone, PartialEq)]
pub struct Traced {
    /// The closed cut.
    pub path: CutPath,
    /// Hinges on the rim, and the vertices at which their flats begin.
    pub flats: Vec<(usize, usize)>,
}

/// Traces a rim.
///
/// # Errors
/// A side without room for the ligaments at its ends, or a hinge whose window is too narrow or too wide.
pub fn trace(
    rim: &Rim,
    design: &Design,
    necks: &[Neck],
    profile: &Profile,
) -> Result<Traced, FabricationError> {
    let (width, kerf) = (profile.ligament.width, profile.cut.kerf);
    let tool = Tool { reach: 0.5 * (width + kerf), root: root_radius(profile), kerf };
    let count = rim.nodes.len();
    let mut corners: Vec<Corner> = Vec::new();
    let mut flats = Vec::new();
    // First and last corner of every node.
    let mut spans = Vec::with_capacity(count);
    for (i, node) in rim.nodes.iter().enumerate() {
        let [before, after] = [&rim.sides[(i + count - 1) % count], &rim.sides[i]];
        let first = corners.len();
        match node.hinge {
            None => corners.push(free_corner(before, after, tool)),
            Some(hinge) => {
                let first_piece = design.hinges[hinge].pieces[0] == before.piece;
                let along = if first_piece { necks[hinge].along } else { -necks[hinge].along };
                let neck = &necks[hinge];
                let end = WindowEnd { centre: neck.centre, along, half_length: 0.5 * neck.length, tool };
                let roots = [end.root(before, false), end.root(after, true)];
                let [arriving, mut leaving] = roots.map(|root| {
                    root.map_err(|reason| {
                        let Point { x, y } = node.point;
                        FabricationError::WindowCorner { hinge, x, y, reason }
                    })
                });
                corners.extend(arriving?);
                flats.push((hinge, corners.len() - 1));
                leaving.iter_mut().for_each(|corners| corners.reverse());
                corners.extend(leaving?);
            }
        }
        spans.push([first, corners.len() - 1]);
    }
    let cuts: Vec<f64> = (0..corners.len()).map(|i| tangent(&corners, i).0).collect();
    for (i, side) in rim.sides.iter().enumerate() {
        let [from, to] = [spans[i][1], spans[(i + 1) % count][0]];
        check_side(side, [corners[from].point, corners[to].point], cuts[from] + cuts[to], kerf)?;
    }
    let (vertices, starts) = rounded(&corners);
    let kind = if rim.border && area(&vertices) > 0.0 { CutKind::Border } else { CutKind::Window };
    flats.iter_mut().for_each(|(_, at)| *at = starts[*at]);
    Ok(Traced { path: CutPath { kind, vertices, closed: true }, flats })
}

/// A piece's own corner at the border: convex ones are rounded like those of a closed sheet.
fn free_corner(before: &Side, after: &Side, tool: Tool) -> Corner {
    let ([a, b], [c, d]) = (before.shifted(), after.shifted());
    let (u, v) = (b - a, d - c);
    let area = u.cross(v);
    let straight = area.abs() < 1e-3 * u.length() * v.length();
    let point = if straight { b.midpoint(c) } else { a + (c - a).cross(v) / area * u };
    let turn = u.cross(v).atan2(u.dot(v));
    let room = 0.3 * u.length().min(v.length()) / (0.5 * turn).tan().abs().max(1e-9);
    let radius = if straight || turn < 0.0 { 0.0 } else { tool.reach.min(room) };
    Corner { point, radius }
}

/// The end of a window beside a ligament.
#[derive(Debug, Clone, Copy)]
struct WindowEnd {
    centre: Point,
    /// Along the ligament in the rim's travelling direction.
    along: Vec2,
    half_length: f64,
    tool: Tool,
}

impl WindowEnd {
    /// The corners between a side and the flat, on the side's half of the ligament: the wall's top if there is a
    /// wall, then the flat's end. `leaves`: whether the side leaves the hinge.
    fn root(&self, side: &Side, leaves: bool) -> Result<Vec<Corner>, &'static str> {
        let Tool { reach, root, .. } = self.tool;
        let mut ends = side.shifted();
        if !leaves {
            ends.reverse();
        }
        // x outwards along the ligament on this half, y out of the ligament into the window.
        let outwards = if leaves { self.along } else { -self.along };
        let into_window = -self.along.turn_90();
        let near = ends[0] - self.centre;
        let far = (ends[1] - ends[0]).normalize();
        let [x, y] = [near.dot(outwards), near.dot(into_window)];
        let [dx, dy] = [far.dot(outwards), far.dot(into_window)];
        let place = |x: f64, y: f64| self.centre + x * outwards + y * into_window;
        if dy < LEAST_CLIMB {
            return Err(
                "the window beside it is too wide: its piece's side runs along the ligament; change the pattern \
                        there",
            );
        }
        let natural = x + (reach - y) / dy * dx;
        let tangent = root * (0.5 * dy.atan2(dx)).tan();
        let wall_x = self.half_length + root;
        let wall = if dx > 0.0 { y + (wall_x - x) / dx * dy - reach } else { f64::INFINITY };
        if natural - tangent >= self.half_length || wall < SHORTEST {
            return Ok(vec![Corner { point: place(natural, reach), radius: root }]);
        }
        if dx < LEAST_CLIMB {
            return Err("the window beside it is too narrow for its ligament: let the hinge turn further");
        }
        let flat_end = Corner { point: place(wall_x, reach), radius: root.min(wall - SHORTEST) };
        Ok(vec![Corner { point: place(wall_x, reach + wall), radius: 0.0 }, flat_end])
    }
}

/// What is left of a side between the cuts at its ends must be longer than a kerf.
fn check_side(side: &Side, ends: [Point; 2], rounding: f64, kerf: f64) -> Result<(), FabricationError> {
    let left = (ends[1] - ends[0]).dot(side.direction()) - rounding;
    if left > kerf {
        return Ok(());
    }
    let (length, Point { x, y }) = (side.ends[0].distance(side.ends[1]), side.ends[0].midpoint(side.ends[1]));
    Err(FabricationError::ShortSide { piece: side.piece, x, y, length, needed: length - left + kerf })
}

/// How far before and after a corner its rounding begins and ends, and by how much the path turns there.
fn tangent(corners: &[Corner], i: usize) -> (f64, f64) {
    let count = corners.len();
    let [before, here, after] = [i + count - 1, i, i + 1].map(|i| corners[i % count].point);
    let (u, v) = (here - before, after - here);
    let turn = u.cross(v).atan2(u.dot(v));
    (corners[i].radius * (0.5 * turn.abs()).tan(), turn)
}

/// Corners with their roundings as arcs; and per corner the vertex from which the segment to the next one leaves.
fn rounded(corners: &[Corner]) -> (Vec<PathVertex>, Vec<usize>) {
    let count = corners.len();
    let mut vertices = Vec::with_capacity(2 * count);
    let mut starts = Vec::with_capacity(count);
    for (i, corner) in corners.iter().enumerate() {
        let (cut, turn) = tangent(corners, i);
        let towards = |other: usize| (corners[other % count].point - corner.point).normalize();
        // The arc's chord; machines stutter over shorter ones, and a sharp corner is as good.
        if 2.0 * cut * (0.5 * turn).cos() > SHORTEST {
            let point = corner.point + cut * towards(i + count - 1);
            vertices.push(PathVertex { point, bulge: (0.25 * turn).tan() });
            starts.push(vertices.len());
            vertices.push(PathVertex { point: corner.point + cut * towards(i + 1), bulge: 0.0 });
        } else {
            starts.push(vertices.len());
            vertices.push(PathVertex { point: corner.point, bulge: 0.0 });
        }
    }
    (vertices, starts)
}

/// Signed area of the polygon through the vertices, positive counter-clockwise.
fn area(vertices: &[PathVertex]) -> f64 {
    let next = |i: usize| vertices[(i + 1) % vertices.len()].point.to_vec2();
    (0..vertices.len()).map(|i| 0.5 * vertices[i].point.to_vec2().cross(next(i))).sum()
}
