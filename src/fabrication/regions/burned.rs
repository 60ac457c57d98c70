//! The grooves of all cuts by place.

use kurbo::Rect;
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use crate::fabrication::cuts::ARC_TOLERANCE;
use crate::fabrication::layout::{CutKind, CutPath};
use crate::fabrication::outline::{Contour, Shape, contains, contour_box, groove, stroke, subtract};

/// The box of a path or of one of its segments, with the indices of both.
type Segment = GeomWithData<Rectangle<[f64; 2]>, (usize, usize)>;

/// The cuts by place.
pub(super) struct Cuts<'a> {
    paths: &'a [CutPath],
    /// Every path as points.
    lines: Vec<Contour>,
    /// The grooves of open paths.
    grooves: Vec<Vec<Shape>>,
    /// Boxes of the open paths, and of each segment of the closed ones: the path's index and the segment's.
    tree: RTree<Segment>,
    /// The box of them all.
    pub bounds: Rect,
    pub kerf: f64,
}

impl<'a> Cuts<'a> {
    pub fn new(paths: &'a [CutPath], kerf: f64) -> Self {
        let points = |path: &CutPath| -> Contour {
            path.flatten(ARC_TOLERANCE).into_iter().map(|point| [point.x, point.y]).collect()
        };
        let lines: Vec<Contour> = paths.par_iter().map(points).collect();
        let burned = |(path, line): (&CutPath, &Contour)| {
            if path.closed { Vec::new() } else { groove(line, kerf) }
        };
        let grooves = paths.par_iter().zip(&lines).map(burned).collect();
        let item = |index: usize, segment: usize, part: &[[f64; 2]]| {
            let Rect { x0, y0, x1, y1 } = contour_box(part);
            GeomWithData::new(Rectangle::from_corners([x0, y0], [x1, y1]), (index, segment))
        };
        let mut items = Vec::with_capacity(paths.len());
        for (index, (path, line)) in paths.iter().zip(&lines).enumerate() {
            if path.closed {
                let segment = |k: usize| item(index, k, &[line[k], line[(k + 1) % line.len()]]);
                items.extend((0..line.len()).map(segment));
            } else {
                items.push(item(index, 0, line));
            }
        }
        let bounds = lines.iter().fold(contour_box(&[]), |all, line| all.union(contour_box(line)));
        Cuts { paths, lines, grooves, tree: RTree::bulk_load(items), bounds, kerf }
    }

    /// The grooves in a box; outside of it they may end anywhere.
    fn grooves(&self, place: Rect) -> Vec<Shape> {
        let near = place.inflate(self.kerf, self.kerf);
        let corners = AABB::from_corners([near.x0, near.y0], [near.x1, near.y1]);
        let mut found: Vec<(usize, usize)> =
            self.tree.locate_in_envelope_intersecting(&corners).map(|item| item.data).collect();
        found.sort_unstable();
        let (mut grooves, mut open, mut closed) = (Vec::new(), Vec::new(), Vec::new());
        for run in found.chunk_by(|a, b| a.0 == b.0) {
            let index = run[0].0;
            let line = &self.lines[index];
            if !self.paths[index].closed {
                let parts = self.grooves[index].iter().flatten().map(|contour| clipped(contour, near));
                grooves.extend(parts.filter(|part| part.len() > 2).map(|part| vec![part]));
            } else if run.len() == line.len() {
                closed.push(line.clone());
            } else {
                let parts = run.chunk_by(|a, b| a.1 + 1 == b.1);
                let part = |part: &[(usize, usize)]| -> Contour {
                    (part[0].1..=part[part.len() - 1].1 + 1).map(|k| line[k % line.len()]).collect()
                };
                open.extend(parts.map(part));
            }
        }
        for (lines, closed) in [(open, false), (closed, true)] {
            if !lines.is_empty() {
                grooves.extend(stroke(lines, self.kerf, closed));
            }
        }
        grooves
    }

    /// What the grooves and further `holes` leave of a box.
    pub fn left(&self, place: Rect, holes: impl Iterator<Item = Contour>) -> Vec<Shape> {
        let Rect { x0, y0, x1, y1 } = place;
        let sheet = vec![vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]]];
        let mut burned = self.grooves(place);
        burned.extend(holes.map(|hole| vec![hole]));
        subtract(&sheet, &burned)
    }

    /// Whether a point lies in the sheet: inside of the border and of no window.
    pub fn in_sheet(&self, point: [f64; 2]) -> bool {
        let around = |kind: CutKind| {
            let closed = self.paths.iter().zip(&self.lines).filter(|(path, _)| path.kind == kind);
            closed.into_iter().any(|(_, line)| contains(line, point))
        };
        around(CutKind::Border) && !around(CutKind::Window)
    }
}

/// The part of a contour in a box. Where it leaves the box and comes back it runs along the box's edge, maybe twice.
fn clipped(contour: &Contour, place: Rect) -> Contour {
    let Rect { x0, y0, x1, y1 } = place;
    let mut points = contour.clone();
    // Per side of the box: the coordinate, its bound, and on which side of it lies the box.
    for (axis, bound, sign) in [(0, x0, 1.0), (0, x1, -1.0), (1, y0, 1.0), (1, y1, -1.0)] {
        let depth = |point: &[f64; 2]| sign * (point[axis] - bound);
        if points.iter().all(|point| depth(point) >= 0.0) {
            continue;
        }
        let mut kept = Vec::with_capacity(points.len());
        for (i, b) in points.iter().enumerate() {
            let a = &points[(i + points.len() - 1) % points.len()];
            let [s, t] = [depth(a), depth(b)];
            if (s < 0.0) != (t < 0.0) {
                let part = s / (s - t);
                kept.push([0, 1].map(|k| a[k] + part * (b[k] - a[k])));
            }
            if t >= 0.0 {
                kept.push(*b);
            }
        }
        points = kept;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabrication::outline::area;

    #[test]
    fn a_clipped_contour_has_the_area_that_is_in_the_box() {
        // A U of 3 x 3 with a slot of 1 x 2 from above; the box cuts both of its legs.
        let points = [[0., 0.], [3., 0.], [3., 3.], [2., 3.], [2., 1.], [1., 1.], [1., 3.], [0., 3.]];
        for (place, expected) in [
            (Rect::new(-1.0, -1.0, 4.0, 4.0), 7.0),
            (Rect::new(-1.0, 2.0, 4.0, 4.0), 2.0),
            (Rect::new(0.5, 0.5, 2.5, 2.0), 2.0),
            (Rect::new(1.2, 1.5, 1.8, 2.5), 0.0),
            (Rect::new(5.0, 5.0, 6.0, 6.0), 0.0),
        ] {
            let part = clipped(&points.to_vec(), place);
            let closed: Contour = part.iter().chain(part.first()).copied().collect();
            assert!((area(&closed) - expected).abs() < 1e-12, "{place:?} {part:?}");
            let whole = place.inflate(1e-12, 1e-12);
            assert!(part.iter().all(|&[x, y]| whole.contains(kurbo::Point::new(x, y))));
        }
    }
}
