//! Whether every side of every piece is cut where it should be, and nothing else.
//!
//! [`expected`] tells where all cuts should run. Both ways are looked at: whether there is a cut wherever one should run, and
//! whether every cut runs where one should.

use kurbo::Point;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Line};

use super::Wanted;
use super::expected::{self, Expected};
use super::fault::{Check, Fault};
use super::grooves::{Grooves, Lines, nearest_line};
use super::machine_file::MachineFile;
use crate::kirigami::design::State;

/// Largest distance between a cut and where it should run, millimetres.
pub(super) const DEVIATION: f64 = 0.02;
/// The same beside corners that are not known, in distances of the two hinges at a corner: slits that bend there are led straight
/// past both hinges, which moves them by less than that.
const BEND: f64 = 0.5;
/// How far outside of a side at the border its cut may run beside such corners, in lengths of the side: it bridges the kinks
/// between sides.
const BRIDGED: f64 = 0.3;

/// Parts of a line at which it is looked for.
const PLACES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Where a cut should run.
struct Side {
    piece: usize,
    /// The piece on the other side.
    other: Option<usize>,
    ends: [Point; 2],
    /// How far from its ends it is not known, millimetres.
    margin: f64,
    /// How far the cut may be off it.
    limit: f64,
}

/// All lines where cuts should run, and places around which cuts may run otherwise.
struct Sides {
    sides: Vec<Side>,
    unknown: Vec<Point>,
    /// How far from these places, and from the ends of sides with a margin.
    corner: f64,
}

/// The largest deviation, millimetres.
pub(super) fn check(file: &MachineFile, grooves: &Grooves, wanted: Wanted, faults: &mut Vec<Fault>) -> f64 {
    let profile = wanted.profile;
    let corner = 0.5 * profile.ligament_lengths()[1] + profile.ligament.width + profile.cut.kerf;
    let expected = match wanted.design.sheet_state {
        Some(State::Closed) => expected::closed(wanted.design, profile, &file.paths),
        _ => Ok(expected::open(wanted.design, profile)),
    };
    let all = match expected {
        Ok(expected) => Sides::new(expected, wanted, corner),
        Err(error) => {
            faults.push(Fault::new(Check::Piece, file.name, "the design", None, error.to_string()));
            return f64::INFINITY;
        }
    };
    if let Some(side) = all.sides.iter().find(|side| !side.ends.iter().all(|end| end.is_finite())) {
        let what = format!("piece {}", side.piece);
        let says = "has collapsed: nobody can tell where it should be cut";
        faults.push(Fault::new(Check::Piece, file.name, what, None, says));
        return f64::INFINITY;
    }
    let found: Vec<(f64, Point)> = all.sides.par_iter().map(|side| farthest(grooves, side)).collect();
    let mut worst = 0.0_f64;
    for (side, (deviation, at)) in all.sides.iter().zip(found) {
        worst = worst.max(deviation - (side.limit - DEVIATION));
        if deviation > side.limit {
            let what = match side.other {
                Some(other) => format!("piece {}, its side to piece {other}", side.piece),
                None => format!("piece {}, its outer side", side.piece),
            };
            let says = format!(
                "is not cut: the nearest cut is {deviation:.3} mm away, the limit is {:.3} mm",
                side.limit
            );
            faults.push(Fault::new(Check::Piece, file.name, what, at, says));
        }
    }
    check_strays(file, grooves, &all, faults);
    worst
}

impl Sides {
    fn new(expected: Expected, wanted: Wanted, corner: f64) -> Self {
        let side = |line: expected::Line| {
            let expected::Line { ends, piece, other, known } = line;
            let outside = if other.is_some() { 0.0 } else { BRIDGED * ends[0].distance(ends[1]) };
            let (margin, limit) =
                if known { (0.0, DEVIATION) } else { (corner, BEND * wanted.profile.hinge_gap() + outside) };
            Side { piece, other, ends, margin, limit }
        };
        Sides { sides: expected.lines.into_iter().map(side).collect(), unknown: expected.unknown, corner }
    }
}

/// The largest distance from a side to the nearest cut, and where.
fn farthest(grooves: &Grooves, side: &Side) -> (f64, Point) {
    let [from, to] = side.ends;
    let margin = (side.margin / from.distance(to)).min(0.4);
    let sample = |part: f64| {
        let at = from.lerp(to, margin + (1.0 - 2.0 * margin) * part);
        (grooves.nearest(at).map_or(f64::INFINITY, |(distance, _)| distance), at)
    };
    PLACES
        .into_iter()
        .map(sample)
        .fold((0.0, from), |worst, next| if next.0 > worst.0 { next } else { worst })
}

/// Cuts where no side is.
fn check_strays(file: &MachineFile, grooves: &Grooves, all: &Sides, faults: &mut Vec<Fault>) {
    let line = |(i, side): (usize, &Side)| {
        let [from, to] = side.ends.map(|point| [point.x, point.y]);
        GeomWithData::new(Line::new(from, to), i)
    };
    let tree: Lines = RTree::bulk_load(all.sides.iter().enumerate().map(line).collect());
    let unknown = RTree::bulk_load(all.unknown.iter().map(|at| [at.x, at.y]).collect());
    let corner = all.corner;
    let limit_at = |side: &Side, at: Point| {
        let near = |end: &Point| side.margin > 0.0 && end.distance(at) <= corner;
        let beside = side.ends.iter().any(near)
            || unknown
                .nearest_neighbor(&[at.x, at.y])
                .is_some_and(|&[x, y]| at.distance(Point::new(x, y)) <= corner);
        if beside { side.limit.max(corner) } else { side.limit }
    };
    // How far a segment strays, and the limit where that is worst.
    let stray = |segment: usize| -> (f64, f64, Point) {
        let [from, to] = grooves.segments[segment].ends;
        let mut worst = (0.0, DEVIATION, from);
        for at in PLACES.map(|part| from.lerp(to, part)) {
            let Some((distance, near)) = nearest_line(&tree, at, corner) else { continue };
            let limit = limit_at(&all.sides[near], at);
            if distance - limit > worst.0 - worst.1 {
                worst = (distance, limit, at);
            }
        }
        worst
    };
    let found: Vec<(f64, f64, Point)> = (0..grooves.segments.len()).into_par_iter().map(stray).collect();
    let segments = grooves.segments.iter().zip(found).collect::<Vec<_>>();
    for of_cut in segments.chunk_by(|a, b| a.0.path == b.0.path) {
        let worst = of_cut.iter().map(|(_, found)| *found);
        let Some((distance, limit, at)) = worst.max_by(|a, b| (a.0 - a.1).total_cmp(&(b.0 - b.1))) else {
            continue;
        };
        if distance > limit {
            let says = format!(
                "runs {distance:.3} mm from where the nearest cut should be, the limit is {limit:.3} mm"
            );
            faults.push(file.cut_fault(Check::Piece, of_cut[0].0.path, at, says));
        }
    }
}
