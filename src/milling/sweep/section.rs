//! The line that a tool's axis draws at a height while it moves.

use std::collections::HashSet;

use kurbo::{Point, Vec2};

use super::Move;

/// A move's line may bend so much between its ends, millimetres.
const STRAIGHT: f64 = 5e-4;

/// Sections nearer to each other than this are one, millimetres.
const SAME: f64 = 1e-4;

/// A straight piece of such a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// From and to.
    pub ends: [Point; 2],
    /// The axis there: (dx/dz, dy/dz).
    pub lean: Vec2,
    /// The move.
    pub step: usize,
    /// Whether it goes on where the one before ended.
    pub goes_on: bool,
}

/// Which part of the flat end counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counted {
    /// Heights that any of it has reached.
    Touched,
    /// Heights that all of it has reached.
    Cleared,
}

/// All lines at a height, each once.
pub fn sections(moves: &[Move], z: f64, radius: f64, counted: Counted) -> Vec<Section> {
    let mut all = Vec::new();
    let mut known: HashSet<[i64; 4]> = HashSet::new();
    let mut last: Option<Point> = None;
    for (step, a_move) in moves.iter().enumerate() {
        let Some([from, to]) = span(a_move, z, radius, counted) else {
            last = None;
            continue;
        };
        let start = all.len();
        divide(a_move, z, step, [from, to], 6, &mut all);
        let joined = last.zip(all.get(start)).is_some_and(|(last, next)| last.distance(next.ends[0]) < SAME);
        if let Some(first) = all.get_mut(start) {
            first.goes_on = joined;
        }
        last = all.last().map(|section| section.ends[1]);
        // The same way at another depth leaves nothing else at this height.
        let fresh: Vec<Section> = all.drain(start..).collect();
        for section in fresh {
            let [a, b] = section.ends.map(|p| [p.x, p.y].map(|c| (c / SAME).round() as i64));
            let (a, b) = (a.min(b), a.max(b));
            if known.insert([a[0], a[1], b[0], b[1]]) {
                all.push(section);
            }
        }
    }
    all
}

/// The part of a move in which the tool has reached a height.
fn span(a_move: &Move, z: f64, radius: f64, counted: Counted) -> Option<[f64; 2]> {
    let sine = |axis: &nalgebra::Vector3<f64>| axis.x.hypot(axis.y);
    let rim = radius * sine(&a_move.from.axis).max(sine(&a_move.to.axis));
    let limit = if counted == Counted::Touched { z + rim } else { z - rim };
    let [a, b] = [a_move.from.tip.z - limit, a_move.to.tip.z - limit];
    match (a <= 0.0, b <= 0.0) {
        (true, true) => Some([0.0, 1.0]),
        (false, false) => None,
        (true, false) => Some([0.0, a / (a - b)]),
        (false, true) => Some([a / (a - b), 1.0]),
    }
}

/// Where the axis stands at a height, and how it leans.
fn axis_at(a_move: &Move, part: f64, z: f64) -> (Point, Vec2) {
    let tip = a_move.from.tip + part * (a_move.to.tip - a_move.from.tip);
    // Turning evenly: the vectors of nearly equal axes hardly differ from their even mixture.
    let axis = a_move.from.axis.slerp(&a_move.to.axis, part);
    let lean = Vec2::new(axis.x, axis.y) / axis.z;
    (Point::new(tip.x, tip.y) + (z - tip.z) * lean, lean)
}

fn divide(a_move: &Move, z: f64, step: usize, [from, to]: [f64; 2], depth: usize, out: &mut Vec<Section>) {
    let [(a, l), (b, m)] = [from, to].map(|part| axis_at(a_move, part, z));
    let middle = 0.5 * (from + to);
    if depth > 0 && axis_at(a_move, middle, z).0.distance(a.midpoint(b)) > STRAIGHT {
        divide(a_move, z, step, [from, middle], depth - 1, out);
        divide(a_move, z, step, [middle, to], depth - 1, out);
        return;
    }
    out.push(Section { ends: [a, b], lean: 0.5 * (l + m), step, goes_on: true });
}
