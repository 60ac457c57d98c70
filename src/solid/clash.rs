//! Whether thick pieces run into each other in the other state.
//!
//! Every line that runs through a piece's wall from face to face, at the corners of its outline and between
//! them, is looked at from each piece nearby. Two plates that interpenetrate always have such a line of one
//! inside the other, for what they share is bounded, and faces alone do not bound it. How deep a line is
//! inside a piece is the lesser of how far it would have to move along that piece's normal to leave it, and
//! of its largest distance from that piece's walls.

use std::fmt;

use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{RTree, RTreeObject};

use super::Walls;
use super::error::SolidError;
use super::outline::{Outline, Plate, shifted};
use crate::fabrication::hinge_table::HingeRow;
use crate::geometry::rotation::RigidMotion;
use crate::geometry::{Point3, Vector3};

/// Depth to which pieces may overlap, millimetres: that of two right-angled corners with the overlap that the
/// check of the mid-planes lets pass ([`crate::fabrication::collision::OVERLAP_TOLERANCE`]). Less than any
/// laser's accuracy.
pub const PLAY: f64 = 0.01;

/// Lines per outline beside those at its corners.
const LINES: f64 = 64.0;

/// A piece in the other state.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    /// The piece in the sheet state, without ligaments: one outline.
    pub plate: Plate,
    /// From the sheet into the other state.
    pub motion: RigidMotion,
    /// Largest distance by which the motion misses a hinge point of the piece, millimetres.
    pub misfit: f64,
    /// The sheet's corners around it.
    pub corners: Vec<usize>,
}

/// Two pieces that overlap in the other state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clash {
    /// The pieces, the lower number first.
    pub pieces: [usize; 2],
    /// How deep, millimetres.
    pub depth: f64,
    /// How deep they may, millimetres.
    pub limit: f64,
    /// The part of the limit that vertical walls take beside a tilted hinge axis, millimetres.
    pub tilt: f64,
    /// The part of the limit for rims that meet across an open cut, millimetres.
    pub rim: f64,
    /// Where, in the other state.
    pub at: Point3,
    /// The other state's name.
    pub state: &'static str,
}

impl Clash {
    /// By how much it is deeper than it may be, millimetres; negative where it may pass.
    pub fn excess(&self) -> f64 {
        self.depth - self.limit
    }
}

impl fmt::Display for Clash {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { pieces, depth, limit, at, state, .. } = self;
        write!(
            f,
            "thick pieces {pieces:?} overlap by {depth:.3} mm at ({:.2}, {:.2}, {:.2}) mm in the {state} state, where \
             {limit:.3} mm may pass",
            at.x, at.y, at.z
        )?;
        if self.tilt > 0.0 {
            write!(
                f,
                " ({:.3} mm of it for walls that do not follow the tilt of the hinge axis)",
                self.tilt
            )?;
        }
        if self.rim > 0.0 {
            write!(f, " ({:.3} mm of it for rims that meet across an open cut: trim their tips)", self.rim)?;
        }
        Ok(())
    }
}

/// A hinge as the pieces around it see it.
#[derive(Debug, Clone, Copy)]
struct Near {
    /// Its point on the sheet.
    point: [f64; 2],
    /// How far from it its tilt excuses an overlap: to the far end of the cuts around its ligament.
    reach: f64,
    /// By how much: both faces are off by t/2 tan(tilt), and turning by the angle a about a point that is off
    /// by d moves things by 2 d sin(a/2).
    tilt: f64,
}

/// A piece ready to be looked at.
struct Solid<'a> {
    outline: &'a Outline,
    motion: RigidMotion,
    misfit: f64,
    corners: &'a [usize],
    /// Corners of the outline's box, at any height.
    low: [f64; 2],
    high: [f64; 2],
    hinges: Vec<Near>,
}

/// The deepest overlap of any two pieces, of those that may pass.
///
/// `state`: the other state's name; `rows`: the hinge table; `thickness`: of the sheet, millimetres.
///
/// # Errors
/// The overlap that exceeds its limit most.
pub fn deepest(
    state: &'static str,
    rows: &[HingeRow],
    pieces: &[Placed],
    thickness: f64,
    walls: Walls,
) -> Result<Option<Clash>, SolidError> {
    match overlaps(state, rows, pieces, thickness, walls) {
        [_, Some(clash)] if clash.excess() > 0.0 => Err(SolidError::Clash(clash)),
        [deepest, _] => Ok(deepest),
    }
}

/// The deepest overlap of any two pieces, and the one that exceeds its limit most or comes nearest to it.
pub fn overlaps(
    state: &'static str,
    rows: &[HingeRow],
    pieces: &[Placed],
    thickness: f64,
    walls: Walls,
) -> [Option<Clash>; 2] {
    let solids = solids(rows, pieces, thickness, walls);
    let half = 0.5 * thickness;
    let boxes: Vec<GeomWithData<Rectangle<[f64; 3]>, usize>> =
        solids.iter().enumerate().map(|(i, solid)| GeomWithData::new(solid.space(half), i)).collect();
    let tree = RTree::bulk_load(boxes.clone());
    // The border stands half a ligament outside the hinge points, so two right-angled tips that meet across an
    // open cut are inside each other by up to a ligament's width, though the hinge polygons only touch.
    let width = rows.iter().map(|row| row.width).fold(0.0, f64::max);
    // Each piece's own worst overlap with later ones: by depth, and by excess.
    let found: Vec<[Option<Clash>; 2]> = boxes
        .par_iter()
        .map(|own| {
            let mut worst = [None, None];
            let near = tree.locate_in_envelope_intersecting(&own.geom().envelope());
            let mut later: Vec<usize> = near.map(|other| other.data).filter(|&j| j > own.data).collect();
            later.sort_unstable();
            for j in later {
                let pieces = [own.data, j];
                let [a, b] = pieces.map(|piece| &solids[piece]);
                let play = PLAY + a.misfit + b.misfit;
                let apart = !a.corners.iter().any(|corner| b.corners.contains(corner));
                for [of, into] in [[a, b], [b, a]] {
                    overlap(of, into, half, |Found { depth, inside, tilt, at }| {
                        let rim = if apart && inside <= width + play { width } else { 0.0 };
                        let limit = play + tilt + rim;
                        keep(&mut worst, Clash { pieces, depth, limit, tilt, rim, at, state });
                    });
                }
            }
            worst
        })
        .collect();
    let mut worst = [None, None];
    found.iter().flatten().flatten().for_each(|clash| keep(&mut worst, *clash));
    worst
}

/// Keeps the deepest and the one with the largest excess; the first of equals.
fn keep([deepest, excess]: &mut [Option<Clash>; 2], clash: Clash) {
    if deepest.is_none_or(|old| clash.depth > old.depth) {
        *deepest = Some(clash);
    }
    if excess.is_none_or(|old| clash.excess() > old.excess()) {
        *excess = Some(clash);
    }
}

fn solids<'a>(rows: &[HingeRow], pieces: &'a [Placed], thickness: f64, walls: Walls) -> Vec<Solid<'a>> {
    let half = 0.5 * thickness;
    let mut hinges = vec![Vec::new(); pieces.len()];
    for row in rows {
        let tilt = match walls {
            // Beyond a ligament's width the axis leaves the ligament before it reaches the face.
            Walls::Vertical => (thickness * row.tilt.tan() * (0.5 * row.angle).sin()).min(row.width),
            Walls::Ruled => 0.0,
        };
        let near = Near { point: [row.point.x, row.point.y], reach: row.length + row.width, tilt };
        row.pieces.iter().for_each(|&piece| hinges[piece].push(near));
    }
    let solid = |(piece, hinges): (&'a Placed, Vec<Near>)| {
        let outline = &piece.plate.outlines[0];
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in [-half, half].iter().flat_map(|&z| outline.at(z)) {
            low = [0, 1].map(|k| low[k].min(point[k]));
            high = [0, 1].map(|k| high[k].max(point[k]));
        }
        let Placed { motion, misfit, ref corners, .. } = *piece;
        Solid { outline, motion, misfit, corners, low, high, hinges }
    };
    pieces.iter().zip(hinges).map(solid).collect()
}

impl Solid<'_> {
    /// Its box in the other state.
    fn space(&self, half: f64) -> Rectangle<[f64; 3]> {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for z in [-half, half] {
            for [x, y] in [self.low, [self.high[0], self.low[1]], self.high, [self.low[0], self.high[1]]] {
                let p = self.motion.apply(&Point3::new(x, y, z));
                low = [0, 1, 2].map(|k| low[k].min(p[k]));
                high = [0, 1, 2].map(|k| high[k].max(p[k]));
            }
        }
        Rectangle::from_corners(low, high)
    }

    /// The outline's corners and points between them, with their leans.
    fn lines(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
        let points = &self.outline.points;
        let n = points.len();
        let side = move |i: usize| [points[i], points[(i + 1) % n]];
        let length = move |i: usize| {
            let [a, b] = side(i);
            (b[0] - a[0]).hypot(b[1] - a[1])
        };
        let step = (0..n).map(length).sum::<f64>() / LINES;
        (0..n).flat_map(move |i| {
            let [a, b] = side(i);
            let [l, m] = [self.lean(i), self.lean((i + 1) % n)];
            let count = (length(i) / step).ceil().max(1.0);
            (0..count as usize).map(move |k| {
                let part = k as f64 / count;
                let mixed = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|k| a[k] + part * (b[k] - a[k]));
                (mixed(a, b), mixed(l, m))
            })
        })
    }

    fn lean(&self, i: usize) -> [f64; 2] {
        self.outline.lean.as_ref().map_or([0.0; 2], |lean| lean[i])
    }

    /// How far inside the walls a point of its own frame is; 0 outside.
    fn inside(&self, p: Point3) -> f64 {
        let within = |k: usize| p[k] > self.low[k] && p[k] < self.high[k];
        if !(within(0) && within(1)) {
            return 0.0;
        }
        let n = self.outline.points.len();
        let corner = |i: usize| {
            let [x, y] = shifted(self.outline.points[i], self.lean(i), p.z);
            [x - p.x, y - p.y]
        };
        let (mut inside, mut nearest) = (false, f64::INFINITY);
        let mut a = corner(n - 1);
        for i in 0..n {
            let b = corner(i);
            let side = [b[0] - a[0], b[1] - a[1]];
            if (a[1] > 0.0) != (b[1] > 0.0) && a[0] - a[1] / side[1] * side[0] > 0.0 {
                inside = !inside;
            }
            let square = side[0] * side[0] + side[1] * side[1];
            let part = (-(a[0] * side[0] + a[1] * side[1]) / square).clamp(0.0, 1.0);
            let [x, y] = [0, 1].map(|k| a[k] + part * side[k]);
            nearest = nearest.min(x * x + y * y);
            a = b;
        }
        if inside { nearest.sqrt() } else { 0.0 }
    }

    /// What the tilt of a hinge near a point of the sheet excuses.
    fn excused(&self, [x, y]: [f64; 2]) -> f64 {
        let near = self.hinges.iter().filter(|h| (h.point[0] - x).hypot(h.point[1] - y) < h.reach);
        near.map(|hinge| hinge.tilt).fold(0.0, f64::max)
    }
}

/// A line through a wall inside another piece.
struct Found {
    /// How deep.
    depth: f64,
    /// How far inside the other piece's walls.
    inside: f64,
    /// What the tilt of a hinge nearby excuses.
    tilt: f64,
    /// Where, in the other state.
    at: Point3,
}

/// Tells of every line through the wall of `of` that is inside `into`.
fn overlap(of: &Solid, into: &Solid, half: f64, mut tell: impl FnMut(Found)) {
    let back = into.motion.inverse();
    let rotation = back.rotation * of.motion.rotation;
    let shift: Vector3 = back.rotation * of.motion.translation + back.translation;
    for (point, lean) in of.lines() {
        let end = |z: f64| {
            let [x, y] = shifted(point, lean, z);
            Point3::from(rotation * Vector3::new(x, y, z) + shift)
        };
        let Some([a, b]) = between_faces([end(-half), end(half)], half) else { continue };
        let aside = |k: usize| a[k].max(b[k]) < into.low[k] || a[k].min(b[k]) > into.high[k];
        if aside(0) || aside(1) {
            continue;
        }
        let middle = nalgebra::center(&a, &b);
        let [mut inside, mut place] = [0.0, 0.0];
        for (i, p) in [a, middle, b].into_iter().enumerate() {
            let found = into.inside(p);
            if found > inside {
                [inside, place] = [found, i as f64];
            }
        }
        let out = [half - a.z.min(b.z), a.z.max(b.z) + half];
        let depth = out[0].min(out[1]).min(inside);
        if depth > 0.0 {
            let at = a + 0.5 * place * (b - a);
            let tilt = of.excused(point).max(into.excused([at.x, at.y]));
            tell(Found { depth, inside, tilt, at: into.motion.apply(&at) });
        }
    }
}

/// The part of a line that is between the faces of a piece, in that piece's frame.
fn between_faces([a, b]: [Point3; 2], half: f64) -> Option<[Point3; 2]> {
    let rise = b.z - a.z;
    if rise.abs() < 1e-12 {
        return (a.z.abs() < half).then_some([a, b]);
    }
    let mut parts = [(-half - a.z) / rise, (half - a.z) / rise];
    parts.sort_by(f64::total_cmp);
    let [from, to] = [parts[0].max(0.0), parts[1].min(1.0)];
    (from < to).then(|| [a + from * (b - a), a + to * (b - a)])
}

#[cfg(test)]
mod tests;
