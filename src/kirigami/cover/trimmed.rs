//! The straight grid of whole cells, for outlines that no grid follows.

use std::collections::BTreeSet;

use super::frame::{Frame, extent};
use super::{Boundary, Cover, ModelCell, build};
use crate::geometry::{Point2, Vector2};

/// A straight grid over the bounding rectangle, without the cells that lie outside by more than a sixth. Of
/// several positions of the grid the one is taken that leaves the smallest gap to the outline.
pub(super) fn trimmed(outline: &[Point2], frame: &Frame, cell: ModelCell) -> Cover {
    let side = cell.open[0];
    let local: Vec<Point2> = outline.iter().map(|p| frame.local(p) / side).collect();
    let shifts = (0..SHIFTS * SHIFTS).map(|k| {
        let part = |k: usize| k as f64 / SHIFTS as f64;
        Vector2::new(part(k % SHIFTS), part(k / SHIFTS))
    });
    let mut best: Option<(f64, Vector2, BTreeSet<[i32; 2]>)> = None;
    for shift in shifts {
        let shifted: Vec<Point2> = local.iter().map(|p| p + shift).collect();
        let cells = cells_inside(&shifted);
        let gap = largest_gap(&shifted, &cells);
        // A better place must be better by more than rounding.
        if best.as_ref().is_none_or(|(least, ..)| gap < least - 1e-9) {
            best = Some((gap, shift, cells));
        }
    }
    let (_, shift, cells) = best.expect("at least one position");
    let at = |x: f64, y: f64| frame.point((x - shift.x) * side, (y - shift.y) * side);
    build(&cells.into_iter().collect::<Vec<_>>(), at, cell, Boundary::Trimmed)
}

/// Positions of the grid per direction that are tried.
const SHIFTS: usize = 10;

/// The unit cells of which five sixths or more lie inside an outline, tidied.
fn cells_inside(outline: &[Point2]) -> BTreeSet<[i32; 2]> {
    let (low, high) = extent(outline, &Vector2::x());
    let (left, right) = (low.x.floor() as i32, high.x.ceil() as i32);
    let part = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
    let mut cells = BTreeSet::new();
    for j in low.y.floor() as i32..high.y.ceil() as i32 {
        let rows: Vec<Vec<f64>> =
            (0..SAMPLES).map(|row| crossings(outline, f64::from(j) + part(row))).collect();
        for i in left..right {
            let samples = (0..SAMPLES * SAMPLES).filter(|k| {
                // Inside where an odd number of crossings lies to the left (even-odd rule).
                let x = f64::from(i) + part(k % SAMPLES);
                rows[k / SAMPLES].partition_point(|&crossing| crossing <= x) % 2 == 1
            });
            if 6 * samples.count() >= 5 * SAMPLES * SAMPLES {
                cells.insert([i, j]);
            }
        }
    }
    let block = |[i, j]: [i32; 2]| (0..BLOCK * BLOCK).map(move |k| [i + k % BLOCK, j + k / BLOCK]);
    let full: Vec<[i32; 2]> =
        cells.iter().copied().filter(|&cell| block(cell).all(|c| cells.contains(&c))).collect();
    let mut cells = full.into_iter().flat_map(block).collect();
    tidy(&mut cells);
    cells
}

/// Every cell belongs to a full block of this many by as many cells: narrower tips would hang on few hinges.
const BLOCK: i32 = 3;

/// Samples per side with which the share of a cell inside the outline is estimated.
const SAMPLES: usize = 4;

/// Largest distance of a point of an outline from the unit cells; infinite where there is no cell.
fn largest_gap(outline: &[Point2], cells: &BTreeSet<[i32; 2]>) -> f64 {
    let border: Vec<[i32; 2]> = cells
        .iter()
        .copied()
        .filter(|[i, j]| {
            ![[i + 1, *j], [i - 1, *j], [*i, j + 1], [*i, j - 1]].iter().all(|n| cells.contains(n))
        })
        .collect();
    let distance = |p: &Point2, [i, j]: &[i32; 2]| {
        let outside = |x: f64, low: i32| (f64::from(low) - x).max(x - f64::from(low + 1)).max(0.0);
        outside(p.x, *i).hypot(outside(p.y, *j))
    };
    let gap = |p: &Point2| border.iter().map(|cell| distance(p, cell)).fold(f64::INFINITY, f64::min);
    outline.iter().map(gap).fold(0.0, f64::max)
}

/// Removes cells until every cell has two neighbours, no two cells touch in a corner only, and all connect.
fn tidy(cells: &mut BTreeSet<[i32; 2]>) {
    loop {
        let has = |i: i32, j: i32| cells.contains(&[i, j]);
        let neighbours = |[i, j]: [i32; 2]| {
            [(1, 0), (0, 1), (-1, 0), (0, -1)].iter().filter(|(x, y)| has(i + x, j + y)).count()
        };
        let loose = cells.iter().copied().find(|&cell| neighbours(cell) < 2);
        let pinched = cells.iter().copied().find_map(|[i, j]| {
            let corner = |x: i32| has(i + x, j + 1) && !has(i + x, j) && !has(i, j + 1);
            let diagonal = if corner(1) { [i + 1, j + 1] } else { [i - 1, j + 1] };
            (corner(1) || corner(-1))
                .then(|| if neighbours([i, j]) < neighbours(diagonal) { [i, j] } else { diagonal })
        });
        match loose.or(pinched) {
            Some(cell) => cells.remove(&cell),
            None => break,
        };
    }
    let mut largest = BTreeSet::new();
    let mut rest = cells.clone();
    while let Some(start) = rest.pop_first() {
        let mut part = BTreeSet::from([start]);
        let mut open = vec![start];
        while let Some([i, j]) = open.pop() {
            for next in [[i + 1, j], [i, j + 1], [i - 1, j], [i, j - 1]] {
                if rest.remove(&next) {
                    part.insert(next);
                    open.push(next);
                }
            }
        }
        if part.len() > largest.len() {
            largest = part;
        }
    }
    *cells = largest;
}

/// Where a closed polygon crosses the horizontal line at `y`, from left to right.
fn crossings(polygon: &[Point2], y: f64) -> Vec<f64> {
    let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let across = sides.filter(|(a, b)| (a.y > y) != (b.y > y));
    let mut crossings: Vec<f64> = across.map(|(a, b)| a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x)).collect();
    crossings.sort_by(f64::total_cmp);
    crossings
}
