//! The order of the cuts: slits with their relief bars, then windows, then the border, so that what is cut is held by its
//! frame to the end; within each the shortest way that a search finds.
//!
//! A unit is a slit between the bars that it ends on: bar, slit, bar. So the beam goes on where it stopped, and a slit
//! begins in the groove of a bar that is already open. Nothing but the cuts' own coordinates is used: a bar belongs to the
//! slit that ends in its middle.

mod ascent;

mod bound;

mod first_way;

mod heat;

mod nearest;

mod tour;

#[cfg(test)]
mod tests;

use std::collections::HashMap;

use kurbo::Point;
use rstar::RTree;

use super::cuts::ARC_TOLERANCE;
use super::layout::{CutKind, CutPath, PathVertex};
use super::web::{CutIndex, nearest_on_segment};
use first_way::End;
use tour::{Frame, tour};

pub use bound::spanning_tree;
pub use heat::{Cooling, Pace, Rest, cooled, rest};

/// Where the head of the machine waits: the stock's lower left corner.
pub const HOME: Point = Point::ORIGIN;

/// A slit's end and the middle of its bar are one point to within this, millimetres.
const SAME_POINT: f64 = 1e-6;
/// A border begins at least this far from the middle of any ligament, millimetres: well beyond the 0.5 mm that heat
/// reaches. On small parts half of what is possible will do.
const CLEAR: f64 = 3.5;

/// The way of the head between cuts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Travel {
    /// From [`HOME`] through all cuts, with the beam off, millimetres.
    pub length: f64,
    /// No order of the same cuts travels less: the minimum spanning tree over them, millimetres.
    pub bound: f64,
}

/// The same cuts in cutting order, each in cutting direction; borders begin away from `ligaments` (their middles).
pub fn cutting_order(paths: &[CutPath], ligaments: &[Point]) -> Vec<CutPath> {
    let units = units(paths);
    let ligaments = RTree::bulk_load(ligaments.iter().map(|p| [p.x, p.y]).collect());
    let borders: Vec<(usize, Vec<CutPath>)> = of_kind(paths, CutKind::Border)
        .map(|index| (index, closed_starts(&paths[index], &ligaments)))
        .collect();
    let starts_of = |borders: &[(usize, Vec<CutPath>)]| -> Vec<[f64; 2]> {
        let starts = borders.iter().flat_map(|(_, starts)| starts);
        starts.map(|path| [path.vertices[0].point.x, path.vertices[0].point.y]).collect()
    };
    let windows: Vec<CutPath> = of_kind(paths, CutKind::Window).map(|i| paths[i].clone()).collect();
    let border_tree = RTree::bulk_load(starts_of(&borders));
    let window_tree = RTree::bulk_load(windows.iter().map(first).map(|p| [p.x, p.y]).collect());
    let to_border = |from: Point| nearest_in(&border_tree, from).unwrap_or(0.0);
    let to_next = |from: Point| nearest_in(&window_tree, from).unwrap_or_else(|| to_border(from));

    let stops: Vec<[End; 2]> = units.iter().map(|unit| unit.ends(paths)).collect();
    let way = tour(&stops, &Frame { home: HOME, onwards: &to_next });
    let mut order: Vec<CutPath> = Vec::with_capacity(paths.len());
    for (unit, back) in way {
        order.extend(units[unit].paths(back).map(|index| directed(&paths[index], back)));
    }
    let at = order.last().map_or(HOME, last);
    let stops: Vec<[End; 2]> = windows.iter().map(|path| [[first(path); 2]; 2]).collect();
    let way = tour(&stops, &Frame { home: at, onwards: &to_border });
    order.extend(way.into_iter().map(|(window, _)| windows[window].clone()));
    append_borders(borders, &mut order);
    turned_for_least_travel(&mut order);
    order
}

/// The way between cuts in the order given, and its bound.
///
/// The bound is that of all orders with windows after all open cuts and borders last: the tree over the open cuts and
/// [`HOME`], that over the windows where they begin, and the least ways from open cuts to windows and on to a border,
/// wherever that begins.
pub fn travel(order: &[CutPath]) -> Travel {
    let mut at = HOME;
    let mut length = 0.0;
    for path in order {
        length += at.distance(first(path));
        at = last(path);
    }
    let ends = |path: &CutPath| if path.closed { vec![first(path)] } else { vec![first(path), last(path)] };
    let of = |wanted: fn(&CutPath) -> bool| -> Vec<Vec<Point>> {
        order.iter().filter(|path| wanted(path)).map(ends).collect()
    };
    let mut open = of(|path| matches!(path.kind, CutKind::Slit | CutKind::Relief));
    open.push(vec![HOME]);
    let windows = window_groups(order);
    let mut bound = spanning_tree(&open) + spanning_tree(&windows);
    let tree = |groups: &[Vec<Point>]| {
        RTree::bulk_load(groups.iter().flatten().map(|point| [point.x, point.y]).collect())
    };
    let mut inner = tree(&open);
    if !windows.is_empty() {
        let ways = windows.iter().flatten().filter_map(|&window| nearest_in(&inner, window));
        bound += ways.fold(f64::INFINITY, f64::min);
        inner = tree(&windows);
    }
    let borders = order.iter().filter(|path| path.kind == CutKind::Border);
    let chords = borders.flat_map(|path| path.segments(ARC_TOLERANCE));
    // From a chord's middle to all of it is half its length.
    let ways = chords.filter_map(|[a, b]| {
        let middle = a.midpoint(b);
        let near = inner.locate_within_distance([middle.x, middle.y], reach(&inner, middle, a.distance(b)));
        near.map(|&[x, y]| nearest_on_segment(Point::new(x, y), [a, b]).distance(Point::new(x, y)))
            .min_by(f64::total_cmp)
    });
    let to_border = ways.fold(f64::INFINITY, f64::min);
    bound += if to_border.is_finite() { to_border } else { 0.0 };
    Travel { length, bound }
}

/// Where each window begins; one with a lead may begin where that does.
fn window_groups(order: &[CutPath]) -> Vec<Vec<Point>> {
    (0..order.len())
        .filter(|&i| order[i].kind == CutKind::Window)
        .map(|i| match i.checked_sub(1).map(|before| &order[before]) {
            Some(lead) if lead.kind == CutKind::Lead => vec![first(lead), first(&order[i])],
            _ => vec![first(&order[i])],
        })
        .collect()
}

/// Most cuts for which [`least_way`] is worked out: that takes time in the square of their number, here half a second.
const MOST_ASCENDED: usize = 1200;

/// A bound that is nearer to the truth than the tree of [`travel`], of all orders with windows after all open cuts and borders
/// last, millimetres: Held and Karp's ascent. `None` where there are too many open cuts, or none.
pub fn least_way(order: &[CutPath], found: Travel) -> Option<f64> {
    let open: Vec<&CutPath> =
        order.iter().filter(|path| matches!(path.kind, CutKind::Slit | CutKind::Relief)).collect();
    if open.is_empty() || open.len() > MOST_ASCENDED {
        return None;
    }
    let windows = window_groups(order);
    let window_tree = RTree::bulk_load(windows.iter().flatten().map(|p| [p.x, p.y]).collect());
    let borders: Vec<CutPath> = order.iter().filter(|path| path.kind == CutKind::Border).cloned().collect();
    let borders = CutIndex::new(&borders);
    let to_border = |from: Point| {
        let way = borders.nearest([from, from], &[]);
        if way.is_finite() { way } else { 0.0 }
    };
    let onwards = |from: Point| nearest_in(&window_tree, from).unwrap_or_else(|| to_border(from));
    let out = windows.iter().flatten().map(|&at| to_border(at)).fold(f64::INFINITY, f64::min);
    let after = spanning_tree(&windows) + if out.is_finite() { out } else { 0.0 };
    let ends: Vec<Point> = open.iter().flat_map(|path| [first(path), last(path)]).collect();
    let onwards: Vec<f64> = ends.iter().map(|&end| onwards(end)).collect();
    let least = after + ascent::ascent(&ends, HOME, &onwards, found.length - after);
    Some(least.max(found.bound))
}

/// The square of a distance from the middle of a chord within which the point nearest to the chord is.
fn reach(points: &RTree<[f64; 2]>, middle: Point, chord: f64) -> f64 {
    (nearest_in(points, middle).unwrap_or(0.0) + chord).powi(2)
}

fn of_kind(paths: &[CutPath], kind: CutKind) -> impl Iterator<Item = usize> + '_ {
    (0..paths.len()).filter(move |&index| paths[index].kind == kind)
}

/// Where a cut begins.
fn first(path: &CutPath) -> Point {
    path.vertices[0].point
}

/// Where a cut ends: a closed one where it began.
fn last(path: &CutPath) -> Point {
    path.vertices[if path.closed { 0 } else { path.vertices.len() - 1 }].point
}

fn nearest_in(tree: &RTree<[f64; 2]>, from: Point) -> Option<f64> {
    tree.nearest_neighbor(&[from.x, from.y]).map(|&[x, y]| from.distance(Point::new(x, y)))
}

/// A slit with the bars that it ends on, or a bar alone: indices of cuts.
struct Unit {
    slit: usize,
    bars: [Option<usize>; 2],
}

impl Unit {
    /// Where the way comes to it and leaves it: the ends of its bars, or its own.
    fn ends(&self, paths: &[CutPath]) -> [End; 2] {
        let slit = &paths[self.slit];
        [(first(slit), self.bars[0]), (last(slit), self.bars[1])]
            .map(|(end, bar)| bar.map_or([end; 2], |bar| [first(&paths[bar]), last(&paths[bar])]))
    }

    /// Bar, slit, bar, in either direction.
    fn paths(&self, back: bool) -> impl Iterator<Item = usize> + use<> {
        let [from, to] = if back { [self.bars[1], self.bars[0]] } else { self.bars };
        [from, Some(self.slit), to].into_iter().flatten()
    }
}

fn units(paths: &[CutPath]) -> Vec<Unit> {
    // Points that are within the tolerance of each other are in the same cell of this grid or in neighbouring ones.
    let cell = |point: Point| [point.x, point.y].map(|c| (c / (2.0 * SAME_POINT)).round() as i64);
    let mut bars: HashMap<[i64; 2], usize> = HashMap::new();
    for index in of_kind(paths, CutKind::Relief) {
        bars.insert(cell(first(&paths[index]).midpoint(last(&paths[index]))), index);
    }
    let mut taken = vec![false; paths.len()];
    let mut bar_at = |point: Point| {
        let [x, y] = cell(point);
        let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy]));
        let found = around.filter_map(|cell| bars.get(&cell).copied()).find(|&bar| !taken[bar]);
        found.inspect(|&bar| taken[bar] = true)
    };
    let slits = of_kind(paths, CutKind::Slit);
    let mut units: Vec<Unit> = slits
        .map(|slit| Unit { slit, bars: [bar_at(first(&paths[slit])), bar_at(last(&paths[slit]))] })
        .collect();
    let alone = of_kind(paths, CutKind::Relief).filter(|&bar| !taken[bar]);
    units.extend(alone.map(|bar| Unit { slit: bar, bars: [None, None] }));
    units
}

/// A cut in its own direction or back.
fn directed(path: &CutPath, back: bool) -> CutPath {
    let mut path = path.clone();
    if back && !path.closed {
        let count = path.vertices.len();
        let bulges: Vec<f64> = path.vertices.iter().map(|vertex| -vertex.bulge).collect();
        path.vertices.reverse();
        for (i, vertex) in path.vertices.iter_mut().enumerate() {
            vertex.bulge = if i + 1 < count { bulges[count - 2 - i] } else { 0.0 };
        }
    }
    path
}

/// A closed cut begun at each of the places that are well away from ligaments (their middles): its vertices and the
/// middles of its straight segments.
pub fn closed_starts(path: &CutPath, ligaments: &RTree<[f64; 2]>) -> Vec<CutPath> {
    let count = path.vertices.len();
    let next = |i: usize| path.vertices[(i + 1) % count].point;
    let vertices = (0..count).map(|i| (i, path.vertices[i].point, false));
    let straight = (0..count).filter(|&i| path.vertices[i].bulge == 0.0);
    let middles = straight.map(|i| (i, path.vertices[i].point.midpoint(next(i)), true));
    let places: Vec<(usize, Point, bool, f64)> = vertices
        .chain(middles)
        .map(|(i, at, middle)| (i, at, middle, nearest_in(ligaments, at).unwrap_or(f64::INFINITY)))
        .collect();
    let clearest = places.iter().map(|place| place.3).fold(0.0, f64::max);
    let well = |place: &&(usize, Point, bool, f64)| place.3 >= CLEAR.min(0.5 * clearest);
    let started = |&(i, point, middle, _): &(usize, Point, bool, f64)| {
        let mut path = path.clone();
        path.vertices.rotate_left(if middle { i + 1 } else { i });
        if middle {
            path.vertices.insert(0, PathVertex { point, bulge: 0.0 });
        }
        path
    };
    places.iter().filter(well).map(started).collect()
}

/// Appends the borders, each begun where that is nearest to where the cut before ended.
fn append_borders(mut borders: Vec<(usize, Vec<CutPath>)>, order: &mut Vec<CutPath>) {
    while !borders.is_empty() {
        let at = order.last().map_or(HOME, last);
        let distance = |path: &CutPath| first(path).distance(at);
        let mut best = (0, 0, f64::INFINITY);
        for (i, (_, starts)) in borders.iter().enumerate() {
            for (k, start) in starts.iter().enumerate() {
                if distance(start) < best.2 {
                    best = (i, k, distance(start));
                }
            }
        }
        let (_, mut starts) = borders.swap_remove(best.0);
        order.push(starts.swap_remove(best.1));
    }
}

/// Turns open cuts round, their order kept, so that the way between them is least: both ways of each in turn, from the
/// least to reach each of the cut before.
fn turned_for_least_travel(order: &mut [CutPath]) {
    // Least way to the beginning of the cut as it lies and turned, and which way the cut before lies then.
    let mut choices: Vec<[bool; 2]> = Vec::with_capacity(order.len());
    let mut least = [0.0, f64::INFINITY];
    let mut leaves = [HOME; 2];
    for path in order.iter() {
        let enters = [first(path), last(path)];
        let reach = |enter: Point| [0, 1].map(|from: usize| least[from] + leaves[from].distance(enter));
        let ways = enters.map(reach);
        choices.push(ways.map(|way| way[1] < way[0]));
        least = ways.map(|way| way[0].min(way[1]));
        leaves = [last(path), first(path)];
        if path.closed {
            (least[1], leaves) = (f64::INFINITY, [first(path); 2]);
        }
    }
    let mut back = least[1] < least[0];
    for (path, choice) in order.iter_mut().zip(choices).rev() {
        if back {
            *path = directed(path, true);
        }
        back = choice[usize::from(back)];
    }
}
