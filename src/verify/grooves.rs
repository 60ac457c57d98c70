//! The centre lines of all grooves, searchable by place.

use kurbo::{Point, Rect};
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, RTree};

use crate::fabrication::layout::CutPath;

/// Distance between a true arc and its chords, millimetres: a twentieth of the finest limit.
pub(super) const FLAT: f64 = 5e-4;

/// A straight piece of a centre line; arcs are flattened to within [`FLAT`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    /// Index of its cut.
    pub path: usize,
    /// Its ends, millimetres.
    pub ends: [Point; 2],
    /// Length of the cut before it.
    pub start: f64,
}

impl Segment {
    pub fn length(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }
}

/// All segments of all cuts, in cutting order, and an index of them.
pub(super) struct Grooves<'a> {
    /// The cuts.
    pub paths: &'a [CutPath],
    /// Their segments.
    pub segments: Vec<Segment>,
    /// Length of every cut.
    pub lengths: Vec<f64>,
    tree: RTree<GeomWithData<Line<[f64; 2]>, usize>>,
}

impl<'a> Grooves<'a> {
    pub fn new(paths: &'a [CutPath]) -> Self {
        let mut segments = Vec::new();
        let mut lengths = Vec::with_capacity(paths.len());
        for (path, cut) in paths.iter().enumerate() {
            let mut start = 0.0;
            for ends in cut.segments(FLAT) {
                // Without a length there is no direction; the path's own checks tell of such segments.
                let segment = Segment { path, ends, start };
                if segment.length() > 0.0 {
                    segments.push(segment);
                }
                start += segment.length();
            }
            lengths.push(start);
        }
        let line = |(index, segment): (usize, &Segment)| {
            let [from, to] = segment.ends.map(|point| [point.x, point.y]);
            GeomWithData::new(Line::new(from, to), index)
        };
        let tree = RTree::bulk_load(segments.iter().enumerate().map(line).collect());
        Self { paths, segments, lengths, tree }
    }

    /// Indices of the segments whose boxes meet a box, in no order.
    pub fn near(&self, place: Rect) -> impl Iterator<Item = usize> + '_ {
        let place = AABB::from_corners([place.x0, place.y0], [place.x1, place.y1]);
        self.tree.locate_in_envelope_intersecting(&place).map(|line| line.data)
    }

    /// Distance from a point to the nearest centre line, and that segment's index.
    pub fn nearest(&self, point: Point) -> Option<(f64, usize)> {
        let line = self.tree.nearest_neighbor(&[point.x, point.y])?;
        let foot = crate::fabrication::web::nearest_on_segment(point, self.segments[line.data].ends);
        Some((point.distance(foot), line.data))
    }
}

/// The square of half side `reach` about a point.
pub(super) fn around(point: Point, reach: f64) -> Rect {
    Rect::from_points(point, point).inflate(reach, reach)
}
