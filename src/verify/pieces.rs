//! Whether every side of every piece is cut where it should be, and nothing else.
//!
//! On an open sheet all cuts run along the pieces' own sides. On a closed one the cut between two pieces runs midway
//! between their sides, but for the bends that lead it straight past hinges, and the border runs outside of the pieces by
//! up to half a ligament and half a kerf. Near corners, where ligaments are, nothing is asked here.

use std::collections::HashMap;

use kurbo::Point;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Line};

use super::Wanted;
use super::cut_name;
use super::fault::{Check, Fault};
use super::grooves::{Grooves, Lines, nearest_line};
use super::machine_file::MachineFile;
use crate::fabrication::layout::CutKind;
use crate::fabrication::states::sheet_vertices;
use crate::kirigami::design::{PatternKind, State};

/// How far outside of a side at the border its cut may run, in lengths of the side: it bridges the kinks between sides, which are
/// sharp where the pieces are those of a control mesh.
const BRIDGED: f64 = 0.3;

/// Largest distance between a cut and the piece's side along which it runs, on an open sheet, millimetres.
const DEVIATION: f64 = 0.02;
/// The same on a closed sheet, in distances of the two hinges at a corner: slits that bend at their corners are led
/// straight past both hinges, which moves them by less than that. Windows of an expanded bistable sheet are so wide beside a
/// hinge that their ends cut along the pieces' sides, by as much.
const BEND: f64 = 0.5;

/// Largest distance between a cut and the line where it should run, millimetres.
pub(super) fn limit(wanted: Wanted) -> f64 {
    let wide = wanted.design.pattern == PatternKind::Bistable;
    match wanted.design.sheet_state {
        Some(State::Closed) => BEND * wanted.profile.hinge_gap(),
        _ if wide => BEND * wanted.profile.hinge_gap(),
        _ => DEVIATION,
    }
}

/// Where a cut should run: one per side of a piece.
struct Side {
    piece: usize,
    /// The piece on the other side.
    other: Option<usize>,
    ends: [Point; 2],
    /// How far outside of it the cut may run by design.
    outside: f64,
}

/// The largest deviation, millimetres.
pub(super) fn check(file: &MachineFile, grooves: &Grooves, wanted: Wanted, faults: &mut Vec<Fault>) -> f64 {
    let profile = wanted.profile;
    let sides = sides(wanted);
    let corner = 0.5 * profile.ligament_lengths()[1] + profile.ligament.width + profile.cut.kerf;
    let found: Vec<(f64, Point)> = sides.par_iter().map(|side| farthest(grooves, side, corner)).collect();
    let limit = limit(wanted);
    let mut worst = 0.0_f64;
    for (side, (deviation, at)) in sides.iter().zip(found) {
        worst = worst.max(deviation - side.outside);
        if deviation - side.outside > limit {
            let what = match side.other {
                Some(other) => format!("piece {}, its side to piece {other}", side.piece),
                None => format!("piece {}, its outer side", side.piece),
            };
            let says = format!(
                "is not cut: the nearest cut is {deviation:.3} mm away, the limit is {:.3} mm",
                limit + side.outside
            );
            faults.push(Fault::new(Check::Piece, file.name, what, at, says));
        }
    }
    check_strays(file, &sides, wanted, corner, faults);
    worst
}

fn sides(wanted: Wanted) -> Vec<Side> {
    let Wanted { design, profile, .. } = wanted;
    let closed = design.sheet_state == Some(State::Closed);
    let flat = |piece: usize, i: usize| {
        let vertices = sheet_vertices(design, &design.pieces[piece]);
        let vertex = &vertices[i % vertices.len()];
        Point::new(vertex.x, vertex.y)
    };
    let mut by_corners = HashMap::new();
    for (piece, corners) in design.pieces.iter().map(|piece| &piece.corners).enumerate() {
        for i in 0..corners.len() {
            by_corners.insert((corners[i], corners[(i + 1) % corners.len()]), (piece, i));
        }
    }
    let mut sides = Vec::new();
    for (piece, corners) in design.pieces.iter().map(|piece| &piece.corners).enumerate() {
        for i in 0..corners.len() {
            let own = [flat(piece, i), flat(piece, i + 1)];
            let neighbour = by_corners.get(&(corners[(i + 1) % corners.len()], corners[i]));
            let other = neighbour.map(|&(other, _)| other);
            let (ends, outside) = match neighbour {
                Some(&(other, _)) if closed && other < piece => continue,
                Some(&(other, k)) if closed => {
                    ([own[0].midpoint(flat(other, k + 1)), own[1].midpoint(flat(other, k))], 0.0)
                }
                None if closed => (own, 0.5 * profile.hinge_gap() + BRIDGED * own[0].distance(own[1])),
                _ => (own, 0.0),
            };
            sides.push(Side { piece, other, ends, outside });
        }
    }
    sides
}

/// The largest distance from a side's middle part to the nearest cut, and where.
fn farthest(grooves: &Grooves, side: &Side, corner: f64) -> (f64, Point) {
    let [from, to] = side.ends;
    let margin = (corner / from.distance(to)).min(0.4);
    let sample = |i: usize| {
        let at = from.lerp(to, margin + (1.0 - 2.0 * margin) * i as f64 / 2.0);
        (grooves.nearest(at).map_or(f64::INFINITY, |(distance, _)| distance), at)
    };
    (0..3).map(sample).fold((0.0, from), |worst, next| if next.0 > worst.0 { next } else { worst })
}

/// Cuts where no side is.
fn check_strays(file: &MachineFile, sides: &[Side], wanted: Wanted, corner: f64, faults: &mut Vec<Fault>) {
    let line = |(i, side): (usize, &Side)| {
        let [from, to] = side.ends.map(|point| [point.x, point.y]);
        GeomWithData::new(Line::new(from, to), i)
    };
    let tree: Lines = RTree::bulk_load(sides.iter().enumerate().map(line).collect());
    let profile = wanted.profile;
    let bar = 0.5 * profile.ligament_lengths()[1] + profile.ligament.width + profile.cut.kerf;
    let limit = limit(wanted);
    // How far a cut strays, and the limit where that is worst.
    let stray = |index: usize| -> (f64, f64, Point) {
        let path = &file.paths[index];
        let vertices = &path.vertices;
        let last = if path.closed { vertices.len() } else { vertices.len() - 1 };
        let middles = (0..last).map(|i| vertices[i].point.midpoint(vertices[(i + 1) % vertices.len()].point));
        let points = vertices.iter().map(|vertex| vertex.point).chain(middles);
        let mut worst = (0.0, limit, vertices[0].point);
        for point in points {
            let Some((distance, near)) = nearest_line(&tree, point, bar) else { continue };
            let side = &sides[near];
            let at_corner = side.ends.iter().any(|end| end.distance(point) <= corner);
            let limit = if at_corner || path.kind == CutKind::Relief { bar } else { limit + side.outside };
            if distance - limit > worst.0 - worst.1 {
                worst = (distance, limit, point);
            }
        }
        worst
    };
    let found: Vec<(f64, f64, Point)> = (0..file.paths.len()).into_par_iter().map(stray).collect();
    for (index, (distance, limit, at)) in found.into_iter().enumerate() {
        if distance > limit {
            let says =
                format!("runs {distance:.3} mm from the nearest piece's side, the limit is {limit:.3} mm");
            faults.push(Fault::new(Check::Piece, file.name, cut_name(&file.paths, index), at, says));
        }
    }
}
