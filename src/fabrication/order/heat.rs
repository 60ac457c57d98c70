//! Cuts in an order that lets hinges cool: what is near a ligament is cut only when it has rested for a while.
//!
//! A hinge rests since the last cut that came within a given distance of it; so cuts that follow each other sooner than it
//! rests are at least that far from each other's hinges. From where it is the head goes to the nearest cut all of whose ligaments have rested; where none of the nearest has, to
//! the one that has rested longest. Bars and slits are cut apart from each other, as they meet at a ligament.

use kurbo::{Point, Rect};
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};

use super::{HOME, directed, first, last};
use crate::fabrication::cuts::ARC_TOLERANCE;
use crate::fabrication::layout::CutPath;
use crate::fabrication::web::nearest_on_segment;

/// How many of the nearest beginnings are looked at.
const SEARCHED: usize = 200;

/// How fast the machine is, and how near to a ligament a cut heats it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pace {
    /// Millimetres per second, cutting.
    pub cutting: f64,
    /// Millimetres per second, between cuts.
    pub rapid: f64,
    /// Seconds per cut before it moves.
    pub pierce: f64,
    /// A cut that comes so near to a ligament's middle heats it, millimetres.
    pub reach: f64,
}

/// What hinges are to be spared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cooling {
    /// How long a ligament is to rest before a cut at it begins, seconds.
    pub cool: f64,
    /// How near a cut comes that heats it, millimetres; `None`: as near as the cuts at it.
    pub within: Option<f64>,
}

/// The ligaments that come within reach of each cut.
fn heated(paths: &[CutPath], ligaments: &[Point], reach: f64) -> Vec<Vec<usize>> {
    let item = |(i, p): (usize, &Point)| GeomWithData::new([p.x, p.y], i);
    let tree = RTree::bulk_load(ligaments.iter().enumerate().map(item).collect());
    let near = |segment: [Point; 2]| {
        let place = Rect::from_points(segment[0], segment[1]).inflate(reach, reach);
        let place = AABB::from_corners([place.x0, place.y0], [place.x1, place.y1]);
        let found: Vec<usize> = tree.locate_in_envelope(&place).map(|item| item.data).collect();
        found
            .into_iter()
            .filter(move |&i| nearest_on_segment(ligaments[i], segment).distance(ligaments[i]) <= reach)
    };
    let of = |path: &CutPath| {
        let mut all: Vec<usize> = path.segments(ARC_TOLERANCE).into_iter().flat_map(near).collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    paths.iter().map(of).collect()
}

/// The clock, the head, and when each ligament was last heated.
struct Run<'a> {
    pace: &'a Pace,
    at: Point,
    now: f64,
    heated: Vec<f64>,
}

impl<'a> Run<'a> {
    fn new(pace: &'a Pace, ligaments: usize) -> Self {
        Self { pace, at: HOME, now: 0.0, heated: vec![f64::NEG_INFINITY; ligaments] }
    }

    /// Seconds since any of the ligaments was heated, if a cut at `place` came next.
    fn rest(&self, place: Point, ligaments: &[usize]) -> f64 {
        let start = self.now + self.at.distance(place) / self.pace.rapid;
        ligaments.iter().map(|&i| start - self.heated[i]).fold(f64::INFINITY, f64::min)
    }

    fn cut(&mut self, path: &CutPath, ligaments: &[usize]) {
        self.now += self.at.distance(first(path)) / self.pace.rapid;
        self.now += self.pace.pierce + path.length() / self.pace.cutting;
        self.at = last(path);
        ligaments.iter().for_each(|&i| self.heated[i] = self.now);
    }
}

/// How long ligaments rest between cuts, and how far apart cuts are that follow each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// Least seconds between the end of a cut at a ligament and the beginning of the next one there; infinite where no
    /// ligament is heated twice.
    pub least: f64,
    /// Number of cuts that begin sooner than asked.
    pub early: usize,
    /// Least distance between a ligament at which a cut is made and the cut just before that, millimetres; infinite where
    /// there are none.
    pub apart: f64,
}

/// The rest that an order gives ligaments, `cool` seconds being asked for.
pub fn rest(order: &[CutPath], ligaments: &[Point], pace: &Pace, cool: f64) -> Rest {
    let mut run = Run::new(pace, ligaments.len());
    let mut found = Rest { least: f64::INFINITY, early: 0, apart: f64::INFINITY };
    let mut before: Option<&CutPath> = None;
    for (path, near) in order.iter().zip(heated(order, ligaments, pace.reach)) {
        if let Some(before) = before.replace(path).filter(|_| !near.is_empty()) {
            let segments = before.segments(ARC_TOLERANCE);
            let apart = |at: Point| segments.iter().map(move |&s| nearest_on_segment(at, s).distance(at));
            found.apart = near.iter().flat_map(|&i| apart(ligaments[i])).fold(found.apart, f64::min);
        }
        let rest = run.rest(first(path), &near);
        found.least = found.least.min(rest);
        found.early += usize::from(rest < cool);
        run.cut(path, &near);
    }
    found
}

/// The open cuts and windows of an order so that every ligament rests before a cut wherever that can be had; then the rest
/// of the order as it is.
pub fn cooled(order: &[CutPath], ligaments: &[Point], pace: &Pace, cooling: Cooling) -> Vec<CutPath> {
    let near = heated(order, ligaments, pace.reach);
    let warmed =
        cooling.within.filter(|&within| within > pace.reach).map(|within| heated(order, ligaments, within));
    let warmed = warmed.as_ref().unwrap_or(&near);
    let mut run = Run::new(pace, ligaments.len());
    let mut made = Vec::with_capacity(order.len());
    let ranks: [fn(&CutPath) -> bool; 2] =
        [|path| !path.closed, |path| path.closed && path.kind != super::CutKind::Border];
    for wanted in ranks {
        let ends = order.iter().enumerate().filter(|(_, path)| wanted(path)).flat_map(|(i, path)| {
            let sides = if path.closed { 1 } else { 2 };
            [(first(path), false), (last(path), true)]
                .into_iter()
                .take(sides)
                .map(move |(p, back)| Begin::new([p.x, p.y], (i, back)))
        });
        let mut left: RTree<Begin> = RTree::bulk_load(ends.collect());
        while let Some((index, back)) = next(&left, &run, &near, cooling.cool) {
            let path = directed(&order[index], back);
            for (point, back) in [(first(&order[index]), false), (last(&order[index]), true)] {
                left.remove(&Begin::new([point.x, point.y], (index, back)));
            }
            run.cut(&path, &warmed[index]);
            made.push(path);
        }
    }
    made.extend(order.iter().filter(|path| path.kind == super::CutKind::Border).cloned());
    made
}

/// Where a cut may begin: its index, and whether that is its last vertex.
type Begin = GeomWithData<[f64; 2], (usize, bool)>;

/// The nearest cut that is cool, or of the nearest the coolest.
fn next(left: &RTree<Begin>, run: &Run, near: &[Vec<usize>], cool: f64) -> Option<(usize, bool)> {
    let mut best: Option<(f64, (usize, bool))> = None;
    for begin in left.nearest_neighbor_iter(&[run.at.x, run.at.y]).take(SEARCHED) {
        let [x, y] = *begin.geom();
        let rest = run.rest(Point::new(x, y), &near[begin.data.0]);
        if rest >= cool {
            return Some(begin.data);
        }
        if best.is_none_or(|(most, _)| rest > most) {
            best = Some((rest, begin.data));
        }
    }
    best.map(|(_, data)| data)
}
