//! A closed walk measured by its length: where the tool is after so many millimetres, and where it is far from hinges.

use std::collections::HashMap;

use kurbo::{Point, Vec2};
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};

use super::walk::Walk;
use crate::fabrication::hinge_table::HingeRow;
use crate::fabrication::web::nearest_on_segment;
use crate::solid::strokes::Strokes;

/// A place on a walk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// Length from the beginning, millimetres.
    pub along: f64,
    /// Where, at mid-plane.
    pub at: Point,
    /// The tool's axis: (dx/dz, dy/dz).
    pub lean: Vec2,
}

/// A closed walk.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Its nodes; the first is repeated at the end.
    stations: Vec<Station>,
    /// Of each stretch between two nodes the one that runs back along it.
    back: Vec<Option<usize>>,
}

impl Track {
    /// A walk on a network.
    pub fn new(walk: &Walk, strokes: &Strokes) -> Self {
        let mut stations: Vec<Station> = Vec::with_capacity(walk.nodes.len() + 1);
        for &node in walk.nodes.iter().chain(walk.nodes.first()) {
            let node = strokes.nodes[node];
            let along = stations.last().map_or(0.0, |last| last.along + last.at.distance(node.at));
            stations.push(Station { along, at: node.at, lean: node.lean });
        }
        let count = walk.nodes.len();
        let ends = |i: usize| [walk.nodes[i], walk.nodes[(i + 1) % count]];
        let places: HashMap<[usize; 2], usize> = (0..count).map(|i| (ends(i), i)).collect();
        let back = (0..count).map(|i| {
            let [from, to] = ends(i);
            places.get(&[to, from]).copied().filter(|&other| other != i)
        });
        Self { stations, back: back.collect() }
    }

    /// The place where the walk comes by again, back along the same line; `None` where it does not.
    pub fn mirrored(&self, along: f64) -> Option<f64> {
        let length = self.length().max(f64::MIN_POSITIVE);
        let once = along - (along / length).floor() * length;
        let stretch = self.stations.partition_point(|station| station.along <= once).max(1) - 1;
        let back = self.back.get(stretch).copied().flatten()?;
        Some(self.stations[back + 1].along - (once - self.stations[stretch].along))
    }

    /// Whether a stretch between two neighbouring nodes runs back along what was passed since `since`.
    pub fn retraces(&self, since: f64, [from, to]: [f64; 2]) -> bool {
        let Some(middle) = self.mirrored(0.5 * (from + to)) else { return false };
        let (length, half) = (self.length().max(f64::MIN_POSITIVE), 0.5 * (to - from));
        // The last time before `from` that it was passed.
        let turn = ((from - (middle + half) + NEAR) / length).floor() * length;
        middle - half + turn >= since - NEAR
    }

    /// Once around, millimetres.
    pub fn length(&self) -> f64 {
        self.stations.last().map_or(0.0, |last| last.along)
    }

    /// The steepest lean on it.
    pub fn steepest(&self) -> f64 {
        self.stations.iter().map(|station| station.lean.hypot()).fold(0.0, f64::max)
    }

    /// The place after a length, which may be more than once around.
    pub fn at(&self, along: f64) -> Station {
        let length = self.length().max(f64::MIN_POSITIVE);
        let once = along - (along / length).floor() * length;
        let after = self.stations.partition_point(|station| station.along <= once);
        let [a, b] = [after.max(1) - 1, after.min(self.stations.len() - 1)].map(|i| self.stations[i]);
        let part = if b.along > a.along { (once - a.along) / (b.along - a.along) } else { 0.0 };
        Station { along, at: a.at.lerp(b.at, part), lean: a.lean.lerp(b.lean, part) }
    }

    /// The nodes strictly between two lengths, rising, then the place at `to`.
    pub fn between(&self, from: f64, to: f64) -> Vec<Station> {
        let length = self.length().max(f64::MIN_POSITIVE);
        let mut places = Vec::new();
        let mut turn = (from / length).floor();
        while turn * length < to {
            let nodes = self.stations[1..].iter();
            places.extend(nodes.map(|station| Station { along: station.along + turn * length, ..*station }));
            turn += 1.0;
        }
        places.retain(|station| station.along > from + NEAR && station.along < to - NEAR);
        places.push(self.at(to));
        places
    }

    /// The stretches, as lengths from and to, where no place of `avoid` is near; the last may go on beyond the end.
    pub fn clear(&self, avoid: &Avoid) -> Vec<[f64; 2]> {
        let mut blocked: Vec<[f64; 2]> = Vec::new();
        for pair in self.stations.windows(2) {
            avoid.on([pair[0].at, pair[1].at], |from, to| {
                blocked.push([pair[0].along + from, pair[0].along + to]);
            });
        }
        blocked.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let length = self.length();
        let Some(first) = blocked.first().copied() else { return vec![[0.0, length]] };
        let mut clear = Vec::new();
        let mut end = first[1];
        for next in blocked.iter().skip(1).copied().chain([[first[0] + length, 0.0]]) {
            if next[0] > end + NEAR {
                clear.push([end, next[0]]);
            }
            end = end.max(next[1]);
        }
        clear
    }
}

/// Places nearer to each other than this along a walk are one, millimetres.
const NEAR: f64 = 1e-6;

/// Places to keep away from.
#[derive(Debug, Clone)]
pub struct Avoid {
    tree: RTree<GeomWithData<[f64; 2], f64>>,
    largest: f64,
}

impl Avoid {
    /// Ligaments, with the straight stretch of the groove that passes them, and further places with their radii.
    pub fn new(hinges: &[HingeRow], radius: f64, more: impl IntoIterator<Item = (Point, f64)>) -> Self {
        let ligaments = hinges.iter().map(|row| {
            let along = 0.5 * row.length + 3.0 * radius;
            GeomWithData::new([row.point.x, row.point.y], along.hypot(0.5 * row.width + radius))
        });
        let more = more.into_iter().map(|(at, radius)| GeomWithData::new([at.x, at.y], radius));
        let places: Vec<_> = ligaments.chain(more).collect();
        let largest = places.iter().map(|place| place.data).fold(0.0, f64::max);
        Self { tree: RTree::bulk_load(places), largest }
    }

    /// Tells between which lengths along a segment a place is near.
    fn on(&self, [a, b]: [Point; 2], mut tell: impl FnMut(f64, f64)) {
        let low = [a.x.min(b.x) - self.largest, a.y.min(b.y) - self.largest];
        let high = [a.x.max(b.x) + self.largest, a.y.max(b.y) + self.largest];
        let length = a.distance(b);
        for place in self.tree.locate_in_envelope(&AABB::from_corners(low, high)) {
            let (centre, radius) = (Point::from((place.geom()[0], place.geom()[1])), place.data);
            if nearest_on_segment(centre, [a, b]).distance(centre) >= radius {
                continue;
            }
            let along = (b - a).normalize();
            let foot = (centre - a).dot(along);
            let half = (radius * radius - (centre - a).cross(along).powi(2)).max(0.0).sqrt();
            tell((foot - half).max(0.0), (foot + half).min(length));
        }
    }
}
