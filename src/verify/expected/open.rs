//! Where the cuts of an open sheet should run, side by side of every piece.
//!
//! A cut runs along each side, or as far inside of it as the closed pieces' tilt asks for. Beside a hinge it turns to the flat
//! (h + k)/2 beside the ligament's axis, where it meets it, or where the ligament is longer than that, over a wall that
//! stands a root's radius beyond the ligament's end; it turns with the root's radius. A piece's own corner at the
//! border is rounded by (h + k)/2 where it is convex.

use std::collections::HashMap;

use kurbo::{Point, Vec2};
use rayon::prelude::*;

use super::{Expected, Line, crossing};
use crate::fabrication::layout::{CutKind, CutPath, PathVertex};
use crate::fabrication::mechanics::{pole_offset, required_length};
use crate::fabrication::states::motions;
use crate::geometry::Vector3;
use crate::geometry::rotation::RigidMotion;
use crate::kirigami::design::{Design, Hinge, PatternKind};
use crate::profile::{Profile, Shape};
use crate::verify::grooves::FLAT;

/// The burned radius at a ligament's root, in its widths.
const ROOT: f64 = 0.25;
/// Arcs with a shorter chord and lower walls are left out, millimetres; a wall keeps as much beside its arc.
const SHORTEST: f64 = 0.011;
/// A piece's corner whose sine is less is straight.
const STRAIGHT: f64 = 1e-3;

/// A line: a point and a unit direction.
type Straight = (Point, Vec2);

/// What should be cut of an open sheet.
pub(in crate::verify) fn open(design: &Design, profile: &Profile) -> Expected {
    let sheet = Sheet::new(design, profile);
    let sides = design.pieces.iter().enumerate();
    let sides: Vec<(usize, usize)> =
        sides.flat_map(|(piece, of)| (0..of.open.len()).map(move |side| (piece, side))).collect();
    let lines = sides.into_par_iter().flat_map_iter(|(piece, side)| {
        let other = sheet.other(piece, side);
        let points = sheet.points(piece, side);
        let line = |pair: &[Point]| Line { ends: [pair[0], pair[1]], piece, other, known: true };
        points.windows(2).map(line).collect::<Vec<_>>()
    });
    Expected { lines: lines.collect(), unknown: Vec::new() }
}

struct Sheet<'a> {
    design: &'a Design,
    profile: &'a Profile,
    motions: Vec<RigidMotion>,
    /// The piece to the left of a way from one corner to the next.
    pieces: HashMap<[usize; 2], usize>,
    /// The hinge at a piece's vertex.
    hinges: HashMap<(usize, usize), usize>,
    /// The middle of each hinge's ligament, and its direction from the hinge's first piece to the second.
    ligaments: Vec<Straight>,
    /// Distance of a flat from its hinge point.
    beside: f64,
    /// Radius of the cut at roots.
    root: f64,
}

impl<'a> Sheet<'a> {
    fn new(design: &'a Design, profile: &'a Profile) -> Self {
        let mut pieces = HashMap::new();
        for (piece, corners) in design.pieces.iter().map(|piece| &piece.corners).enumerate() {
            for i in 0..corners.len() {
                pieces.insert([corners[i], corners[(i + 1) % corners.len()]], piece);
            }
        }
        let ends = |(id, hinge): (usize, &Hinge)| [0, 1].map(|i| ((hinge.pieces[i], hinge.vertices[i]), id));
        let hinges = design.hinges.iter().enumerate().flat_map(ends).collect();
        let ligaments = design.hinges.iter().map(|hinge| ligament(design, profile, hinge)).collect();
        let (width, kerf) = (profile.ligament.width, profile.cut.kerf);
        let root = (ROOT * width - 0.5 * kerf).max(0.0);
        let beside = 0.5 * (width + kerf);
        Sheet { design, profile, motions: motions(design), pieces, hinges, ligaments, beside, root }
    }

    /// The piece on the other side of the closed edge along which a side lies.
    fn other(&self, piece: usize, side: usize) -> Option<usize> {
        let corners = &self.design.pieces[piece].corners;
        self.pieces.get(&[corners[(side + 1) % corners.len()], corners[side]]).copied()
    }

    /// The line of the cut along a side, in the sense of its piece.
    fn line(&self, piece: usize, side: usize) -> (Straight, f64) {
        let [from, to] = vertices(self.design, piece, [side, side + 1]);
        let direction = (to - from).normalize();
        let inset = self.other(piece, side).map_or(0.0, |other| {
            let [a, b] = [piece, other].map(|piece| self.motions[piece].rotation * Vector3::z());
            let tilt = a.angle(&b).min(std::f64::consts::FRAC_PI_2);
            let room = self.profile.sheet.thickness * (0.5 * tilt).tan();
            (0.5 * (room - self.profile.cut.kerf)).max(0.0)
        });
        ((from + inset * direction.turn_90(), direction), from.distance(to))
    }

    /// The cut along a side, with the halves of the flats at its ends.
    fn points(&self, piece: usize, side: usize) -> Vec<Point> {
        let count = self.design.pieces[piece].open.len();
        let ((from, direction), length) = self.line(piece, side);
        let mut points = match self.hinges.get(&(piece, side)) {
            Some(&hinge) => self.root(piece, hinge, (from, direction), true),
            // Of the arc there only the end: the side before has the rest.
            None => self.free(piece, (side + count - 1) % count).pop().into_iter().collect(),
        };
        points.reverse();
        match self.hinges.get(&(piece, (side + 1) % count)) {
            Some(&hinge) => {
                points.extend(self.root(piece, hinge, (from + length * direction, -direction), false))
            }
            None => points.extend(self.free(piece, side)),
        }
        points
    }

    /// From a side to the middle of the flat beside a hinge. `side`: where it begins at the hinge, and its direction from there.
    fn root(&self, piece: usize, hinge: usize, (at, far): Straight, leaves: bool) -> Vec<Point> {
        let Hinge { pieces, angle, .. } = &self.design.hinges[hinge];
        let (centre, along) = self.ligaments[hinge];
        // A cut travels with its piece to the left: where the side leaves it comes from the other piece.
        let along = if (pieces[1] == piece) == leaves { along } else { -along };
        let outwards = if leaves { along } else { -along };
        let window = -along.turn_90();
        let (foot, [dx, dy]) = (centre + self.beside * window, [far.dot(outwards), far.dot(window)]);
        let half = 0.5 * self.flat(*angle);
        let Some(natural) = crossing((at, far), (foot, outwards)) else { return vec![foot] };
        let beyond = self.root * (0.5 * dy.atan2(dx)).tan();
        let wall_foot = foot + (half + self.root) * outwards;
        let top = crossing((at, far), (wall_foot, window)).filter(|_| dx > 0.0);
        let wall = top.map_or(f64::INFINITY, |top| (top - wall_foot).dot(window));
        let mut points = match top {
            Some(top) if (natural - foot).dot(outwards) - beyond < half && wall >= SHORTEST => {
                let radius = self.root.min(wall - SHORTEST);
                let mut points = vec![top];
                points.extend(rounded(-window, wall_foot, -outwards, radius));
                points
            }
            _ => rounded(-far, natural, -outwards, self.root),
        };
        points.push(foot);
        points
    }

    /// Length of the straight cut beside a ligament.
    fn flat(&self, angle: f64) -> f64 {
        let length = asked(self.profile, angle);
        let notch = matches!(self.profile.ligament.shape, Shape::Notch { .. });
        if notch { length - self.profile.cut.kerf } else { length }
    }

    /// The cut around a piece's own corner between a side and the next.
    fn free(&self, piece: usize, side: usize) -> Vec<Point> {
        let count = self.design.pieces[piece].open.len();
        let [((a, u), before), ((b, v), after)] =
            [side, (side + 1) % count].map(|side| self.line(piece, side));
        let sine = u.cross(v);
        if sine.abs() < STRAIGHT {
            return vec![(a + before * u).midpoint(b)];
        }
        let corner = a + (b - a).cross(v) / sine * u;
        let turn = sine.atan2(u.dot(v));
        let room = 0.3 * before.min(after) / (0.5 * turn).tan().abs().max(1e-9);
        rounded(u, corner, v, if turn < 0.0 { 0.0 } else { self.beside.min(room) })
    }
}

fn vertices(design: &Design, piece: usize, of: [usize; 2]) -> [Point; 2] {
    let open = &design.pieces[piece].open;
    of.map(|vertex| open[vertex % open.len()]).map(|at| Point::new(at.x, at.y))
}

/// The free length of a ligament.
fn asked(profile: &Profile, angle: f64) -> f64 {
    required_length(profile, angle).unwrap_or(profile.ligament_lengths()[1])
}

/// A ligament's middle and direction. It stands off its hinge point by the offset of its pole, away from the window that closes.
fn ligament(design: &Design, profile: &Profile, hinge: &Hinge) -> Straight {
    let (point, along) = (Point::new(hinge.point.x, hinge.point.y), along(design, hinge));
    if design.pattern == PatternKind::Bistable {
        return (point, along);
    }
    let pole = pole_offset(profile, asked(profile, hinge.angle), hinge.angle);
    (point - hinge.axis.z.signum() * pole * along.turn_90(), along)
}

/// Unit direction of a ligament from its hinge's first piece to the second: halfway between the middles of both pieces' corners
/// there; on bistable sheets across the middle of the narrower window.
fn along(design: &Design, hinge: &Hinge) -> Vec2 {
    let [first, second] = [0, 1].map(|i| {
        let (piece, at) = (hinge.pieces[i], hinge.vertices[i]);
        let count = design.pieces[piece].open.len();
        // To the vertex after it and to that before.
        [at + 1, at + count - 1].map(|other| {
            let [from, to] = vertices(design, piece, [at, other]);
            (to - from).normalize()
        })
    });
    if design.pattern == PatternKind::Bistable {
        let between =
            |from: Vec2, to: Vec2| from.cross(to).atan2(from.dot(to)).rem_euclid(std::f64::consts::TAU);
        let (left, right) = ([first[1], second[0]], [second[1], first[0]]);
        let (narrow, sign) =
            if between(left[0], left[1]) < between(right[0], right[1]) { (left, 1.0) } else { (right, -1.0) };
        return sign * (narrow[0] + narrow[1]).normalize().turn_90();
    }
    let [from, to] = [first, second].map(|[next, previous]| {
        let middle = next + previous;
        // At a straight angle their sum vanishes.
        if middle.length() > 0.1 { middle.normalize() } else { (next - previous).turn_90().normalize() }
    });
    (to - from).normalize()
}

/// A corner between two directions, rounded: the ends of the arc and points on it.
fn rounded(before: Vec2, at: Point, after: Vec2, radius: f64) -> Vec<Point> {
    let turn = before.cross(after).atan2(before.dot(after));
    let cut = radius * (0.5 * turn.abs()).tan();
    if 2.0 * cut * (0.5 * turn).cos() <= SHORTEST {
        return vec![at];
    }
    let vertices = [(at - cut * before, (0.25 * turn).tan()), (at + cut * after, 0.0)];
    let vertices = vertices.map(|(point, bulge)| PathVertex { point, bulge }).into();
    CutPath { kind: CutKind::Window, vertices, closed: false }.flatten(FLAT)
}
