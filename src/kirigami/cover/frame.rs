//! The smallest rectangle around an outline.

use crate::geometry::{Point2, Vector2};

/// The outline's smallest bounding rectangle: a frame for the grid.
pub(super) struct Frame {
    pub corner: Point2,
    pub axis: Vector2,
    pub size: Vector2,
}

impl Frame {
    /// Around an outline; of its four directions the one nearest to `first`.
    pub fn smallest_rectangle(outline: &[Point2], first: &Vector2) -> Self {
        let hull = convex_hull(outline);
        let mut best: Option<(f64, Vector2)> = None;
        for i in 0..hull.len() {
            let Some(axis) = (hull[(i + 1) % hull.len()] - hull[i]).try_normalize(0.0) else { continue };
            let (low, high) = extent(&hull, &axis);
            let area = (high.x - low.x) * (high.y - low.y);
            // Nearly equal rectangles are told apart by the first one found: 1e-9 is far above rounding.
            if best.is_none_or(|(least, _)| area < least * (1.0 - 1e-9)) {
                best = Some((area, axis));
            }
        }
        let axis = best.map_or(Vector2::x(), |(_, axis)| axis);
        let turned = |v: Vector2| Vector2::new(-v.y, v.x);
        let candidates = [axis, turned(axis), -axis, -turned(axis)];
        let axis =
            candidates.into_iter().max_by(|u, v| u.dot(first).total_cmp(&v.dot(first))).unwrap_or(axis);
        let (low, high) = extent(&hull, &axis);
        let corner = Point2::from(axis * low.x + turned(axis) * low.y);
        Self { corner, axis, size: high - low }
    }

    /// Coordinates of a point of the plane in this frame.
    pub fn local(&self, p: &Point2) -> Point2 {
        let from = p - self.corner;
        Point2::new(from.dot(&self.axis), self.axis.perp(&from))
    }

    /// The point of the plane with these coordinates in this frame.
    pub fn point(&self, x: f64, y: f64) -> Point2 {
        self.corner + self.axis * x + Vector2::new(-self.axis.y, self.axis.x) * y
    }
}

/// Least and largest coordinates along an axis and across it.
pub(super) fn extent(points: &[Point2], axis: &Vector2) -> (Vector2, Vector2) {
    let across = Vector2::new(-axis.y, axis.x);
    let start = (Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY));
    points.iter().fold(start, |(low, high), p| {
        let v = Vector2::new(p.coords.dot(axis), p.coords.dot(&across));
        (low.inf(&v), high.sup(&v))
    })
}

/// A point, with its coordinates along and across an axis (a unit vector) multiplied.
pub fn stretched(p: &Point2, axis: &Vector2, [along, across]: [f64; 2]) -> Point2 {
    let normal = Vector2::new(-axis.y, axis.x);
    Point2::from(axis * (along * p.coords.dot(axis)) + normal * (across * p.coords.dot(&normal)))
}

/// Convex hull, counter-clockwise (A. M. Andrew's monotone chain, 1979).
fn convex_hull(points: &[Point2]) -> Vec<Point2> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    let chain = |order: &mut dyn Iterator<Item = &Point2>| {
        let mut hull: Vec<Point2> = Vec::new();
        for p in order {
            while let [.., a, b] = hull[..] {
                if (b - a).perp(&(p - a)) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(*p);
        }
        hull.pop();
        hull
    };
    let mut hull = chain(&mut sorted.iter());
    hull.extend(chain(&mut sorted.iter().rev()));
    hull
}
