//! The order of the cuts: slits with their relief bars by nearest neighbour, then windows, then the border, so
//! that the sheet stays clamped by its frame to the end.

use kurbo::Point;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::cuts::{CutSet, HingeCuts};
use crate::fabrication::layout::{CutKind, CutPath, PathVertex};

/// A slit's end as stored in the search tree: position, slit, and which of its ends.
type SlitEnd = GeomWithData<[f64; 2], (usize, usize)>;

/// The same cuts in cutting order, with all indices of the set brought along.
///
/// A unit is a slit between its relief bars: bar, slit, bar. The next unit is the one whose slit ends nearest to
/// where the last one stopped; the first is nearest to the origin. Closed cuts start at their vertex farthest from
/// any hinge.
pub fn in_cutting_order(set: &CutSet) -> CutSet {
    let mut steps = slit_steps(set);
    let closed = |kind: CutKind| (0..set.paths.len()).filter(move |&i| set.paths[i].kind == kind);
    let ends = |cuts: &HingeCuts| {
        let slit = &set.slits[cuts.slit];
        let bar = cuts.relief.map(|bar| vec![set.paths[bar].vertices[0].point]);
        bar.unwrap_or_else(|| vec![slit.points[0], slit.points[slit.points.len() - 1]])
    };
    let reliefs: Vec<Point> = set.hinges.iter().flat_map(ends).collect();
    for index in closed(CutKind::Window).chain(closed(CutKind::Border)) {
        steps.push((index, started_far_from(&set.paths[index], &reliefs)));
    }
    let mut new_index = vec![0; set.paths.len()];
    for (new, &(old, _)) in steps.iter().enumerate() {
        new_index[old] = new;
    }
    let mut ordered = set.clone();
    for hinge in &mut ordered.hinges {
        hinge.relief = hinge.relief.map(|bar| new_index[bar]);
        hinge.slit = new_index[hinge.slit];
        for path in hinge.passing.iter_mut().chain(&mut hinge.across) {
            *path = new_index[*path];
        }
    }
    for touch in &mut ordered.touches {
        touch.paths = touch.paths.map(|path| new_index[path]);
    }
    ordered.paths = steps.into_iter().map(|(_, path)| path).collect();
    ordered
}

/// Slits and relief bars with their old indices, in cutting order and direction.
fn slit_steps(set: &CutSet) -> Vec<(usize, CutPath)> {
    let ends = set.slits.iter().enumerate().flat_map(|(slit, cut)| {
        let points = [cut.points[0], cut.points[cut.points.len() - 1]];
        [0, 1].map(|end| SlitEnd::new([points[end].x, points[end].y], (slit, end)))
    });
    let mut left: RTree<SlitEnd> = RTree::bulk_load(ends.collect());
    let mut steps = Vec::new();
    let mut at = Point::ORIGIN;
    while let Some(&nearest) = left.nearest_neighbor(&[at.x, at.y]) {
        let (slit, first) = nearest.data;
        let cut = &set.slits[slit];
        let other = if first == 0 { cut.points[cut.points.len() - 1] } else { cut.points[0] };
        left.remove(&nearest);
        left.remove(&SlitEnd::new([other.x, other.y], (slit, 1 - first)));
        let bar = |end: usize| cut.hinges[end].and_then(|hinge| set.hinges[hinge].relief);
        for index in [bar(first), Some(slit), bar(1 - first)].into_iter().flatten() {
            let mut path = set.paths[index].clone();
            if index == slit {
                orient(&mut path, first == 1)
            } else {
                start_near(&mut path, at)
            }
            at = path.vertices[path.vertices.len() - 1].point;
            steps.push((index, path));
        }
    }
    steps
}

/// Reverses an open path of straight segments if asked to.
fn orient(path: &mut CutPath, reverse: bool) {
    if reverse {
        path.vertices.reverse();
    }
}

fn start_near(path: &mut CutPath, at: Point) {
    let [first, last] = [0, path.vertices.len() - 1].map(|i| path.vertices[i].point.distance(at));
    orient(path, last < first);
}

/// A closed path that starts at its vertex farthest from the given points.
fn started_far_from(path: &CutPath, points: &[Point]) -> CutPath {
    let clearance = |vertex: &PathVertex| {
        points.iter().map(|point| point.distance_squared(vertex.point)).fold(f64::INFINITY, f64::min)
    };
    let mut best = (0, f64::NEG_INFINITY);
    for (index, vertex) in path.vertices.iter().enumerate() {
        let clearance = clearance(vertex);
        if clearance > best.1 {
            best = (index, clearance);
        }
    }
    let mut path = path.clone();
    path.vertices.rotate_left(best.0);
    path
}
