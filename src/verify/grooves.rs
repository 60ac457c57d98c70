//! The centre lines of all grooves, searchable by place.

use kurbo::{Point, Rect};
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, RTree};

use crate::fabrication::layout::CutPath;
use crate::fabrication::web::nearest_on_segment;

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
    tree: Lines,
    /// How far from a place its nearest groove usually is at most, millimetres.
    reach: f64,
}

/// Straight lines by place, with their numbers.
pub(super) type Lines = RTree<GeomWithData<Line<[f64; 2]>, usize>>;

/// The line that is nearest to a point, the first of several, and its distance; looked for within `reach` first, which
/// takes less time than anywhere.
pub(super) fn nearest_line(tree: &Lines, point: Point, reach: f64) -> Option<(f64, usize)> {
    let measured = |line: &GeomWithData<Line<[f64; 2]>, usize>| {
        let ends = [line.geom().from, line.geom().to].map(|[x, y]| Point::new(x, y));
        (nearest_on_segment(point, ends).distance(point), line.data)
    };
    let Rect { x0, y0, x1, y1 } = around(point, reach);
    let near = tree.locate_in_envelope_intersecting(&AABB::from_corners([x0, y0], [x1, y1])).map(measured);
    let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    nearest
        .filter(|(distance, _)| *distance <= reach)
        .or_else(|| tree.nearest_neighbor(&[point.x, point.y]).map(measured))
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
        // Pieces are a few segments wide.
        let reach = 0.25 * lengths.iter().sum::<f64>() / segments.len().max(1) as f64;
        Self { paths, segments, lengths, tree, reach }
    }

    /// Indices of the segments whose boxes meet a box, in no order.
    pub fn near(&self, place: Rect) -> impl Iterator<Item = usize> + '_ {
        let place = AABB::from_corners([place.x0, place.y0], [place.x1, place.y1]);
        self.tree.locate_in_envelope_intersecting(&place).map(|line| line.data)
    }

    /// Distance from a point to the nearest centre line, and that segment's index.
    pub fn nearest(&self, point: Point) -> Option<(f64, usize)> {
        nearest_line(&self.tree, point, self.reach)
    }
}

/// The square of half side `reach` about a point.
pub(super) fn around(point: Point, reach: f64) -> Rect {
    Rect::from_points(point, point).inflate(reach, reach)
}
