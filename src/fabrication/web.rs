//! How much material stands between cuts.

use kurbo::Point;
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, PointDistance, RTree};

use super::cuts::{ARC_TOLERANCE, Touch};
use super::error::FabricationError;
use super::layout::{CutKind, CutPath};

/// A straight piece of a cut's centre line and the index of its path.
type Segment = GeomWithData<Line<[f64; 2]>, usize>;

/// All cuts' segments, searchable by place.
#[derive(Debug, Clone)]
pub struct CutIndex {
    tree: RTree<Segment>,
}

impl CutIndex {
    /// Indexes the segments of all paths, arcs flattened.
    pub fn new(paths: &[CutPath]) -> Self {
        let segments = paths.iter().enumerate().flat_map(|(index, path)| {
            path.segments(ARC_TOLERANCE)
                .into_iter()
                .map(move |[a, b]| Segment::new(Line::new([a.x, a.y], [b.x, b.y]), index))
        });
        CutIndex { tree: RTree::bulk_load(segments.collect()) }
    }

    /// Least distance between the centre line of `bar` (a straight segment) and that of any path not in `except`;
    /// infinite if there is none.
    pub fn nearest(&self, bar: [Point; 2], except: &[usize]) -> f64 {
        let middle = bar[0].midpoint(bar[1]);
        let half = 0.5 * bar[0].distance(bar[1]);
        let mut best = f64::INFINITY;
        for segment in self.tree.nearest_neighbor_iter(&[middle.x, middle.y]) {
            if segment.distance_2(&[middle.x, middle.y]).sqrt() - half > best {
                break;
            }
            if !except.contains(&segment.data) {
                best = best.min(segment_gap(bar, ends(segment)).0);
            }
        }
        best
    }
}

fn ends(segment: &Segment) -> [Point; 2] {
    let [from, to] = [segment.geom().from, segment.geom().to];
    [Point::new(from[0], from[1]), Point::new(to[0], to[1])]
}

/// Checks that between any two different cuts at least `min_web` of material stands beside the burned grooves.
///
/// Cuts that meet on purpose are exempt where they meet: as far as two webs and kerfs from the meeting point.
///
/// # Errors
/// Names the narrowest place.
pub fn check_webs(
    paths: &[CutPath],
    on_purpose: &[Touch],
    index: &CutIndex,
    kerf: f64,
    min_web: f64,
) -> Result<(), FabricationError> {
    let needed = kerf + min_web;
    let mut touches = vec![Vec::new(); paths.len()];
    for touch in on_purpose {
        touches[touch.paths[0]].push((touch.paths[1], touch.point));
        touches[touch.paths[1]].push((touch.paths[0], touch.point));
    }
    let narrowest = |segment: &&Segment| {
        let [a, b] = ends(segment);
        let mut worst: Option<(f64, Point, [usize; 2])> = None;
        let low = [a.x.min(b.x) - needed, a.y.min(b.y) - needed];
        let high = [a.x.max(b.x) + needed, a.y.max(b.y) + needed];
        for other in index.tree.locate_in_envelope_intersecting(&AABB::from_corners(low, high)) {
            if other.data <= segment.data {
                continue; // each pair of paths once, no path against itself
            }
            let (gap, at) = segment_gap([a, b], ends(other));
            let meets = touches[segment.data]
                .iter()
                .any(|&(path, point)| path == other.data && point.distance(at) < 2.0 * needed);
            let pair = [segment.data, other.data];
            if !meets && worst.is_none_or(|(least, _, narrow)| (gap, pair) < (least, narrow)) {
                worst = Some((gap, at, pair));
            }
        }
        worst
    };
    let segments: Vec<&Segment> = index.tree.iter().collect();
    let worst =
        segments.par_iter().filter_map(narrowest).min_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
    // A micrometre: ligaments may be exactly as wide as the least web.
    match worst {
        Some((gap, at, pair)) if gap < needed - 1e-3 => {
            let [first, second] = pair.map(|path| kind_name(paths[path].kind));
            Err(FabricationError::Web { first, second, x: at.x, y: at.y, web: gap - kerf, limit: min_web })
        }
        _ => Ok(()),
    }
}

/// What a cut of a kind is called in messages.
pub fn kind_name(kind: CutKind) -> &'static str {
    match kind {
        CutKind::Slit => "slit",
        CutKind::Relief => "relief",
        CutKind::Window => "window",
        CutKind::Border => "border",
        CutKind::Lead => "lead",
    }
}

/// Distance between two segments and the point midway between their nearest points.
pub fn segment_gap(a: [Point; 2], b: [Point; 2]) -> (f64, Point) {
    if let Some(point) = crossing(a, b) {
        return (0.0, point);
    }
    let candidates = [(a[0], b), (a[1], b), (b[0], a), (b[1], a)].map(|(point, segment)| {
        let foot = nearest_on_segment(point, segment);
        (point.distance(foot), point.midpoint(foot))
    });
    candidates.into_iter().fold(candidates[0], |best, next| if next.0 < best.0 { next } else { best })
}

/// The point of a segment that is nearest to `point`.
pub fn nearest_on_segment(point: Point, [from, to]: [Point; 2]) -> Point {
    let along = to - from;
    let length2 = along.hypot2();
    let part = if length2 > 0.0 { ((point - from).dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    from + part * along
}

/// Where two segments properly cross.
fn crossing([a, b]: [Point; 2], [c, d]: [Point; 2]) -> Option<Point> {
    let (u, v, w) = (b - a, d - c, c - a);
    let area = u.cross(v);
    if area == 0.0 {
        return None; // parallel: the end points' distances decide
    }
    let (s, t) = (w.cross(v) / area, w.cross(u) / area);
    ((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)).then(|| a + s * u)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segment(ax: f64, ay: f64, bx: f64, by: f64) -> [Point; 2] {
        [Point::new(ax, ay), Point::new(bx, by)]
    }

    #[test]
    fn gap_of_crossing_parallel_and_skew_segments() {
        // Closed forms on small integers: exact in floating point.
        assert_eq!(segment_gap(segment(0., 0., 2., 2.), segment(0., 2., 2., 0.)), (0.0, Point::new(1., 1.)));
        assert_eq!(segment_gap(segment(0., 0., 4., 0.), segment(1., 3., 9., 3.)).0, 3.0);
        assert_eq!(segment_gap(segment(0., 0., 1., 0.), segment(4., 4., 4., 9.)).0, 5.0);
        assert_eq!(segment_gap(segment(0., 0., 0., 0.), segment(3., -1., 3., 1.)).0, 3.0);
    }
}
